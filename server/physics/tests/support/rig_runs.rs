//! Random rigs, the course of their runs, feedback that brings one to rest, and the comparison with a simulation of their own.

#![allow(dead_code, reason = "each test file uses its own part")]

use crate::paper;
use crate::support::rig::Rig;
use crate::support::upright::upright_bounce;
use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

/// Gains of state feedback: K of x, θ, ẋ, θ̇.
const GAINS: [Name; 4] = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];

/// The draft with other numbers.
pub(crate) fn with_numbers(mut draft: Draft, values: &[(Name, f64)]) -> Draft {
    for &(name, number) in values {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft
}

/// The draft with other words.
pub(crate) fn worded(mut draft: Draft, words: &[(Name, &'static str)]) -> Draft {
    for &(name, word) in words {
        draft.set(name, Some(Value::Choice(word))).unwrap();
    }
    draft
}

/// The paper's rod with κ = 1.1, released at 0.1 rad, with other numbers.
pub(crate) fn scene(values: &[(Name, f64)]) -> Scene {
    with(paper::scene(1.1, 0.1).draft(), values)
}

/// The scene of a draft with other numbers.
pub(crate) fn with(draft: Draft, values: &[(Name, f64)]) -> Scene {
    with_numbers(draft, values).build().unwrap()
}

/// The scene of a draft with K in place of its tilt law.
pub(crate) fn fed_back(mut draft: Draft, gains: [f64; 4]) -> Scene {
    draft.set(Name::TiltGain, None).unwrap();
    with(draft, &std::array::from_fn::<_, 4, _>(|index| (GAINS[index], gains[index])))
}

/// K that brings the bounce of the paper's rod to rest.
pub(crate) fn gains() -> [f64; 4] {
    let scene = paper::scene(1.1, 0.1);
    let place = small_deviations(&scene).unwrap().fixed_point;
    let model = upright_bounce(&scene.parameters(), place.speed, ContactRegime::Frictionless);
    design_lqr(&model, [1.0, 10.0, 0.1, 0.1], 10.0).unwrap().gain
}

/// t, x, θ, ẋ, ẏ, θ̇ at the contacts, and the ending.
pub(crate) fn states(scene: &Scene, impacts: u64) -> (Vec<[f64; 6]>, Ending) {
    let mut states = Vec::new();
    let ending = run(&mut scene.orbit().unwrap(), impacts, |contact| {
        let state = contact.state;
        states.push([contact.t, contact.x, state.theta, state.x_dot, state.y_dot, state.theta_dot]);
        true
    });
    (states, ending.unwrap())
}

/// Holds the course of a scene to its simulation, within a share of 1 and the number. Returns the number of contacts.
pub(crate) fn hold_to_simulation(course: &[[f64; 6]], scene: &Scene, within: f64) -> usize {
    let other = Rig::of(scene).course(course.len());
    for (one, other) in course.iter().zip(&other) {
        for (a, b) in one.iter().zip(other) {
            assert!((a - b).abs() < within * (1.0 + b.abs()), "{one:?}\n{other:?}\n{scene:?}");
        }
    }
    course.len().min(other.len())
}
