//! Accuracy gained by holding the energy, measured against runs near upright with 50 digits (`tests/oracle/runs.py`).
//! `cargo test -p equipoise-physics accuracy:: -- --nocapture` prints it.

use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Value};
use serde_json::Value as Json;

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Largest error of a component of the state at contact 100.
fn error(sample: &Json, holds_energy: bool) -> f64 {
    let mut draft = Draft::default();
    for (name, pointer) in [
        (Name::ContactDistance, "/body/contact_distance"),
        (Name::RadiusOfGyration, "/body/radius_of_gyration"),
        (Name::TiltGain, "/table/tilt_gain"),
        (Name::Height, "/release/height"),
        (Name::Theta, "/release/theta"),
        (Name::ThetaDot, "/release/theta_dot"),
        (Name::XDot, "/release/x_dot"),
    ] {
        draft.set(name, Some(Value::Number(sample.pointer(pointer).unwrap().as_f64().unwrap()))).unwrap();
    }
    let scene = draft.build().unwrap();
    let rules = Rules { holds_energy, ..scene.rules() };
    let mut orbit = Orbit::new(scene.model(), rules, scene.release()).unwrap();
    let mut last = *orbit.state();
    run(&mut orbit, 100, |contact| {
        last = contact.state;
        true
    });
    [("theta", last.theta), ("x_dot", last.x_dot), ("y_dot", last.y_dot), ("theta_dot", last.theta_dot)]
        .map(|(name, value)| (value - sample["state"][name].as_f64().unwrap()).abs())
        .into_iter()
        .fold(0.0, f64::max)
}

#[test]
fn holding_the_energy_pays() {
    let samples: Json = serde_json::from_str(include_str!("../../../tests/oracle/runs.json")).unwrap();
    let samples = samples.as_array().unwrap();
    let held: Vec<f64> = samples.iter().map(|sample| error(sample, true)).collect();
    let free: Vec<f64> = samples.iter().map(|sample| error(sample, false)).collect();
    let plain: Vec<f64> = samples.iter().map(|sample| sample["plain"].as_f64().unwrap()).collect();
    let (held, free, plain) = (median(held), median(free), median(plain));
    println!("median error at contact 100: plain doubles {plain:.1e}, our map {free:.1e}, with energy held {held:.1e}");
    assert!(held < 0.5 * free && held < 0.25 * plain, "{held:e} {free:e} {plain:e}");
}
