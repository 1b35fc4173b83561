//! Multiple shooting: tilts of a plan by steps of sequential quadratic programming on all its bounces at once.
//!
//! Unknown are the tilts α_1 … α_N and the nodes (states just before the contacts) 2 … N + 1. A step linearizes every bounce at its own
//! node, so that an error of one bounce does not grow over all that follow. It then takes the tilts of least Σα² that join the
//! linearized bounces and bring their end to x = θ = ẋ = θ̇ = 0, with the second derivatives of the bounces in what it minimizes: the steps are
//! Newton's on the conditions of the minimum, which hold where they end. The first step starts from a body that bounces upright.
//!
//! The tilts of a step follow from Riccati's recursion from the end back to the first bounce, in a time that is linear in their number
//! (Dunn and Bertsekas 1989).

use crate::catching::plan::problem::{Goal, LinearizedBounce, PlanFailure, PlanProblem, contact_at, node};
use crate::map::body::{Body, PreImpact};
use crate::map::strike::State;
use crate::numbers::dual::SecondOrder;
use crate::numbers::number::Arithmetic;
use nalgebra::{Matrix4, Matrix4x5, Matrix5, Matrix6, RowVector5, Vector4, Vector5, Vector6};
use std::iter;

const MOST_STEPS: u32 = 40;

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

#[derive(Clone, Debug)]
pub(super) struct Solution {
    pub(super) trajectory: Trajectory,
    pub(super) residual: f64,
    pub(super) steps: u32,
}

/// Solves a problem from a trajectory near the solution, or from [`Trajectory::upright`]. It does not converge once `go_on` says `false`.
pub(super) fn solve(
    problem: &PlanProblem,
    goal: &Goal,
    start: Trajectory,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Solution, PlanFailure> {
    let failure = |iterations, residual| PlanFailure::NotConverged { strikes: problem.strikes, iterations, residual };
    let mut now = start.linearized(problem, goal)?;
    for made in 0..MOST_STEPS {
        let residual = now.residual();
        let steps = now.steps();
        let is_settled = steps.first().is_some_and(|step| step.largest_change() <= SETTLED);
        if residual <= CONVERGED && is_settled {
            return Ok(Solution { trajectory: now.trajectory, residual, steps: made });
        }
        if !go_on() {
            break;
        }
        // The last reason for which a trajectory could not be.
        let mut blocked = None;
        let better = steps.iter().find_map(|step| now.better(step, &mut blocked));
        now = better.ok_or(blocked.unwrap_or(failure(made, residual)))?;
    }
    Err(failure(MOST_STEPS, now.largest_gap()))
}

/// Solves a problem from an upright bounce, or share by share from problems that begin nearer to it.
pub(super) fn solve_from_upright(
    problem: &PlanProblem,
    goal: &Goal,
    first: &PreImpact,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Solution, PlanFailure> {
    let begin = Trajectory::upright(problem, first);
    solve(problem, goal, begin, go_on).or_else(|failure| {
        let nearer = |share: f64| {
            let mut node = node(first);
            node.fixed_rows_mut::<4>(0).scale_mut(share);
            node
        };
        let mut now = Trajectory::upright(problem, &contact_at(first.n, &nearer(SHARES[0]), first.clearance));
        let mut found = Err(failure);
        for share in SHARES {
            now.nodes[0] = nearer(share);
            let solution = solve(problem, goal, now, go_on).map_err(|_| failure)?;
            now = solution.trajectory.clone();
            found = Ok(solution);
        }
        found
    })
}

#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    /// Height of the contact point above y = 0 at the first node, m; 0 at the others.
    pub(super) clearance: f64,
    /// Nodes just before each strike and before the stop.
    pub(super) nodes: Vec<Vector5<f64>>,
    /// Tilts of the strikes, rad.
    pub(super) tilts: Vec<f64>,
}

/// A trajectory with its bounces, each linearized at its own node.
struct Linearized<'a> {
    problem: &'a PlanProblem,
    goal: &'a Goal,
    units: Vector4<f64>,
    trajectory: Trajectory,
    bounces: Vec<LinearizedBounce>,
    /// Gap between the end of each bounce and the next node.
    gaps: Vec<Vector5<f64>>,
}

