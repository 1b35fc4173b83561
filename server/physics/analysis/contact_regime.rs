//! The contact at the upright bounce: without friction, sticking to a table that moves along with it, or sticking to a table that
//! only tilts. Computes the inertia that a strike turns, and the stick cone.

use crate::map::body::Body;
use crate::map::friction::{Friction, Slide};
use crate::map::strike::{Rod, State};

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

/// Rod and coefficient of friction of a model with a velocity-matched contact; `None` for other models.
fn velocity_matched(model: &Body) -> Option<(&Rod, f64)> {
    let is_dragged = model.turning.is_some_and(|turning| turning.drags(model.friction.as_ref()));
    let matched = contact_regime(model) == ContactRegime::VelocityMatched && !is_dragged;
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
