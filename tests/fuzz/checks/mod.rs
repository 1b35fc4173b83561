//! Checks that must hold for any bytes: one function for each reader of foreign input, and for the two formulas that a run depends on.
//! libFuzzer drives them (`targets`), and so does `tests/fuzzed.rs` in every run of the tests.
//!
//! A check returns if all is well and panics otherwise.

pub(crate) mod contact_time;
pub(crate) mod impulse;
pub(crate) mod live;
mod numbers;
mod problem;
pub(crate) mod query;
pub(crate) mod scene;

/// A check and its name.
#[derive(Clone, Copy, Debug)]
#[allow(dead_code, reason = "each target of libFuzzer runs its own")]
pub(crate) struct Check {
    /// The name of the target and of the folder of its corpus.
    pub(crate) name: &'static str,
    /// The check.
    pub(crate) run: fn(&[u8]),
}

/// All checks.
#[allow(dead_code, reason = "each target of libFuzzer runs its own")]
pub(crate) const ALL: [Check; 5] = [
    Check { name: "scene", run: scene::check },
    Check { name: "query", run: query::check },
    Check { name: "live", run: live::check },
    Check { name: "contact_time", run: contact_time::check },
    Check { name: "impulse", run: impulse::check },
];
