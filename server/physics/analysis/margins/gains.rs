//! Margins of the gain of a table: the values nearest to its own at which small deviations do otherwise, and at which the run of the release ends
//! otherwise.

use super::judgement::{Loss, MOST_TRIED, NoMargins, VerdictLimit, search};
use crate::analysis::limits::{Limits, NoLimits, Parameter, limits_of};
use crate::analysis::nonlinear_run::run_nonlinear;
use crate::run::ending::EndingKind;
use crate::scene::Scene;

/// Most runs of the margins of a release.
pub const MOST_RUNS: u64 = 2 * MOST_TRIED + 1;

/// Margins of a gain.
#[derive(Clone, Debug, PartialEq)]
pub struct GainMargins {
    /// The tilt gain, or a factor on the gains of a state feedback.
    pub gain: Parameter,
    /// Ends of the range in which small deviations do the same.
    pub small: Limits,
    /// Distances below and above the gain up to which the run of the release ends as it does.
    pub release: [VerdictLimit; 2],
    /// Contacts of all runs that were made for it.
    pub bounces: u64,
}

/// The margins of a scene's gain, by runs of up to `impacts` contacts. `None` once `go_on` returned false.
pub fn gain_margins(scene: &Scene, impacts: u64, go_on: &mut dyn FnMut() -> bool) -> Option<GainMargins> {
    let gain = Parameter::of_gain(scene);
    let small = match limits_of(scene, gain, go_on) {
        Ok(small) => small,
        Err(NoLimits::Stopped | NoLimits::NoNumber) => return None,
    };
    let mut bounces = 0;
    let mut end = |scene: &Scene| {
        let run = run_nonlinear(scene, impacts, &mut *go_on)?;
        bounces += run.impacts;
        Some((EndingKind::from(run.ending), run.impacts))
    };
    let (own, _) = end(scene)?;
    let (minimum, maximum) = gain.range(scene);
    let mut side = |way: f64| {
        search(way.abs(), None, |distance| {
            let there = match gain.moved(scene, small.value + distance * way.signum()) {
                Ok(there) => there,
                Err(why) => return Ok(Some(Loss::refused(why))),
            };
            let (ending, impacts) = end(&there).ok_or(NoMargins::Stopped)?;
            Ok((ending != own).then(|| Loss::of_run(ending.name(), impacts)))
        })
        .ok()
    };
    let release = [side(minimum - small.value)?, side(maximum - small.value)?];
    Some(GainMargins { gain, small, release, bounces })
}
