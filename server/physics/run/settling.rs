//! End of bounces that have died out (Zeno): the flights have shrunk to nothing beside the first, and the contact point is at rest.
//!
//! Not here: who looks at it. The map, the map with 31 digits and the general methods all do.

use crate::map::strike::Rebound;
use crate::run::ending::Ending;

/// A run that loses energy has settled (Zeno) when a flight is shorter than this share of its first.
pub const SETTLED_SHARE: f64 = 1e-9;

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
