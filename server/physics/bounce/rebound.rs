//! The contact point just after a strike: rising, at rest, or neither.

/// Largest speed of a contact point at rest along the table's normal, in speeds of its rise. A contact point that comes to rest has
/// both in proportion, 1/cos α apart where it sticks; one that grazes y = 0 leaves the table at the speed of the bounce.
const REST_RATIO: f64 = 1e3;

/// Velocity of the contact point just after a strike, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rebound {
    /// Vertical part ẏ_c⁺.
    pub rise: f64,
    /// Part along the table's normal.
    pub along_normal: f64,
    /// Size of a rise that is rounding.
    pub rounding: f64,
}

impl Rebound {
    /// Tells whether the contact point rises from the table, by more than rounding.
    pub fn rises(&self) -> bool {
        self.rise > self.rounding
    }

    /// Tells whether the contact point is at rest but for rounding.
    pub fn has_stopped(&self) -> bool {
        self.rise.abs() <= self.rounding && self.is_slow()
    }

    /// Tells whether the contact point is as slow along the table's normal as it is upwards, so that a short flight is not a graze.
    pub fn is_slow(&self) -> bool {
        self.along_normal.abs() <= REST_RATIO * self.rise.max(self.rounding)
    }
}
