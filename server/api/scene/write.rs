//! Writes a scene with all its defaults, as JSON or as dotted query parameters that read back to the same scene.

use equipoise_physics::scene::{FIELDS, Field, Scene, VERTICES, Value as FieldValue};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

/// A scene as it is written in answers: nested, with all defaults filled in, and valid in a request.
#[derive(Debug, Clone, Copy)]
pub struct Resolved<'a>(pub &'a Scene);

impl Serialize for Resolved<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        scene_to_json(self.0).serialize(serializer)
    }
}

/// [`Resolved`] as a JSON value.
pub fn scene_to_json(scene: &Scene) -> Value {
    let vertices = scene
        .vertices()
        .map(|vertices| (VERTICES, Value::from_iter(vertices.places().iter().map(|place| Value::from_iter(*place)))));
    let values = FIELDS.iter().filter_map(|row| Some((row.path, value_to_json(scene.value(row.name)?))));
    nested(values.chain(vertices))
}

/// Nests values by their dotted paths.
pub(super) fn nested<'a>(values: impl Iterator<Item = (&'a str, Value)>) -> Value {
    let mut root = Map::new();
    for (path, value) in values {
        let mut parts = path.split('.').peekable();
        let mut at = &mut root;
        while let Some(part) = parts.next() {
            if parts.peek().is_none() {
                at.insert(part.to_owned(), value);
                break;
            }
            let group = at.entry(part).or_insert_with(|| Value::Object(Map::new()));
            let Value::Object(group) = group else { break };
            at = group;
        }
    }
    Value::Object(root)
}

/// The value of a field as JSON.
pub fn value_to_json(value: FieldValue) -> Value {
    match value {
        FieldValue::Number(number) => Value::from(number),
        FieldValue::Integer(number) => Value::from(number),
        FieldValue::Choice(word) => Value::from(word),
        FieldValue::Flag(flag) => Value::from(flag),
        FieldValue::Numbers(list) => Value::from(list.heights()),
    }
}

/// The scene as dotted query parameters (`scene.table.tilt_gain`, `1.1`), which read back to the same scene.
pub fn scene_to_query(scene: &Scene) -> Vec<(String, String)> {
    let places = scene.vertices().map_or(&[][..], |vertices| vertices.places());
    let vertices = places.iter().enumerate().flat_map(|(vertex, place)| {
        let name = move |axis: usize| format!("scene.{VERTICES}.{vertex}.{axis}");
        [0, 1].map(|axis| (name(axis), Value::from(place[axis]).to_string()))
    });
    let value = |row: &'static Field| Some(value_to_query(format!("scene.{}", row.path), scene.value(row.name)?));
    FIELDS.iter().filter_map(value).flatten().chain(vertices).collect()
}

/// The value of the field `name` as query parameters: one for each number of a list.
pub fn value_to_query(name: String, value: FieldValue) -> Vec<(String, String)> {
    match value_to_json(value) {
        Value::String(text) => vec![(name, text)],
        Value::Array(items) => {
            items.iter().enumerate().map(|(index, item)| (format!("{name}.{index}"), item.to_string())).collect()
        }
        other => vec![(name, other.to_string())],
    }
}
