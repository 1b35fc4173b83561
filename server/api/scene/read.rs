//! Reads the scene of a request: a preset, a scene, or a preset with a scene merged onto it, field by field by the table of fields.

use std::ops::RangeInclusive;

use equipoise_physics::map::polygon::{FARTHEST, FEWEST_VERTICES, MAX_VERTICES, Vertices};
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{
    Draft, FIELDS, Field, FieldKind, GAINS, Name, Scene, VERTICES, Value as FieldValue, field,
};
use serde_json::{Map, Value, json};

use crate::api::scene::fields::{description, example, explain, field_text, range, value_schema, with_vertices};
use crate::api::scene::presets;
use crate::http::problem::shortened;
use crate::http::request::fields::{FieldList, FieldSpec};
use crate::http::request::reader;
use crate::http::request::reader::{Source, did_you_mean, join};
use crate::http::{Errors, Reader};

/// The scene of a request: `preset`, with `scene` merged onto it.
#[derive(Debug, Clone, Copy)]
pub struct SceneSpec;

impl SceneSpec {
    fn describe(list: &mut FieldList) {
        let preset = json!({"$ref": "#/components/schemas/PresetName"});
        list.property("preset", "", &preset);
        list.property("scene", "", &json!({"$ref": "#/components/schemas/ScenePatch"}));
        let about = "Name of the preset to start from. Without one, the `scene.*` parameters have to give every required field. `null` removes a value of the preset.";
        list.parameter("preset", about, preset, Some(json!("case-1")));
        for path in FIELDS.iter().flat_map(|row| with_vertices(row.path)) {
            let row = FIELDS.iter().find(|row| row.path == path);
            let (about, schema, example) = match row {
                Some(row) if !matches!(row.kind, FieldKind::Numbers { .. }) => {
                    (description(row, false), value_schema(row), example(row))
                }
                Some(row) => (
                    list_about(path, &format!("{}. {}", field_text(row.name).about, range(row)), ".0` is the first"),
                    json!({"type": "object"}),
                    None,
                ),
                None => (
                    list_about(
                        path,
                        "Vertices of a polygon, counter-clockwise, m, in place of the two lengths.",
                        ".0.0` is x of the first",
                    ),
                    json!({"type": "object"}),
                    None,
                ),
            };
            list.parameter(&format!("scene.{path}"), &about, schema, example);
        }
    }
}

/// The word of a list whose numbers are parameters of their own.
fn list_about(path: &str, about: &str, first: &str) -> String {
    format!(
        "{about} Each number is a parameter of its own: `scene.{path}{first}. Indices have no gaps. The parameter itself is never sent by this bare name."
    )
}

impl FieldSpec<Scene> for SceneSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, _: &'static str) -> Option<Scene> {
        read_scene(reader)
    }

    fn describe(&self, _: &'static str, _: &str, list: &mut FieldList) {
        Self::describe(list);
    }
}

impl FieldSpec<Draft> for SceneSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, _: &'static str) -> Option<Draft> {
        read_draft(reader)
    }

    fn describe(&self, _: &'static str, _: &str, list: &mut FieldList) {
        Self::describe(list);
    }
}

/// The scene of a request in which the table follows no law of the scene.
#[derive(Debug, Clone, Copy)]
pub struct LawlessSceneSpec;

impl FieldSpec<Scene> for LawlessSceneSpec {
    fn read(&self, reader: &mut Reader<'_, '_>, _: &'static str) -> Option<Scene> {
        read_scene_without_law(reader)
    }

    fn describe(&self, _: &'static str, _: &str, list: &mut FieldList) {
        SceneSpec::describe(list);
    }
}

/// Reads the scene of a request: `preset` with `scene` merged onto it (RFC 7396), or either of them alone.
///
/// Returns None if something is wrong; the reader's errors then say what.
pub fn read_scene(reader: &mut Reader<'_, '_>) -> Option<Scene> {
    let draft = read_draft(reader)?;
    let pointer = reader.pointer_to("scene");
    build_scene(draft, &pointer, reader.errors())
}

