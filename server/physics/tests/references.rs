//! Every reference run, computed with 60 digits: same outcome, same number of contacts, states as close
//! as the plain algorithm in doubles comes, or closer.

use crate::support::reference;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::Name;
use equipoise_physics::scene::model::ModelLevel;

/// Distance of a double from a decimal of more digits than a double holds: the decimal's own rest counts too.
fn distance(value: f64, exact: &str) -> f64 {
    (value - exact.parse::<f64>().unwrap()).abs()
}

#[test]
fn every_reference_agrees() {
    let mut seen = 0;
    for (name, scene, reference) in reference::all() {
        seen += 1;
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
        if scene.model_level() == ModelLevel::Rod
            && scene.rules().holds_energy
            && scene.number(Name::EnergyGain) == Some(0.0)
        {
            let drift = energies.iter().map(|energy| (energy - energies[0]).abs()).fold(0.0, f64::max);
            assert!(drift <= allowed * 3.0, "{name}: energy drifts by {drift:.2e}");
        }
    }
    assert!(seen >= 22, "only {seen} references were run");
}
