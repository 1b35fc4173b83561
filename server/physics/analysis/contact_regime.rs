//! The contact at the upright bounce: without friction, sticking to a table that moves along with it, or sticking to a table that
//! only tilts. Computes the inertia that a strike turns, the stick cone, and the eigenvalues for a table that only tilts, and of the angle
//! where a matched table turns as it strikes.
//!
//! Not here: the impulse itself ([`crate::map::friction`]), and the conclusions ([`crate::analysis::linear_verdict`],
//! [`crate::analysis::verdict`]).

use crate::map::body::Body;
use crate::map::friction::{Friction, Slide};
use crate::map::strike::{Rod, State};
use crate::map::table::pivot::TurningTable;
use nalgebra::Complex;

/// Behaviour of the contact at the fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactRegime {
    /// No friction.
    Frictionless,
    /// The contact sticks to a table that moves along its surface with the contact point.
    VelocityMatched,
    /// The contact sticks to a table that only tilts: v_t = 0 is inside the stick cone for any μ > 0.
    Sticking,
}

/// The contact regime of a model at its fixed point.
pub fn contact_regime(model: &Body) -> ContactRegime {
    match model.friction {
        None => ContactRegime::Frictionless,
        Some(Friction { coefficient: 0.0, .. }) => ContactRegime::Frictionless,
        Some(Friction { slide: Slide::Matched, .. }) => ContactRegime::VelocityMatched,
        Some(Friction { slide: Slide::None, .. }) => ContactRegime::Sticking,
    }
}

/// The square of the radius of gyration, m², about the point that a strike turns the rod about: ρ² about the centre of gravity, or
/// ρ² + l² about a contact that sticks.
pub(crate) fn turning_radius_squared(rod: &Rod, regime: ContactRegime) -> f64 {
    let (l, rho_squared) = (rod.contact_distance, rod.radius_of_gyration * rod.radius_of_gyration);
    match regime {
        ContactRegime::Frictionless => rho_squared,
        ContactRegime::VelocityMatched | ContactRegime::Sticking => rho_squared + l * l,
    }
}

/// The turning of a model's table, if it drags the contact point along.
pub fn dragging_turn(model: &Body) -> Option<TurningTable> {
    model.turning.filter(|turning| turning.drags(model.friction.as_ref()))
}

/// Rod and coefficient of friction of a model with a velocity-matched contact; `None` for other models.
fn velocity_matched(model: &Body) -> Option<(&Rod, f64)> {
    let matched = contact_regime(model) == ContactRegime::VelocityMatched && dragging_turn(model).is_none();
    matched.then(|| (&model.rod, model.friction.map_or(0.0, |friction| friction.coefficient)))
}

/// The cone |θ| (rad, small angles) within which a velocity-matched contact sticks: μ(ρ² + l²)/(l²|κ − 1|), from |C| ≤ μA. `None`
/// if the contact sticks at every small angle, and in the other regimes.
pub fn stick_cone(model: &Body) -> Option<f64> {
    let (rod, coefficient) = velocity_matched(model)?;
    let turning = turning_radius_squared(rod, ContactRegime::VelocityMatched);
    let excess = (rod.tilt_gain - 1.0).abs();
    (excess > 0.0).then(|| coefficient * turning / (rod.contact_distance * rod.contact_distance * excess))
}

/// The term that completes |v|² + 2Gy, m²/s², to a quantity that a velocity-matched table conserves to second order about a
/// bounce with drift speed c (m/s): 2lcθ̇ + κ(ρ² + l²)θ̇²/(κ − 1). 0 in the other regimes.
///
/// Such a table works on the rod by P_t v_t = lsθ(ẋ − Vκθ + lθ̇) at a strike, where s = 2Vl(κ − 1)/(ρ² + l²) and θ̇⁺ = θ̇ − sθ.
/// With ẋ = c + (κρ² + l²)θ̇/((κ − 1)l) that is lc(θ̇ − θ̇⁺) + (lVκ/s)(θ̇² − θ̇⁺²): a difference of two values of one quantity.
pub(crate) fn lent_by_table(model: &Body, start: &State, drift_speed: f64) -> f64 {
    let Some((rod, _)) = velocity_matched(model) else { return 0.0 };
    let excess = rod.tilt_gain - 1.0;
    if excess == 0.0 {
        return 0.0;
    }
    let spin = start.theta_dot;
    let turning = turning_radius_squared(rod, ContactRegime::VelocityMatched);
    2.0 * rod.contact_distance * drift_speed * spin + rod.tilt_gain * turning * spin * spin / excess
}

