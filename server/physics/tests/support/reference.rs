//! The reference runs of `tests/reference`, as scenes.

use equipoise_physics::analysis::return_map::ReturnMap;
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{Draft, FIELDS, FieldKind, Scene, Value};
use nalgebra::DMatrix;
use serde_json::Value as Json;
use std::path::{Path, PathBuf};

/// Name, scene and what was computed with 60 digits, of those without friction.
#[allow(dead_code)]
pub(crate) fn frictionless() -> Vec<(String, Scene, Json)> {
    all().into_iter().filter(|(name, ..)| !name.starts_with("friction")).collect()
}

/// The same of all.
pub(crate) fn all() -> Vec<(String, Scene, Json)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference");
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let mut found = Vec::new();
    for file in files {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let reference: Json = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        match draft(&reference["scene"]) {
            Some(draft) => found.push((name, draft.build().unwrap(), reference)),
            None => panic!("{name} was refused"),
        }
    }
    found
}

fn draft(scene: &Json) -> Option<Draft> {
    let mut draft = Draft::default();
    for row in &FIELDS {
        let pointer = format!("/{}", row.path.replace('.', "/"));
        let Some(json) = scene.pointer(&pointer) else { continue };
        let value = match row.kind {
            FieldKind::Number { .. } => Value::Number(json.as_f64().unwrap()),
            FieldKind::Integer { .. } => Value::Integer(json.as_u64().unwrap()),
            FieldKind::Choice(words) => Value::Choice(words.iter().find(|word| Some(**word) == json.as_str()).unwrap()),
            FieldKind::Flag => Value::Flag(json.as_bool().unwrap()),
            FieldKind::Numbers { .. } => {
                let heights: Vec<f64> =
                    json.as_array().unwrap().iter().map(|height| height.as_f64().unwrap()).collect();
                Value::Numbers(HeightProgram::new(&heights).unwrap())
            }
        };
        draft.set(row.name, Some(value)).ok()?;
    }
    Some(draft)
}

/// Central differences of a map from a place and a state, with a step in m/s (m for ρθ), in the components of the map; `None` if a run that
/// starts so far aside ends before.
pub(crate) fn differences(map: &ReturnMap, x: f64, state: &State, step: f64) -> Option<DMatrix<f64>> {
    map.differences(&map.planned(&map.vector(state, x)), step)
}
