//! The upper end κ_c of the tilt gain: the coefficient that says whether stability is lost softly there, and the orbit of period 2
//! that branches off.

use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::rod::Rod;
use crate::numbers::trig;
use crate::scene::model::Model;
use crate::stability::contact_regime::{ContactRegime, contact_regime};
use crate::stability::fixed_point::FixedPoint;

/// The boundary coefficient C of the next order of the normal form: κ − κ_c ≈ a C θ² on the branch of period-2 orbits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryCoefficient {
    /// C; positive is soft (runs stay bounded at and a little beyond κ_c), negative hard (they fall).
    pub coefficient: f64,
}

impl BoundaryCoefficient {
    /// `soft`, `hard` or, at C = 0, `degenerate`.
    pub fn kind(&self) -> &'static str {
        if self.coefficient > 0.0 {
            "soft"
        } else if self.coefficient < 0.0 {
            "hard"
        } else {
            "degenerate"
        }
    }
}

/// The rod of a model for which the boundary is derived: frictionless, with an angle, with a tilt gain, and about a bounce in place.
fn frictionless_rod<'a>(model: &'a Model, fixed_point: &FixedPoint) -> Option<&'a Rod> {
    let is_point = matches!(model, Model::Point(_));
    let derived = !is_point && contact_regime(model) == ContactRegime::Frictionless && model.feedback().is_none();
    (derived && fixed_point.x_dot == 0.0).then(|| model.rod())
}

/// Case for which C is not derived, in words; `None` where it is derived, for a point mass and with state feedback.
pub fn underived(model: &Model, fixed_point: &FixedPoint) -> Option<&'static str> {
    if matches!(model, Model::Point(_)) || model.feedback().is_some() {
        None
    } else if contact_regime(model) != ContactRegime::Frictionless {
        Some("with friction")
    } else if fixed_point.x_dot != 0.0 {
        Some("for a drift in the energy that the table holds")
    } else if misses_target(model.rod()) {
        Some("for one strike with a wrong assumed_restitution")
    } else {
        None
    }
}

/// Tells whether a wrong restitution keeps one strike from its target.
fn misses_target(rod: &Rod) -> bool {
    rod.energy_feedback == EnergyFeedback::OneStrike && rod.strike_gain != 2.0
}

/// Tells whether the table holds η in place of the energy. One that measures the total energy keeps the surface of the target energy,
/// on which the map is that without losses.
fn holds_height(rod: &Rod) -> bool {
    rod.strike_gain_per_energy > 0.0 && rod.energy_feedback == EnergyFeedback::Vertical
}

/// The boundary coefficient C at κ_c, with a = κ_c − 1 and γ = Gl/V²: (1+a)²/2 + a²/6 − (1−a)γ, and with a positive
/// energy gain that holds η and not the energy, −(1+a)²/2 + a²/6 − γ. `None` for a point mass, with friction, with state
/// feedback, with a drift in the energy that is held, and where one strike misses its target by a wrong restitution.
pub fn boundary_coefficient(model: &Model, fixed_point: &FixedPoint) -> Option<BoundaryCoefficient> {
    let rod = frictionless_rod(model, fixed_point)?;
    let gamma = rod.gravity * rod.contact_distance / (fixed_point.speed * fixed_point.speed);
    let lever = rod.radius_of_gyration / rod.contact_distance;
    let a = gamma * lever * lever;
    let half_square = 0.5 * (1.0 + a) * (1.0 + a);
    let sixth = a * a / 6.0;
    if misses_target(rod) {
        return None;
    }
    let holds_height = holds_height(rod);
    let coefficient = if holds_height { sixth - half_square - gamma } else { half_square + sixth - (1.0 - a) * gamma };
    Some(BoundaryCoefficient { coefficient })
}

/// θ, rad, of the mirror-symmetric period-2 orbit at the energy of the fixed point, the one nearest to upright; `None` if there is
/// none within the topple angle (rad).
///
/// The states of the orbit are (±θ, ±V tan κθ, −V, ±Gθ/V) with V² = Gρ²θ cos κθ / (l sin((κ − 1)θ)); with energy feedback η is held in
/// place of the energy. `None` also with friction, with state feedback and with a drift in the energy that is held.
pub fn period_two_angle(model: &Model, topple_angle: f64, fixed_point: &FixedPoint) -> Option<f64> {
    let rod = frictionless_rod(model, fixed_point)?;
    let Rod { contact_distance, radius_of_gyration, gravity, tilt_gain: kappa, .. } = *rod;
    let weight = gravity * contact_distance;
    // The energy of the orbit with angle θ above that of the fixed point; NaN if there is no such orbit.
    let excess = |theta: f64| {
        let (sin_alpha, cos_alpha) = trig::sin_cos(kappa * theta);
        let (sin_beta, _) = trig::sin_cos((kappa - 1.0) * theta);
        let (_, versine) = trig::sin_versine(theta);
        let rho_squared = radius_of_gyration * radius_of_gyration;
        let speed_squared = gravity * rho_squared * theta * cos_alpha / (contact_distance * sin_beta);
        let slant = sin_alpha / cos_alpha;
        let aside = slant * slant * speed_squared + rho_squared * gravity * gravity * theta * theta / speed_squared;
        let held = if holds_height(rod) { 0.0 } else { 0.5 * aside };
        let speed = fixed_point.speed;
        if cos_alpha > 0.0 && speed_squared > 0.0 {
            0.5 * (speed_squared - speed * speed) + held - weight * versine
        } else {
            f64::NAN
        }
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
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) * below > 0.0 { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}
