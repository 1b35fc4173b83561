//! The rules of a run: when it ends, beside the physics.

use crate::table::actuator_load::ActuatorLimits;

/// Fastest speed, m/s, of the centre of gravity or of the contact point about it, that a run may reach: beyond it
/// doubles no longer resolve a flight, and only a wrong energy feedback gets there.
pub const SPEED_LIMIT: f64 = 1e6;

/// What decides, beside the physics, when a run ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// |θ| at which a contact counts as toppled, rad; infinite for a body without an angle.
    pub topple_angle: f64,
    /// Whether strikes take energy away, always or at times, so that a run can settle.
    pub settles: bool,
    /// Whether rounding is kept off the energy ([`Orbit`]); not where a settling run loses it to G l (1 − cos θ).
    pub holds_energy: bool,
    /// What the table can do, if that is limited.
    pub limits: Option<ActuatorLimits>,
}

impl Rules {
    /// The map alone: nothing but what the physics itself forbids ends a run, and nothing is corrected.
    pub const BARE_MAP: Self = Self { topple_angle: f64::INFINITY, settles: false, holds_energy: false, limits: None };
}
