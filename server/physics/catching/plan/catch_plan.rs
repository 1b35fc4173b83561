//! Plan of a catch: its strikes one by one, with the load on the table.

use super::bounce::Node;
use super::failure::{FEWEST_STRIKES, MOST_STRIKES, Obstacle, PlanFailure};
use super::problem::{Goal, PlanLimits, PlanProblem};
use super::shooting::solve_from_upright;
use super::trajectory::Trajectory;
use crate::body::PreImpact;
use crate::bounce::strike::{PlannedTableMotion, Strike};
use crate::table::actuator_load::{ActuatorLoad, LoadTracker, Pose};

/// A strike of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedStrike {
    /// Time since the contact at which the plan begins, s.
    pub t: f64,
    /// Place and state just before it.
    pub node: Node,
    /// α, rad.
    pub alpha: f64,
    /// Height ratio ẏ_c⁺/|ẏ_c|: 0 of the stop.
    pub ratio: f64,
    /// The strike, and with it the motion of the table and the state just after.
    pub strike: Strike,
    /// Velocity of the table along its normal, m/s.
    pub table_velocity: f64,
    /// Time to the next strike, s; `None` after the stop.
    pub flight_time: Option<f64>,
}

/// A plan from a contact to rest.
#[derive(Clone, Debug, PartialEq)]
pub struct CatchPlan {
    /// Strikes in their order; the last is the stop.
    pub strikes: Vec<PlannedStrike>,
    /// Largest error of a joint between two bounces and of x, θ, ẋ, θ̇ at the end, in m, rad, m/s and rad/s.
    pub residual: f64,
    /// Steps of the solver.
    pub iterations: u32,
    /// Σα², rad².
    pub cost: f64,
    /// Load of the strikes on the table.
    pub load: ActuatorLoad,
}

/// Plans the strikes from a coming contact on, within limits. A finished plan is checked against the limits; the solver does not
/// steer around them.
///
/// # Errors
/// The reason for which there is no plan.
pub fn plan_within(
    problem: &PlanProblem,
    coming: &PreImpact,
    limits: &PlanLimits,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<CatchPlan, PlanFailure> {
    let plan = plan_catch(problem, coming, go_on)?;
    let mut last: Option<(Pose, f64)> = None;
    for (place, planned) in plan.strikes.iter().enumerate() {
        let blocked = |obstacle| PlanFailure::Blocked { strike: place as u32 + 1, obstacle };
        let pose = Pose { alpha: planned.alpha, velocity: planned.strike.table_velocity };
        if let Some(violation) = limits.table.and_then(|table| table.exceeded(&pose.load(last))) {
            return Err(blocked(Obstacle::BeyondLimits(violation)));
        }
        last = planned.flight_time.map(|time| (pose, time));
        let Some(outline) = limits.outline else { continue };
        let clearance = if place == 0 { coming.clearance } else { 0.0 };
        let (theta, strike) = (planned.node.state.theta, &planned.strike);
        if let Some(touch) = problem.body.touch(outline, theta, strike, planned.flight_time, clearance) {
            return Err(blocked(touch));
        }
    }
    Ok(plan)
}

/// Plans the strikes from a coming contact on. There is no plan once `go_on` says `false`.
///
/// # Errors
/// The reason for which there is no plan.
pub fn plan_catch(
    problem: &PlanProblem,
    coming: &PreImpact,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<CatchPlan, PlanFailure> {
    if !(FEWEST_STRIKES..=MOST_STRIKES).contains(&problem.strikes) {
        return Err(PlanFailure::Strikes(problem.strikes));
    }
    let first = Node { x: coming.x, state: coming.state };
    let solution = solve_from_upright(problem, &Goal::Rest, coming.clearance, &first, go_on)?;
    let Trajectory { nodes, mut tilts } = solution.trajectory;
    let cost = tilts.iter().map(|tilt| tilt * tilt).sum();
    tilts.push(0.0);
    let mut strikes = Vec::with_capacity(tilts.len());
    let mut load = LoadTracker::default();
    let mut t = 0.0;
    for (place, (node, alpha)) in nodes.iter().zip(tilts).enumerate() {
        let node = Node::from_vector(node);
        let strikes_on = place < problem.strikes as usize;
        let ratio = if strikes_on { problem.ratio } else { 0.0 };
        let clearance = if place == 0 { coming.clearance } else { 0.0 };
        let blocked = |obstacle| PlanFailure::Blocked { strike: place as u32 + 1, obstacle };
        let (motion, strike) = problem.body.aimed(&node, alpha, ratio).map_err(blocked)?;
        let flight_time =
            if strikes_on { Some(problem.body.flight_time(&strike, clearance).map_err(blocked)?) } else { None };
        load.track(&strike, flight_time);
        let PlannedTableMotion { normal_velocity: table_velocity, .. } = motion;
        strikes.push(PlannedStrike { t, node, alpha, ratio, strike, table_velocity, flight_time });
        t += flight_time.unwrap_or(0.0);
    }
    Ok(CatchPlan { strikes, residual: solution.residual, iterations: solution.steps, cost, load: load.most })
}
