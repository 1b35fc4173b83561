//! One step of a plan: the tilts of least Σα² by the linearized bounces and their second derivatives.

use super::bounce::BouncingRod;
use super::problem::{END_WEIGHT, Goal};
use super::trajectory::{Linearization, Trajectory};
use nalgebra::{DMatrix, DVector, Matrix4xX, Matrix5, Matrix5xX, Matrix6xX, RowVector5, Vector4, Vector5, Vector6};

/// Change of a trajectory.
pub(super) struct Step {
    nodes: Vec<Vector5<f64>>,
    tilts: Vec<f64>,
    /// Largest cost of an error of a joint or of the end.
    pub(super) price: f64,
}

impl Step {
    /// Largest change of a tilt, rad.
    pub(super) fn largest_change(&self) -> f64 {
        self.tilts.iter().fold(0.0, |most, change| most.max(change.abs()))
    }

    /// The trajectory a share of the step on.
    pub(super) fn taken(&self, trajectory: &Trajectory, share: f64) -> Trajectory {
        let nodes = trajectory.nodes.iter().zip(&self.nodes).map(|(node, change)| node + change * share).collect();
        let tilts = trajectory.tilts.iter().zip(&self.tilts).map(|(tilt, change)| tilt + change * share).collect();
        Trajectory { nodes, tilts }
    }
}

/// Units in which the errors of the end weigh alike: l, 1, √(Gl), √(G/l).
pub(super) fn end_units(body: &BouncingRod) -> Vector4<f64> {
    let (length, gravity) = (body.rod.contact_distance, body.rod.gravity);
    let speed = (gravity * length).sqrt();
    Vector4::new(length, 1.0, speed, speed / length)
}

impl Linearization {
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
    pub(super) fn steps(&self, trajectory: &Trajectory, units: &Vector4<f64>, goal: &Goal) -> Vec<Step> {
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
const MOST_SHIFTS: u32 = 12;

/// Minimum under constraints, and what these cost.
struct ConstrainedMinimum {
    change: DVector<f64>,
    /// ν of Hδ + g + Gᵀν = 0.
    multipliers: Vector4<f64>,
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
    let mut shift = 0.0;
    for _ in 0..MOST_SHIFTS {
        let bent = hessian + &identity * shift;
        // Along Q, where nothing is free, the identity stands in.
        if let Some(factors) = (&keep * &bent * &keep + &along * along.transpose()).cholesky() {
            let right = -(&keep * (slope + &bent * &fixed));
            let change = &keep * factors.solve(&right) + &fixed;
            let push = along.transpose() * (&bent * &change + slope);
            let multipliers = -upper.solve_upper_triangular(&push)?;
            let finite = change.iter().chain(&multipliers).all(|value| value.is_finite());
            let multipliers = Vector4::from_column_slice(multipliers.as_slice());
            return finite.then_some(ConstrainedMinimum { change, multipliers });
        }
        shift = next_shift(shift);
    }
    None
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
    let mut shift = 0.0;
    for _ in 0..MOST_SHIFTS {
        if let Some(factors) = (&pulled + DMatrix::identity(count, count) * shift).cholesky() {
            let change = factors.solve(&right);
            let multipliers = (reach * &change - wanted) * weight;
            let finite = change.iter().chain(&multipliers).all(|value| value.is_finite());
            return finite.then_some(ConstrainedMinimum { change, multipliers });
        }
        shift = next_shift(shift);
    }
    None
}

/// The next number to add to the diagonal of a matrix that is not positive definite.
fn next_shift(shift: f64) -> f64 {
    if shift == 0.0 { 1.0 } else { 4.0 * shift }
}
