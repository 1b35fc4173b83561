//! The table of scene fields as clients see it: forms and checkers of their own can be made from it.

use equipoise_physics::scene::{FIELDS, Field, Kind};
use serde::Serialize;
use serde_json::Value;

use crate::api::scene::write::value_to_json;

/// `GET /v1/fields`.
#[derive(Debug, Clone, Serialize)]
pub struct Fields {
    fields: Vec<Row>,
}

/// One field.
#[derive(Debug, Clone, Serialize)]
struct Row {
    path: &'static str,
    symbol: &'static str,
    group: &'static str,
    title: &'static str,
    about: &'static str,
    unit: &'static str,
    kind: &'static str,
    minimum: Option<Value>,
    maximum: Option<Value>,
    default: Option<Value>,
    required: bool,
    choices: Option<&'static [&'static str]>,
    live: bool,
}

impl Fields {
    /// All of them.
    pub fn all() -> Self {
        Self { fields: FIELDS.iter().map(Row::of).collect() }
    }
}

impl Row {
    fn of(row: &'static Field) -> Self {
        let (kind, minimum, maximum, choices) = match row.kind {
            Kind::Number { minimum, maximum } => ("number", Some(minimum.into()), Some(maximum.into()), None),
            Kind::Integer { maximum } => ("integer", Some(0.into()), Some(maximum.into()), None),
            Kind::Choice(words) => ("choice", None, None, Some(words)),
            Kind::Flag => ("boolean", None, None, None),
        };
        Self {
            path: row.path,
            symbol: row.symbol,
            group: row.group(),
            title: row.title,
            about: row.about,
            unit: row.unit,
            kind,
            minimum,
            maximum,
            default: row.default.map(value_to_json),
            required: row.required,
            choices,
            live: row.live,
        }
    }
}
