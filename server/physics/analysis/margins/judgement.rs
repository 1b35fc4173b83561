//! Tells whether a scene with errors keeps the verdict of the one without.

use crate::analysis::evidence::{self, Evidence};
use crate::analysis::limits::{Limit, LimitKind, Moving, Place, Search};
use crate::analysis::nonlinear_run::{NonlinearRun, run_nonlinear};
use crate::analysis::small_deviations::small_deviations;
use crate::analysis::verdict::{DecidedBy, Verdict};
use crate::run::ending::Ending;
use crate::scene::Scene;

/// Reason for which there is no budget.
#[derive(Clone, Debug, PartialEq)]
pub enum NoBudget {
    /// The search was cancelled.
    Stopped,
    /// There is nothing to keep, for this reason.
    Because(String),
}

/// Criterion that decides a limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitedBy {
    /// The verdict becomes worse, by this evidence.
    Verdict(DecidedBy),
    /// No bounce repeats on the table any more.
    FixedPoint,
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
            Self::FixedPoint => "fixed_point",
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

/// The judgement on one scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Judgement {
    /// It keeps the verdict.
    Kept,
    /// It does not.
    Lost {
        /// Criterion that is lost.
        by: LimitedBy,
        /// End of its run, where that is what is lost.
        ending: Option<&'static str>,
        /// Reason in a sentence.
        detail: String,
    },
}

impl Judgement {
    /// A run that ends at this contact.
    pub(super) fn run_lost(ending: &'static str, contact: u64) -> Self {
        Self::Lost {
            by: LimitedBy::Verdict(DecidedBy::Nonlinear),
            ending: Some(ending),
            detail: format!("the run ends as `{ending}` at contact {contact}"),
        }
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
    /// Contacts so far.
    pub(super) bounces: u64,
}

impl<'a> Judge<'a> {
    /// The judge for a scene without errors, whose run has to survive.
    pub(super) fn of(ideal: &'a Scene, impacts: u64, go_on: &'a mut dyn FnMut() -> bool) -> Result<Self, NoBudget> {
        let mut judge = Self { ideal, impacts, go_on, kept: None, bounces: 0 };
        let run = judge.run(ideal)?;
        if run.ending != Ending::Completed {
            return Err(NoBudget::Because(format!(
                "without errors the run ends as `{}` at contact {}, so no error is the reason",
                run.ending.name(),
                run.impacts
            )));
        }
        let weighed = judge.weighed(ideal, &run)?;
        if let Some((Verdict::Unstable, by)) = weighed {
            let by = by.name();
            return Err(NoBudget::Because(format!("the verdict is unstable without errors, by the evidence `{by}`")));
        }
        judge.kept = weighed;
        Ok(judge)
    }

    fn run(&mut self, scene: &Scene) -> Result<NonlinearRun, NoBudget> {
        let run = run_nonlinear(scene, self.impacts, &mut self.go_on).ok_or(NoBudget::Stopped)?;
        self.bounces += run.impacts;
        Ok(run)
    }

    /// Small deviations in scenes at distances up to `end`.
    pub(super) fn small(&mut self, scenes: &dyn Fn(f64) -> Result<Scene, String>, end: f64) -> Result<Small, NoBudget> {
        // The map is that without noise.
        let is_noisy = scenes(end * f64::EPSILON).is_ok_and(|scene| scene.has_noise());
        if self.kept.is_none() || is_noisy {
            return Ok(Small::NothingRepeats);
        }
        let (moving, own) = Moving::along(self.ideal, scenes);
        if !own.as_ref().is_ok_and(Place::is_bounded) {
            return Ok(Small::Bounded(None));
        }
        let mut search = Search { moving, go_on: &mut *self.go_on };
        let limit = search.toward(end, 0.0, &own).map_err(|_| NoBudget::Stopped)?;
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
                (LimitedBy::FixedPoint, kind.to_string())
            }
            LimitKind::Refused(why) => (LimitedBy::Refused, why.clone()),
            LimitKind::PlusOne | LimitKind::MinusOne | LimitKind::Pair(_) => {
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

    /// Judges by the run, and by the verdict that weighs it with the evidence on the scene unless runs alone judge.
    pub(super) fn judge(&mut self, scene: &Scene, by_run_alone: bool) -> Result<Judgement, NoBudget> {
        let run = self.run(scene)?;
        if run.ending != Ending::Completed {
            return Ok(Judgement::run_lost(run.ending.name(), run.impacts));
        }
        let Some((kept, _)) = self.kept.filter(|_| !by_run_alone) else { return Ok(Judgement::Kept) };
        Ok(match self.weighed(scene, &run)? {
            Some((verdict, by)) if rank(verdict) < rank(kept) => {
                Judgement::Lost { by: LimitedBy::Verdict(by), ending: None, detail: loss(kept, verdict) }
            }
            Some(_) | None => Judgement::Kept,
        })
    }

    /// The verdict on a scene with its run; `None` where no bounce repeats and with noise, where the run alone decides. A drift that leaves the
    /// table later than the run does not count.
    fn weighed(&mut self, scene: &Scene, run: &NonlinearRun) -> Result<Option<(Verdict, DecidedBy)>, NoBudget> {
        if scene.has_noise() {
            return Ok(None);
        }
        let judgement = evidence::judge(scene, run, self.impacts, &mut self.go_on).ok_or(NoBudget::Stopped)?;
        self.bounces += judgement.bounces;
        let Evidence::Balances(balance) = &judgement.evidence else { return Ok(None) };
        Ok(Some(match balance.leaves {
            Some(_) => balance.between_ends(),
            None => (judgement.verdict, judgement.decided_by),
        }))
    }
}

/// Tells whether small deviations stay small in a scene.
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
