//! The gain of a catch, scheduled on the contact speed: K(v) of the bounce model with a height ratio, and the gain in lasting contact.

use crate::bounce::strike::Rod;
use crate::control::bounce_model::BounceModel;
use crate::control::lqr::{DesignFailure, design_continuous, gain};
use crate::stability::contact_regime::ContactRegime;
use crate::table::control_law::Gains;
use nalgebra::{Matrix4, Vector4};

/// Law of the tilt at strikes of one height ratio r, α = −K(v)·(x, θ, ẋ, θ̇).
///
/// K(v) is that of the linear-quadratic regulator on the bounce model at contact speed v, with impulse (1 + r)v and flight time
/// τ = 2rv/G. Weights scaled by τ make the sum over the bounces an integral over time as v → 0, and do not change K. In that limit the
/// strikes push with (1 + r)v/τ = (1 + r)G/(2r) on average, and K(v) tends to [`contact_gain`] under this push: at r = 1 to that of
/// a contact at rest. Below, bounces push harder than the weight because they also slow the body down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GainSchedule {
    /// l, ρ and G.
    pub rod: Rod,
    /// Contact at the strikes.
    pub regime: ContactRegime,
    /// r.
    pub ratio: f64,
    /// Weights on (x, θ, ẋ, θ̇).
    pub state_weights: [f64; 4],
    /// Weight on α.
    pub input_weight: f64,
}

impl GainSchedule {
    /// K at a contact speed `speed` > 0, m/s.
    ///
    /// # Errors
    /// [`DesignFailure`].
    pub fn gain(&self, speed: f64) -> Result<Gains, DesignFailure> {
        let model = BounceModel::with_ratio(&self.rod, speed, self.ratio, self.regime);
        Ok(gains(gain(&model, self.state_weights, self.input_weight)?.gain))
    }

    /// The limit of K(v) as v → 0.
    ///
    /// # Errors
    /// [`DesignFailure`].
    pub fn limit(&self) -> Result<Gains, DesignFailure> {
        let push = self.rod.gravity * (1.0 + self.ratio) / (2.0 * self.ratio);
        contact_gain(&self.rod, push, self.regime, self.state_weights, self.input_weight)
    }
}

/// K of a table that tilts in lasting contact and pushes with `push` (m/s²): the regulator of ẍ = −push·α, θ̈ = push·(l/ρ²)(θ − α). At
/// push G the contact rests; at G + a the table brakes at a. A contact that sticks to a table that moves along with it turns about the
/// contact point, with ρ² + l² in place of ρ².
///
/// # Errors
/// [`DesignFailure`].
pub fn contact_gain(
    rod: &Rod,
    push: f64,
    regime: ContactRegime,
    state_weights: [f64; 4],
    input_weight: f64,
) -> Result<Gains, DesignFailure> {
    let (l, rho_squared) = (rod.contact_distance, rod.radius_of_gyration * rod.radius_of_gyration);
    let (turning, light) = match regime {
        ContactRegime::Frictionless => (rho_squared, 1.0),
        ContactRegime::VelocityMatched | ContactRegime::Sticking => {
            (rho_squared + l * l, rho_squared / (rho_squared + l * l))
        }
    };
    let turn = push * l / turning;
    let a = Matrix4::new(
        0.0,
        0.0,
        1.0,
        0.0, //
        0.0,
        0.0,
        0.0,
        1.0, //
        0.0,
        -push * (1.0 - light),
        0.0,
        0.0, //
        0.0,
        turn,
        0.0,
        0.0,
    );
    let b = Vector4::new(0.0, 0.0, -push * light, -turn);
    Ok(gains(design_continuous(&a, &b, state_weights, input_weight)?.gain))
}

/// K of a level table whose surface accelerates along x by a = −K·(x, θ, ẋ, θ̇), m/s², under a contact that sticks:
/// (l² + ρ²)θ̈ = l(push·θ + a), ẍ = a − lθ̈. A table tilted by α that moves along with the contact does the same with a = −push·α.
///
/// # Errors
/// [`DesignFailure`].
pub fn cart_pole_gain(
    rod: &Rod,
    push: f64,
    state_weights: [f64; 4],
    input_weight: f64,
) -> Result<Gains, DesignFailure> {
    let tilt = contact_gain(rod, push, ContactRegime::VelocityMatched, state_weights, input_weight)?;
    Ok(gains([tilt.x, tilt.theta, tilt.x_dot, tilt.theta_dot].map(|gain| -(push * gain))))
}

fn gains([x, theta, x_dot, theta_dot]: [f64; 4]) -> Gains {
    Gains { x, theta, x_dot, theta_dot }
}
