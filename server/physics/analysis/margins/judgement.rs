//! Tells whether a scene with errors keeps the verdict of the one without, and finds the largest distance up to which all distances tried keep it.
//! Margins of the gain of a table are found by the same search.

use crate::analysis::evidence::{self, Evidence};
use crate::analysis::limits::{Limit, LimitKind, Limits, Moving, Parameter, limits_of};
use crate::analysis::nonlinear_run::{NonlinearRun, run_nonlinear};
use crate::analysis::repeating::{RepeatingBounce, SceneMap};
use crate::analysis::root::Bracket;
use crate::analysis::small_deviations::small_deviations;
use crate::analysis::verdict::{DecidedBy, Verdict};
use crate::run::ending::{Ending, EndingKind};
use crate::scene::Scene;

/// Reason for which there are no margins, or no budget.
#[derive(Clone, Debug, PartialEq)]
pub enum NoMargins {
    /// The search was cancelled.
    Stopped,
    /// A body has no verdict, or there is nothing to keep, for this reason.
    Because(String),
}

impl From<String> for NoMargins {
    fn from(why: String) -> Self {
        Self::Because(why)
    }
}

/// Criterion that decides a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitedBy {
    /// The verdict becomes worse by this evidence, or no bounce repeats on the table any more.
    Verdict(DecidedBy),
    /// No scene can have the value.
    Refused,
    /// The range of the field ends; nothing is lost within it.
    Range,
}

impl LimitedBy {
    /// Names in answers.
    pub const NAMES: [&'static str; 7] =
        ["linear", "nonlinear", "boundary", "lyapunov", "fixed_point", "refused", "range"];

    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Verdict(by) => by.name(),
            Self::Refused => "refused",
            Self::Range => "range",
        }
    }
}

/// A limit up to which a verdict is kept: of an error, of a factor on errors, or of another number.
#[derive(Clone, Debug, PartialEq)]
pub struct VerdictLimit {
    /// Largest distance from 0 up to which every distance tried keeps the verdict.
    pub value: f64,
    /// Distance from there to the nearest one found that loses it; 0 where nothing is lost up to the end of the range.
    pub accuracy: f64,
    /// Spacing of the distances tried below it: a narrower gap may have been missed.
    pub spacing: f64,
    /// Criterion that is lost.
    pub by: LimitedBy,
    /// End of the run that is lost, where one is.
    pub ending: Option<&'static str>,
    /// Loss in a sentence.
    pub detail: String,
    /// Limit of small deviations of the state alone; `None` where no bounce repeats beside the one without the errors, and where they stay small
    /// over the whole range.
    pub linear: Option<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Loss {
    pub(super) by: LimitedBy,
    /// End of its run, where that is what is lost.
    pub(super) ending: Option<&'static str>,
    pub(super) detail: String,
}

impl Loss {
    /// A value that no scene can have, for this reason.
    pub(super) fn refused(detail: String) -> Self {
        Self { by: LimitedBy::Refused, ending: None, detail }
    }

    fn of_run(ending: &'static str, contact: u64) -> Self {
        let detail = format!("the run ends as `{ending}` at contact {contact}");
        Self { by: LimitedBy::Verdict(DecidedBy::Nonlinear), ending: Some(ending), detail }
    }
}

/// Rank of a verdict; a higher one is no worse.
fn rank(verdict: Verdict) -> u8 {
    match verdict {
        Verdict::StableInPlace | Verdict::StableDrifting | Verdict::WeaklyAttracting => 3,
        Verdict::Elliptic => 2,
        Verdict::BoundedBeyondBoundary | Verdict::WeaklyUnstable | Verdict::Random => 1,
        Verdict::Unstable => 0,
    }
}

/// Small deviations along a direction of errors.
pub(super) enum Small {
    /// No bounce repeats beside the one without errors: runs alone judge.
    NothingRepeats,
    /// They stay small up to a limit, if there is one.
    Bounded(Option<VerdictLimit>),
}

/// Least share of the distance of a limit, and largest, by which the eigenvalues have left the unit circle within it.
const INSIDE: (f64, f64) = (1e-9, 1e-3);

/// Judges scenes by the verdict of one without errors.
pub(super) struct Judge<'a> {
    ideal: &'a Scene,
    impacts: u64,
    go_on: &'a mut dyn FnMut() -> bool,
    /// Verdict to keep, and the evidence for it; `None` where the run alone decides.
    pub(super) kept: Option<(Verdict, DecidedBy)>,
    pub(super) bounces: u64,
}

