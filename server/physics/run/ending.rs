//! Endings of runs: with the numbers that decided, and without them, as a cell of a stability map keeps them.

use crate::body::{NoContact, Touch};
use crate::table::actuator_load::LimitViolation;

/// Why a run ended, with the number that decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ending {
    /// Another vertex than the one that bounces meets the table.
    OtherVertex(Touch),
    /// |θ| reached the topple angle; both in rad.
    Toppled {
        /// θ at the contact.
        theta: f64,
        /// The topple angle.
        limit: f64,
    },
    /// The strike asks more of the table than its limits allow.
    BeyondLimits(LimitViolation),
    /// The contact point does not approach the moving table: it could only pull.
    Separating {
        /// Velocity relative to the table along its normal, m/s, ≥ 0.
        approach: f64,
    },
    /// There is no next contact from above: the contact point does not rise after the strike, or not up to y = 0.
    Sinking {
        /// Vertical velocity of the contact point after the strike, m/s; ≤ 0 unless it started below y = 0.
        contact_rise: f64,
    },
    /// The planned table is never met.
    Missed,
    /// Flights have shrunk to nothing (Zeno).
    Settled {
        /// The flight that was too short, s.
        flight_time: f64,
        /// When it comes to rest, s, from the geometric tail of its flights.
        settle_time: f64,
    },
    /// A speed passed [`crate::run::rules::SPEED_LIMIT`], or the next contact could not be found within its work limit.
    Diverged {
        /// The larger of the speeds, m/s; not finite where the arithmetic overflowed.
        speed: f64,
    },
    /// It went on to the last contact asked for.
    Completed,
}

impl NoContact {
    /// Why a run ends that flies on at this vertical velocity of the contact point and this speed, m/s.
    pub fn ending(self, contact_rise: f64, speed: f64) -> Ending {
        match self {
            Self::TooManyPieces => Ending::Diverged { speed },
            Self::Sinking => Ending::Sinking { contact_rise },
            Self::Missed => Ending::Missed,
            Self::OtherVertex(touch) => Ending::OtherVertex(touch),
        }
    }
}

impl Ending {
    /// Name in answers.
    pub fn name(self) -> &'static str {
        EndingKind::from(self).name()
    }
}

/// The kinds of [`Ending`], without their numbers.
#[allow(missing_docs)] // as in `Ending`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum EndingKind {
    Completed,
    Toppled,
    Separating,
    Sinking,
    Settled,
    Diverged,
    OtherVertex,
    Missed,
    BeyondLimits,
}

impl EndingKind {
    /// All of them, each at the place of its number.
    pub const ALL: [Self; 9] = [
        Self::Completed,
        Self::Toppled,
        Self::Separating,
        Self::Sinking,
        Self::Settled,
        Self::Diverged,
        Self::OtherVertex,
        Self::Missed,
        Self::BeyondLimits,
    ];

    /// Name in answers.
    pub fn name(self) -> &'static str {
        [
            "completed",
            "toppled",
            "separating",
            "sinking",
            "settled",
            "diverged",
            "other_vertex",
            "missed",
            "beyond_limits",
        ][self as usize]
    }
}

impl From<Ending> for EndingKind {
    fn from(ending: Ending) -> Self {
        match ending {
            Ending::Completed => Self::Completed,
            Ending::Toppled { .. } => Self::Toppled,
            Ending::Separating { .. } => Self::Separating,
            Ending::Sinking { .. } => Self::Sinking,
            Ending::Settled { .. } => Self::Settled,
            Ending::Diverged { .. } => Self::Diverged,
            Ending::OtherVertex(_) => Self::OtherVertex,
            Ending::Missed => Self::Missed,
            Ending::BeyondLimits(_) => Self::BeyondLimits,
        }
    }
}
