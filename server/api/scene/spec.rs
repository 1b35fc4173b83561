//! The scene as a declared field of a request.

use equipoise_physics::scene::{Draft, FIELDS, FieldKind, Scene};
use serde_json::json;

use crate::api::scene::fields::field_text;
use crate::api::scene::read::{read_draft, read_scene, read_scene_without_law};
use crate::api::scene::schema::{description, example, range, value_schema, with_vertices};
use crate::http::Reader;
use crate::http::request::fields::{FieldList, FieldSpec};

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
