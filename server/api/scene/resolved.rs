//! Scenes as JSON or as dotted query parameters: read field by field from the table of fields, and the vertices of a polygon
//! beside it; written back with all defaults filled in.

use equipoise_physics::body::polygon::{FARTHEST, MAX_VERTICES, Vertices};
use equipoise_physics::scene::model::Rung;
use equipoise_physics::scene::{Draft, FIELDS, Field, Kind, Name, Scene, VERTICES, Value as FieldValue, field};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};

use crate::api::scene::presets;
use crate::http::problem::shortened;
use crate::http::request::reader::join;
use crate::http::request::scalar;
use crate::http::request::scalar::Source;
use crate::http::{Errors, Reader};

/// The scene of a request: `preset`, with `scene` merged onto it (RFC 7396), or either of them alone.
///
/// None if something is wrong; then it is in the reader's errors.
pub fn read(reader: &mut Reader<'_, '_>) -> Option<Scene> {
    let draft = read_draft(reader)?;
    let pointer = reader.pointer_to("scene");
    build(draft, &pointer, reader.errors())
}

/// [`read`] for what is derived for frictionless contacts only.
pub fn read_frictionless(reader: &mut Reader<'_, '_>) -> Option<Scene> {
    read_within(reader, &[])
}

/// [`read`] for what is derived for the plain rod and some rungs above it.
pub fn read_within(reader: &mut Reader<'_, '_>, known: &[Rung]) -> Option<Scene> {
    let scene = read(reader)?;
    let pointer = reader.pointer_to("scene");
    if let Some(error) = scene.beyond(known) {
        reader.errors().push(format!("{pointer}/{}", error.path.replace('.', "/")), error.detail);
        return None;
    }
    Some(scene)
}

/// What a request says of its scene, not yet built: something else may still set a field of it.
pub fn read_draft(reader: &mut Reader<'_, '_>) -> Option<Draft> {
    let (preset, changes) = (reader.text("preset"), reader.value("scene"));
    let (source, pointer) = (reader.source(), reader.pointer_to("scene"));
    if preset.is_none() && changes.is_none() {
        if !reader.has("preset") {
            reader.refuse_whole("give a scene, a preset, or a preset and what to change in its scene");
        }
        return None;
    }
    let mut draft = Draft::default();
    if let Some(name) = preset {
        let Some(preset) = presets::find(name) else {
            reader.refuse(
                "preset",
                format!("preset is {:?}; it must be {}", shortened(name), scalar::one_of(&presets::names())),
            );
            return None;
        };
        draft = preset.draft();
    }
    changes.is_none_or(|changes| merge(&mut draft, changes, &pointer, source, reader.errors())).then_some(draft)
}

/// Merges `changes`, which stand at `pointer`, onto a draft and builds the scene. Null takes a value back.
pub fn apply(
    draft: &mut Draft,
    changes: Option<&Value>,
    pointer: &str,
    source: Source,
    errors: &mut Errors,
) -> Option<Scene> {
    let merged = changes.is_none_or(|changes| merge(draft, changes, pointer, source, errors));
    if merged { build(*draft, pointer, errors) } else { None }
}

/// Whether all of `changes` could be said.
fn merge(draft: &mut Draft, changes: &Value, pointer: &str, source: Source, errors: &mut Errors) -> bool {
    let before = errors.len();
    Walk { draft, source, errors }.object(changes, "", pointer);
    errors.len() == before
}

/// The scene of a draft whose fields stand at `pointer`.
pub fn build(draft: Draft, pointer: &str, errors: &mut Errors) -> Option<Scene> {
    match draft.build() {
        Ok(scene) => Some(scene),
        Err(found) => {
            for error in found {
                errors.push(format!("{pointer}/{}", error.path.replace('.', "/")), error.detail);
            }
            None
        }
    }
}

/// Goes down a JSON scene with the table of fields in hand.
struct Walk<'a> {
    draft: &'a mut Draft,
    source: Source,
    errors: &'a mut Errors,
}