impl<'a> Judge<'a> {
    /// The judge for a scene without errors, whose run has to survive.
    pub(super) fn of(ideal: &'a Scene, impacts: u64, go_on: &'a mut dyn FnMut() -> bool) -> Result<Self, NoMargins> {
        let mut judge = Self { ideal, impacts, go_on, kept: None, bounces: 0 };
        let run = judge.run(ideal)?;
        if run.ending != Ending::Completed {
            return Err(NoMargins::Because(format!(
                "without errors the run ends as `{}` at contact {}, so no error is the reason",
                run.ending.name(),
                run.impacts
            )));
        }
        let weighed = judge.weighed(ideal, &run)?;
        if let Some((Verdict::Unstable, by)) = weighed {
            let by = by.name();
            return Err(NoMargins::Because(format!("the verdict is unstable without errors, by the evidence `{by}`")));
        }
        judge.kept = weighed;
        Ok(judge)
    }

    fn run(&mut self, scene: &Scene) -> Result<NonlinearRun, NoMargins> {
        let run = run_nonlinear(scene, self.impacts, &mut self.go_on).ok_or(NoMargins::Stopped)?;
        self.bounces += run.impacts;
        Ok(run)
    }

    /// Small deviations in scenes at distances up to `end`.
    pub(super) fn small(
        &mut self,
        scenes: &dyn Fn(f64) -> Result<Scene, String>,
        end: f64,
    ) -> Result<Small, NoMargins> {
        // The map is that without noise.
        let is_noisy = scenes(end * f64::EPSILON).is_ok_and(|scene| scene.has_noise());
        if self.kept.is_none() || is_noisy {
            return Ok(Small::NothingRepeats);
        }
        let mut moving = Moving::about(self.ideal, scenes, SceneMap::find, &mut *self.go_on);
        if !moving.own.as_ref().is_ok_and(RepeatingBounce::is_bounded) {
            return Ok(Small::Bounded(None));
        }
        let limit = moving.toward(end, 0.0).map_err(|_| NoMargins::Stopped)?;
        let Some(Limit { mut value, mut accuracy, kind }) = limit else { return Ok(Small::Bounded(None)) };
        let is_start = value <= accuracy;
        if is_start {
            (value, accuracy) = (0.0, accuracy.max(f64::EPSILON * end));
            while accuracy < end && scenes(accuracy).is_ok_and(|scene| says_bounded(&scene)) {
                accuracy *= 4.0;
            }
        }
        let (by, detail) = match &kind {
            LimitKind::NoBounce(_) | LimitKind::NoContact if is_start => return Ok(Small::NothingRepeats),
            LimitKind::NoBounce(_) | LimitKind::NoContact | LimitKind::OffTable => {
                (LimitedBy::Verdict(DecidedBy::FixedPoint), kind.to_string())
            }
            LimitKind::Refused(why) => (LimitedBy::Refused, why.clone()),
            LimitKind::Eigenvalue(_) => {
                // At the limit itself they are on the unit circle, within rounding.
                let (root, mut share) = (value, INSIDE.0);
                while !is_start && share < INSIDE.1 {
                    value = (root - accuracy.max(share * root)).max(0.0);
                    if scenes(value).is_ok_and(|scene| says_bounded(&scene)) {
                        // As far beyond the limit they are off it.
                        accuracy = 2.0 * (root - value);
                        break;
                    }
                    share *= 4.0;
                }
                (LimitedBy::Verdict(DecidedBy::Linear), format!("a small deviation grows: {kind}"))
            }
        };
        let linear = (by != LimitedBy::Refused).then_some(value);
        Ok(Small::Bounded(Some(VerdictLimit { value, accuracy, spacing: 0.0, by, ending: None, detail, linear })))
    }

    /// Judges by the run, and by the verdict that weighs it with the evidence on the scene unless runs alone judge: the loss, if there is one.
    pub(super) fn judge(&mut self, scene: &Scene, by_run_alone: bool) -> Result<Option<Loss>, NoMargins> {
        let run = self.run(scene)?;
        if run.ending != Ending::Completed {
            return Ok(Some(Loss::of_run(run.ending.name(), run.impacts)));
        }
        let Some((kept, _)) = self.kept.filter(|_| !by_run_alone) else { return Ok(None) };
        let worse = self.weighed(scene, &run)?.filter(|(verdict, _)| rank(*verdict) < rank(kept));
        Ok(worse.map(|(verdict, by)| Loss { by: LimitedBy::Verdict(by), ending: None, detail: loss(kept, verdict) }))
    }

