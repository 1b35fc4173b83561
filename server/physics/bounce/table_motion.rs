//! The motion of a table that was planned before the contact.

/// A table that moves as it was planned before the contact, whatever it then meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedTableMotion {
    /// α, rad.
    pub alpha: f64,
    /// The table's velocity along its normal, m/s.
    pub normal_velocity: f64,
    /// The table's velocity along itself, m/s.
    pub tangential_velocity: f64,
}
