//! Multiple shooting: tilts of a plan by steps of sequential quadratic programming on all its bounces at once.
//!
//! Unknown are the tilts α_1 … α_N and the nodes (states just before the contacts) 2 … N + 1. A step linearizes every bounce at its own
//! node, so that an error of one bounce does not grow over all that follow. It then takes the tilts of least Σα² that join the
//! linearized bounces and bring their end to x = θ = ẋ = θ̇ = 0, with the second derivatives of the bounces in what it minimizes: the steps are
//! Newton's on the conditions of the minimum, which hold where they end. The first step starts from a body that bounces upright.

use crate::catching::plan::problem::{
    END_WEIGHT, Goal, LinearizedBounce, Obstacle, PlanFailure, PlanProblem, contact_at, node,
};
use crate::map::body::{Body, PreImpact};
use crate::map::strike::State;
use crate::numbers::number::Arithmetic;
use crate::numbers::second_order::SecondOrder;
use nalgebra::{
    Cholesky, DMatrix, DVector, Dyn, Matrix4xX, Matrix5, Matrix5xX, Matrix6xX, RowVector5, Vector4, Vector5, Vector6,
};
use std::iter;

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

/// Solves a problem from a trajectory near the solution, or from [`Trajectory::upright`]. It does not converge once `go_on` says `false`.
///
/// # Errors
/// The reason for which it does not converge.
pub(super) fn solve(
    problem: &PlanProblem,
    goal: &Goal,
    start: Trajectory,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Solution, PlanFailure> {
    let PlanProblem { body, strikes, .. } = problem;
    let blocked = |(strike, obstacle)| PlanFailure::Blocked { strike, obstacle };
    let units = end_units(body);
    let mut trajectory = start;
    let mut linearization = trajectory.linearized(problem).map_err(blocked)?;
    for made in 0..MOST_STEPS {
        let residual = match goal {
            Goal::Rest => linearization.largest_gap().max(trajectory.end().amax()),
            Goal::NearRest { .. } => linearization.largest_gap(),
        };
        let steps = linearization.steps(&trajectory, &units, goal);
        let is_settled = steps.first().is_some_and(|step| step.largest_change() <= SETTLED);
        if residual <= CONVERGED && is_settled {
            return Ok(Solution { trajectory, residual, steps: made });
        }
        let mut search = LineSearch { problem, goal, units: &units, obstacle: None };
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
    Err(PlanFailure::NotConverged { strikes: *strikes, iterations: MOST_STEPS, residual: linearization.largest_gap() })
}

/// Solves a problem from a body that bounces upright; where that does not converge, from the solution of the problem that begins nearer to
/// upright, share by share.
///
/// # Errors
/// The reason for which the first does not converge.
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

/// Search along a step for a better trajectory.
struct LineSearch<'a> {
    problem: &'a PlanProblem,
    goal: &'a Goal,
    units: &'a Vector4<f64>,
    /// The last reason for which a trajectory could not be.
    obstacle: Option<(u32, Obstacle)>,
}

impl LineSearch<'_> {
    /// The trajectory the largest share of a step on that is better; `None` if none is.
    fn better(&mut self, from: &Trajectory, at: &Linearization, step: &Step) -> Option<(Trajectory, Linearization)> {
        // More than what an error of a joint costs, so that joining is worth it.
        let price = 2.0 * step.price;
        let before = self.merit(from, at, price);
        let is_near = step.largest_change() <= NEAR;
        let mut share = 1.0;
        for _ in 0..MOST_HALVINGS {
            let next = step.taken(from, share);
            if next.tilts.iter().all(|tilt| tilt.abs() <= LARGEST_TILT) {
                match next.linearized(self.problem) {
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
        let gaps: f64 = linearization.gaps.iter().map(|gap| gap.abs().sum()).sum();
        tilts.map(|tilt| tilt * tilt).sum::<f64>() + end + price * gaps
    }
}

/// Nodes and tilts of a plan.
#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    /// Height of the contact point above y = 0 at the first node, m; 0 at the others.
    pub(super) clearance: f64,
    /// Nodes just before each strike and before the stop.
    pub(super) nodes: Vec<Vector5<f64>>,
    /// Tilts of the strikes, rad.
    pub(super) tilts: Vec<f64>,
}

/// All bounces of a trajectory, linearized.
struct Linearization {
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

    /// The contacts at the nodes.
    pub(super) fn contacts(&self) -> impl Iterator<Item = PreImpact> {
        let clearances = iter::once(self.clearance).chain(iter::repeat(0.0));
        (1..).zip(&self.nodes).zip(clearances).map(|((n, node), clearance)| contact_at(n, node, clearance))
    }

    /// Linearizes every bounce at its own node.
    ///
    /// # Errors
    /// The first strike that cannot be, from 1, and the reason.
    fn linearized(&self, problem: &PlanProblem) -> Result<Linearization, (u32, Obstacle)> {
        let body = problem.body.map(SecondOrder::from_f64);
        let linearized = |(coming, tilt): (PreImpact, &f64)| {
            let bounce = LinearizedBounce::new(&body, &coming, *tilt, problem.ratio);
            bounce.map_err(|obstacle| (coming.n as u32, obstacle))
        };
        let bounces = self.contacts().zip(&self.tilts).map(linearized).collect::<Result<Vec<_>, _>>()?;
        let gaps = bounces.iter().zip(&self.nodes[1..]).map(|(bounce, joined)| bounce.next - joined).collect();
        Ok(Linearization { bounces, gaps })
    }

    /// x, θ, ẋ and θ̇ before the stop.
    fn end(&self) -> Vector4<f64> {
        self.nodes.last().map_or_else(Vector4::zeros, |node| node.fixed_rows::<4>(0).into_owned())
    }
}

/// Change of a trajectory.
struct Step {
    nodes: Vec<Vector5<f64>>,
    tilts: Vec<f64>,
    /// Largest cost of an error of a joint or of the end.
    price: f64,
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

impl Linearization {
    /// Largest component of a gap.
    fn largest_gap(&self) -> f64 {
        self.gaps.iter().fold(0.0, |most, gap| most.max(gap.amax()))
    }

    /// Gains K of δα = −K·δs + v with which changes of the nodes die out: of least Σ|δs|² + Σδα².
    fn steadying_gains(&self, units: &Vector4<f64>) -> Vec<RowVector5<f64>> {
        let mut weight = Vector5::zeros();
        for (weight, unit) in weight.iter_mut().zip(units) {
            *weight = 1.0 / (unit * unit);
        }
        let weights = Matrix5::from_diagonal(&weight);
        let mut cost = weights;
        let mut gains: Vec<RowVector5<f64>> = Vec::with_capacity(self.bounces.len());
        for bounce in self.bounces.iter().rev() {
            let pressed = cost * bounce.by_tilt;
            let gain = pressed.transpose() * bounce.by_node / (1.0 + bounce.by_tilt.dot(&pressed));
            let next = bounce.by_node.transpose() * cost * (bounce.by_node - bounce.by_tilt * gain) + weights;
            cost = (next + next.transpose()) * 0.5;
            gains.push(gain);
        }
        gains.reverse();
        gains
    }

    /// Steps to the least tilts with which the linearized bounces join and end as the goal says: Newton's, then the one without the
    /// curvature of the bounces, which gets nearer from farther off.
    ///
    /// Their unknowns are the parts v of δα = −K·δs + v: the nodes by the tilts alone would grow without bound along the bounces.
    fn steps(&self, trajectory: &Trajectory, units: &Vector4<f64>, goal: &Goal) -> Vec<Step> {
        let count = self.bounces.len();
        let gains = self.steadying_gains(units);
        // Change of each node and tilt by the gaps alone, and by each v.
        let (mut node, mut node_by) = (Vector5::zeros(), Matrix5xX::zeros(count));
        let (mut offsets, mut moves) = (Vec::with_capacity(count), Vec::with_capacity(count));
        for (place, ((bounce, gap), gain)) in self.bounces.iter().zip(&self.gaps).zip(&gains).enumerate() {
            let steady = bounce.by_node - bounce.by_tilt * gain;
            let tilt = -(gain * node)[0];
            let mut tilt_by = -(gain * &node_by);
            tilt_by[place] = 1.0;
            offsets.push(Vector6::new(node[0], node[1], node[2], node[3], node[4], tilt));
            moves.push(Matrix6xX::from_fn(count, |row, column| match row {
                5 => tilt_by[column],
                _ => node_by[(row, column)],
            }));
            node = steady * node + gap;
            node_by = steady * node_by;
            node_by.set_column(place, &bounce.by_tilt);
        }
        let reach = Matrix4xX::from_fn(count, |row, column| node_by[(row, column)] / units[row]);
        let wanted = -(trajectory.end() + node.fixed_rows::<4>(0)).component_div(units);
        let mut hessian = DMatrix::zeros(count, count);
        let mut slope = DVector::zeros(count);
        // Tilts beside those that cost nothing.
        let tilts = trajectory.tilts.iter().enumerate().map(|(place, tilt)| tilt - goal.free_tilt(place));
        let tilts: Vec<f64> = tilts.collect();
        for ((moves, offset), tilt) in moves.iter().zip(&offsets).zip(&tilts) {
            let by_tilt = moves.row(5);
            hessian += by_tilt.transpose() * by_tilt * 2.0;
            slope += by_tilt.transpose() * (2.0 * (tilt + offset[5]));
        }
        // Without the curvature of the bounces, to know the prices of errors by which they are weighed.
        let minimum = |hessian: &DMatrix<f64>, slope: &DVector<f64>| match goal {
            Goal::Rest => constrained_minimum(hessian, slope, &reach, &wanted),
            Goal::NearRest { .. } => penalized_minimum(hessian, slope, &reach, &wanted),
        };
        let Some(plain) = minimum(&hessian, &slope) else { return Vec::new() };
        let mut price = Vector5::zeros();
        price.fixed_rows_mut::<4>(0).copy_from(&plain.multipliers.component_div(units));
        let mut largest = 0.0_f64;
        for place in (0..count).rev() {
            let (bounce, moves, offset) = (&self.bounces[place], &moves[place], &offsets[place]);
            largest = largest.max(price.amax());
            let curvature = bounce.curvature(&price);
            hessian += moves.transpose() * (curvature * moves);
            slope += moves.transpose() * (curvature * offset);
            // The price of an error before a bounce, Aᵀλ with bᵀλ = −2α.
            let tilt = tilts[place] + offset[5] + (moves.row(5) * &plain.change)[0];
            let steady = bounce.by_node - bounce.by_tilt * gains[place];
            price = steady.transpose() * price - gains[place].transpose() * (2.0 * tilt);
        }
        let step = |change: &DVector<f64>| {
            let mut step = Step { nodes: vec![Vector5::zeros()], tilts: Vec::with_capacity(count), price: largest };
            for (place, (moves, offset)) in moves.iter().zip(&offsets).enumerate() {
                let moved = moves * change + offset;
                if place > 0 {
                    step.nodes.push(moved.fixed_rows::<5>(0).into_owned());
                }
                step.tilts.push(moved[5]);
            }
            step.nodes.push(&node_by * change + node);
            step
        };
        let newton = minimum(&hessian, &slope);
        newton.iter().chain([&plain]).map(|minimum| step(&minimum.change)).collect()
    }
}

/// Largest number of times that a Hessian is made more convex.
const MOST_SHIFTS: usize = 12;

/// Minimum under constraints, and what these cost.
struct ConstrainedMinimum {
    change: DVector<f64>,
    /// ν of Hδ + g + Gᵀν = 0.
    multipliers: Vector4<f64>,
}

impl ConstrainedMinimum {
    /// The minimum, if its numbers are finite.
    fn finite(self) -> Option<Self> {
        self.change.iter().chain(&self.multipliers).all(|value| value.is_finite()).then_some(self)
    }
}

/// The δ with Gδ = `wanted` that minimizes ½δᵀHδ + gᵀδ; H is made convex where it is not.
fn constrained_minimum(
    hessian: &DMatrix<f64>,
    slope: &DVector<f64>,
    reach: &Matrix4xX<f64>,
    wanted: &Vector4<f64>,
) -> Option<ConstrainedMinimum> {
    let count = slope.len();
    let identity = DMatrix::<f64>::identity(count, count);
    // Gᵀ = QR.
    let factors = DMatrix::from_fn(count, 4, |row, column| reach[(column, row)]).qr();
    let (along, upper) = (factors.q(), factors.r());
    let fixed = &along * upper.transpose().solve_lower_triangular(&DVector::from_column_slice(wanted.as_slice()))?;
    // Projection onto the changes that keep the end.
    let keep = &identity - &along * along.transpose();
    // Along Q, where nothing is free, the identity stands in.
    let shifted = |shift| hessian + &identity * shift;
    let (factors, shift) = convex_factors(|shift| &keep * shifted(shift) * &keep + &along * along.transpose())?;
    let bent = shifted(shift);
    let right = -(&keep * (slope + &bent * &fixed));
    let change = &keep * factors.solve(&right) + &fixed;
    let push = along.transpose() * (&bent * &change + slope);
    let multipliers = Vector4::from_column_slice((-upper.solve_upper_triangular(&push)?).as_slice());
    ConstrainedMinimum { change, multipliers }.finite()
}

/// The δ that minimizes ½δᵀHδ + gᵀδ + w|Gδ − `wanted`|², w = [`END_WEIGHT`]; H is made convex where it is not.
fn penalized_minimum(
    hessian: &DMatrix<f64>,
    slope: &DVector<f64>,
    reach: &Matrix4xX<f64>,
    wanted: &Vector4<f64>,
) -> Option<ConstrainedMinimum> {
    let count = slope.len();
    let weight = 2.0 * END_WEIGHT;
    let pulled = hessian + reach.transpose() * reach * weight;
    let right = reach.transpose() * wanted * weight - slope;
    let (factors, _) = convex_factors(|shift| &pulled + DMatrix::identity(count, count) * shift)?;
    let change = factors.solve(&right);
    let multipliers = (reach * &change - wanted) * weight;
    ConstrainedMinimum { change, multipliers }.finite()
}

/// Factors of a matrix with the least of a row of numbers on its diagonal that makes it positive definite, and this number.
fn convex_factors(matrix: impl Fn(f64) -> DMatrix<f64>) -> Option<(Cholesky<f64, Dyn>, f64)> {
    let larger = iter::successors(Some(1.0), |shift| Some(4.0 * shift));
    let mut shifts = iter::once(0.0).chain(larger).take(MOST_SHIFTS);
    shifts.find_map(|shift| matrix(shift).cholesky().map(|factors| (factors, shift)))
}
