//! A contact of a run, as a run gives it to those who look at it.

use crate::map::body::PreImpact;
use crate::map::strike::State;
use crate::map::strike::Strike;
use crate::map::table::actuator_load::Pose;
use crate::run::ending::Ending;

/// One contact of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<N = f64> {
    /// Number of the contact, from 1.
    pub n: u64,
    /// Time, s after release.
    pub t: N,
    /// Horizontal place of the centre of gravity, m.
    pub x: N,
    /// Angle and velocities just before it.
    pub state: State<N>,
    /// Height of the contact point above y = 0, m: 0 unless the table strikes early or late.
    pub clearance: N,
    /// α, table tilt, rad; of a table that does not strike too.
    pub alpha: N,
    /// The strike, unless the run ended before it.
    pub strike: Option<Strike<N>>,
    /// Time to the next contact, s; `None` if the run ended.
    pub flight_time: Option<N>,
    /// Ending of the run, if it ended here.
    pub ending: Option<Ending>,
}

impl<N: Copy> Contact<N> {
    /// The same contact in other numbers.
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> Contact<M> {
        let Self { n, t, x, ref state, clearance, alpha, strike, flight_time, ending } = *self;
        Contact {
            n,
            t: function(t),
            x: function(x),
            state: state.map(&function),
            clearance: function(clearance),
            alpha: function(alpha),
            strike: strike.map(|strike| strike.map(&function)),
            flight_time: flight_time.map(&function),
            ending,
        }
    }
}

/// A coming contact of a run, and its time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ComingContact {
    /// Time of the run, s.
    pub t: f64,
    /// The contact.
    pub coming: PreImpact,
    /// The table at the strike before, and the flight since then, s, if there was one.
    pub before: Option<(Pose, f64)>,
}
