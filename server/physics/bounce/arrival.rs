//! The beginning and the end of a flight: release, kick, arrival, the contact to come, and the reasons for which there is none.

use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::table_motion::PlannedTableMotion;
use crate::numbers::number::Number;

/// Start of a run: a free body at t = 0, before its first contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Release {
    /// Horizontal place of the centre of gravity, m.
    pub x: f64,
    /// Height of the centre of gravity, m.
    pub height: f64,
    /// Angle and velocities.
    pub state: State,
}

/// Velocities that something else than the table gives a body, just after a strike.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Kick {
    /// Added to the horizontal velocity, m/s.
    pub x_dot: f64,
    /// Added to the vertical velocity, m/s.
    pub y_dot: f64,
    /// Added to the angular velocity, rad/s.
    pub theta_dot: f64,
}

impl Kick {
    /// Adds the kick to a strike of a body whose contact point is `length` (m) from its centre of gravity.
    #[inline(always)]
    pub fn disturb(&self, strike: &mut Strike, length: f64) {
        strike.after.x_dot += self.x_dot;
        strike.after.y_dot += self.y_dot;
        strike.after.theta_dot += self.theta_dot;
        strike.contact_rise += self.y_dot + length * self.theta_dot * strike.sin_cos_theta.0;
    }
}

/// End of a flight: just before a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival<N = f64> {
    /// Time since the flight began, s.
    pub t: N,
    /// Angle and velocities.
    pub state: State<N>,
    /// Height of the contact point above y = 0, m: 0 unless the table strikes early or late.
    pub clearance: N,
    /// Planned motion of the table, if it planned ahead.
    pub plan: Option<PlannedTableMotion<N>>,
    /// Way along x since the flight began, m; `None` where ẋ stays the same on it.
    pub travel: Option<N>,
}

impl<N: Number> Arrival<N> {
    /// Way along x since the flight began, m.
    #[inline(always)]
    pub fn way(&self) -> N {
        match self.travel {
            Some(way) => way,
            None => self.state.x_dot * self.t,
        }
    }
}

impl<N: Number> From<(N, State<N>)> for Arrival<N> {
    #[inline(always)]
    fn from((t, state): (N, State<N>)) -> Self {
        Self { t, state, clearance: N::from_f64(0.0), plan: None, travel: None }
    }
}

/// A contact that is about to happen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreImpact<N = f64> {
    /// Number of the contact, from 1.
    pub n: u64,
    /// Horizontal place of the centre of gravity, m.
    pub x: N,
    /// Angle and velocities just before it.
    pub state: State<N>,
    /// Same as in [`Arrival`], m.
    pub clearance: N,
    /// Same as in [`Arrival`].
    pub plan: Option<PlannedTableMotion<N>>,
}

impl PreImpact {
    /// A contact at y = 0, on a table that has planned nothing.
    #[inline(always)]
    pub fn at(n: u64, x: f64, state: State) -> Self {
        Self { n, x, state, clearance: 0.0, plan: None }
    }
}

/// Reason for which a flight ends without a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoContact {
    /// The contact time passed its work limit.
    TooManyPieces,
    /// The contact point does not come up to y = 0 again.
    Sinking,
    /// The planned table is never met.
    Missed,
    /// Another vertex comes down first.
    OtherVertex(Touch),
}

impl From<TooManyPieces> for NoContact {
    fn from(_: TooManyPieces) -> Self {
        Self::TooManyPieces
    }
}

/// A vertex of the body, other than the one that bounces, on the table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// Index of the vertex, from 0.
    pub vertex: usize,
    /// Time since the last contact, or since the release, s.
    pub t: f64,
}
