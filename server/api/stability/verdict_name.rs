//! Names of a verdict in answers: a sentence, and a code for programs.

use equipoise_physics::analysis::nonlinear_run::NonlinearRun;
use equipoise_physics::analysis::verdict::Verdict;

/// The verdict in words, with the length of the run that it rests on.
pub(super) fn words(verdict: Verdict, run: &NonlinearRun) -> String {
    let NonlinearRun { impacts, .. } = run;
    let name = verdict.name();
    match verdict {
        Verdict::StableInPlace | Verdict::StableDrifting | Verdict::Random | Verdict::Unstable => name.to_owned(),
        Verdict::WeaklyAttracting | Verdict::WeaklyUnstable | Verdict::Elliptic | Verdict::BoundedBeyondBoundary => {
            format!("{name}, {impacts} bounces survived")
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
