//! The upper end κ_c of the tilt gain: is stability lost softly there, and which orbit of period 2 branches off?

use crate::analysis::contact_regime::{ContactRegime, contact_regime, turning_radius_squared};
use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::root::root;
use crate::map::body::Body;
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::numbers::trig;

/// Kind of a loss of stability by the sign of its coefficient: `soft` if positive (runs stay bounded at the end and a little beyond), `hard` if
/// negative (they fall), or `degenerate`.
pub fn loss_kind(coefficient: f64) -> &'static str {
    match coefficient {
        soft if soft > 0.0 => "soft",
        hard if hard < 0.0 => "hard",
        _ => "degenerate",
    }
}

/// The regime of a model for which the boundary is derived: a rod with a tilt gain about a bounce in place, without friction or with a matched
/// contact that sticks.
fn derived_regime(model: &Body, fixed_point: &FixedPoint) -> Option<ContactRegime> {
    let alone = model.turning.is_none() && model.drag.is_none();
    let is_derived = !model.is_point && model.feedback().is_none() && alone && fixed_point.x_dot == 0.0;
    Some(contact_regime(model)).filter(|regime| is_derived && *regime != ContactRegime::Sticking)
}

/// Tells whether the table holds η in place of the energy. One that measures the total energy keeps the surface of the target energy,
/// on which the map is that without losses.
fn holds_height(rod: &Rod) -> bool {
    rod.strike_gain_per_energy > 0.0 && rod.energy_feedback == EnergyFeedback::Vertical
}

/// The boundary coefficient C at κ_c, of the next order of the normal form: κ − κ_c ≈ a C θ² on the branch of period-2 orbits.
///
/// It is, with a = κ_c − 1 and γ = Gl/V²: (1+a)²/2 + a²/6 − (1−a)γ, and with a positive
/// energy gain that holds η and not the energy, −(1+a)²/2 + a²/6 − γ.
///
/// A matched contact that sticks has, with p = ρ²/(ρ² + l²), 1/2 + ap + 2a²/3 at the quantity that the table conserves to second order
/// ([`crate::analysis::fixed_point`]), and −1/2 − a − a²/3 where η is held.
///
/// `None` for a point mass, for friction on a table that only tilts, with state feedback, with a drift in the energy that is held, and where
/// one strike misses its target by a wrong restitution.
pub fn boundary_coefficient(model: &Body, fixed_point: &FixedPoint) -> Option<f64> {
    let (rod, regime) = (&model.rod, derived_regime(model, fixed_point)?);
    let gamma = rod.gravity * rod.contact_distance / (fixed_point.speed * fixed_point.speed);
    // A wrong restitution keeps one strike from its target.
    if rod.energy_feedback == EnergyFeedback::OneStrike && rod.strike_gain != 2.0 {
        return None;
    }
    Some(if regime == ContactRegime::VelocityMatched {
        let turning = turning_radius_squared(rod, regime);
        let share = rod.radius_of_gyration * rod.radius_of_gyration / turning;
        let a = gamma * turning / (rod.contact_distance * rod.contact_distance);
        if holds_height(rod) { -0.5 - a - a * a / 3.0 } else { 0.5 + a * share + 2.0 * a * a / 3.0 }
    } else {
        let lever = rod.radius_of_gyration / rod.contact_distance;
        let a = gamma * lever * lever;
        let half_square = 0.5 * (1.0 + a) * (1.0 + a);
        let sixth = a * a / 6.0;
        if holds_height(rod) { sixth - half_square - gamma } else { half_square + sixth - (1.0 - a) * gamma }
    })
}

