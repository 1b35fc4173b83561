//! Scenes in the contract, from the table of scene fields: as they are asked for, answered, and set during a run.

use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, PI};

use equipoise_physics::map::polygon::{FARTHEST, MAX_VERTICES};
use equipoise_physics::scene::{FIELDS, Field, FieldKind, Name, VERTICES, Value as FieldValue};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde_json::{Map, Value, json};

use crate::api::scene::fields::field_text;
use crate::api::scene::write::{Resolved, value_to_json};
use crate::api::schemas::component;
use crate::schema_names;

impl JsonSchema for Resolved<'_> {
    fn schema_name() -> Cow<'static, str> {
        "Scene".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schemars::json_schema!({"$ref": "#/components/schemas/Scene"})
    }
}

schema_names! {
    pub PresetName;
    pub ScenePatch;
}

/// A number for people: multiples of π as such.
pub fn number(value: f64) -> String {
    match value {
        PI => "π".to_owned(),
        FRAC_PI_2 => "π/2".to_owned(),
        _ if value == -PI => "-π".to_owned(),
        _ => value.to_string(),
    }
}

/// Range and default of a field in a sentence; empty if it has neither.
pub(super) fn range(row: &Field) -> String {
    let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
    let default = match row.default {
        Some(FieldValue::Number(value)) => Some(number(value)),
        Some(FieldValue::Choice(word)) => Some(format!("`{word}`")),
        Some(value) => Some(value.to_string()),
        None => None,
    };
    let range = match row.kind {
        FieldKind::Numbers { minimum, maximum, most } => {
            Some(format!("from 1 to {most} numbers, each from {} to {}{unit}", number(minimum), number(maximum)))
        }
        FieldKind::Number { minimum, maximum } => {
            Some(format!("from {} to {}{unit}", number(minimum), number(maximum)))
        }
        FieldKind::Integer { maximum } => Some(format!("from 0 to {maximum}")),
        FieldKind::Choice(_) | FieldKind::Flag => None,
    };
    let parts: Vec<String> = range.into_iter().chain(default.map(|value| format!("by default {value}"))).collect();
    let mut sentence = parts.join(", ");
    if let Some(first) = sentence.get(..1).map(str::to_uppercase) {
        sentence.replace_range(..1, &first);
        sentence.push('.');
    }
    sentence
}

pub(super) fn description(row: &Field, with_detail: bool) -> String {
    let text = field_text(row.name);
    let detail = if with_detail { text.detail } else { "" };
    let sentences = [text.about, detail].into_iter().filter(|part| !part.is_empty()).map(|part| format!("{part}."));
    let all: Vec<String> = sentences.chain([range(row)]).filter(|part| !part.is_empty()).collect();
    all.join(" ")
}

/// An example of a value in a query.
pub(super) fn example(row: &Field) -> Option<Value> {
    let text = field_text(row.name).example;
    let number = serde_json::from_str(text).ok();
    number.or((!text.is_empty()).then(|| json!(text)))
}

/// The values that a field takes.
pub(super) fn value_schema(row: &Field) -> Value {
    let mut schema = match row.kind {
        FieldKind::Number { minimum, maximum } => json!({"type": "number", "minimum": minimum, "maximum": maximum}),
        FieldKind::Integer { maximum } => {
            let mut schema = json!({"type": "integer", "minimum": 0, "maximum": maximum});
            // Generated clients take 32 bits otherwise.
            if maximum > i32::MAX as u64 {
                schema["format"] = json!("int64");
            }
            schema
        }
        FieldKind::Choice(_) => json!({"$ref": format!("#/components/schemas/{}", component(row.path))}),
        FieldKind::Flag => json!({"type": "boolean"}),
        FieldKind::Numbers { minimum, maximum, most } => json!({
            "type": "array", "minItems": 1, "maxItems": most, "items": {"type": "number", "minimum": minimum, "maximum": maximum},
        }),
    };
    if let Some(value) = row.default {
        schema["x-default"] = value_to_json(value);
    }
    if !matches!(row.kind, FieldKind::Choice(_) | FieldKind::Flag) {
        schema["x-unit"] = json!(row.unit);
    }
    let symbol = field_text(row.name).symbol;
    if !symbol.is_empty() {
        schema["x-symbol"] = json!(symbol);
    }
    schema
}

/// Schemas of the fields that are one of some words. Each has a name, because generators declare one type for each.
pub fn choices() -> impl Iterator<Item = (String, Value)> {
    FIELDS.iter().filter_map(|row| match row.kind {
        FieldKind::Choice(words) => Some((component(row.path), json!({"type": "string", "enum": words}))),
        _ => None,
    })
}

fn field_schema(path: &str) -> Value {
    let Some(row) = FIELDS.iter().find(|row| row.path == path) else { return vertices() };
    let mut schema = value_schema(row);
    schema["description"] = json!(description(row, true));
    schema
}

const VERTICES_WORD: &str = "A polygon: vertices [x, y] of a sheet of even density, in metres, counter-clockwise, anywhere in the plane. The outline must not meet itself. \
    Centre of gravity, l and ρ follow from it. The polygon is turned so that at θ = 0 the centre of gravity is straight above the contact vertex. It \
    bounces as the rod of that l and ρ. The run ends as `other_vertex` as soon as another vertex touches the table.";

