//! Random scenes of tables that sense with errors, and the course of their runs.

use crate::random::Random;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

pub(crate) const FURTHER: [Name; 5] = [Name::XSd, Name::XDotSd, Name::YDotSd, Name::ThetaDotSd, Name::RestitutionSd];

pub(crate) fn with(mut draft: Draft, values: &[(Name, f64)]) -> Scene {
    for &(name, number) in values {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft.build().unwrap()
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

/// Scenes with a tilt gain or feedback, with and without energy feedback, on tables that move.
pub(crate) fn random_draft(random: &mut Random) -> Draft {
    let length = random.between(0.05, 0.3);
    let rho = length * random.between(0.3, 1.0);
    let above = length * random.between(0.3, 1.5);
    let kappa = 1.0 + random.between(0.1, 0.9) * rho * rho / (2.0 * above * length);
    let mut values = vec![
        (Name::ContactDistance, length),
        (Name::RadiusOfGyration, rho),
        (Name::Height, length + above),
        (Name::Theta, random.size(0.001, 0.05)),
        (Name::ThetaDot, random.size(0.001, 0.2)),
        (Name::XDot, random.size(0.001, 0.2)),
        (Name::X, random.size(0.001, 0.2)),
        (Name::Restitution, random.between(0.3, 1.0)),
        (Name::AssumedRestitution, random.between(0.3, 1.0)),
    ];
    if random.between(0.0, 1.0) < 0.5 {
        values.push((Name::TiltGain, kappa));
    } else {
        values.extend([
            (Name::FeedbackX, random.size(0.01, 0.2)),
            (Name::FeedbackTheta, -kappa),
            (Name::FeedbackXDot, random.size(0.001, 0.05)),
            (Name::FeedbackThetaDot, random.size(0.0001, 0.005)),
        ]);
    }
    if random.between(0.0, 1.0) < 0.5 {
        values.push((Name::EnergyGain, random.between(0.05, 0.6) / (2.0 * 9.81 * above)));
        values.push((Name::TargetHeight, length + above * random.between(0.8, 1.3)));
    }
    with(Draft::default(), &values).draft()
}

/// With random errors of all kinds but those of timing.
pub(crate) fn random_scene(random: &mut Random) -> Scene {
    let mut draft = random_draft(random);
    draft.set(Name::Seed, Some(Value::Integer(random.between(0.0, 1e9) as u64))).unwrap();
    let mut values = vec![(Name::AngleSd, random.size(1e-4, 0.01).abs())];
    for (name, largest) in FURTHER.into_iter().zip([0.01, 0.03, 0.05, 0.1, 0.05]) {
        if random.between(0.0, 1.0) < 0.7 {
            values.push((name, random.size(1e-4, largest).abs()));
        }
    }
    with(draft, &values)
}