impl Trajectory {
    /// A body that bounces upright from the first contact on, struck by a level table.
    fn upright(problem: &PlanProblem, first: &PreImpact) -> Self {
        let mut nodes = vec![node(first)];
        let mut y_dot = problem.body.rod.contact_speed(&first.state);
        for _ in 0..problem.strikes {
            y_dot *= problem.ratio;
            nodes.push(node(&PreImpact::at(0, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot, theta_dot: 0.0 })));
        }
        Self { clearance: first.clearance, nodes, tilts: vec![0.0; problem.strikes as usize] }
    }

    pub(super) fn contacts(&self) -> impl Iterator<Item = PreImpact> {
        let clearances = iter::once(self.clearance).chain(iter::repeat(0.0));
        (1..).zip(&self.nodes).zip(clearances).map(|((n, node), clearance)| contact_at(n, node, clearance))
    }

    /// Linearizes every bounce at its own node. Fails with the first strike that cannot be, and the reason.
    fn linearized<'a>(self, problem: &'a PlanProblem, goal: &'a Goal) -> Result<Linearized<'a>, PlanFailure> {
        let body = problem.body.map(SecondOrder::from_f64);
        let linearized = |(coming, tilt): (PreImpact, &f64)| {
            let bounce = LinearizedBounce::new(&body, &coming, *tilt, problem.ratio);
            bounce.map_err(|obstacle| PlanFailure::Blocked { strike: coming.n as u32, obstacle })
        };
        let bounces = self.contacts().zip(&self.tilts).map(linearized).collect::<Result<Vec<_>, _>>()?;
        let gaps = bounces.iter().zip(&self.nodes[1..]).map(|(bounce, joined)| bounce.next - joined).collect();
        Ok(Linearized { problem, goal, units: end_units(&problem.body), trajectory: self, bounces, gaps })
    }

    /// x, θ, ẋ and θ̇ before the stop.
    fn end(&self) -> Vector4<f64> {
        self.nodes.last().map_or_else(Vector4::zeros, |node| node.fixed_rows::<4>(0).into_owned())
    }
}

struct Step {
    nodes: Vec<Vector5<f64>>,
    tilts: Vec<f64>,
    /// Cost of an error of each node, by its components.
    prices: Vec<Vector5<f64>>,
}

impl Step {
    /// Largest change of a tilt, rad.
    fn largest_change(&self) -> f64 {
        self.tilts.iter().fold(0.0, |most, change| most.max(change.abs()))
    }

    /// The trajectory a share of the step on.
    fn taken(&self, trajectory: &Trajectory, share: f64) -> Trajectory {
        let nodes = trajectory.nodes.iter().zip(&self.nodes).map(|(node, change)| node + change * share).collect();
        let tilts = trajectory.tilts.iter().zip(&self.tilts).map(|(tilt, change)| tilt + change * share).collect();
        Trajectory { clearance: trajectory.clearance, nodes, tilts }
    }
}

/// Units in which the errors of the end weigh alike: l, 1, √(Gl), √(G/l).
fn end_units(body: &Body) -> Vector4<f64> {
    let (length, gravity) = (body.rod.contact_distance, body.rod.gravity);
    let speed = (gravity * length).sqrt();
    Vector4::new(length, 1.0, speed, speed / length)
}

