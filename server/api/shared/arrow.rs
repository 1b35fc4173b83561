//! A table as an IPC stream of Arrow: a schema with units and meanings, then record batches of bounded length.
//!
//! Whole numbers are `int64`, numbers `float64`, words a dictionary, numbers of 32 digits text. A value that does not exist is null. The
//! schema has the rest of the answer as JSON.

use std::io;
use std::io::Write;
use std::ops::Range;
use std::sync::Arc;

use arrow_array::types::{Float64Type, Int32Type};
use arrow_array::{
    ArrayRef, BooleanArray, DictionaryArray, Float64Array, Int32Array, Int64Array, ListArray, RecordBatch, StringArray,
};
use arrow_ipc::writer::StreamEncoder;
use arrow_schema::{ArrowError, DataType, Field, Metadata, Schema, SchemaRef};

use crate::api::shared::table::{Cells, Column, Table};
use crate::limits;

/// Key of the rest of the answer in the metadata of the schema.
const REST: &str = "equipoise";

/// A unit as it is written in JSON: `m_per_s` of a CSV header is `m/s`.
fn unit_sign(unit: &str) -> String {
    unit.replace("_per_", "/").replace('_', "·").replace('2', "²")
}

/// A column of a stream: its name, unit and meaning (either may be empty) and its type.
pub(crate) fn field(name: &str, unit: &str, about: &str, kind: DataType, nullable: bool) -> Field {
    let mut metadata = Metadata::new();
    if !matches!(unit, "" | "1") {
        metadata.insert("unit", unit_sign(unit));
    }
    if !about.is_empty() {
        metadata.insert("description", about);
    }
    Field::new(name, kind, nullable).with_metadata(metadata)
}

/// The words of a column. All batches share them, so that a stream has them once.
#[derive(Debug)]
pub(crate) struct Dictionary {
    words: Vec<&'static str>,
    values: ArrayRef,
}

impl Dictionary {
    /// These words, in their order.
    pub(crate) fn new(words: Vec<&'static str>) -> Self {
        let values = Arc::new(StringArray::from_iter_values(&words));
        Self { words, values }
    }

    /// The words of some cells, each once, in the order in which they come.
    fn of(cells: &[Option<&'static str>]) -> Self {
        let mut words = Vec::new();
        for word in cells.iter().flatten() {
            if !words.contains(word) {
                words.push(*word);
            }
        }
        Self::new(words)
    }

    /// The type of a column of these words.
    pub(crate) fn kind() -> DataType {
        DataType::Dictionary(Box::new(DataType::Int32), Box::new(DataType::Utf8))
    }

    /// A column of words.
    pub(crate) fn array(&self, cells: impl Iterator<Item = Option<&'static str>>) -> ArrayRef {
        let place = |word| self.words.iter().position(|own| *own == word).map(|place| place as i32);
        let keys: Int32Array = cells.map(|word| place(word?)).collect();
        Arc::new(DictionaryArray::<Int32Type>::new(keys, self.values.clone()))
    }
}

/// An IPC stream under way.
pub(crate) struct ArrowStream {
    schema: SchemaRef,
    encoder: StreamEncoder,
}

impl ArrowStream {
    /// A stream of these columns, with the rest of the answer as JSON.
    pub(crate) fn new(fields: Vec<Field>, rest: String) -> io::Result<Self> {
        let schema = Arc::new(Schema::new(fields).with_metadata(Metadata::new().with(REST, rest)));
        let encoder = StreamEncoder::try_new(&schema).map_err(io::Error::other)?;
        Ok(Self { schema, encoder })
    }

    /// Writes a batch of rows. The first one has the schema ahead of it.
    pub(crate) fn write(&mut self, columns: Vec<ArrayRef>, out: &mut impl Write) -> io::Result<()> {
        let batch = RecordBatch::try_new(self.schema.clone(), columns).map_err(io::Error::other)?;
        write_all(self.encoder.encode(&batch), out)
    }

