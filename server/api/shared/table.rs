//! A table of results, defined once and written as JSON columns, CSV with units in its header, NDJSON rows, or an Arrow stream.

use std::io;
use std::io::Write;

use equipoise_physics::numbers::double_double::DoubleDouble;
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::{Value, json};

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name in JSON.
    pub name: &'static str,
    /// Unit, which CSV appends to the name: `m/s` or `m_per_s`. Empty for none.
    pub unit: &'static str,
    /// Values.
    pub cells: Cells,
}

/// A name with its unit for the header of CSV: `rad/s` and `rad_per_s` are written as `_rad_per_s`.
pub fn with_unit(name: &str, unit: &str) -> String {
    match unit {
        "" | "1" => name.to_owned(),
        _ => format!("{name}_{}", unit.replace('/', "_per_").replace('·', "_").replace('²', "2")),
    }
}

fn decimals<S: Serializer>(cells: &[Option<DoubleDouble>], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_seq(cells.iter().map(|cell| cell.map(Digits)))
}

/// A number of 32 digits as text.
struct Digits(DoubleDouble);

impl Serialize for Digits {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl Cells {
    /// All values as doubles, if every one exists.
    pub fn numbers(&self) -> Option<Vec<f64>> {
        match self {
            Self::Numbers(cells) => Some(cells.clone()),
            Self::Sparse(cells) => cells.iter().copied().collect(),
            Self::Decimals(cells) => cells.iter().map(|cell| cell.map(DoubleDouble::to_f64)).collect(),
            _ => None,
        }
    }

    /// Writes one value as CSV: numbers as in JSON, texts in quotes where necessary, nothing for none.
    fn write_csv(&self, row: usize, out: &mut Vec<u8>) {
        let text = match self {
            Self::Words(cells) => cells[row],
            Self::Texts(cells) => cells[row].as_deref(),
            Self::Decimals(cells) => {
                if let Some(number) = cells[row] {
                    // Writing to memory does not fail.
                    let _ = write!(out, "{number}");
                }
                return;
            }
            Self::Lists(cells) => {
                if cells[row].is_some() {
                    out.push(b'"');
                    self.write_json(row, out);
                    out.push(b'"');
                }
                return;
            }
            Self::Counts(_) | Self::Numbers(_) | Self::Sparse(_) | Self::SparseCounts(_) | Self::Flags(_) => {
                let start = out.len();
                self.write_json(row, out);
                if out[start..] == *b"null" {
                    out.truncate(start);
                }
                return;
            }
        };
        let text = text.unwrap_or_default();
        if text.contains([',', '"', '\r', '\n']) {
            out.extend_from_slice(format!("\"{}\"", text.replace('"', "\"\"")).as_bytes());
        } else {
            out.extend_from_slice(text.as_bytes());
        }
    }
}

/// Columns of equal length; as JSON an object of arrays.
#[derive(Debug, Clone, PartialEq)]
pub struct Table(pub Vec<Column>);

impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(self.0.len()))?;
        for column in &self.0 {
            map.serialize_entry(column.name, &column.cells)?;
        }
        map.end()
    }
}

impl Table {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.0.first().map_or(0, |column| column.cells.len())
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.rows() * self.0.len()
    }

    /// Length of the names of a row in NDJSON with their signs, bytes.
    pub fn names_bytes(&self) -> usize {
        self.0.iter().map(|column| column.name.len() + "\"\":".len()).sum()
    }

    /// Writes CSV by RFC 4180, with a header. A value that does not exist is an empty cell.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_csv(&self, out: &mut impl Write) -> io::Result<()> {
        let header: Vec<String> = self.0.iter().map(|Column { name, unit, .. }| with_unit(name, unit)).collect();
        out.write_all(header.join(",").as_bytes())?;
        out.write_all(b"\r\n")?;
        let mut line = Vec::new();
        for row in 0..self.rows() {
            line.clear();
            for (index, column) in self.0.iter().enumerate() {
                if index > 0 {
                    line.push(b',');
                }
                column.cells.write_csv(row, &mut line);
            }
            line.extend_from_slice(b"\r\n");
            out.write_all(&line)?;
        }
        Ok(())
    }

    /// Writes one JSON object for each row, then `{"end": …}`, so that a truncated answer is recognised.
    ///
    /// # Errors
    /// The errors of `out`.
    pub fn write_ndjson(&self, end: &impl Serialize, out: &mut impl Write) -> io::Result<()> {
        let mut line = Vec::new();
        for row in 0..self.rows() {
            line.clear();
            for (index, column) in self.0.iter().enumerate() {
                line.extend_from_slice(if index == 0 { b"{\"" } else { b",\"" });
                line.extend_from_slice(column.name.as_bytes());
                line.extend_from_slice(b"\":");
                column.cells.write_json(row, &mut line);
            }
            line.extend_from_slice(b"}\n");
            out.write_all(&line)?;
        }
        out.write_all(b"{\"end\":")?;
        serde_json::to_writer(&mut *out, end)?;
        out.write_all(b"}\n")
    }
}

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

