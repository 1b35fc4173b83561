//! Multiple shooting: tilts of a plan by steps of sequential quadratic programming on all its bounces at once.
//!
//! Unknown are the tilts α_1 … α_N and the nodes (states just before the contacts) 2 … N + 1. A step linearizes every bounce at its own
//! node, so that an error of one bounce does not grow over all that follow. It then takes the tilts of least Σα² that join the
//! linearized bounces and bring their end to x = θ = ẋ = θ̇ = 0, with the second derivatives of the bounces in what it minimizes: the steps are
//! Newton's on the conditions of the minimum, which hold where they end. The first step starts from a body that bounces upright.

use super::failure::PlanFailure;
use super::problem::{END_WEIGHT, Goal, PlanProblem};
use super::step::end_units;
use super::trajectory::{Linearization, Trajectory};

/// Most steps.
const MOST_STEPS: u32 = 100;

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

/// A solution and the way to it.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    pub(super) trajectory: Trajectory,
    pub(super) residual: f64,
    pub(super) steps: u32,
}

/// Solves a problem from a trajectory near the solution, or from [`Trajectory::upright`]. The first contact is `clearance` (m) above y = 0.
///
/// # Errors
/// The reason for which it does not converge.
pub(super) fn solve(
    problem: &PlanProblem,
    goal: &Goal,
    clearance: f64,
    start: Trajectory,
) -> Result<Solution, PlanFailure> {
    let PlanProblem { body, ratio, strikes } = problem;
    let blocked = |(strike, obstacle)| PlanFailure::Blocked { strike, obstacle };
    let units = end_units(body);
    let mut trajectory = start;
    let mut linearization = trajectory.linearized(body, clearance, *ratio).map_err(blocked)?;
    let mut price = 0.0_f64;
    for steps in 0..MOST_STEPS {
        let residual = match goal {
            Goal::Rest => linearization.largest_gap.max(trajectory.end().amax()),
            Goal::NearRest { .. } => linearization.largest_gap,
        };
        let not_converged = PlanFailure::NotConverged { strikes: *strikes, iterations: steps, residual };
        let Some(step) = linearization.step(&trajectory, &units, goal) else { return Err(not_converged) };
        let change = step.largest_change();
        if residual <= CONVERGED && change <= SETTLED {
            return Ok(Solution { trajectory, residual, steps });
        }
        price = price.max(2.0 * step.price);
        let merit = |trajectory: &Trajectory, linearization: &Linearization| {
            let end = match goal {
                Goal::Rest => price * trajectory.end().abs().sum(),
                Goal::NearRest { .. } => END_WEIGHT * trajectory.end().component_div(&units).norm_squared(),
            };
            let tilts = trajectory.tilts.iter().enumerate().map(|(place, tilt)| tilt - goal.free_tilt(place));
            tilts.map(|tilt| tilt * tilt).sum::<f64>() + end + price * linearization.sum_of_gaps
        };
        let before = merit(&trajectory, &linearization);
        let mut share = 1.0;
        let mut taken = None;
        let mut obstacle = None;
        for _ in 0..MOST_HALVINGS {
            let next = step.taken(&trajectory, share);
            if next.tilts.iter().all(|tilt| tilt.abs() <= LARGEST_TILT) {
                match next.linearized(body, clearance, *ratio) {
                    // Rounding decides which of two trajectories near the end is better.
                    Ok(linearized) if change <= NEAR || merit(&next, &linearized) < before => {
                        taken = Some((next, linearized));
                        break;
                    }
                    Ok(_) => {}
                    Err(reason) => obstacle = Some(reason),
                }
            }
            share *= 0.5;
        }
        match (taken, obstacle) {
            (Some((next, linearized)), _) => (trajectory, linearization) = (next, linearized),
            (None, Some(reason)) => return Err(blocked(reason)),
            (None, None) => return Err(not_converged),
        }
    }
    Err(PlanFailure::NotConverged { strikes: *strikes, iterations: MOST_STEPS, residual: linearization.largest_gap })
}