fn vertices() -> Value {
    json!({
        "type": "array",
        "minItems": 3,
        "maxItems": MAX_VERTICES,
        "items": {
            "type": "array", "minItems": 2, "maxItems": 2,
            "items": {"type": "number", "minimum": -FARTHEST, "maximum": FARTHEST},
        },
        "x-unit": "m",
        "description": VERTICES_WORD,
    })
}

/// The vertices stand before the contact vertex, which is one of them.
pub(super) fn with_vertices(path: &'static str) -> Vec<&'static str> {
    if path == Name::ContactVertex.row().path { vec![VERTICES, path] } else { vec![path] }
}

/// Forms in which a scene stands in the contract.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// As it is asked for: null takes a value back.
    Patch,
    /// As it is answered.
    Answer,
    /// As it is set during a run.
    Live,
}

/// A scene as it is asked for.
pub fn patch() -> Value {
    let mut schema = tree(Form::Patch, "");
    schema["description"] =
        json!("A scene, or what changes in that of the preset. Null takes a value of the preset back.");
    schema["type"] = json!("object");
    schema
}

/// A scene as it is answered.
pub fn scene() -> Value {
    let mut schema = tree(Form::Answer, "");
    schema["description"] = json!("The scene with all defaults. It is valid in a request.");
    schema
}

/// The fields that can be set during a run, nested or by dotted path.
pub fn live_fields() -> Value {
    let mut schema = tree(Form::Live, "");
    for row in FIELDS.iter().filter(|row| row.live) {
        schema["properties"][row.path] = field_schema(row.path);
    }
    schema["description"] = json!("Fields that can be set during a run, nested or by dotted path.");
    schema["minProperties"] = json!(1);
    schema
}

/// The same by dotted path alone.
pub fn live_paths() -> Map<String, Value> {
    let live = FIELDS.iter().filter(|row| row.live);
    live.map(|row| (row.path.to_owned(), field_schema(row.path))).collect()
}

/// An object of the fields below `group` (empty or ending in a dot).
fn tree(form: Form, group: &str) -> Value {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    let paths = FIELDS.iter().filter(|row| form != Form::Live || row.live).flat_map(|row| with_vertices(row.path));
    for path in paths.filter(|path| form != Form::Live || *path != VERTICES) {
        let Some(rest) = path.strip_prefix(group) else { continue };
        let (key, is_group) = rest.split_once('.').map_or((rest, false), |(key, _)| (key, true));
        if properties.contains_key(key) {
            continue;
        }
        let schema = match (form, is_group, key) {
            (Form::Answer, true, "body") => bodies(),
            (_, true, _) => tree(form, &format!("{group}{key}.")),
            (_, false, _) => field_schema(path),
        };
        properties.insert(key.to_owned(), if form == Form::Patch { or_null(schema) } else { schema });
    }
    if form == Form::Answer {
        let below = FIELDS.iter().filter(|row| is_always_answered(row)).filter_map(|row| row.path.strip_prefix(group));
        for key in below.map(|rest| rest.split('.').next().unwrap_or(rest)) {
            if !required.contains(&key) {
                required.push(key);
            }
        }
    }
    let mut schema = json!({"type": "object", "additionalProperties": false});
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    schema["properties"] = Value::Object(properties);
    schema
}

fn or_null(mut schema: Value) -> Value {
    match schema.as_object_mut().and_then(|schema| schema.shift_remove("$ref")) {
        Some(of_words) => schema["anyOf"] = json!([{"$ref": of_words}, {"type": "null"}]),
        None => schema["type"] = json!([schema["type"], "null"]),
    }
    schema
}

/// Tells whether every scene that is answered has the field. A point mass has no angle, and state feedback no tilt gain.
fn is_always_answered(row: &Field) -> bool {
    let depends = matches!(row.name, Name::Theta | Name::ThetaDot | Name::TiltGain);
    (row.default.is_some() || row.required) && !depends
}

/// The three kinds of body, each with all of its fields.
fn bodies() -> Value {
    let [length, rho, offset, point, contact_vertex] =
        [Name::ContactDistance, Name::RadiusOfGyration, Name::Offset, Name::PointMass, Name::ContactVertex]
            .map(|name| name.row().path);
    let kinds = [
        ("A rod.", vec![length, rho], vec![offset]),
        ("A point mass.", vec![point], vec![]),
        ("A polygon.", vec![VERTICES, contact_vertex], vec![]),
    ];
    let body = |(about, paths, optional): (&str, Vec<&str>, Vec<&str>)| {
        let key = |path: &&str| path.trim_start_matches("body.").to_owned();
        let properties: Map<_, _> = paths.iter().chain(&optional).map(|path| (key(path), field_schema(path))).collect();
        json!({
            "type": "object",
            "description": about,
            "additionalProperties": false,
            "required": paths.iter().map(key).collect::<Vec<_>>(),
            "properties": properties,
        })
    };
    json!({"oneOf": kinds.map(body)})
}
