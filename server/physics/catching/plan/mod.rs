//! Plans of a catch: strikes of least tilts that bring the body to rest upright above x = 0, and a stop.
//!
//! N strikes have one height ratio. The stop is a strike of ratio 0 by a level table: the body comes to it straight down, so that an error of
//! its time costs nothing.

mod bounce;
mod catch_plan;
mod choice;
mod failure;
mod learned;
mod problem;
mod replan;
mod shooting;
mod step;
mod trajectory;

pub use bounce::{BouncingRod, Node};
pub use catch_plan::{CatchPlan, PlannedStrike, plan_catch, plan_within};
pub use choice::{CALM_TILT, ChosenPlan, MOST_TRIED, StrikesReason, TriedPlan, choose_plan};
pub use failure::{FEWEST_STRIKES, MOST_STRIKES, Obstacle, PlanFailure};
pub use learned::LearnedRestitution;
pub use problem::{PlanLimits, PlanProblem};
pub use replan::{NextStrike, Replanner};