impl Walk<'_> {
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
            if let Some(row) = field(&path) {
                self.leaf(row, value, &pointer);
            } else if FIELDS.iter().any(|row| row.path.starts_with(&format!("{path}."))) {
                if value.is_null() {
                    self.forget(&path);
                } else {
                    self.object(value, &path, &pointer);
                }
            } else if path == VERTICES {
                self.vertices(value, &pointer);
            } else {
                let known = known_beside(&path).join(", ");
                self.errors.push(pointer, format!("unknown field `{}`; known here: {known}", shortened(&path)));
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
        let wanted = format!("an array of 3 to {MAX_VERTICES} points [x, y] in m, counter-clockwise");
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
            // Taking a value back is always admitted.
            let _ = self.draft.set(row.name, None);
        }
        if VERTICES.strip_prefix(group).is_some_and(|rest| rest.starts_with('.')) {
            self.draft.set_vertices(None);
        }
    }
}

/// The value of a field as a request says it, none for null. The error continues a sentence that begins with the
/// field's name.
pub fn read_value(row: &'static Field, value: &Value, source: Source) -> Result<Option<FieldValue>, String> {
    match (row.kind, value) {
        (_, Value::Null) => Ok(None),
        // The only way to take a value back in a query.
        (_, Value::String(text)) if source == Source::Query && text == "null" => Ok(None),
        (Kind::Number { minimum, maximum }, _) => {
            scalar::number_within(value, source, &(minimum..=maximum), row.unit).map(FieldValue::Number).map(Some)
        }
        (Kind::Integer { maximum }, _) => {
            scalar::integer(value, source, &(0..=maximum)).map(FieldValue::Integer).map(Some)
        }
        (Kind::Choice(words), _) => {
            let known: Vec<_> = words.iter().map(|word| (*word, *word)).collect();
            scalar::choice(value, &known).map(FieldValue::Choice).map(Some)
        }
        (Kind::Flag, _) => scalar::boolean(value, source).map(|flag| flag.then_some(FieldValue::Flag(true))),
    }
}

/// The names that may stand where the last part of `path` stands.
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
    // In the order in which they come first.
    let mut seen = Vec::new();
    names.retain(|name| {
        !seen.contains(name) && {
            seen.push(*name);
            true
        }
    });
    names
}

/// A scene as it is written in answers: nested, all defaults filled in, ready to be asked again.
#[derive(Debug, Clone, Copy)]
pub struct Resolved<'a>(pub &'a Scene);

impl Serialize for Resolved<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        to_json(self.0).serialize(serializer)
    }
}

/// [`Resolved`] as a JSON value.
pub fn to_json(scene: &Scene) -> Value {
    let vertices = scene
        .vertices()
        .map(|vertices| (VERTICES, Value::from_iter(vertices.places().iter().map(|place| Value::from_iter(*place)))));
    let values = FIELDS.iter().filter_map(|row| Some((row.path, value_to_json(scene.value(row.name)?))));
    let mut root = Map::new();
    for (path, value) in values.chain(vertices) {
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
    }
}

/// The scene as dotted query parameters (`scene.table.tilt_gain`, `1.1`), which read back to the same scene.
pub fn to_query(scene: &Scene) -> Vec<(String, String)> {
    let written = |value| match value_to_json(value) {
        Value::String(text) => text,
        other => other.to_string(),
    };
    let places = scene.vertices().map_or(&[][..], |vertices| vertices.places());
    let vertices = places.iter().enumerate().flat_map(|(vertex, place)| {
        let name = move |axis: usize| format!("scene.{VERTICES}.{vertex}.{axis}");
        [0, 1].map(|axis| (name(axis), written(FieldValue::Number(place[axis]))))
    });
    let values = FIELDS.iter().filter_map(|row| Some((format!("scene.{}", row.path), written(scene.value(row.name)?))));
    values.chain(vertices).collect()
}

/// The angle fields of a body, which a point mass does not have.
pub fn has_angle(scene: &Scene) -> bool {
    scene.value(Name::PointMass).is_none()
}

