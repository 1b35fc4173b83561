//! Reads the scene of a request: a preset, a scene, or a preset with a scene merged onto it.

use equipoise_physics::scene::{Draft, FIELDS, GAINS, Name, Scene, Value};
use serde_json::Value as JsonValue;

use crate::api::scene::merge::{build_scene, merge};
use crate::api::scene::presets;
use crate::http::Reader;
use crate::http::problem::shortened;
use crate::http::request::scalar;
use crate::http::request::scalar::Source;

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
        Some(Value::Number(kappa)) => Some(kappa),
        _ => None,
    };
    if tilt_gain.is_none() && GAINS.iter().all(|&name| draft.get(name).is_none()) {
        // 1 is within the range of the field.
        let _ = draft.set(Name::TiltGain, Some(Value::Number(1.0)));
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
                format!("preset is {:?}; it must be {}", shortened(name), scalar::one_of(&presets::names())),
            );
            return None;
        };
        draft = preset.draft();
    }
    let is_read = changes.is_none_or(|changes| merge(&mut draft, changes, &pointer, source, reader.errors()));
    (merge_short(&mut draft, short, reader) && is_read).then_some(draft)
}

/// Merges the fields of a scene that a query gives without `scene.` in front, as in `table.tilt_gain=1.2`. A body has them in `scene` alone.
fn merge_short(draft: &mut Draft, short: Vec<(&str, &JsonValue)>, reader: &mut Reader<'_, '_>) -> bool {
    let (pointer, before) = (reader.pointer_to("scene"), reader.errors().len());
    for (group, value) in short {
        if reader.value("scene").and_then(|scene| scene.get(group)).is_some_and(|said| overlaps(said, value)) {
            reader.refuse(group, format!("{group} and scene.{group} both give a value; leave one of them out"));
            continue;
        }
        let changes = JsonValue::Object([(group.to_owned(), value.clone())].into_iter().collect());
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
fn overlaps(one: &JsonValue, other: &JsonValue) -> bool {
    match (one, other) {
        (JsonValue::Object(one), JsonValue::Object(other)) => {
            one.iter().any(|(name, value)| other.get(name).is_some_and(|other| overlaps(value, other)))
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::scene::price::bounce_price;
    use crate::api::scene::write::scene_to_json;
    use crate::http::{Errors, Source};
    use serde_json::{Value, json};

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
            let parameters = crate::http::request::query::parameters(query).unwrap();
            let fields = crate::http::request::query::unfold(parameters).unwrap();
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
