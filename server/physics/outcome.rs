//! How runs can end, without the numbers of [`Ending`]: what a cell of a region keeps, and the names of answers.

use crate::map::Ending;

/// The kinds of [`Ending`], without their numbers.
#[allow(missing_docs)] // as in `Ending`
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Outcome {
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

impl Outcome {
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

    /// Its name in answers.
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

impl From<Ending> for Outcome {
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