/// Price of a bounce of a scene at most, in bounces of the plain rod.
pub fn bounce_price(scene: &Scene) -> u64 {
    let vertices = scene.vertices().map_or(0, |vertices| vertices.places().len() as u64);
    let dearer = scene.forced().into_iter().map(|forced| if forced.rung == Rung::Noise { 2 } else { 1 });
    1 + u64::from(!has_angle(scene)) + vertices / 8 + dearer.sum::<u64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_rung_above_the_plain_rod_makes_bounces_dearer() {
        for (preset, price) in [("case-1", 1), ("point-mass", 2), ("triangle-polygon", 2), ("case-1-noise", 3)] {
            let scene = presets::find(preset).unwrap().draft().build().unwrap();
            assert_eq!(bounce_price(&scene), price, "{preset}");
        }
    }

    fn read_json(body: &Value) -> Result<Scene, Vec<(String, String)>> {
        let mut errors = Errors::default();
        let mut reader = Reader::new(body.as_object().unwrap(), String::new(), Source::Json, &mut errors);
        let scene = read(&mut reader);
        reader.finish();
        let found = errors.into_result().err().map(|problem| {
            problem.errors().iter().map(|error| (error.pointer.clone(), error.detail.clone())).collect::<Vec<_>>()
        });
        found.map_or_else(|| Ok(scene.unwrap()), Err)
    }

    #[test]
    fn changes_are_merged_onto_a_preset_and_null_takes_back() {
        let body =
            json!({"preset": "case-4", "scene": {"table": {"tilt_gain": 1.2, "energy_gain": null}, "gravity": null}});
        let scene = to_json(&read_json(&body).unwrap());
        assert_eq!(scene["table"]["tilt_gain"], 1.2);
        assert_eq!(scene["table"]["energy_gain"], 0.0);
        assert_eq!(scene["gravity"], 9.81);
        assert_eq!(scene["contact"]["restitution"], 0.5);
    }

    #[test]
    fn another_kind_of_body_replaces_the_presets() {
        let scene =
            read_json(&json!({"preset": "case-1", "scene": {"body": {"point": true}, "release": {"theta": null}}}));
        assert_eq!(to_json(&scene.unwrap())["body"], json!({"point": true}));
        let body =
            json!({"preset": "point-mass", "scene": {"body": {"contact_distance": 0.1, "radius_of_gyration": 0.2}}});
        assert_eq!(to_json(&read_json(&body).unwrap())["body"], body["scene"]["body"]);
        let both = json!({"preset": "case-1", "scene": {"body": {"point": true, "contact_distance": 0.1}}});
        assert!(read_json(&both).unwrap_err().iter().any(|(pointer, _)| pointer == "/scene/body/contact_distance"));
    }

    #[test]
    fn every_scene_reads_back_as_itself() {
        for preset in presets::all() {
            let scene = preset.draft().build().unwrap();
            assert_eq!(read_json(&json!({"scene": to_json(&scene)})).unwrap(), scene, "{}", preset.name);
        }
    }

    #[test]
    fn errors_point_to_the_field_and_name_limit_and_unit() {
        let body = json!({"preset": "case-1", "scene": {
            "table": {"tilt_gain": 5000, "tilt": 1}, "gravity": "9.81", "body": {"vertices": []}, "release": 3}});
        let errors = read_json(&body).unwrap_err();
        let expected = [
            ("/scene/table/tilt_gain", "tilt_gain is 5000; it must be from -100 to 100 (no unit)"),
            (
                "/scene/table/tilt",
                "unknown field `table.tilt`; known here: tilt_gain, energy_gain, target_height, strike, slide, feedback, \
                 assumed_restitution, limits",
            ),
            ("/scene/gravity", "gravity is \"9.81\"; it must be a number from 0.1 to 100 m/s², not text"),
            ("/scene/body/vertices", "vertices are 0; a polygon has from 3 to 32"),
            ("/scene/release", "release is 3; it must be an object"),
        ];
        for (pointer, detail) in expected {
            assert!(errors.contains(&(pointer.to_owned(), detail.to_owned())), "{pointer}: {errors:?}");
        }
    }
}
