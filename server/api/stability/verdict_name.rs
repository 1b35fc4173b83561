//! A verdict in answers, with its code for programs and its words.

use equipoise_physics::analysis::verdict::{DecidedBy, Verdict};
use schemars::JsonSchema;
use serde::Serialize;

use crate::words;

words! {
    /// Code of a verdict on this setting and this release, from the most stable to the least. A run that ended is `unstable`, whatever small
    /// deviations do; `reason` and `lyapunov` say what those do. `stable_in_place`: a small deviation dies out. `stable_drifting`: a small
    /// deviation of the angle dies out, and a drift stays. `weakly_attracting`: the angle circles in first order, and a swing dies out in third.
    /// `elliptic`: the angle circles, and the run did for as long as it was watched. `bounded_beyond_boundary`: at or beyond an end of the
    /// linear verdict, yet bounded over 20,000 bounces. `weakly_unstable`: the angle circles in first order, and every swing grows in a higher
    /// one. `random`: with noise, the run survived, and others do with the probability in `reason`. `unstable`: the body falls, or would fall
    /// from a slightly different start, or a drift takes it off its table.
    pub VerdictCode = CODES;

    /// The analysis that decided. `boundary`: the way stability is lost at an end of the linear verdict (`loss_of_stability`). `fixed_point`: no
    /// bounce repeats, or a drift leaves the table. `ensemble`: runs with noise.
    pub VerdictDecidedBy = DecidedBy::ALL.map(DecidedBy::name);
}

/// Pattern of a verdict in words.
const VERDICT: &str = "^(stable in place|stable, drifting|unstable|(elliptic|weakly attracting|weakly unstable|bounded beyond the boundary), [0-9]+ bounces survived|random, [0-9]+ of [0-9]+ runs survive [0-9]+ bounces)$";

/// A verdict.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Verdict")]
pub struct VerdictAnswer {
    /// The verdict for programs.
    #[schemars(with = "VerdictCode")]
    pub(super) code: &'static str,
    /// The verdict in words. A number in it is how many bounces the run was watched for, and with noise the runs of an ensemble that survive.
    #[schemars(extend("pattern" = VERDICT))]
    pub(super) text: String,
    #[schemars(with = "VerdictDecidedBy")]
    pub(super) decided_by: &'static str,
    /// One sentence, with numbers.
    pub reason: String,
}

/// The verdict in words, with the number of bounces of the run that it rests on.
pub(super) fn words(verdict: Verdict, bounces: u64) -> String {
    let name = verdict.name();
    match verdict {
        Verdict::StableInPlace | Verdict::StableDrifting | Verdict::Random | Verdict::Unstable => name.to_owned(),
        Verdict::WeaklyAttracting | Verdict::WeaklyUnstable | Verdict::Elliptic | Verdict::BoundedBeyondBoundary => {
            format!("{name}, {bounces} bounces survived")
        }
    }
}

/// Code of a verdict, whatever its run was.
pub const fn code(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::StableInPlace => "stable_in_place",
        Verdict::StableDrifting => "stable_drifting",
        Verdict::Elliptic => "elliptic",
        Verdict::WeaklyAttracting => "weakly_attracting",
        Verdict::WeaklyUnstable => "weakly_unstable",
        Verdict::BoundedBeyondBoundary => "bounded_beyond_boundary",
        Verdict::Random => "random",
        Verdict::Unstable => "unstable",
    }
}

/// The codes of all verdicts, from the most stable to the least.
pub const CODES: [&str; 8] = [
    code(Verdict::StableInPlace),
    code(Verdict::StableDrifting),
    code(Verdict::WeaklyAttracting),
    code(Verdict::Elliptic),
    code(Verdict::BoundedBeyondBoundary),
    code(Verdict::WeaklyUnstable),
    code(Verdict::Random),
    code(Verdict::Unstable),
];
