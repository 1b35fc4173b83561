//! The failure gallery: scenes on which a common method is wrong, with what each method says there and what is true.
//!
//! A case is a scene and functions of it: everything it says is computed when it is asked for, nothing is recorded. Not here:
//! how a case is written down, and HTTP.

mod case;
mod linear;
mod methods;
mod rig;

pub use case::{FailureCase, Findings, MethodClaim};

/// All cases, in the order in which they are shown.
pub const CASES: [FailureCase; 22] = [
    linear::SOFT,
    linear::HARD,
    linear::HARD_WITH_FEEDBACK,
    linear::DRIFT,
    linear::RESONANCE,
    linear::WIDE,
    linear::BEYOND,
    methods::INVENTED,
    methods::DESTROYED,
    methods::MISSED,
    methods::DIFFERENCES,
    methods::GRAZE,
    methods::ZENO,
    methods::TRIVIAL_ROOT,
    linear::CHAOS,
    rig::LOW_TARGET,
    linear::SETTLED,
    rig::CONTACT_GAIN,
    rig::BIAS,
    rig::TURNING,
    rig::LATE,
    rig::AIR,
];

/// The case of this name.
pub fn find(name: &str) -> Option<&'static FailureCase> {
    const { &CASES }.iter().find(|case| case.name == name)
}
