//! Choice of the number of strikes of a plan: the fewest with calm tilts, or those with the least tilt.

use super::catch_plan::{CatchPlan, plan_within};
use super::failure::{FEWEST_STRIKES, PlanFailure};
use super::problem::{PlanLimits, PlanProblem};
use crate::body::PreImpact;

/// Most strikes that are tried.
pub const MOST_TRIED: u32 = 12;

/// Tilt, rad, below which a plan is calm: the reach of the hold is some 0.3 rad, and more strikes take more time.
pub const CALM_TILT: f64 = 0.25;

/// Share of the least tilt so far that a further strike has to save; a plan that does not is the last that is tried.
const WORTH: f64 = 0.03;

/// Number of strikes that was tried, and its plan's largest tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriedPlan {
    /// Strikes before the stop.
    pub strikes: u32,
    /// Largest |α|, rad; `None` if there is no plan.
    pub tilt: Option<f64>,
}

/// Reason for a number of strikes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StrikesReason {
    /// The fewest with all tilts within this, rad.
    FewestWithin(f64),
    /// No number that was tried keeps its tilts within this, rad; the plan has the least tilt of them.
    LeastTilt(f64),
}

/// Plan with a number of strikes that was chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct ChosenPlan {
    /// The plan.
    pub plan: CatchPlan,
    /// Strikes before the stop.
    pub strikes: u32,
    /// Reason for their number.
    pub reason: StrikesReason,
    /// All numbers that were tried, in their order.
    pub tried: Vec<TriedPlan>,
}

/// The plan of the fewest strikes whose tilts are calm; if there is none, the plan of the least tilt, with more strikes as
/// long as each of them lowers the tilt. `problem.strikes` is ignored.
///
/// # Errors
/// The reason for which there is no plan of [`MOST_TRIED`] strikes, if there is none at all.
pub fn choose_plan(
    problem: &PlanProblem,
    coming: &PreImpact,
    limits: &PlanLimits,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<ChosenPlan, PlanFailure> {
    let calm = limits.table.map_or(CALM_TILT, |table| table.tilt.min(CALM_TILT));
    let mut tried = Vec::new();
    let mut best: Option<(CatchPlan, u32)> = None;
    let mut failure = PlanFailure::Strikes(0);
    for strikes in FEWEST_STRIKES..=MOST_TRIED {
        match plan_within(&PlanProblem { strikes, ..*problem }, coming, limits, go_on) {
            Ok(plan) => {
                let tilt = plan.load.tilt;
                tried.push(TriedPlan { strikes, tilt: Some(tilt) });
                if tilt <= calm {
                    return Ok(ChosenPlan { plan, strikes, reason: StrikesReason::FewestWithin(calm), tried });
                }
                let least = best.as_ref().map_or(f64::INFINITY, |(best, _)| best.load.tilt);
                if tilt < least {
                    best = Some((plan, strikes));
                }
                if tilt > (1.0 - WORTH) * least {
                    break;
                }
            }
            Err(reason) => {
                tried.push(TriedPlan { strikes, tilt: None });
                failure = reason;
            }
        }
    }
    let (plan, strikes) = best.ok_or(failure)?;
    Ok(ChosenPlan { plan, strikes, reason: StrikesReason::LeastTilt(calm), tried })
}