/// The state before one contact of the mirror-symmetric orbit of period 2 through an angle θ, rad, at the energy that it has: the other one has all
/// signs but that of ẏ turned round. Without friction or with a matched contact that sticks; `None` if there is none, or if the contact would slide.
///
/// These orbits branch off the upright bounce at κ_c. A strike turns all velocities round, so with V = |ẏ| it needs ρ²θ̇ = Gρ²θ/V of turn and V of rise
/// on each side. Without friction V² = Gρ²θ cos κθ/(l sin((κ − 1)θ)) and ẋ = V tan κθ. With β = (1 − κ)θ and the impulse P_t = −(C/A)P_n of a contact
/// that sticks, V² = Gθ(ρ² cos κθ + l² cos β cos θ)/(l sin((κ − 1)θ)) and ẋ = V tan(κθ + atan(C/A)), for |C/A| ≤ μ.
pub fn symmetric_orbit(model: &Body, theta: f64) -> Option<State> {
    let Rod { contact_distance, radius_of_gyration, gravity, tilt_gain: kappa, .. } = model.rod;
    let (sin_alpha, cos_alpha) = trig::sin_cos(kappa * theta);
    let (sin_beta, cos_beta) = trig::sin_cos((kappa - 1.0) * theta);
    let rho_squared = radius_of_gyration * radius_of_gyration;
    let weight = contact_distance * sin_beta;
    let (speed_squared, slope) = match contact_regime(model) {
        ContactRegime::Frictionless => (gravity * rho_squared * theta * cos_alpha / weight, sin_alpha / cos_alpha),
        ContactRegime::VelocityMatched => {
            let l_squared = contact_distance * contact_distance;
            // C/A, with the sign of β = (1 − κ)θ.
            let held = -l_squared * sin_beta * cos_beta / (rho_squared + l_squared * cos_beta * cos_beta);
            if model.friction.is_some_and(|friction| held.abs() > friction.coefficient) {
                return None;
            }
            let turned = rho_squared * cos_alpha + l_squared * cos_beta * trig::sin_cos(theta).1;
            (gravity * theta * turned / weight, (sin_alpha + held * cos_alpha) / (cos_alpha - held * sin_alpha))
        }
        ContactRegime::Sticking => return None,
    };
    let rises = cos_alpha > 0.0 && speed_squared > 0.0 && speed_squared.is_finite();
    rises.then(|| {
        let speed = speed_squared.sqrt();
        State { theta, x_dot: slope * speed, y_dot: -speed, theta_dot: gravity * theta / speed }
    })
}

/// θ, rad, of the mirror-symmetric period-2 orbit at the energy of the fixed point, the one nearest to upright; `None` if there is
/// none within the topple angle (rad).
///
/// With energy feedback η is held in place of the energy. Where a matched contact sticks, the energy is the quantity that the table
/// conserves to second order. `None` also for friction on a table that only tilts, with state feedback and with a drift in the energy that is
/// held.
pub fn period_two_angle(model: &Body, topple_angle: f64, fixed_point: &FixedPoint) -> Option<f64> {
    let (rod, regime) = (&model.rod, derived_regime(model, fixed_point)?);
    let Rod { contact_distance, radius_of_gyration, gravity, tilt_gain: kappa, .. } = *rod;
    let weight = gravity * contact_distance;
    let rho_squared = radius_of_gyration * radius_of_gyration;
    // Of the energy lent by a matched table, per θ̇².
    let is_matched = regime == ContactRegime::VelocityMatched;
    let lent = if is_matched { kappa * turning_radius_squared(rod, regime) / (kappa - 1.0) } else { 0.0 };
    // The energy of the orbit with angle θ above that of the fixed point; NaN if there is no such orbit.
    let excess = |theta: f64| {
        let Some(State { x_dot, y_dot, theta_dot, .. }) = symmetric_orbit(model, theta) else {
            return f64::NAN;
        };
        let (_, versine) = trig::sin_versine(theta);
        let aside = x_dot * x_dot + (rho_squared + lent) * theta_dot * theta_dot;
        let held = if holds_height(rod) { 0.0 } else { 0.5 * aside };
        0.5 * (y_dot * y_dot - fixed_point.speed * fixed_point.speed) + held - weight * versine
    };
    let step = topple_angle / 1024.0;
    let (mut low, mut high) = (step * 1e-6, step);
    while excess(low) * excess(high) > 0.0 && high < topple_angle {
        (low, high) = (high, high + step);
    }
    let (below, above) = (excess(low), excess(high));
    if below.is_nan() || above.is_nan() || below * above > 0.0 {
        return None;
    }
    root([(low, below), (high, above)], 0.0, |theta| Ok::<_, ()>(Some(excess(theta)))).ok().map(|(theta, _)| theta)
}
