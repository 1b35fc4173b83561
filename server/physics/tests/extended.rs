//! The map with 31 digits against runs computed with 60, those that are chaotic too; and against the map in doubles.

use crate::support::decimals::number;
use crate::support::reference;
use crate::support::rig_runs::with_numbers;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::error_estimate::ErrorEstimate;
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::ExtendedContact;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use serde_json::Value as Json;

fn contacts(scene: &Scene, impacts: u64) -> (Vec<ExtendedContact>, &'static str) {
    let mut contacts = Vec::new();
    let ending = orbit::run(&mut scene.extended_orbit().unwrap(), impacts, |contact| {
        contacts.push(*contact);
        true
    });
    (contacts, ending.unwrap().name())
}

fn worst(contacts: &[ExtendedContact], states: &Json) -> f64 {
    let mut worst: f64 = 0.0;
    for (index, contact) in contacts.iter().enumerate() {
        let state = contact.state;
        for (column, value) in [
            ("t", contact.t),
            ("x", contact.x),
            ("theta", state.theta),
            ("x_dot", state.x_dot),
            ("y_dot", state.y_dot),
            ("theta_dot", state.theta_dot),
        ] {
            let exact = number(states[column][index].as_str().unwrap());
            worst = worst.max((value - exact).to_f64().abs() / exact.to_f64().abs().max(1.0));
        }
    }
    worst
}

#[test]
fn every_reference_agrees_to_its_last_digits() {
    let mut seen = 0;
    for (name, scene, reference) in reference::all() {
        let (contacts, ending) = contacts(&scene, reference["impacts"].as_u64().unwrap());
        assert_eq!(ending, reference["outcome"], "{name}");
        let states = &reference["states"];
        assert_eq!(contacts.len(), states["t"].as_array().unwrap().len(), "{name}");
        let worst = worst(&contacts, states);
        let mut estimate = ErrorEstimate::of_extended_run(&scene, contacts[0].t.to_f64());
        let mut bound = estimate.bound();
        for contact in &contacts[..contacts.len() - 1] {
            estimate.pass(contact);
            bound = bound.max(estimate.bound());
        }
        // The bound is of m/s, which are some ten times the angles; the references are written with 25 digits.
        assert!(worst <= 20.0 * bound + 1e-24 && bound < 1e-19, "{name}: error {worst:.1e}, bound {bound:.1e}");
        let allowed = f64::max(1e-23, reference["plain_double_error"].as_f64().unwrap() * 1e-15);
        let orbit = scene.extended_orbit().unwrap();
        if scene.model_level() == ModelLevel::Rod
            && scene.rules().holds_energy
            && scene.number(Name::EnergyGain) == Some(0.0)
        {
            let energies: Vec<_> = contacts.iter().map(|contact| orbit.body.energy(&contact.state)).collect();
            let drift = energies.iter().map(|energy| (*energy - energies[0]).to_f64().abs()).fold(0.0, f64::max);
            assert!(drift <= 1e-30, "{name}: energy drifts by {drift:.1e}");
        }
        let last = contacts.last().unwrap().state;
        let speed = orbit.body.contact_speed(&last).to_f64();
        assert!((speed - scene.model().contact_speed(&last.to_f64())).abs() <= 1e-14 * speed.abs().max(1.0));
        println!("{name}: error {worst:.1e}, bound {bound:.1e}, allowed {allowed:.1e}");
        assert!(worst <= allowed, "{name}: error {worst:.1e}, allowed {allowed:.1e}");
        seen += 1;
    }
    assert!(seen >= 11, "only {seen} references were run");
}

fn scene(numbers: &[(Name, f64)], others: &[(Name, Value)]) -> Scene {
    let mut draft = with_numbers(Draft::default(), numbers);
    for &(name, value) in others {
        draft.set(name, Some(value)).unwrap();
    }
    draft.build().unwrap()
}

/// Eq. (5), exact at any angle: θ_n = (1 − 2κ)ⁿ θ₀.
#[test]
fn a_point_mass_follows_equation_5() {
    let tilt_gain = 0.0625;
    let scene = scene(
        &[(Name::TiltGain, tilt_gain), (Name::Height, 0.3), (Name::XDot, 0.7)],
        &[(Name::PointMass, Value::Flag(true))],
    );
    let (contacts, ending) = contacts(&scene, 60);
    assert_eq!(ending, "completed");
    let mut expected = contacts[0].state.theta;
    assert!(expected.to_f64() > 0.1);
    for contact in contacts {
        let error = (contact.state.theta - expected).to_f64().abs();
        assert!(error <= 1e-29, "contact {}: {error:e}", contact.n);
        expected = expected * DoubleDouble::from(1.0 - 2.0 * tilt_gain);
    }
}

/// It settles where the geometric series of its flights says.
#[test]
fn a_run_that_settles_does_so_when_it_should() {
    let scene = scene(
        &[
            (Name::ContactDistance, 0.1),
            (Name::RadiusOfGyration, 0.08),
            (Name::TiltGain, 0.0),
            (Name::Height, 0.3),
            (Name::Restitution, 0.5),
        ],
        &[(Name::Strike, Value::Choice("still"))],
    );
    let mut settles_at = None;
    let ending = orbit::run(&mut scene.extended_orbit().unwrap(), 100, |contact| {
        if let Some(equipoise_physics::run::ending::Ending::Settled { settle_time, .. }) = contact.ending {
            settles_at = Some(settle_time);
        }
        true
    });
    assert_eq!(ending.unwrap().name(), "settled");
    // The fall, and twice as long a flight for each factor 1/2 from there: 1 + 2·(1/2 + 1/4 + …) = 3 falls.
    let fall = (2.0_f64 * 0.2 / 9.81).sqrt();
    assert!((settles_at.unwrap() - 3.0 * fall).abs() <= 1e-15, "{settles_at:?} {fall}");
}
