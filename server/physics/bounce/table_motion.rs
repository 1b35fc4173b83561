//! The motion of a table that was planned before the contact.

/// A table that moves as it was planned before the contact, whatever it then meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedTableMotion<N = f64> {
    /// α, rad.
    pub alpha: N,
    /// The table's velocity along its normal, m/s.
    pub normal_velocity: N,
    /// The table's velocity along itself, m/s.
    pub tangential_velocity: N,
}
