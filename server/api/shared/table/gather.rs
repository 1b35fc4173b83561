//! Gathers the values of a column row by row.

use serde::ser::SerializeMap;

use crate::api::shared::table::Cells;

/// Kinds of values in a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnKind {
    /// Whole numbers.
    Count,
    /// Numbers.
    Number,
    /// Numbers as text, with all their digits.
    Digits,
    /// Words.
    Word,
    /// Yes or no.
    Flag,
    /// Lists of numbers.
    List,
}

/// Reads the value of a column from a row.
#[derive(Debug)]
pub enum Read<Row> {
    /// A whole number.
    Count(fn(&Row) -> u64),
    /// A whole number, or none.
    SparseCount(fn(&Row) -> Option<u64>),
    /// A finite number.
    Number(fn(&Row) -> f64),
    /// A number, or none.
    Sparse(fn(&Row) -> Option<f64>),
    /// A word, or none.
    Word(fn(&Row) -> Option<&'static str>),
    /// Yes, no, or none.
    Flag(fn(&Row) -> Option<bool>),
    /// A sentence, or none.
    Text(fn(&Row) -> Option<String>),
    /// A list of numbers, or none.
    List(fn(&Row) -> Option<Vec<f64>>),
}

impl<Row> Clone for Read<Row> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Row> Copy for Read<Row> {}

impl<Row> Read<Row> {
    /// Kind of the values, and whether one may be missing.
    pub fn kind(self) -> (ColumnKind, bool) {
        match self {
            Self::Count(_) => (ColumnKind::Count, false),
            Self::SparseCount(_) => (ColumnKind::Count, true),
            Self::Number(_) => (ColumnKind::Number, false),
            Self::Sparse(_) => (ColumnKind::Number, true),
            Self::Word(_) | Self::Text(_) => (ColumnKind::Word, true),
            Self::Flag(_) => (ColumnKind::Flag, true),
            Self::List(_) => (ColumnKind::List, true),
        }
    }

    /// Writes the value of a row as a member of an object.
    pub fn write_member<M: SerializeMap>(self, row: &Row, name: &str, object: &mut M) -> Result<(), M::Error> {
        match self {
            Self::Count(read) => object.serialize_entry(name, &read(row)),
            Self::SparseCount(read) => object.serialize_entry(name, &read(row)),
            Self::Number(read) => object.serialize_entry(name, &read(row)),
            Self::Sparse(read) => object.serialize_entry(name, &read(row)),
            Self::Word(read) => object.serialize_entry(name, &read(row)),
            Self::Flag(read) => object.serialize_entry(name, &read(row)),
            Self::Text(read) => object.serialize_entry(name, &read(row)),
            Self::List(read) => object.serialize_entry(name, &read(row)),
        }
    }
}

/// The values of a column so far.
#[derive(Debug)]
pub enum Gathered<Row> {
    /// Values of [`Read::Count`].
    Counts(fn(&Row) -> u64, Vec<u64>),
    /// Values of [`Read::SparseCount`].
    SparseCounts(fn(&Row) -> Option<u64>, Vec<Option<u64>>),
    /// Values of [`Read::Number`].
    Numbers(fn(&Row) -> f64, Vec<f64>),
    /// Values of [`Read::Sparse`].
    Sparse(fn(&Row) -> Option<f64>, Vec<Option<f64>>),
    /// Values of [`Read::Word`].
    Words(fn(&Row) -> Option<&'static str>, Vec<Option<&'static str>>),
    /// Values of [`Read::Flag`].
    Flags(fn(&Row) -> Option<bool>, Vec<Option<bool>>),
    /// Values of [`Read::Text`].
    Texts(fn(&Row) -> Option<String>, Vec<Option<String>>),
    /// Values of [`Read::List`].
    Lists(fn(&Row) -> Option<Vec<f64>>, Vec<Option<Vec<f64>>>),
}

impl<Row> Gathered<Row> {
    /// No values yet, with room for some.
    pub fn with_capacity(read: Read<Row>, room: usize) -> Self {
        match read {
            Read::Count(read) => Self::Counts(read, Vec::with_capacity(room)),
            Read::SparseCount(read) => Self::SparseCounts(read, Vec::with_capacity(room)),
            Read::Number(read) => Self::Numbers(read, Vec::with_capacity(room)),
            Read::Sparse(read) => Self::Sparse(read, Vec::with_capacity(room)),
            Read::Word(read) => Self::Words(read, Vec::with_capacity(room)),
            Read::Flag(read) => Self::Flags(read, Vec::with_capacity(room)),
            Read::Text(read) => Self::Texts(read, Vec::with_capacity(room)),
            Read::List(read) => Self::Lists(read, Vec::with_capacity(room)),
        }
    }

    /// Adds the value of a row.
    pub fn push(&mut self, row: &Row) {
        self.extend(std::slice::from_ref(row));
    }

    /// Adds the values of rows. Many at once cost less.
    pub fn extend(&mut self, rows: &[Row]) {
        match self {
            Self::Counts(read, cells) => cells.extend(rows.iter().map(*read)),
            Self::SparseCounts(read, cells) => cells.extend(rows.iter().map(*read)),
            Self::Numbers(read, cells) => cells.extend(rows.iter().map(*read)),
            Self::Sparse(read, cells) => cells.extend(rows.iter().map(*read)),
            Self::Words(read, cells) => cells.extend(rows.iter().map(*read)),
            Self::Flags(read, cells) => cells.extend(rows.iter().map(*read)),
            Self::Texts(read, cells) => cells.extend(rows.iter().map(*read)),
            Self::Lists(read, cells) => cells.extend(rows.iter().map(*read)),
        }
    }

    /// All values.
    pub fn into_cells(self) -> Cells {
        match self {
            Self::Counts(_, cells) => Cells::Counts(cells),
            Self::SparseCounts(_, cells) => Cells::SparseCounts(cells),
            Self::Numbers(_, cells) => Cells::Numbers(cells),
            Self::Sparse(_, cells) => Cells::Sparse(cells),
            Self::Words(_, cells) => Cells::Words(cells),
            Self::Flags(_, cells) => Cells::Flags(cells),
            Self::Texts(_, cells) => Cells::Texts(cells),
            Self::Lists(_, cells) => Cells::Lists(cells),
        }
    }
}
