//! Columns of rows, each declared once: name, unit, word, and how its value is read from a row.

use serde_json::{Value, json};

use crate::api::shared::table::gather::{ColumnKind, Gathered, Read};
use crate::api::shared::table::{Column, Table, with_unit};

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

    /// What the contract says of it.
    pub fn word(&self) -> ColumnWord {
        let Self { name, unit, about, ref read, words, always } = *self;
        let (kind, may_be_missing) = read.kind();
        ColumnWord { name, unit, about, kind: (kind, may_be_missing && !always), words, only: "" }
    }
}

/// A number with a unit, or none.
pub const fn number<R>(
    name: &'static str,
    unit: &'static str,
    about: &'static str,
    read: fn(&R) -> Option<f64>,
) -> RowColumn<R> {
    RowColumn::new(name, unit, about, Read::Sparse(read))
}

/// A whole number, or none.
pub const fn count<R>(name: &'static str, about: &'static str, read: fn(&R) -> Option<u64>) -> RowColumn<R> {
    RowColumn::new(name, "", about, Read::SparseCount(read))
}

/// A word of a list in the contract, or none.
pub const fn word<R>(
    name: &'static str,
    about: &'static str,
    read: fn(&R) -> Option<&'static str>,
    words: &'static str,
) -> RowColumn<R> {
    RowColumn::new(name, "", about, Read::Word(read)).among(words)
}

/// True or false, or none.
pub const fn flag<R>(name: &'static str, about: &'static str, read: fn(&R) -> Option<bool>) -> RowColumn<R> {
    RowColumn::new(name, "", about, Read::Flag(read))
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

/// What the contract says of a column.
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