/// Gives a draft without a law of the tilt a tilt gain of 1, because a scene needs a law to be built. Returns its own tilt gain.
pub fn complete_law(draft: &mut Draft) -> Option<f64> {
    let tilt_gain = match draft.get(Name::TiltGain) {
        Some(FieldValue::Number(kappa)) => Some(kappa),
        _ => None,
    };
    if tilt_gain.is_none() && GAINS.iter().all(|&name| draft.get(name).is_none()) {
        // 1 is within the range of the field.
        let _ = draft.set(Name::TiltGain, Some(FieldValue::Number(1.0)));
    }
    tilt_gain
}

/// [`read_scene`] for resources in which the table follows no law of the scene: it needs none.
pub fn read_scene_without_law(reader: &mut Reader<'_, '_>) -> Option<Scene> {
    let mut draft = read_draft(reader)?;
    complete_law(&mut draft);
    let pointer = reader.pointer_to("scene");
    build_scene(draft, &pointer, reader.errors())
}

/// Reads the scene of a request without building it: the caller may still set a field.
pub fn read_draft(reader: &mut Reader<'_, '_>) -> Option<Draft> {
    let (preset, changes) = (reader.text("preset"), reader.value("scene"));
    let (source, pointer) = (reader.source(), reader.pointer_to("scene"));
    let short: Vec<_> =
        short_groups(reader).into_iter().filter_map(|group| Some((group, reader.value(group)?))).collect();
    if preset.is_none() && changes.is_none() && short.is_empty() {
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
                format!("preset is {:?}; it must be {}", shortened(name), reader::one_of(&presets::names())),
            );
            return None;
        };
        draft = preset.draft();
    }
    let is_read = changes.is_none_or(|changes| merge(&mut draft, changes, &pointer, source, reader.errors()));
    (merge_short(&mut draft, short, reader) && is_read).then_some(draft)
}

/// Merges the fields of a scene that a query gives without `scene.` in front, as in `table.tilt_gain=1.2`. A body has them in `scene` alone.
fn merge_short(draft: &mut Draft, short: Vec<(&str, &Value)>, reader: &mut Reader<'_, '_>) -> bool {
    let (pointer, before) = (reader.pointer_to("scene"), reader.errors().len());
    for (group, value) in short {
        if reader.value("scene").and_then(|scene| scene.get(group)).is_some_and(|said| overlaps(said, value)) {
            reader.refuse(group, format!("{group} and scene.{group} both give a value; leave one of them out"));
            continue;
        }
        let changes = Value::Object([(group.to_owned(), value.clone())].into_iter().collect());
        merge(draft, &changes, &pointer, Source::Query, reader.errors());
    }
    reader.errors().len() == before
}

/// Groups of a scene that a query gives without `scene.` in front. A word of such a name, as `contact=stick` of a controller, is a field of the
/// request.
fn short_groups(reader: &Reader<'_, '_>) -> Vec<&'static str> {
    if reader.source() != Source::Query {
        return Vec::new();
    }
    let mut groups: Vec<&str> = FIELDS.iter().filter_map(|row| row.path.split('.').next()).collect();
    groups.dedup();
    let is_field = |group: &str| FIELDS.iter().any(|row| row.path == group);
    groups.retain(|group| reader.peek(group).is_some_and(|value| is_field(group) || value.is_object()));
    groups
}