impl Linearized<'_> {
    /// Largest error of a joint, and of the end where it has to be at rest.
    fn residual(&self) -> f64 {
        let gap = self.largest_gap();
        if self.goal.must_rest { gap.max(self.trajectory.end().amax()) } else { gap }
    }

    /// The trajectory the largest share of a step on that is better; `None` if none is.
    fn better(&self, step: &Step, blocked: &mut Option<PlanFailure>) -> Option<Self> {
        // More than what an error of a joint costs, so that joining is worth it.
        let price = 2.0 * step.prices.iter().skip(1).fold(0.0_f64, |most, price| most.max(price.amax()));
        let before = self.merit(price);
        let is_near = step.largest_change() <= NEAR;
        let mut share = 1.0;
        for _ in 0..MOST_HALVINGS {
            let next = step.taken(&self.trajectory, share);
            if next.tilts.iter().all(|tilt| tilt.abs() <= LARGEST_TILT) {
                match next.linearized(self.problem, self.goal) {
                    // Near the end rounding decides which is better.
                    Ok(next) if is_near || next.merit(price) < before => return Some(next),
                    Ok(_) => {}
                    Err(reason) => *blocked = Some(reason),
                }
            }
            share *= 0.5;
        }
        None
    }

    /// Number that falls from step to step: Σα² and the price of errors.
    fn merit(&self, price: f64) -> f64 {
        let Self { goal, units, trajectory, .. } = self;
        let end = if goal.must_rest {
            price * trajectory.end().abs().sum()
        } else {
            goal.end_weight * trajectory.end().component_div(units).norm_squared()
        };
        let tilts = trajectory.tilts.iter().enumerate().map(|(place, tilt)| tilt - goal.free_tilt(place));
        let gaps: f64 = self.gaps.iter().map(|gap| gap.abs().sum()).sum();
        tilts.map(|tilt| tilt * tilt).sum::<f64>() + end + price * gaps
    }

    fn largest_gap(&self) -> f64 {
        self.gaps.iter().fold(0.0, |most, gap| most.max(gap.amax()))
    }

    /// Gains K of a law δα = −Kδs with which changes of the nodes die out: of least Σ|δs|² + Σδα².
    fn steadying_gains(&self) -> Vec<RowVector5<f64>> {
        let weights = Matrix5::from_diagonal(&self.units.map(|unit| 1.0 / (unit * unit)).push(0.0));
        let mut cost = weights;
        let mut gains: Vec<RowVector5<f64>> = Vec::with_capacity(self.bounces.len());
        for LinearizedBounce { by_node, by_tilt, .. } in self.bounces.iter().rev() {
            let pressed = cost * by_tilt;
            let gain = pressed.transpose() * by_node / (1.0 + by_tilt.dot(&pressed));
            let next = by_node.transpose() * cost * (by_node - by_tilt * gain) + weights;
            cost = (next + next.transpose()) * 0.5;
            gains.push(gain);
        }
        gains.reverse();
        gains
    }

    /// Steps to the least tilts with which the linearized bounces join and end as the goal says: Newton's, then the one without the
    /// curvature of the bounces, which gets nearer from farther off.
    fn steps(&self) -> Vec<Step> {
        let straight = vec![Matrix6::zeros(); self.bounces.len()];
        let Some(plain) = self.step(&straight) else { return Vec::new() };
        let weighed = self.bounces.iter().zip(&plain.prices[1..]);
        let curvatures: Vec<Matrix6<f64>> = weighed.map(|(bounce, price)| bounce.curvature(price)).collect();
        // Made more convex as far as it takes, in the tilts beside a steadying law.
        let beside = |gain: &RowVector5<f64>| Vector6::new(gain[0], gain[1], gain[2], gain[3], gain[4], 1.0);
        let larger = iter::successors(Some(1.0), |shift| Some(4.0 * shift));
        let newton = iter::once(0.0).chain(larger).take(MOST_SHIFTS).find_map(|shift| {
            let mut shifted = curvatures.clone();
            for (curvature, off) in shifted.iter_mut().zip(self.steadying_gains().iter().map(beside)) {
                *curvature += off * off.transpose() * shift;
            }
            Some(Step { prices: plain.prices.clone(), ..self.step(&shifted)? })
        });
        newton.into_iter().chain([plain]).collect()
    }

    /// The step of least cost where these are the second derivatives of the bounces, by node and tilt; `None` if there is none.
    /// The cost of all that follows a node is ½δsᵀPδs + pᵀδs. A bounce with the next node's P and p has the best tilt δα = −K·δs − d.
    fn step(&self, curvatures: &[Matrix6<f64>]) -> Option<Step> {
        let Self { goal, units, trajectory, .. } = self;
        let ends = Matrix4x5::from_fn(|row, column| if row == column { 1.0 / units[row] } else { 0.0 });
        let off = ends * trajectory.nodes.last()?;
        let weight = 2.0 * goal.end_weight;
        // In p, d and what moves, column 1 is of the problem itself; the others are changes by the price of an end.
        let (mut cost, mut slope) = (ends.transpose() * ends * weight, Matrix5::zeros());
        slope.set_column(0, &(ends.transpose() * off * weight));
        slope.fixed_columns_mut::<4>(1).copy_from(&ends.transpose());
        let (mut costs, mut gains, mut pushes) = (vec![(cost, slope)], Vec::new(), Vec::new());
        for (place, (bounce, gap)) in self.bounces.iter().zip(&self.gaps).enumerate().rev() {
            let LinearizedBounce { by_node, by_tilt, .. } = bounce;
            let curvature = &curvatures[place];
            let mut priced = slope;
            priced.set_column(0, &(slope.column(0) + cost * gap));
            let pressed = cost * by_tilt;
            let bend = 2.0 + curvature[(5, 5)] + by_tilt.dot(&pressed);
            // A bend that is not a number has no minimum either.
            if !bend.gt(&0.0) {
                return None;
            }
            let cross = curvature.fixed_view::<5, 1>(0, 5) + by_node.transpose() * pressed;
            let mut pull = by_tilt.transpose() * priced;
            pull[0] += 2.0 * (trajectory.tilts[place] - goal.free_tilt(place));
            let (gain, push) = (cross.transpose() / bend, pull / bend);
            let next = curvature.fixed_view::<5, 5>(0, 0) + by_node.transpose() * cost * by_node - cross * gain;
            (cost, slope) = ((next + next.transpose()) * 0.5, by_node.transpose() * priced - cross * push);
            costs.push((cost, slope));
            gains.push(gain);
            pushes.push(push);
        }
        for reversed in [&mut gains, &mut pushes] {
            reversed.reverse();
        }
        costs.reverse();
        let mut node = Matrix5::zeros();
        let (mut nodes, mut tilts) = (vec![node], Vec::with_capacity(gains.len()));
        for (place, (bounce, gap)) in self.bounces.iter().zip(&self.gaps).enumerate() {
            let tilt = -(gains[place] * node + pushes[place]);
            node = bounce.by_node * node + bounce.by_tilt * tilt;
            node.set_column(0, &(node.column(0) + gap));
            nodes.push(node);
            tilts.push(tilt);
        }
        let mut shares = Vector5::new(1.0, 0.0, 0.0, 0.0, 0.0);
        if goal.must_rest {
            let end = ends * node;
            let by_price: Matrix4<f64> = end.fixed_columns::<4>(1).into_owned();
            let prices = by_price.lu().solve(&-(off + end.column(0)))?;
            shares.fixed_rows_mut::<4>(1).copy_from(&prices);
        }
        let nodes: Vec<Vector5<f64>> = nodes.iter().map(|by| by * shares).collect();
        let tilts: Vec<f64> = tilts.iter().map(|by| (by * shares)[0]).collect();
        let prices = nodes.iter().zip(&costs).map(|(node, (cost, slope))| cost * node + slope * shares).collect();
        tilts.iter().all(|tilt| tilt.is_finite()).then_some(Step { nodes, tilts, prices })
    }
}

const MOST_SHIFTS: usize = 12;
