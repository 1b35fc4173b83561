//! Tells whether a scene with errors keeps the verdict of the one without.

use crate::analysis::contact_regime::{ContactRegime, contact_regime};
use crate::analysis::evidence;
use crate::analysis::fixed_point::{FixedPoint, find_fixed_point, undecided_turn};
use crate::analysis::linear_verdict::{LinearVerdict, linear_verdict};
use crate::analysis::nonlinear_run::{NonlinearRun, run_nonlinear};
use crate::analysis::steady_drift::SteadyDrift;
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
    /// There is no bounce in place on the table any more.
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

fn lost(by: LimitedBy, detail: String) -> Judgement {
    Judgement::Lost { by, ending: None, detail }
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

/// Judges scenes by the verdict of one without errors.
pub(super) struct Judge<'a> {
    impacts: u64,
    go_on: &'a mut dyn FnMut() -> bool,
    /// Verdict to keep, and whether the linear verdict is bounded; `None` where the run alone decides.
    kept: Option<(Verdict, bool)>,
    /// Contacts so far.
    pub(super) bounces: u64,
}

impl<'a> Judge<'a> {
    /// The judge for a scene without errors, whose run has to survive.
    pub(super) fn of(ideal: &Scene, impacts: u64, go_on: &'a mut dyn FnMut() -> bool) -> Result<Self, NoBudget> {
        let mut judge = Self { impacts, go_on, kept: None, bounces: 0 };
        let run = judge.run(ideal)?;
        if run.ending != Ending::Completed {
            return Err(NoBudget::Because(format!(
                "without errors the run ends as `{}` at contact {}, so no error is the reason",
                run.ending.name(),
                run.impacts
            )));
        }
        if let Ok(place) = find_fixed_point(ideal) {
            let ideal = &ideal.with_tilt_law();
            let linear = linear_verdict(ideal, &place);
            let (verdict, decided_by) = judge.weighed(ideal, &run)?;
            if verdict == Verdict::Unstable {
                let by = decided_by.name();
                return Err(NoBudget::Because(format!(
                    "the verdict is unstable without errors, by the evidence `{by}`"
                )));
            }
            judge.kept = Some((verdict, linear.says_bounded()));
        }
        Ok(judge)
    }

    /// Verdict that is kept.
    pub(super) fn verdict(&self) -> Option<Verdict> {
        self.kept.map(|(verdict, _)| verdict)
    }

    fn run(&mut self, scene: &Scene) -> Result<NonlinearRun, NoBudget> {
        let run = run_nonlinear(scene, self.impacts, &mut self.go_on).ok_or(NoBudget::Stopped)?;
        self.bounces += run.impacts;
        Ok(run)
    }

    /// The fixed point and the linear verdict, where both the ideal scene and this one are to have one.
    fn judged(&self, scene: &Scene) -> Option<Result<(FixedPoint, LinearVerdict), String>> {
        self.kept?;
        match find_fixed_point(scene) {
            Ok(place) => {
                let linear = linear_verdict(&scene.with_tilt_law(), &place);
                Some(Ok((place, linear)))
            }
            Err(_) if run_decides(scene) => None,
            Err(why) => Some(Err(why)),
        }
    }

    /// Judges by the linear verdict alone.
    pub(super) fn linearly(&self, scene: &Scene) -> Judgement {
        match self.judged(scene) {
            Some(Err(why)) => lost(LimitedBy::FixedPoint, why),
            Some(Ok((_, linear))) if self.kept.is_some_and(|(_, bounded)| bounded) && !linear.says_bounded() => {
                let sticks = contact_regime(&scene.with_tilt_law().model()) == ContactRegime::Sticking;
                let detail = match (linear.energy_eigenvalue.abs() > 1.0, sticks) {
                    (true, _) => "a small deviation of the height grows",
                    (false, true) => "the contact sticks to the table, and a small deviation of the angle grows",
                    (false, false) => "a small deviation of the angle grows",
                };
                lost(LimitedBy::Verdict(DecidedBy::Linear), detail.to_owned())
            }
            Some(Ok(_)) | None => Judgement::Kept,
        }
    }

    /// Judges by the linear verdict, the run, and the verdict that weighs them.
    pub(super) fn judge(&mut self, scene: &Scene) -> Result<Judgement, NoBudget> {
        let linearly = self.linearly(scene);
        if linearly != Judgement::Kept {
            return Ok(linearly);
        }
        let run = self.run(scene)?;
        if run.ending != Ending::Completed {
            return Ok(Judgement::Lost {
                by: LimitedBy::Verdict(DecidedBy::Nonlinear),
                ending: Some(run.ending.name()),
                detail: format!("the run ends as `{}` at contact {}", run.ending.name(), run.impacts),
            });
        }
        let (Some((kept, _)), Some(Ok(_))) = (self.kept, self.judged(scene)) else {
            return Ok(Judgement::Kept);
        };
        let (verdict, decided_by) = self.weighed(scene, &run)?;
        if rank(verdict) >= rank(kept) {
            return Ok(Judgement::Kept);
        }
        Ok(lost(LimitedBy::Verdict(decided_by), loss(kept, verdict)))
    }

    /// The verdict on a scene with its run, and the evidence that decides it. A drift that leaves the table later than the run does not count.
    fn weighed(&mut self, scene: &Scene, run: &NonlinearRun) -> Result<(Verdict, DecidedBy), NoBudget> {
        let judgement = evidence::judge(scene, run, self.impacts, &mut self.go_on).ok_or(NoBudget::Stopped)?;
        self.bounces += judgement.bounces;
        Ok(match &judgement.evidence {
            evidence::Evidence::Balances(balance) if balance.leaves.is_some() => balance.between_ends(),
            _ => (judgement.verdict, judgement.decided_by),
        })
    }
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

/// Tells whether a scene without a fixed point is still to be judged by its run: it drifts, it is not judged linearly at all, its turning or its
/// delay acts in a way that is not derived, or no bounce repeats because the table moves too fast, too slowly or by what it sensed before, or the
/// air takes energy that nothing gives back.
fn run_decides(scene: &Scene) -> bool {
    let told_wrong = scene.assumed_restitution() != scene.restitution || scene.moves_late();
    let braked = scene.drag().is_some() && (!scene.steers_energy() || scene.constant_tilt() != 0.0);
    let matched_late = scene.lag() != 0.0 && contact_regime(&scene.model()) == ContactRegime::VelocityMatched;
    SteadyDrift::of(scene).is_some()
        || scene.noise.is_some()
        || undecided_turn(&scene.with_tilt_law()).is_some()
        || matched_late
        || (told_wrong && !scene.steers_energy())
        || braked
}
