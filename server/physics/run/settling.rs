//! When bounces have died out (Zeno): the flights have shrunk to nothing beside the first, and the contact point is at rest.
//!
//! Not here: who looks at it. The map, the map with 31 digits and the general methods all do.

use crate::run::ending::Ending;

/// A run that loses energy has settled (Zeno) when a flight is shorter than this share of its first.
pub const SETTLED_SHARE: f64 = 1e-9;

/// Largest speed of a contact point at rest along the table's normal, in speeds of its rise. A contact point that comes to rest has
/// both in proportion, 1/cos α apart where it sticks; one that grazes y = 0 leaves the table at the speed of the bounce.
const REST_RATIO: f64 = 1e3;

/// Velocity of the contact point just after a strike, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rebound {
    /// Its vertical part ẏ_c⁺.
    pub rise: f64,
    /// Its part along the table's normal.
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

/// The ending of a run at a strike at time `t`, s, from which the contact point does not rise; `settles` says whether strikes take
/// energy away.
pub fn stay(rebound: &Rebound, settles: bool, t: f64) -> Ending {
    if settles && rebound.has_stopped() {
        Ending::Settled { flight_time: 0.0, settle_time: t }
    } else {
        Ending::Sinking { contact_rise: rebound.rise.min(0.0) }
    }
}

/// Time from a strike to rest, s, by the geometric series of the flights: the coming one and the one before it, s.
pub fn time_to_rest(flight_time: f64, last_flight: f64) -> f64 {
    let ratio = flight_time / last_flight;
    if ratio < 1.0 { flight_time / (1.0 - ratio) } else { flight_time }
}
