//! Merges a JSON scene, or one made of dotted query parameters, onto a draft: field by field by the table of fields.

use equipoise_physics::map::polygon::{FARTHEST, FEWEST_VERTICES, MAX_VERTICES, Vertices};
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{Draft, FIELDS, Field, FieldKind, Scene, VERTICES, Value as FieldValue, field};
use serde_json::{Map, Value};
use std::ops::RangeInclusive;

use crate::api::scene::fields::explain;
use crate::http::Errors;
use crate::http::problem::shortened;
use crate::http::request::reader::join;
use crate::http::request::scalar;
use crate::http::request::scalar::Source;
use crate::http::request::suggestion::did_you_mean;

/// Merges `changes`, which stand at `pointer`, onto a draft; null takes a value back. Returns false if there were errors.
pub(super) fn merge(draft: &mut Draft, changes: &Value, pointer: &str, source: Source, errors: &mut Errors) -> bool {
    let before = errors.len();
    Merger { draft, source, errors }.object(changes, "", pointer);
    errors.len() == before
}

/// Builds the scene of a draft whose fields stand at `pointer`.
pub fn build_scene(draft: Draft, pointer: &str, errors: &mut Errors) -> Option<Scene> {
    match draft.build() {
        Ok(scene) => Some(scene),
        Err(found) => {
            for error in explain(found) {
                errors.push(format!("{pointer}/{}", error.path.replace('.', "/")), error.detail);
            }
            None
        }
    }
}

/// Walks down a JSON scene along the table of fields.
struct Merger<'a> {
    draft: &'a mut Draft,
    source: Source,
    errors: &'a mut Errors,
}

impl Merger<'_> {
    fn object(&mut self, value: &Value, path: &str, pointer: &str) {
        let Some(fields) = value.as_object() else {
            let name = path.rsplit('.').next().filter(|name| !name.is_empty()).unwrap_or("scene");
            self.errors.push(pointer, format!("{name} is {}; it must be an object", scalar::shown(value)));
            return;
        };
        if path == "body" {
            self.replace_other_kind_of_body(fields);
        }
        for (key, value) in fields {
            let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
            let pointer = join(pointer, key);
            if key.contains('.') && is_known(&path) {
                let shown = shortened(&path);
                self.errors.push(pointer, format!("the name `{shown}` has a dot in it; write {}", nested(key, value)));
            } else if let Some(row) = field(&path) {
                self.leaf(row, value, &pointer);
            } else if is_group(&path) {
                if value.is_null() {
                    self.forget(&path);
                } else {
                    self.object(value, &path, &pointer);
                }
            } else if path == VERTICES {
                self.vertices(value, &pointer);
            } else {
                let meant = did_you_mean(&path, FIELDS.iter().map(|row| row.path));
                let known = known_beside(&path).join(", ");
                self.errors.push(pointer, format!("unknown field `{}`{meant}; known here: {known}", shortened(&path)));
            }
        }
    }

    fn leaf(&mut self, row: &'static Field, value: &Value, pointer: &str) {
        match read_value(row, value, self.source) {
            Ok(value) => {
                if let Err(error) = self.draft.set(row.name, value) {
                    self.errors.push(pointer, error.detail);
                }
            }
            Err(error) => self.errors.push(pointer, format!("{} {error}", row.key())),
        }
    }

    /// A body of another kind replaces the preset's body whole; one of the same kind is merged onto it.
    fn replace_other_kind_of_body(&mut self, fields: &Map<String, Value>) {
        let says = |key: &str| fields.get(key).is_some_and(|value| !value.is_null());
        let (point, polygon) = (says("point"), says("vertices"));
        let rod = says("contact_distance") || says("radius_of_gyration");
        let another = match (self.draft.is_point(), self.draft.vertices().is_some()) {
            (true, _) => !point && (polygon || rod),
            (false, true) => !polygon && (point || rod),
            (false, false) => point || polygon,
        };
        if another {
            self.forget("body");
        }
    }

    /// An array of [x, y], replaced whole.
    fn vertices(&mut self, value: &Value, pointer: &str) {
        let wanted = format!("an array of {FEWEST_VERTICES} to {MAX_VERTICES} points [x, y] in m, counter-clockwise");
        if value.is_null() {
            return self.draft.set_vertices(None);
        }
        let Some(items) = value.as_array().filter(|items| items.len() <= MAX_VERTICES) else {
            return self.errors.push(pointer, format!("vertices is {}; it must be {wanted}", scalar::shown(value)));
        };
        let before = self.errors.len();
        let mut places = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            let pointer = format!("{pointer}/{index}");
            let Some([x, y]) = item.as_array().map(Vec::as_slice) else {
                self.errors.push(pointer, format!("vertex {index} is {}; it must be [x, y] in m", scalar::shown(item)));
                continue;
            };
            let mut coordinate = |axis: usize, value| {
                let read = scalar::number_within(value, self.source, &(-FARTHEST..=FARTHEST), "m");
                let name = ["x", "y"][axis];
                read.map_err(|error| {
                    self.errors.push(format!("{pointer}/{axis}"), format!("{name} of vertex {index} {error}"))
                })
                .unwrap_or_default()
            };
            places.push([coordinate(0, x), coordinate(1, y)]);
        }
        if self.errors.len() > before {
            return;
        }
        match Vertices::new(&places) {
            Ok(vertices) => self.draft.set_vertices(Some(vertices)),
            Err(error) => self.errors.push(pointer, error.to_string()),
        }
    }

    fn forget(&mut self, group: &str) {
        for row in FIELDS.iter().filter(|row| row.path.strip_prefix(group).is_some_and(|rest| rest.starts_with('.'))) {
            // Clearing a value cannot fail.
            let _ = self.draft.set(row.name, None);
        }
        if VERTICES.strip_prefix(group).is_some_and(|rest| rest.starts_with('.')) {
            self.draft.set_vertices(None);
        }
    }
}

