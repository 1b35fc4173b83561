//! Readers of tables: an Arrow stream as JSON values, by the library's reader, and CSV by RFC 4180, strictly: CRLF line ends, rows of one width,
//! quotes only around whole cells.

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int8Type, Int32Type, Int64Type};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_ipc::reader::StreamReader;
use arrow_schema::{DataType, SchemaRef};
use serde_json::{Value, json};

/// A stream that was read to its end.
pub(crate) struct Stream {
    pub(crate) schema: SchemaRef,
    pub(crate) batches: Vec<RecordBatch>,
}

impl Stream {
    /// Reads a stream. An error says why it is none.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, String> {
        let mut rest = std::io::Cursor::new(bytes);
        let reader = StreamReader::try_new(&mut rest, None).map_err(|error| error.to_string())?;
        let schema = reader.schema();
        let batches: Result<Vec<_>, _> = reader.collect();
        let batches = batches.map_err(|error| error.to_string())?;
        // A stream ends with its own mark, so that one that is cut off is recognised.
        if !bytes.ends_with(&[0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0]) {
            return Err("the stream has no end".to_owned());
        }
        Ok(Self { schema, batches })
    }

    pub(crate) fn rows(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    pub(crate) fn names(&self) -> Vec<&str> {
        self.schema.fields().iter().map(|field| field.name().as_str()).collect()
    }

    /// Metadata of a column.
    pub(crate) fn about(&self, name: &str, key: &str) -> Option<&str> {
        self.schema.field_with_name(name).expect("a column").metadata().get(key).map(String::as_str)
    }

    /// The values of a column.
    pub(crate) fn column(&self, name: &str) -> Vec<Value> {
        let index = self.schema.index_of(name).unwrap_or_else(|_| panic!("no column {name}"));
        self.batches.iter().flat_map(|batch| values(batch.column(index))).collect()
    }

    /// The rest of the answer.
    pub(crate) fn rest(&self) -> Value {
        serde_json::from_str(self.schema.metadata().get("equipoise").expect("the rest of the answer")).expect("JSON")
    }
}

/// The values of an array, null included.
fn values(array: &ArrayRef) -> Vec<Value> {
    let valid = |row: usize, value: &dyn Fn() -> Value| if array.is_null(row) { Value::Null } else { value() };
    let each = |value: &dyn Fn(usize) -> Value| (0..array.len()).map(|row| valid(row, &|| value(row))).collect();
    match array.data_type() {
        DataType::Int8 => each(&|row| json!(array.as_primitive::<Int8Type>().value(row))),
        DataType::Int64 => each(&|row| json!(array.as_primitive::<Int64Type>().value(row))),
        DataType::Float64 => each(&|row| json!(array.as_primitive::<Float64Type>().value(row))),
        DataType::Boolean => each(&|row| json!(array.as_boolean().value(row))),
        DataType::Utf8 => each(&|row| json!(array.as_string::<i32>().value(row))),
        DataType::Dictionary(..) => {
            let words = array.as_dictionary::<Int32Type>();
            each(&|row| json!(words.values().as_string::<i32>().value(words.keys().value(row) as usize)))
        }
        DataType::List(_) => each(&|row| Value::Array(values(&array.as_list::<i32>().value(row)))),
        DataType::FixedSizeList(..) => each(&|row| Value::Array(values(&array.as_fixed_size_list().value(row)))),
        other => panic!("a column of {other}"),
    }
}

/// A header row and the rows under it.
pub(crate) struct Table {
    pub(crate) names: Vec<String>,
    pub(crate) rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads a text. Errors name the broken rule.
    pub(crate) fn parse(text: &str) -> Result<Self, String> {
        if !text.ends_with("\r\n") {
            return Err("the last line does not end with CRLF".into());
        }
        if text.replace("\r\n", "").contains(['\r', '\n']) {
            return Err("a line ends with something else than CRLF".into());
        }
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(false).from_reader(text.as_bytes());
        let mut rows: Vec<Vec<String>> = Vec::new();
        for row in reader.records() {
            rows.push(row.map_err(|error| error.to_string())?.iter().map(str::to_owned).collect());
        }
        if rows.is_empty() {
            return Err("no header row".into());
        }
        let names = rows.remove(0);
        Ok(Self { names, rows })
    }

    /// The cells of a column.
    #[track_caller]
    pub(crate) fn column(&self, name: &str) -> Vec<&str> {
        let index = self.names.iter().position(|known| known == name);
        let index = index.unwrap_or_else(|| panic!("no column {name} among {:?}", self.names));
        self.rows.iter().map(|row| row[index].as_str()).collect()
    }
}
