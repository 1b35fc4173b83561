//! Endings of runs: with the numbers that decided, and without them, as a cell of a stability map keeps them.

use crate::map::body::{NoContact, Touch};
use crate::map::table::actuator_load::LimitViolation;

/// Declares the endings, each with its name in answers. Their order is that of counts and of codes in maps.
macro_rules! endings {
    ($($(#[$about:meta])* $name:literal => $ending:ident $(($($inner:tt)*))? $({ $($numbers:tt)* })?,)*) => {
        /// Reason for which a run ended, with the number that decided.
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub enum Ending {
            $($(#[$about])* $ending $(($($inner)*))? $({ $($numbers)* })?,)*
        }

        /// The kinds of [`Ending`], without their numbers.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(u8)]
        pub enum EndingKind {
            $($(#[$about])* $ending,)*
        }

        names!(EndingKind: $($ending => $name),*);

        impl From<Ending> for EndingKind {
            fn from(ending: Ending) -> Self {
                match ending {
                    $(Ending::$ending { .. } => Self::$ending,)*
                }
            }
        }
    };
}

endings! {
    /// The run went on to the last contact asked for.
    "completed" => Completed,
    /// |θ| reached the topple angle; both in rad.
    "toppled" => Toppled {
        /// θ at the contact.
        theta: f64,
        /// The topple angle.
        limit: f64,
    },
    /// The contact point does not approach the moving table: it could only pull.
    "separating" => Separating {
        /// Velocity relative to the table along its normal, m/s, ≥ 0.
        approach: f64,
    },
    /// There is no next contact from above: the contact point does not rise after the strike, or not up to y = 0.
    "sinking" => Sinking {
        /// Vertical velocity of the contact point after the strike, m/s; ≤ 0 unless it started below y = 0.
        contact_rise: f64,
    },
    /// Flights have shrunk to nothing (Zeno).
    "settled" => Settled {
        /// The flight that was too short, s.
        flight_time: f64,
        /// Time at which the body comes to rest, s, from the geometric tail of its flights.
        settle_time: f64,
    },
    /// A speed passed [`crate::run::rules::SPEED_LIMIT`], or the next contact could not be found within its work limit.
    "diverged" => Diverged {
        /// The larger of the speeds, m/s; not finite where the arithmetic overflowed.
        speed: f64,
    },
    /// Another vertex than the one that bounces meets the table.
    "other_vertex" => OtherVertex(Touch),
    /// The planned table is never met.
    "missed" => Missed,
    /// The strike asks more of the table than its limits allow.
    "beyond_limits" => BeyondLimits(LimitViolation),
    /// The contact point came down beyond an end of the table.
    "off_table" => OffTable {
        /// Place of the contact point from the middle of the table, m.
        place: f64,
        /// Half the length of the table, m.
        limit: f64,
    },
}

impl NoContact {
    /// The ending of a run that flies on at this vertical velocity of the contact point and this speed, m/s.
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