/// Reads the value of a field in a request; None for null. The error continues a sentence that begins with the name of the field.
pub fn read_value(row: &'static Field, value: &Value, source: Source) -> Result<Option<FieldValue>, String> {
    match (row.kind, value) {
        (_, Value::Null) => Ok(None),
        // A query has no other way to take a value back.
        (_, Value::String(text)) if source == Source::Query && text == "null" => Ok(None),
        (FieldKind::Number { minimum, maximum }, _) => {
            scalar::number_within(value, source, &(minimum..=maximum), row.unit).map(FieldValue::Number).map(Some)
        }
        (FieldKind::Integer { maximum }, _) => {
            scalar::integer(value, source, &(0..=maximum)).map(FieldValue::Integer).map(Some)
        }
        (FieldKind::Choice(words), _) => {
            let known: Vec<_> = words.iter().map(|word| (*word, *word)).collect();
            scalar::choice(value, &known).map(FieldValue::Choice).map(Some)
        }
        (FieldKind::Numbers { minimum, maximum, most }, _) => {
            read_numbers(row, value, source, &(minimum..=maximum), most).map(FieldValue::Numbers).map(Some)
        }
        (FieldKind::Flag, _) => scalar::boolean(value, source).map(|flag| flag.then_some(FieldValue::Flag(true))),
    }
}

/// Reads a list of numbers.
fn read_numbers(
    row: &'static Field,
    value: &Value,
    source: Source,
    range: &RangeInclusive<f64>,
    most: usize,
) -> Result<HeightProgram, String> {
    let wrong = || format!("is {}; it must be {}", scalar::shown(value), row.limits());
    let items = value.as_array().filter(|items| items.len() <= most).ok_or_else(wrong)?;
    let number = |(index, item)| {
        scalar::number_within(item, source, range, row.unit).map_err(|error| format!("at index {index} {error}"))
    };
    let numbers = items.iter().enumerate().map(number).collect::<Result<Vec<f64>, String>>()?;
    HeightProgram::new(&numbers).ok_or_else(wrong)
}

/// True if there are fields below this path.
fn is_group(path: &str) -> bool {
    FIELDS.iter().any(|row| row.path.strip_prefix(path).is_some_and(|rest| rest.starts_with('.')))
}

/// True if a scene may have something at this path.
fn is_known(path: &str) -> bool {
    field(path).is_some() || is_group(path) || path == VERTICES
}

/// A dotted name and its value as objects within each other.
fn nested(name: &str, value: &Value) -> String {
    let value = match value {
        Value::Array(_) => "[…]".to_owned(),
        Value::Object(_) => "{…}".to_owned(),
        Value::String(text) => format!("{:?}", shortened(text)),
        Value::Null | Value::Bool(_) | Value::Number(_) => value.to_string(),
    };
    name.rsplit('.').fold(value, |inner, part| format!("{{\"{part}\": {inner}}}"))
}

/// Names that may stand in place of the last part of `path`.
fn known_beside(path: &str) -> Vec<&'static str> {
    let group = path.rsplit_once('.').map_or("", |(group, _)| group);
    let mut names: Vec<_> = FIELDS
        .iter()
        .map(|row| row.path)
        .chain([VERTICES])
        .filter_map(|path| match group {
            "" => Some(path),
            group => path.strip_prefix(group)?.strip_prefix('.'),
        })
        .filter_map(|rest| rest.split('.').next())
        .collect();
    // Keeps the first of each.
    let mut seen = Vec::new();
    names.retain(|name| {
        !seen.contains(name) && {
            seen.push(*name);
            true
        }
    });
    names
}
