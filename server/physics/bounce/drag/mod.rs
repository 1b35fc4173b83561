//! Flights through air that drags the body: forces in the plane proportional to velocity, for place and rotation.
//!
//! v̇ = g − cv and θ̈ = −c_θθ̇, both in closed form. Not here: flights without drag ([`crate::bounce::flight`]).

pub mod contact_time;
pub mod decay;
pub mod flight;

/// Rates at which the air takes velocities away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirDrag {
    /// c, 1/s, of the velocity of the centre of gravity.
    pub linear: f64,
    /// c_θ, 1/s, of the angular velocity.
    pub rotational: f64,
}

impl AirDrag {
    /// Drag with these rates, 1/s; `None` if both are 0.
    pub fn new(linear: f64, rotational: f64) -> Option<Self> {
        (linear != 0.0 || rotational != 0.0).then_some(Self { linear, rotational })
    }
}