    /// Writes the end of the stream.
    pub(crate) fn end(self, out: &mut impl Write) -> io::Result<()> {
        write_all(self.encoder.finish(), out)
    }
}

fn write_all(buffers: Result<Vec<impl AsRef<[u8]>>, ArrowError>, out: &mut impl Write) -> io::Result<()> {
    buffers.map_err(io::Error::other)?.iter().try_for_each(|buffer| out.write_all(buffer.as_ref()))
}

impl Cells {
    /// The type of the values, and true if some may be null.
    fn kind(&self) -> (DataType, bool) {
        match self {
            Self::Counts(_) => (DataType::Int64, false),
            Self::SparseCounts(_) => (DataType::Int64, true),
            Self::Numbers(_) => (DataType::Float64, false),
            Self::Sparse(_) => (DataType::Float64, true),
            Self::Words(_) => (Dictionary::kind(), true),
            Self::Flags(_) => (DataType::Boolean, true),
            Self::Texts(_) | Self::Decimals(_) => (DataType::Utf8, true),
            Self::Lists(_) => (DataType::new_list(DataType::Float64, true), true),
        }
    }

    /// Some values. Whole numbers are at most 2⁵³.
    fn array(&self, rows: Range<usize>, words: Option<&Dictionary>) -> ArrayRef {
        match self {
            Self::Counts(cells) => {
                Arc::new(Int64Array::from_iter_values(cells[rows].iter().map(|&count| count as i64)))
            }
            Self::SparseCounts(cells) => {
                Arc::new(cells[rows].iter().map(|count| count.map(|count| count as i64)).collect::<Int64Array>())
            }
            Self::Numbers(cells) => Arc::new(Float64Array::from_iter_values(cells[rows].iter().copied())),
            Self::Sparse(cells) => Arc::new(cells[rows].iter().copied().collect::<Float64Array>()),
            Self::Words(cells) => match words {
                Some(words) => words.array(cells[rows].iter().copied()),
                None => Dictionary::of(&cells[rows.clone()]).array(cells[rows].iter().copied()),
            },
            Self::Flags(cells) => Arc::new(cells[rows].iter().copied().collect::<BooleanArray>()),
            Self::Texts(cells) => Arc::new(cells[rows].iter().map(Option::as_deref).collect::<StringArray>()),
            Self::Decimals(cells) => {
                let digits = cells[rows].iter().map(|cell| cell.map(|number| number.to_string()));
                Arc::new(digits.collect::<StringArray>())
            }
            Self::Lists(cells) => {
                let lists = cells[rows].iter().map(|list| Some(list.as_ref()?.iter().copied().map(Some)));
                Arc::new(ListArray::from_iter_primitive::<Float64Type, _, _>(lists))
            }
        }
    }
}

impl Table {
    /// Writes an IPC stream of Arrow. `about` says what a column means, `rest` is the rest of the answer as JSON.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_arrow(
        &self,
        about: impl Fn(&str) -> &'static str,
        rest: String,
        out: &mut impl Write,
    ) -> io::Result<()> {
        let fields = self.0.iter().map(|Column { name, unit, cells }| {
            let (kind, nullable) = cells.kind();
            field(name, unit, about(name), kind, nullable)
        });
        let mut stream = ArrowStream::new(fields.collect(), rest)?;
        let words = |column: &Column| match &column.cells {
            Cells::Words(cells) => Some(Dictionary::of(cells)),
            _ => None,
        };
        let words: Vec<Option<Dictionary>> = self.0.iter().map(words).collect();
        for first in (0..self.rows()).step_by(limits::ARROW_BATCH_ROWS) {
            let rows = first..(first + limits::ARROW_BATCH_ROWS).min(self.rows());
            let arrays =
                self.0.iter().zip(&words).map(|(column, words)| column.cells.array(rows.clone(), words.as_ref()));
            stream.write(arrays.collect(), out)?;
        }
        stream.end(out)
    }
}
