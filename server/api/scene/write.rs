//! Writes a scene with all its defaults, as JSON or as dotted query parameters that read back to the same scene.

use std::sync::LazyLock;

use equipoise_physics::scene::{FIELDS, Field, Name, Scene, VERTICES, Value as FieldValue};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

/// A scene as it is written in answers: nested, with all defaults filled in, and valid in a request.
#[derive(Debug, Clone, Copy)]
pub struct Resolved(pub Scene);

impl Serialize for Resolved {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Group { scene: &self.0, places: &PLACES, depth: 0 }.serialize(serializer)
    }
}

/// Writes a scene as [`Resolved`], for `#[serde(serialize_with = "resolved")]`.
///
/// # Errors
/// Those of the serializer.
pub fn resolved<S: Serializer>(scene: &Scene, serializer: S) -> Result<S::Ok, S::Error> {
    Resolved(*scene).serialize(serializer)
}

/// [`Resolved`] as a JSON value.
pub fn scene_to_json(scene: &Scene) -> Value {
    // A scene has finite numbers and text keys, so this does not fail.
    serde_json::to_value(Resolved(*scene)).unwrap_or_default()
}

/// A place of a scene in JSON.
#[derive(Debug)]
struct Place {
    /// The parts of its path.
    path: Vec<&'static str>,
    /// The field there; None for the vertices.
    field: Option<Name>,
}

/// All places, sorted by path: groups are together, and keys are in the order of JSON.
static PLACES: LazyLock<Vec<Place>> = LazyLock::new(|| {
    let fields = FIELDS.iter().map(|row| (row.path, Some(row.name)));
    let places = fields.chain([(VERTICES, None)]);
    let mut places: Vec<_> = places.map(|(path, field)| Place { path: path.split('.').collect(), field }).collect();
    places.sort_by(|one, other| one.path.cmp(&other.path));
    places
});

impl Place {
    /// The value of a scene here, if it has one.
    fn value(&self, scene: &Scene) -> Option<PlaceValue> {
        match self.field {
            Some(name) => scene.value(name).map(PlaceValue::Field),
            None => scene.vertices().map(|vertices| PlaceValue::Vertices(vertices.places().to_vec())),
        }
    }
}

/// The value at a place.
enum PlaceValue {
    Field(FieldValue),
    Vertices(Vec<[f64; 2]>),
}

impl Serialize for PlaceValue {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Field(FieldValue::Number(number)) => serializer.serialize_f64(*number),
            Self::Field(FieldValue::Integer(number)) => serializer.serialize_u64(*number),
            Self::Field(FieldValue::Choice(word)) => serializer.serialize_str(word),
            Self::Field(FieldValue::Flag(flag)) => serializer.serialize_bool(*flag),
            Self::Field(FieldValue::Numbers(list)) => list.heights().serialize(serializer),
            Self::Vertices(places) => places.serialize(serializer),
        }
    }
}

/// The values of a scene at places with the same parts of their paths up to a depth. Places without a value are left out.
struct Group<'a> {
    scene: &'a Scene,
    places: &'a [Place],
    depth: usize,
}

impl Serialize for Group<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { scene, places, depth } = *self;
        let mut map = serializer.serialize_map(None)?;
        for places in places.chunk_by(|one, other| one.path[depth] == other.path[depth]) {
            let (first, key) = (&places[0], places[0].path[depth]);
            if first.path.len() == depth + 1 {
                if let Some(value) = first.value(scene) {
                    map.serialize_entry(key, &value)?;
                }
            } else if places.iter().any(|place| place.value(scene).is_some()) {
                map.serialize_entry(key, &Group { scene, places, depth: depth + 1 })?;
            }
        }
        map.end()
    }
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
    // Finite numbers and words, so this does not fail.
    serde_json::to_value(PlaceValue::Field(value)).unwrap_or_default()
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