/// −4lV²/(G(l² + ρ²)): the characteristic polynomial, at 1, of the derivative at the fixed point of speed V (m/s) for a contact
/// that is [`ContactRegime::Sticking`]. It is negative, so one eigenvalue is greater than 1.
pub fn sticking_polynomial_at_one(rod: &Rod, speed: f64) -> f64 {
    let turning = turning_radius_squared(rod, ContactRegime::Sticking);
    -4.0 * rod.contact_distance * speed * speed / (rod.gravity * turning)
}

/// The eigenvalues of θ, ẋ and θ̇ for [`ContactRegime::Sticking`]. One is 0: every strike removes the contact's velocity along the
/// table. The others are λ = 1 + m ± √(m² + 2ν) with ν = 2lV²/(G(l² + ρ²)), m = ν(2 − κ)/2.
pub(crate) fn sticking_eigenvalues(rod: &Rod, speed: f64) -> [Complex<f64>; 3] {
    let nu = -0.5 * sticking_polynomial_at_one(rod, speed);
    let mean = 0.5 * nu * (2.0 - rod.tilt_gain);
    let root = (mean * mean + 2.0 * nu).sqrt();
    // The two values of λ − 1 have the product −2ν, which gives the smaller one without cancellation.
    let large = if mean < 0.0 { mean - root } else { mean + root };
    [1.0 + large, 1.0 - 2.0 * nu / large, 0.0].map(|value| Complex::new(value, 0.0))
}

/// The angle on a matched table whose turning drags the contact point along: θ̇⁺ = Dθ̇ − sθ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DraggedAngle {
    /// D = 1 − lκp/(ρ² + l²), the determinant of the angle.
    pub determinant: f64,
    /// 1 + D − sτ, its trace.
    pub trace: f64,
    /// Greatest κ that balances, (1 + q)/(q + lp/(2(ρ² + l²))) with q = V²l/(G(ρ² + l²)); −∞ where none does.
    pub critical_tilt_gain: f64,
}

impl DraggedAngle {
    /// The angle of a rod over a pivot at a depth (m) that bounces at `speed` V (m/s).
    ///
    /// The eigenvalues are inside the unit circle for |D| < 1 and |trace| < 1 + D. With s = 2Vl(κ − 1)/(ρ² + l²) that is κ > 1, p > 0 and
    /// κ below the critical value, which is above 1 for p < 2(ρ² + l²)/l; D > −1 follows.
    pub fn new(rod: &Rod, speed: f64, depth: f64) -> Self {
        let (l, kappa) = (rod.contact_distance, rod.tilt_gain);
        let turning = turning_radius_squared(rod, ContactRegime::VelocityMatched);
        let (q, drag) = (speed * speed * l / (rod.gravity * turning), l * depth / turning);
        let determinant = 1.0 - kappa * drag;
        let balances = 0.0 < drag && drag < 2.0;
        Self {
            determinant,
            trace: 1.0 + determinant - 4.0 * q * (kappa - 1.0),
            critical_tilt_gain: if balances { (1.0 + q) / (q + 0.5 * drag) } else { f64::NEG_INFINITY },
        }
    }

    /// Both eigenvalues.
    pub fn eigenvalues(&self) -> [Complex<f64>; 2] {
        let half = 0.5 * self.trace;
        let square = half * half - self.determinant;
        if square < 0.0 {
            let imaginary = (-square).sqrt();
            return [Complex::new(half, imaginary), Complex::new(half, -imaginary)];
        }
        let large = if half < 0.0 { half - square.sqrt() } else { half + square.sqrt() };
        let small = if large == 0.0 { 0.0 } else { self.determinant / large };
        [large, small].map(|value| Complex::new(value, 0.0))
    }
}
