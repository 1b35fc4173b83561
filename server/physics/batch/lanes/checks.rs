//! The checks of [`crate::run::rules`] as masks: whether the run in a lane surely goes on past its contact.
//!
//! Any other lane is set apart, and the map itself decides. So a mask may be too cautious but never too bold.

use crate::run::rules::{Check, CheckedByMask, SPEED_LIMIT};
use crate::run::settling::SETTLED_SHARE;

/// A contact point that rises faster does so by more than rounding ([`Strike::rises`]), at any speed up to the limit, m/s.
pub(super) const SURE_RISE: f64 = 1e-8;

/// The run in a lane at a contact. Each loop over the lanes knows a part of it; the rest is as in [`LaneContact::GOES_ON`].
#[derive(Clone, Copy)]
pub(super) struct LaneContact {
    /// |θ|, rad.
    pub(super) size: f64,
    pub(super) topple_angle: f64,
    /// As in [`crate::bounce::strike::Strike`], m/s.
    pub(super) push: f64,
    /// Velocities after the strike, m/s.
    pub(super) x_dot: f64,
    pub(super) y_dot: f64,
    pub(super) contact_rise: f64,
    /// A faster rise is more than rounding, m/s.
    pub(super) sure_rise: f64,
    /// True once the time of flight is found.
    pub(super) found: bool,
    /// s.
    pub(super) flight_time: f64,
    /// First flight of a run that can settle, s; 0 of others.
    pub(super) first_flight: f64,
}

impl LaneContact {
    /// A contact at which no run ends.
    pub(super) const GOES_ON: Self = Self {
        size: 0.0,
        topple_angle: 1.0,
        push: -1.0,
        x_dot: 0.0,
        y_dot: 0.0,
        contact_rise: 1.0,
        sure_rise: 0.0,
        found: true,
        flight_time: 1.0,
        first_flight: 0.0,
    };
}

impl CheckedByMask for LaneContact {
    // No comparison holds where something is not a number.
    #[inline(always)]
    fn passes(&self, check: Check) -> bool {
        match check {
            // Lanes hold rods on tables without limits.
            Check::OtherVertex | Check::BeyondLimits => true,
            Check::Toppled => self.size < self.topple_angle,
            Check::Separating => self.push < 0.0,
            Check::TooFast => (self.x_dot.abs() <= 0.5 * SPEED_LIMIT) & (self.y_dot.abs() <= 0.5 * SPEED_LIMIT),
            Check::NotRising => self.contact_rise > self.sure_rise,
            Check::NoContact => self.found,
            Check::ShortFlight => self.flight_time >= SETTLED_SHARE * self.first_flight,
        }
    }
}