/// Tells whether two trees give a value to the same field.
fn overlaps(one: &Value, other: &Value) -> bool {
    match (one, other) {
        (Value::Object(one), Value::Object(other)) => {
            one.iter().any(|(name, value)| other.get(name).is_some_and(|other| overlaps(value, other)))
        }
        _ => true,
    }
}

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
            self.errors.push(pointer, format!("{name} is {}; it must be an object", reader::shown(value)));
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
            return self.errors.push(pointer, format!("vertices is {}; it must be {wanted}", reader::shown(value)));
        };
        let before = self.errors.len();
        let mut places = Vec::with_capacity(items.len());
        for (index, item) in items.iter().enumerate() {
            let pointer = format!("{pointer}/{index}");
            let Some([x, y]) = item.as_array().map(Vec::as_slice) else {
                self.errors.push(pointer, format!("vertex {index} is {}; it must be [x, y] in m", reader::shown(item)));
                continue;
            };
            let mut coordinate = |axis: usize, value| {
                let read = reader::number_within(value, self.source, &(-FARTHEST..=FARTHEST), "m");
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
            reader::number_within(value, source, &(minimum..=maximum), row.unit).map(FieldValue::Number).map(Some)
        }
        (FieldKind::Integer { maximum }, _) => {
            reader::integer(value, source, &(0..=maximum)).map(FieldValue::Integer).map(Some)
        }
        (FieldKind::Choice(words), _) => {
            let known: Vec<_> = words.iter().map(|word| (*word, *word)).collect();
            reader::choice(value, &known).map(FieldValue::Choice).map(Some)
        }
        (FieldKind::Numbers { minimum, maximum, most }, _) => {
            read_numbers(row, value, source, &(minimum..=maximum), most).map(FieldValue::Numbers).map(Some)
        }
        (FieldKind::Flag, _) => reader::boolean(value, source).map(|flag| flag.then_some(FieldValue::Flag(true))),
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
    let wrong = || format!("is {}; it must be {}", reader::shown(value), row.limits());
    let items = value.as_array().filter(|items| items.len() <= most).ok_or_else(wrong)?;
    let number = |(index, item)| {
        reader::number_within(item, source, range, row.unit).map_err(|error| format!("at index {index} {error}"))
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

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::api::scene::derived::bounce_price;
    use crate::api::scene::write::scene_to_json;
    use crate::http::{Errors, Source};

    #[test]
    fn every_level_above_the_plain_rod_makes_bounces_dearer() {
        for (preset, price) in [("case-1", 1), ("point-mass", 2), ("triangle-polygon", 2), ("case-1-noise", 3)] {
            let scene = presets::find(preset).unwrap().draft().build().unwrap();
            assert_eq!(bounce_price(&scene), price, "{preset}");
        }
    }

    fn read_json(body: &Value) -> Result<Scene, Vec<(String, String)>> {
        let mut errors = Errors::default();
        let mut reader = Reader::new(body.as_object().unwrap(), String::new(), Source::Json, &mut errors);
        let scene = read_scene(&mut reader);
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
        let scene = scene_to_json(&read_json(&body).unwrap());
        assert_eq!(scene["table"]["tilt_gain"], 1.2);
        assert_eq!(scene["table"]["energy_gain"], 0.0);
        assert_eq!(scene["gravity"], 9.81);
        assert_eq!(scene["contact"]["restitution"], 0.5);
    }

    #[test]
    fn another_kind_of_body_replaces_the_presets() {
        let scene =
            read_json(&json!({"preset": "case-1", "scene": {"body": {"point": true}, "release": {"theta": null}}}));
        assert_eq!(scene_to_json(&scene.unwrap())["body"], json!({"point": true}));
        let body =
            json!({"preset": "point-mass", "scene": {"body": {"contact_distance": 0.1, "radius_of_gyration": 0.2}}});
        assert_eq!(scene_to_json(&read_json(&body).unwrap())["body"], body["scene"]["body"]);
        let both = json!({"preset": "case-1", "scene": {"body": {"point": true, "contact_distance": 0.1}}});
        assert!(read_json(&both).unwrap_err().iter().any(|(pointer, _)| pointer == "/scene/body/contact_distance"));
    }

    #[test]
    fn every_scene_reads_back_as_itself() {
        for preset in presets::all() {
            let scene = preset.draft().build().unwrap();
            assert_eq!(read_json(&json!({"scene": scene_to_json(&scene)})).unwrap(), scene, "{}", preset.name);
        }
    }

    #[test]
    fn a_dotted_name_is_refused_with_the_right_form() {
        for (scene, pointer, form) in [
            (json!({"table.tilt_gain": 1.2}), "/scene/table.tilt_gain", r#"{"table": {"tilt_gain": 1.2}}"#),
            (json!({"table": {"errors.speed": 0.1}}), "/scene/table/errors.speed", r#"{"errors": {"speed": 0.1}}"#),
            (json!({"body.vertices": [[0, 0]]}), "/scene/body.vertices", r#"{"body": {"vertices": […]}}"#),
            (json!({"table.errors": {"speed": 0.1}}), "/scene/table.errors", r#"{"table": {"errors": {…}}}"#),
            (json!({"table.strike": "still"}), "/scene/table.strike", r#"{"table": {"strike": "still"}}"#),
            (json!({"table.delay": null}), "/scene/table.delay", r#"{"table": {"delay": null}}"#),
        ] {
            let errors = read_json(&json!({"preset": "case-1", "scene": scene})).unwrap_err();
            assert_eq!(errors.len(), 1, "{errors:?}");
            assert_eq!(errors[0].0, pointer);
            assert!(errors[0].1.ends_with(&format!("has a dot in it; write {form}")), "{errors:?}");
        }
        let unknown = read_json(&json!({"preset": "case-1", "scene": {"table.tilt": 1}})).unwrap_err();
        assert!(unknown[0].1.starts_with("unknown field `table.tilt`"), "{unknown:?}");
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
                "unknown field `table.tilt` (did you mean `table.tilt_gain`?); known here: tilt_gain, energy_gain, target_height, energy_measure, \
                 energy_law, program, strike, slide, feedback, assumed_restitution, errors, \
                 tilt_rate, pivot, delay, prediction, length, limits",
            ),
            ("/scene/gravity", "gravity is \"9.81\"; it must be a number from 0.1 to 100 m/s², not text"),
            ("/scene/body/vertices", "vertices are 0; a polygon has from 3 to 32"),
            ("/scene/release", "release is 3; it must be an object"),
        ];
        for (pointer, detail) in expected {
            assert!(errors.contains(&(pointer.to_owned(), detail.to_owned())), "{pointer}: {errors:?}");
        }
    }

    #[test]
    fn a_query_may_leave_scene_out_of_its_names() {
        let read = |query: &str| {
            let parameters = crate::http::request::tree::parameters(query).unwrap();
            let fields = crate::http::request::tree::unfold(parameters).unwrap();
            let mut errors = Errors::default();
            let mut reader = Reader::new(&fields, String::new(), Source::Query, &mut errors);
            let scene = read_scene(&mut reader);
            reader.finish();
            let problem = errors.into_result().err();
            (scene.map(|scene| scene_to_json(&scene)), problem.map(|problem| problem.errors()[0].clone()))
        };
        let long = read("preset=case-1&scene.table.tilt_gain=1.2&scene.gravity=9.8&scene.release.theta=0.01");
        let short = read("preset=case-1&table.tilt_gain=1.2&gravity=9.8&scene.release.theta=0.01");
        assert_eq!((&long, &long.1), (&short, &None));
        let error = read("preset=case-1&table.tilt_gain=900").1.unwrap();
        assert_eq!(error.pointer, "/scene/table/tilt_gain");
        let error = read("preset=case-1&table.tilt_gian=1.2").1.unwrap();
        assert!(error.detail.contains("did you mean `table.tilt_gain`?"), "{}", error.detail);
        let error = read("preset=case-1&table.tilt_gain=1.2&scene.table.tilt_gain=1.3").1.unwrap();
        assert!(error.detail.contains("leave one of them out"), "{}", error.detail);
        let error = read_json(&json!({"preset": "case-1", "table": {"tilt_gain": 1.2}})).unwrap_err();
        assert_eq!(error[0].0, "/table");
    }
}
