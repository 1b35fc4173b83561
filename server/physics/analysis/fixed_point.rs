//! The upright bounce of the plain rod with a tilt gain, and the drift beside it, in closed form.

use crate::analysis::contact_regime::{ContactRegime, contact_regime, lent_by_table};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::scene::Scene;

/// The bounce of a scene that repeats.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FixedPoint {
    /// x*, m: where the law takes a constant tilt back; 0 where no strike depends on the place.
    pub x: f64,
    /// ẋ*, m/s: the drift that the bounce has; 0 where the same bounce belongs to every drift.
    pub x_dot: f64,
    /// θ*, rad: 0 unless a constant tilt leaves the body a lean.
    pub theta: f64,
    /// θ̇*, rad/s.
    pub theta_dot: f64,
    /// V = |ẏ*|, m/s.
    pub speed: f64,
    /// Length of a flight, s; over a program of heights the mean.
    pub flight_time: f64,
    /// Height of the centre of gravity at the top of the bounce, m.
    pub apex_height: f64,
}

impl FixedPoint {
    /// The state just before a contact.
    pub fn state(&self) -> State {
        State { theta: self.theta, x_dot: self.x_dot, y_dot: -self.speed, theta_dot: self.theta_dot }
    }
}

/// Tells whether the bounce of a scene has closed forms: a rod or a point mass with a tilt gain, without friction or with a contact that a table
/// matches, and with nothing else that acts on the body or errs.
pub fn is_plain(scene: &Scene) -> bool {
    let model = scene.model();
    let one_strike = scene.steers_energy() && model.rod.energy_feedback == EnergyFeedback::OneStrike;
    let has_friction = model.rough().is_some();
    model.feedback().is_none()
        && model.turning.is_none()
        && model.drag.is_none()
        && model.program.is_none()
        && model.constant_tilt == 0.0
        && model.lag == 0.0
        && contact_regime(&model) != ContactRegime::Sticking
        && !(one_strike && (has_friction || scene.speed_factor() != 1.0))
        && !(model.is_point && model.friction.is_some())
}

/// c = ẋ − κρ²θ̇/((κ − 1)l), or ẋ − (κρ² + l²)θ̇/((κ − 1)l) where a matched contact sticks: the mean horizontal speed of a balanced run of a
/// plain rod, m/s. `None` if κ = 1, which drifts off in angle instead, and for a point mass, whose drift dies out.
pub fn plain_drift(scene: &Scene) -> Option<f64> {
    let Rod { contact_distance, radius_of_gyration, tilt_gain, .. } = scene.running_model.rod;
    let start = scene.start();
    let excess = tilt_gain - 1.0;
    (!scene.is_point() && excess != 0.0).then(|| {
        let lever = radius_of_gyration * radius_of_gyration / contact_distance;
        let matched = contact_regime(&scene.model()) == ContactRegime::VelocityMatched;
        let stuck = if matched { contact_distance } else { 0.0 };
        start.x_dot - (tilt_gain * lever + stuck) * start.theta_dot / excess
    })
}

/// The upright bounce of a plain rod on the energy surface of the release, or that of the target height with energy feedback; `None` if no bounce
/// repeats, and for other bodies.
///
/// V² = |v₀|² + 2G(y₀ − l) − c²: drift energy never comes back, and what counts is the height above l, not above l cos θ as in eq. (10). A matched
/// table with friction lends some more. A table that holds the total energy holds that of the drift too: V² = 2G(y* − l) − c².
pub fn plain_bounce(scene: &Scene) -> Option<FixedPoint> {
    if !is_plain(scene) {
        return None;
    }
    let drift = plain_drift(scene).unwrap_or(0.0);
    let Rod { contact_distance, radius_of_gyration, gravity, restitution, energy_feedback, .. } =
        scene.running_model.rod;
    let (held, available, taken) = match scene.target_height(1) {
        Some(height) => {
            let total = matches!(energy_feedback, EnergyFeedback::Total | EnergyFeedback::OneStrike);
            let held = if total { drift } else { 0.0 };
            let one_strike = energy_feedback == EnergyFeedback::OneStrike;
            let share = if one_strike { held_share(scene) } else { 1.0 };
            (held, 2.0 * gravity * (height + height_error(scene) - contact_distance), share * held)
        }
        None if scene.assumed_restitution() != restitution || scene.is_lossy() => return None,
        None => {
            let start = scene.start();
            let spin = radius_of_gyration * start.theta_dot;
            let kinetic = start.y_dot * start.y_dot
                + start.x_dot * start.x_dot
                + spin * spin
                + lent_by_table(&scene.model(), start, drift);
            (0.0, kinetic + 2.0 * gravity * (scene.release().height - contact_distance), drift)
        }
    };
    let square = available - taken * taken;
    (square > 0.0 && square.is_finite()).then(|| {
        let (speed, apex_height) = (square.sqrt(), contact_distance + square / (2.0 * gravity));
        FixedPoint { x_dot: held, speed, flight_time: 2.0 * speed / gravity, apex_height, ..FixedPoint::default() }
    })
}

/// Height above the target height at which the energy feedback of a plain rod comes to rest, m: the strike gain is 2 there for an assumed
/// restitution ê, κ_E(η* − η) = 2(ê − e)/((1 + e)(1 + ê)).
///
/// With [`EnergyFeedback::OneStrike`] the speeds of upright bounces follow u ↦ (s − 1)u + s√C, s = (1 + e)/(1 + ê), C = 2G(y* − l). They
/// come to rest at u² = C s²/(2 − s)²; at s = 2 nowhere, and the height is infinite. With a drift c, C is 2G(y* − l) − c².
fn height_error(scene: &Scene) -> f64 {
    let Rod { contact_distance, gravity, restitution: e, energy_feedback, .. } = scene.running_model.rod;
    let assumed = scene.assumed_restitution();
    if e == assumed {
        return 0.0;
    }
    if let (EnergyFeedback::OneStrike, Some(height)) = (energy_feedback, scene.target_height(1)) {
        let share = held_share(scene);
        return (share * share - 1.0) * (height - contact_distance);
    }
    2.0 * (e - assumed) / ((1.0 + e) * (1.0 + assumed) * scene.energy_gain() * gravity)
}

/// s/(2 − s) with s = (1 + e)/(1 + ê): the speed that [`EnergyFeedback::OneStrike`] settles at, over the speed that it aims at.
fn held_share(scene: &Scene) -> f64 {
    let e = scene.running_model.rod.restitution;
    (1.0 + e) / (1.0 + 2.0 * scene.assumed_restitution() - e)
}
