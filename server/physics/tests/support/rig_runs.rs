//! Random rigs, the course of their runs, feedback that brings one to rest, and the comparison with a simulation of their own.

#![allow(dead_code, reason = "each test file uses its own part")]

use crate::paper;
use crate::support::random::Random;
use crate::support::rig::Rig;
use equipoise_physics::control::bounce_model::BounceModel;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use equipoise_physics::stability::contact_regime::ContactRegime;
use equipoise_physics::stability::fixed_point::find_fixed_point;

/// Gains of state feedback: K of x, θ, ẋ, θ̇.
const GAINS: [Name; 4] = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];

/// The draft with other numbers.
pub(crate) fn with_numbers(mut draft: Draft, values: &[(Name, f64)]) -> Draft {
    for &(name, number) in values {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft
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
    let place = find_fixed_point(&scene).unwrap();
    let model = BounceModel::new(&scene.parameters(), place.speed, ContactRegime::Frictionless);
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

/// A random rod in flight: its contact distance, its height above upright contact, m, a gain within its limits, and its numbers.
pub(crate) struct RandomRod {
    pub(crate) length: f64,
    above: f64,
    kappa: f64,
    pub(crate) values: Vec<(Name, f64)>,
}

impl RandomRod {
    pub(crate) fn new(random: &mut Random) -> Self {
        let length = random.between(0.05, 0.3);
        let rho = length * random.between(0.3, 1.0);
        let above = length * random.between(0.3, 1.5);
        let kappa = 1.0 + random.between(0.1, 0.9) * rho * rho / (2.0 * above * length);
        let values = vec![
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
        Self { length, above, kappa, values }
    }

    /// Adds the laws of its table: a tilt gain or feedback, with or without energy feedback.
    pub(crate) fn with_laws(mut self, random: &mut Random) -> Vec<(Name, f64)> {
        let Self { length, above, kappa, .. } = self;
        if random.between(0.0, 1.0) < 0.5 {
            self.values.push((Name::TiltGain, kappa));
        } else {
            self.values.extend([
                (Name::FeedbackX, random.size(0.01, 0.2)),
                (Name::FeedbackTheta, -kappa),
                (Name::FeedbackXDot, random.size(0.001, 0.05)),
                (Name::FeedbackThetaDot, random.size(0.0001, 0.005)),
            ]);
        }
        if random.between(0.0, 1.0) < 0.5 {
            self.values.push((Name::EnergyGain, random.between(0.05, 0.6) / (2.0 * 9.81 * above)));
            self.values.push((Name::TargetHeight, length + above * random.between(0.8, 1.3)));
        }
        self.values
    }
}

/// A draft of such a rod on a table that moves.
pub(crate) fn random_draft(random: &mut Random) -> Draft {
    with_numbers(Draft::default(), &RandomRod::new(random).with_laws(random))
}
