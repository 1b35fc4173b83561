//! Every reference run without friction, computed with 60 digits: same outcome, same number of contacts, states as close
//! as the plain algorithm in doubles comes, or closer.

use equipoise_physics::map::{Body, run};
use equipoise_physics::scene::{Draft, FIELDS, Kind, Value};
use serde_json::Value as Json;
use std::path::{Path, PathBuf};

fn references() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/reference");
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files
}

fn draft(scene: &Json) -> Option<Draft> {
    let mut draft = Draft::default();
    for row in &FIELDS {
        let pointer = format!("/{}", row.path.replace('.', "/"));
        let Some(json) = scene.pointer(&pointer) else { continue };
        let value = match row.kind {
            Kind::Number { .. } => Value::Number(json.as_f64().unwrap()),
            Kind::Integer { .. } => Value::Integer(json.as_u64().unwrap()),
            Kind::Choice(words) => Value::Choice(words.iter().find(|word| Some(**word) == json.as_str()).unwrap()),
            Kind::Flag => Value::Flag(json.as_bool().unwrap()),
        };
        draft.set(row.name, Some(value)).ok()?;
    }
    Some(draft)
}

/// Distance of a double from a decimal of more digits than a double holds: the decimal's own rest counts too.
fn distance(value: f64, exact: &str) -> f64 {
    (value - exact.parse::<f64>().unwrap()).abs()
}

#[test]
fn every_frictionless_reference_agrees() {
    let mut seen = 0;
    for file in references() {
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let reference: Json = serde_json::from_str(&std::fs::read_to_string(&file).unwrap()).unwrap();
        let Some(draft) = draft(&reference["scene"]) else {
            assert!(name.starts_with("friction"), "{name} was refused");
            continue;
        };
        seen += 1;
        let scene = draft.build().unwrap();
        let mut orbit = scene.orbit().unwrap();
        let mut contacts = Vec::new();
        let ending = run(&mut orbit, reference["impacts"].as_u64().unwrap(), |contact| {
            contacts.push(*contact);
            true
        });
        assert_eq!(ending.unwrap().name(), reference["outcome"], "{name}");
        let states = &reference["states"];
        assert_eq!(contacts.len(), states["t"].as_array().unwrap().len(), "{name}");
        let mut worst: f64 = 0.0;
        for (index, contact) in contacts.iter().enumerate() {
            let ours = [
                ("t", contact.t),
                ("x", contact.x),
                ("theta", contact.state.theta),
                ("x_dot", contact.state.x_dot),
                ("y_dot", contact.state.y_dot),
                ("theta_dot", contact.state.theta_dot),
            ];
            for (column, value) in ours {
                worst = worst.max(distance(value, states[column][index].as_str().unwrap()));
            }
        }
        let plain = reference["plain_double_error"].as_f64().unwrap();
        let allowed = (10.0 * plain).max(1e-13);
        println!("{name}: error {worst:.2e}, plain doubles {plain:.2e}, allowed {allowed:.2e}");
        assert!(worst <= allowed, "{name}: error {worst:.2e}, allowed {allowed:.2e}");
        let energies: Vec<f64> = contacts.iter().map(|contact| orbit.body.energy(&contact.state)).collect();
        if scene.rung().name() == "rod" {
            let drift = energies.iter().map(|energy| (energy - energies[0]).abs()).fold(0.0, f64::max);
            assert!(drift <= allowed * 3.0, "{name}: energy drifts by {drift:.2e}");
        }
    }
    assert!(seen >= 11, "only {seen} references were run");
}
