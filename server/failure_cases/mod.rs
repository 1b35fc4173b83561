//! The failure gallery: scenes on which a common method is wrong, with what each method says there and what is true.
//!
//! A case is a scene and functions of it: everything it says is computed when it is asked for, nothing is recorded. Not here:
//! how a case is written down, and HTTP.

mod angle_history;
mod basin;
mod boundary;
mod case;
mod catching;
mod contact;
mod derivative;
mod eigenvalue;
mod horizon;
mod rig;
mod scenes;
mod steps;
mod swing;

pub use case::{FailureCase, Findings, MethodClaim};

/// All cases, in the order in which they are shown.
pub const CASES: [FailureCase; 22] = [
    boundary::SOFT,
    boundary::HARD,
    boundary::HARD_WITH_FEEDBACK,
    basin::DRIFT,
    basin::RESONANCE,
    basin::WIDE,
    boundary::BEYOND,
    steps::INVENTED,
    steps::DESTROYED,
    steps::MISSED,
    derivative::DIFFERENCES,
    derivative::GRAZE,
    steps::ZENO,
    contact::TRIVIAL_ROOT,
    horizon::CHAOS,
    catching::LOW_TARGET,
    swing::SETTLED,
    catching::CONTACT_GAIN,
    rig::BIAS,
    rig::TURNING,
    rig::LATE,
    rig::AIR,
];

/// The case of this name.
pub fn find(name: &str) -> Option<&'static FailureCase> {
    const { &CASES }.iter().find(|case| case.name == name)
}
