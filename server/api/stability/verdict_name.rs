//! Names of a verdict in answers: a sentence, and a code for programs.

use equipoise_physics::run::ending::Ending;
use equipoise_physics::stability::nonlinear_run::NonlinearRun;
use equipoise_physics::stability::verdict::Verdict;

/// The verdict in words, with the length of the run that it rests on.
pub(super) fn words(verdict: Verdict, run: &NonlinearRun) -> String {
    let NonlinearRun { impacts, ending, .. } = run;
    let name = verdict.name();
    match (verdict, *ending == Ending::Completed) {
        (Verdict::StableInPlace | Verdict::StableDrifting | Verdict::Random | Verdict::Unstable, _) => name.to_owned(),
        (Verdict::WeaklyAttracting, false) => format!("{name}, but this run ended at bounce {impacts}"),
        (Verdict::WeaklyUnstable, false) => format!("{name}, this run ended at bounce {impacts}"),
        (Verdict::WeaklyAttracting | Verdict::WeaklyUnstable, true)
        | (Verdict::Elliptic | Verdict::BoundedBeyondBoundary, _) => format!("{name}, {impacts} bounces survived"),
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