    /// The verdict on a scene with its run; `None` where no bounce repeats and with noise, where the run alone decides. A drift that leaves the
    /// table later than the run does not count.
    fn weighed(&mut self, scene: &Scene, run: &NonlinearRun) -> Result<Option<(Verdict, DecidedBy)>, NoMargins> {
        if scene.has_noise() {
            return Ok(None);
        }
        let judgement = evidence::judge(scene, run, self.impacts, &mut self.go_on).ok_or(NoMargins::Stopped)?;
        self.bounces += judgement.bounces;
        let Evidence::Balances(balance) = &judgement.evidence else { return Ok(None) };
        Ok(Some(match balance.leaves {
            Some(_) => balance.between_ends(),
            None => (judgement.verdict, judgement.decided_by),
        }))
    }
}

fn says_bounded(scene: &Scene) -> bool {
    small_deviations(scene).is_ok_and(|small| small.motion.is_bounded())
}

/// The loss of a verdict to a worse one, in a sentence.
fn loss(kept: Verdict, verdict: Verdict) -> String {
    let (kept, name) = (kept.name(), verdict.name());
    if verdict.holds() {
        format!("a small deviation no longer dies out: `{kept}` becomes `{name}`")
    } else {
        format!("`{kept}` becomes `{name}`")
    }
}

/// Distances of the first scan: from the end of the range down, each half of the one before.
const HALVES: u32 = 20;

/// Distances further down, each half the one before, to 1e-9 of the range, if all are lost. Then no distance is left.
const FURTHER_HALVES: usize = 10;

/// Bisections of the distance at which the verdict is lost: to 1/4096 of it.
const BISECTIONS: usize = 12;

/// Evenly spaced distances within the limit at which the verdict is looked at again.
const CHECKS: usize = 16;

/// Most distances of one search that are judged with a run. A scan further down is in place of one up, and shorter.
pub(super) const MOST_TRIED: u64 = HALVES as u64 + 1 + 2 * BISECTIONS as u64 + CHECKS as u64;

/// The limit of a distance up to `end`, by `judge`. `small` is where the limit of small deviations is, if it has one: beyond it no run is needed.
pub(super) fn search(
    end: f64,
    small: Option<VerdictLimit>,
    mut judge: impl FnMut(f64) -> Result<Option<Loss>, NoMargins>,
) -> Result<VerdictLimit, NoMargins> {
    let mut judged = |distance: f64| {
        let loss = judge(distance)?;
        let is_kept = loss.is_none();
        Ok((loss, is_kept))
    };
    // Nothing is lost nearer.
    let known = small.unwrap_or_else(|| VerdictLimit {
        value: end,
        accuracy: 0.0,
        spacing: 0.0,
        by: LimitedBy::Range,
        ending: None,
        detail: "nothing is lost up to the end of the range".to_owned(),
        linear: None,
    });
    let mut found = if known.value == 0.0 { None } else { first_loss(known.value, &mut judged)? };
    let kept = found.as_ref().map_or(known.value, |bracket| bracket.kept.0);
    let spacing = kept / (CHECKS + 1) as f64;
    let mut below = 0.0;
    for check in 1..=if kept == 0.0 { 0 } else { CHECKS } {
        let distance = spacing * check as f64;
        let (loss, is_kept) = judged(distance)?;
        if !is_kept {
            let mut gap = Bracket { kept: (below, None), lost: (distance, loss) };
            gap.halve(BISECTIONS, |distance, _| judged(distance))?;
            found = Some(gap);
            break;
        }
        below = distance;
    }
    Ok(match found {
        Some(Bracket { kept: (value, _), lost: (beyond, Some(Loss { by, ending, detail })) }) => {
            VerdictLimit { value, accuracy: beyond - value, spacing, by, ending, detail, linear: known.linear }
        }
        _ => VerdictLimit { spacing, ..known },
    })
}

/// The first loss on the way to `end`, narrowed; `None` if nothing is lost at the distances scanned.
fn first_loss(
    end: f64,
    mut judged: impl FnMut(f64) -> Result<(Option<Loss>, bool), NoMargins>,
) -> Result<Option<Bracket<Option<Loss>>>, NoMargins> {
    let mut kept = (0.0, None);
    for step in (0..=HALVES).rev() {
        let distance = end / f64::from(1_u32 << step);
        let (loss, is_kept) = judged(distance)?;
        if is_kept {
            kept = (distance, loss);
            continue;
        }
        let mut bracket = Bracket { kept, lost: (distance, loss) };
        if step == HALVES {
            bracket.halve(FURTHER_HALVES, |distance, _| judged(distance))?;
        }
        if bracket.kept.0 > 0.0 {
            bracket.halve(BISECTIONS, |distance, _| judged(distance))?;
        }
        return Ok(Some(bracket));
    }
    Ok(None)
}

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
    let small = limits_of(scene, gain, go_on).ok()?;
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
