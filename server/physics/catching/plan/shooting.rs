//! Multiple shooting: tilts of a plan by steps of sequential quadratic programming on all its bounces at once.
//!
//! Unknown are the tilts α_1 … α_N and the nodes (states just before the contacts) 2 … N + 1. A step linearizes every bounce at its own
//! node, so that an error of one bounce does not grow over all that follow. It then takes the tilts of least Σα² that join the
//! linearized bounces and bring their end to x = θ = ẋ = θ̇ = 0, with the second derivatives of the bounces in what it minimizes: the steps are
//! Newton's on the conditions of the minimum, which hold where they end. The first step starts from a body that bounces upright.

use super::bounce::Node;
use super::failure::{Obstacle, PlanFailure};
use super::problem::{END_WEIGHT, Goal, PlanProblem};
use super::step::{Step, end_units};
use super::trajectory::{Linearization, Trajectory};
use nalgebra::Vector4;

/// Most steps.
const MOST_STEPS: u32 = 40;

/// Most halvings of a step.
const MOST_HALVINGS: u32 = 12;

/// Largest error of joints and end of a plan that has converged, m, rad, m/s and rad/s.
const CONVERGED: f64 = 1e-12;

/// Largest change of a tilt in the last step, rad.
const SETTLED: f64 = 1e-10;

/// Change of a tilt, rad, below which a step is taken without looking at what it gains.
const NEAR: f64 = 1e-6;

/// Largest tilt on the way, rad: below a quarter turn.
const LARGEST_TILT: f64 = 1.4;

/// Shares of a first node's x, θ, ẋ and θ̇ from which a plan is carried on to all of it, where it does not converge at once.
const SHARES: [f64; 4] = [0.4, 0.6, 0.8, 1.0];

/// A solution and the way to it.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    pub(super) trajectory: Trajectory,
    pub(super) residual: f64,
    pub(super) steps: u32,
}

/// Solves a problem from a trajectory near the solution, or from [`Trajectory::upright`]. The first contact is `clearance` (m) above y = 0.
/// It does not converge once `go_on` says `false`.
///
/// # Errors
/// The reason for which it does not converge.
pub(super) fn solve(
    problem: &PlanProblem,
    goal: &Goal,
    clearance: f64,
    start: Trajectory,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Solution, PlanFailure> {
    let PlanProblem { body, ratio, strikes } = problem;
    let blocked = |(strike, obstacle)| PlanFailure::Blocked { strike, obstacle };
    let units = end_units(body);
    let mut trajectory = start;
    let mut linearization = trajectory.linearized(body, clearance, *ratio).map_err(blocked)?;
    for made in 0..MOST_STEPS {
        let residual = match goal {
            Goal::Rest => linearization.largest_gap.max(trajectory.end().amax()),
            Goal::NearRest { .. } => linearization.largest_gap,
        };
        let steps = linearization.steps(&trajectory, &units, goal);
        let is_settled = steps.first().is_some_and(|step| step.largest_change() <= SETTLED);
        if residual <= CONVERGED && is_settled {
            return Ok(Solution { trajectory, residual, steps: made });
        }
        let mut search = LineSearch { problem, goal, clearance, units: &units, obstacle: None };
        if !go_on() {
            break;
        }
        let better = steps.iter().find_map(|step| search.better(&trajectory, &linearization, step));
        match (better, search.obstacle) {
            (Some(better), _) => (trajectory, linearization) = better,
            (None, Some(reason)) => return Err(blocked(reason)),
            (None, None) => {
                return Err(PlanFailure::NotConverged { strikes: *strikes, iterations: made, residual });
            }
        }
    }
    Err(PlanFailure::NotConverged { strikes: *strikes, iterations: MOST_STEPS, residual: linearization.largest_gap })
}

/// Solves a problem from a body that bounces upright; where that does not converge, from the solution of the problem that begins nearer to
/// upright, share by share.
///
/// # Errors
/// The reason for which the first does not converge.
pub(super) fn solve_from_upright(
    problem: &PlanProblem,
    goal: &Goal,
    clearance: f64,
    first: &Node,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Solution, PlanFailure> {
    let begin = Trajectory::upright(problem, first);
    solve(problem, goal, clearance, begin, go_on).or_else(|failure| {
        let nearer = |share: f64| {
            let mut node = first.to_vector();
            node.fixed_rows_mut::<4>(0).scale_mut(share);
            node
        };
        let mut now = Trajectory::upright(problem, &Node::from_vector(&nearer(SHARES[0])));
        let mut found = Err(failure);
        for share in SHARES {
            now.nodes[0] = nearer(share);
            let solution = solve(problem, goal, clearance, now, go_on).map_err(|_| failure)?;
            now = solution.trajectory.clone();
            found = Ok(solution);
        }
        found
    })
}

/// Search along a step for a better trajectory.
struct LineSearch<'a> {
    problem: &'a PlanProblem,
    goal: &'a Goal,
    clearance: f64,
    units: &'a Vector4<f64>,
    /// The last reason for which a trajectory could not be.
    obstacle: Option<(u32, Obstacle)>,
}

impl LineSearch<'_> {
    /// The trajectory the largest share of a step on that is better; `None` if none is.
    fn better(&mut self, from: &Trajectory, at: &Linearization, step: &Step) -> Option<(Trajectory, Linearization)> {
        let PlanProblem { body, ratio, .. } = self.problem;
        // More than what an error of a joint costs, so that joining is worth it.
        let price = 2.0 * step.price;
        let before = self.merit(from, at, price);
        let is_near = step.largest_change() <= NEAR;
        let mut share = 1.0;
        for _ in 0..MOST_HALVINGS {
            let next = step.taken(from, share);
            if next.tilts.iter().all(|tilt| tilt.abs() <= LARGEST_TILT) {
                match next.linearized(body, self.clearance, *ratio) {
                    // Near the end rounding decides which is better.
                    Ok(linearized) if is_near || self.merit(&next, &linearized, price) < before => {
                        return Some((next, linearized));
                    }
                    Ok(_) => {}
                    Err(reason) => self.obstacle = Some(reason),
                }
            }
            share *= 0.5;
        }
        None
    }

    /// Number that falls from step to step: Σα² and the price of errors.
    fn merit(&self, trajectory: &Trajectory, linearization: &Linearization, price: f64) -> f64 {
        let end = match self.goal {
            Goal::Rest => price * trajectory.end().abs().sum(),
            Goal::NearRest { .. } => END_WEIGHT * trajectory.end().component_div(self.units).norm_squared(),
        };
        let tilts = trajectory.tilts.iter().enumerate().map(|(place, tilt)| tilt - self.goal.free_tilt(place));
        tilts.map(|tilt| tilt * tilt).sum::<f64>() + end + price * linearization.sum_of_gaps
    }
}