/// Declares the kinds of values of a row: the function that reads one, the list of all, the type of a value, and its kind in the contract with
/// whether one may be missing.
macro_rules! kinds {
    ($($(#[doc = $about:literal])+ $read:ident, $cells:ident: $value:ty = $kind:ident, $may_be_missing:literal;)+) => {
        /// The values of a column.
        #[derive(Debug, Clone, PartialEq, Serialize)]
        #[serde(untagged)]
        pub enum Cells {
            $(#[doc = concat!("Values of [`Read::", stringify!($read), "`].")] $cells(Vec<$value>),)+
            /// Numbers of 32 digits as text, or none.
            #[serde(serialize_with = "decimals")]
            Decimals(Vec<Option<DoubleDouble>>),
        }

        impl Cells {
            fn len(&self) -> usize {
                match self {
                    $(Self::$cells(cells) => cells.len(),)+
                    Self::Decimals(cells) => cells.len(),
                }
            }

            /// Writes one value as JSON, `null` included.
            fn write_json(&self, row: usize, out: &mut Vec<u8>) {
                // Writing to memory does not fail.
                let _ = match self {
                    $(Self::$cells(cells) => serde_json::to_writer(out, &cells[row]),)+
                    Self::Decimals(cells) => serde_json::to_writer(out, &cells[row].map(Digits)),
                };
            }
        }

        /// Reads the value of a column from a row.
        #[derive(Debug)]
        pub enum Read<Row> {
            $($(#[doc = $about])+ $read(fn(&Row) -> $value),)+
        }

        impl<Row> Read<Row> {
            /// Kind of the values, and whether one may be missing.
            pub fn kind(self) -> (ColumnKind, bool) {
                match self {
                    $(Self::$read(_) => (ColumnKind::$kind, $may_be_missing),)+
                }
            }

            /// Writes the value of a row as a member of an object.
            pub fn write_member<M: SerializeMap>(self, row: &Row, name: &str, object: &mut M) -> Result<(), M::Error> {
                match self {
                    $(Self::$read(read) => object.serialize_entry(name, &read(row)),)+
                }
            }
        }

        /// The values of a column so far.
        #[derive(Debug)]
        pub enum Gathered<Row> {
            $(#[doc = concat!("Values of [`Read::", stringify!($read), "`].")] $cells(fn(&Row) -> $value, Vec<$value>),)+
        }

        impl<Row> Gathered<Row> {
            /// No values yet, with room for some.
            pub fn with_capacity(read: Read<Row>, room: usize) -> Self {
                match read {
                    $(Read::$read(read) => Self::$cells(read, Vec::with_capacity(room)),)+
                }
            }

            /// Adds the values of rows. Many at once cost less.
            pub fn extend(&mut self, rows: &[Row]) {
                match self {
                    $(Self::$cells(read, cells) => cells.extend(rows.iter().map(*read)),)+
                }
            }

            /// All values.
            pub fn into_cells(self) -> Cells {
                match self {
                    $(Self::$cells(_, cells) => Cells::$cells(cells),)+
                }
            }
        }
    };
}

kinds! {
    /// A whole number.
    Count, Counts: u64 = Count, false;
    /// A whole number, or none.
    SparseCount, SparseCounts: Option<u64> = Count, true;
    /// A finite number.
    Number, Numbers: f64 = Number, false;
    /// A number, or none.
    Sparse, Sparse: Option<f64> = Number, true;
    /// A word, or none.
    Word, Words: Option<&'static str> = Word, true;
    /// Yes, no, or none.
    Flag, Flags: Option<bool> = Flag, true;
    /// A sentence, or none.
    Text, Texts: Option<String> = Word, true;
    /// A list of numbers, or none.
    List, Lists: Option<Vec<f64>> = List, true;
}

impl<Row> Clone for Read<Row> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Row> Copy for Read<Row> {}

/// A column of rows.
#[derive(Debug)]
pub struct RowColumn<Row> {
    /// Name in JSON.
    pub name: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Meaning, as the contract says it.
    pub about: &'static str,
    /// Reads the value.
    pub read: Read<Row>,
    /// Schema of its words in the contract; empty for any.
    pub words: &'static str,
    /// True if no value is missing, whatever `read` allows.
    pub always: bool,
}

impl<Row> RowColumn<Row> {
    /// A column.
    pub const fn new(name: &'static str, unit: &'static str, about: &'static str, read: Read<Row>) -> Self {
        Self { name, unit, about, read, words: "", always: false }
    }

    /// The same column, whose words are those of a schema.
    #[must_use]
    pub const fn among(self, words: &'static str) -> Self {
        Self { words, ..self }
    }

    /// The same column, of which no value is missing.
    #[must_use]
    pub const fn always(self) -> Self {
        Self { always: true, ..self }
    }

    /// Description in the contract.
    pub fn word(&self) -> ColumnWord {
        let Self { name, unit, about, ref read, words, always } = *self;
        let (kind, may_be_missing) = read.kind();
        ColumnWord { name, unit, about, kind: (kind, may_be_missing && !always), words, only: "" }
    }
}

/// The table of some rows.
pub fn table_of<'a, Row: 'a>(columns: impl IntoIterator<Item = &'a RowColumn<Row>>, rows: &[Row]) -> Table {
    let column = |column: &RowColumn<Row>| {
        let mut gathered = Gathered::with_capacity(column.read, rows.len());
        gathered.extend(rows);
        Column { name: column.name, unit: column.unit, cells: gathered.into_cells() }
    };
    Table(columns.into_iter().map(column).collect())
}

/// The meaning of the column of this name; empty if there is none.
pub fn about<'a, Row: 'a>(columns: impl IntoIterator<Item = &'a RowColumn<Row>>, name: &str) -> &'static str {
    columns.into_iter().find(|column| column.name == name).map_or("", |column| column.about)
}

/// Description of a column in the contract.
#[derive(Debug, Clone, Copy)]
pub struct ColumnWord {
    /// Name in JSON.
    pub name: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Meaning.
    pub about: &'static str,
    /// Kind of its values, and whether one may be missing.
    pub kind: (ColumnKind, bool),
    /// Schema of its words; empty for any.
    pub words: &'static str,
    /// When answers have it, as in "with `epoch_ms`"; empty for always.
    pub only: &'static str,
}

impl ColumnWord {
    /// The same column, which only some answers have.
    #[must_use]
    pub const fn only(self, only: &'static str) -> Self {
        Self { only, ..self }
    }

    /// Name in the header of CSV.
    pub fn csv_name(&self) -> String {
        with_unit(self.name, self.unit)
    }

    /// Schema of a value.
    pub fn schema(&self) -> Value {
        let (kind, may_be_missing) = self.kind;
        let kind = match kind {
            // Generated clients take 32 bits otherwise.
            ColumnKind::Count => json!({"type": "integer", "format": "int64", "minimum": 0}),
            ColumnKind::Number => json!({"type": "number"}),
            ColumnKind::Digits => json!({"$ref": "#/components/schemas/Decimal"}),
            ColumnKind::Word if !self.words.is_empty() => {
                json!({"$ref": format!("#/components/schemas/{}", self.words)})
            }
            ColumnKind::Word => json!({"type": "string"}),
            ColumnKind::Flag => json!({"type": "boolean"}),
            ColumnKind::List => json!({"type": "array", "items": {"type": "number"}}),
        };
        let mut schema = match (may_be_missing, kind["type"].as_str()) {
            (true, Some(name)) => {
                let mut schema = kind.clone();
                schema["type"] = json!([name, "null"]);
                schema
            }
            (true, None) => json!({"anyOf": [kind, {"type": "null"}]}),
            (false, _) => kind,
        };
        if !self.unit.is_empty() {
            schema["x-unit"] = json!(self.unit);
        }
        if !self.about.is_empty() {
            schema["description"] = json!(self.about);
        }
        schema
    }

    /// Name of the schema of the whole column, where it has one.
    fn named_list(&self) -> Option<&'static str> {
        match (self.kind, self.words) {
            ((ColumnKind::Number, true), _) => Some("NumbersOrNull"),
            ((ColumnKind::Flag, true), _) => Some("BooleansOrNull"),
            ((ColumnKind::Digits, false), _) => Some("Decimals"),
            ((ColumnKind::Digits, true), _) => Some("DecimalsOrNull"),
            ((ColumnKind::Word, true), "ContactMode") => Some("ContactModes"),
            ((ColumnKind::Word, true), "BranchChangeKind") => Some("BranchChangeKinds"),
            _ => None,
        }
    }

    /// Schema of the whole column in JSON.
    pub fn list_schema(&self) -> Value {
        let mut items = self.schema();
        let about = items.as_object_mut().and_then(|items| items.shift_remove("description"));
        let unit = items.as_object_mut().and_then(|items| items.shift_remove("x-unit"));
        // Lists with gaps have names: openapi-generator has no form of its own for them in Rust.
        let mut schema = match self.named_list() {
            Some(name) => json!({"$ref": format!("#/components/schemas/{name}")}),
            None => json!({"type": "array", "items": items}),
        };
        for (key, value) in [("x-unit", unit), ("description", about)] {
            if let Some(value) = value {
                schema[key] = value;
            }
        }
        schema
    }
}

/// Schemas of lists that have names of their own, and of a number with all its digits.
pub fn named_lists() -> [(&'static str, Value); 8] {
    let reference = |name: &str| json!({"$ref": format!("#/components/schemas/{name}")});
    let list = |items: Value| json!({"type": "array", "items": items});
    let or_null = |name: &str| json!({"anyOf": [reference(name), {"type": "null"}]});
    let number = json!({"title": "Number", "type": "number"});
    let text = json!({"title": "Text", "type": "string", "pattern": r"^-?[0-9]+(\.[0-9]+)?(e-?[0-9]+)?$"});
    let about = "A number; with the method `extended`, a decimal string of 32 digits.";
    [
        ("Decimal", json!({"description": about, "oneOf": [number, text]})),
        ("DecimalOrNull", json!({"description": about, "anyOf": [{"type": "null"}, number, text]})),
        ("Decimals", list(reference("Decimal"))),
        ("DecimalsOrNull", list(reference("DecimalOrNull"))),
        ("NumbersOrNull", list(json!({"type": ["number", "null"]}))),
        ("BooleansOrNull", list(json!({"type": ["boolean", "null"]}))),
        ("ContactModes", list(or_null("ContactMode"))),
        ("BranchChangeKinds", list(or_null("BranchChangeKind"))),
    ]
}

/// The schema of columns in JSON: an object of lists of equal length.
pub fn columns_schema(about: &str, columns: &[ColumnWord]) -> Value {
    object_schema(about, columns, ColumnWord::list_schema)
}

/// The schema of a row.
pub fn row_schema(about: &str, columns: &[ColumnWord]) -> Value {
    object_schema(about, columns, ColumnWord::schema)
}

fn object_schema(about: &str, columns: &[ColumnWord], schema: fn(&ColumnWord) -> Value) -> Value {
    let required: Vec<_> = columns.iter().filter(|column| column.only.is_empty()).map(|column| column.name).collect();
    let properties: serde_json::Map<_, _> =
        columns.iter().map(|column| (column.name.to_owned(), schema(column))).collect();
    json!({
        "type": "object",
        "description": about,
        "additionalProperties": false,
        "required": required,
        "properties": properties,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(write: impl FnOnce(&mut Vec<u8>) -> io::Result<()>) -> String {
        let mut out = Vec::new();
        write(&mut out).unwrap();
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn one_table_three_ways() {
        let table = Table(vec![
            Column { name: "n", unit: "", cells: Cells::Counts(vec![1, 2]) },
            Column { name: "t", unit: "s", cells: Cells::Numbers(vec![0.1, 1e21]) },
            Column { name: "flight_time", unit: "s", cells: Cells::Sparse(vec![Some(0.5), None]) },
            Column { name: "contact_mode", unit: "", cells: Cells::Words(vec![Some("stick"), None]) },
            Column { name: "why", unit: "", cells: Cells::Texts(vec![None, Some("a, \"b\"".to_owned())]) },
        ]);
        assert_eq!(
            serde_json::to_string(&table).unwrap(),
            r#"{"n":[1,2],"t":[0.1,1e+21],"flight_time":[0.5,null],"contact_mode":["stick",null],"why":[null,"a, \"b\""]}"#
        );
        assert_eq!(
            text(|out| table.write_csv(out)),
            "n,t_s,flight_time_s,contact_mode,why\r\n1,0.1,0.5,stick,\r\n2,1e+21,,,\"a, \"\"b\"\"\"\r\n"
        );
        assert_eq!(
            text(|out| table.write_ndjson(&"done", out)),
            "{\"n\":1,\"t\":0.1,\"flight_time\":0.5,\"contact_mode\":\"stick\",\"why\":null}\n\
             {\"n\":2,\"t\":1e+21,\"flight_time\":null,\"contact_mode\":null,\"why\":\"a, \\\"b\\\"\"}\n{\"end\":\"done\"}\n"
        );
    }
}
