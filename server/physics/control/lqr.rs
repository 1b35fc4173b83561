//! The linear-quadratic regulator (LQR): the gain that is optimal for given weights on the state and on the tilt.

use crate::control::bounce_model::{BounceModel, STABLE, states};
use crate::control::riccati::{self, RiccatiSolution, Step};
use nalgebra::{DMatrix, DVector, Matrix4, RowVector4, Vector4};

/// Weights on (x, θ, ẋ, θ̇) if none are asked for. With [`DEFAULT_INPUT_WEIGHT`] they keep tilts so small that laws hold for large
/// deviations.
pub const DEFAULT_STATE_WEIGHTS: [f64; 4] = [1.0, 10.0, 0.1, 0.1];

/// Weight on the tilt if none is asked for.
pub const DEFAULT_INPUT_WEIGHT: f64 = 10.0;

/// Largest residual of the Riccati equation at which its solution still has trustworthy digits.
pub const RESIDUAL: f64 = 1e-8;

/// A designed law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LqrDesign {
    /// K, in the order of [`crate::control::bounce_model::STATE`]; 0 for x if its weight is 0.
    pub gain: [f64; 4],
    /// Relative residual of the Riccati equation.
    pub residual: f64,
    /// Doublings of the iteration.
    pub iterations: u32,
}

/// Reason for which there is no law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DesignFailure {
    /// The doubling did not converge.
    Diverging,
    /// It converged, but with this relative residual of the equation.
    Inaccurate(f64),
    /// It converged, but the closed loop has this spectral radius: a deviation without weight does not die out.
    Unseen(f64),
}

/// Most rounds in which a gain and the turning of its table are brought together.
const MOST_ROUNDS: u32 = 200;

/// Change of a gain, as a share of it, at which they are together.
const SAME_GAIN: f64 = 1e-14;

/// The law α = −K·s that minimizes the sum of sᵀ diag(`state`) s + `input` α² over all bounces.
///
/// With a weight of 0 on x the design leaves x out, and its gain is 0. The gain of a table that senses s as Ts is KT⁻¹. That of a table which
/// drags the contact as it turns is the best of the loop that its own turning makes.
pub fn design_lqr(model: &BounceModel, state: [f64; 4], input: f64) -> Result<LqrDesign, DesignFailure> {
    let mut found = gain(model, state, input)?;
    if model.dragged.is_some() {
        let largest = |gain: &[f64; 4]| gain.iter().fold(0.0_f64, |most, gain| most.max(gain.abs()));
        let mut change = f64::INFINITY;
        for _ in 0..MOST_ROUNDS {
            let next = gain(&BounceModel { a: model.a + model.dragged_by(found.gain), ..*model }, state, input)?;
            let moved =
                largest(&std::array::from_fn(|index| next.gain[index] - found.gain[index])) / largest(&next.gain);
            let is_same = moved <= SAME_GAIN || (moved >= change && moved <= RESIDUAL);
            (found, change) = (next, moved);
            if is_same {
                break;
            }
        }
        if change.is_nan() || change > RESIDUAL {
            return Err(DesignFailure::Diverging);
        }
    }
    let spectral_radius =
        model.closed_loop(found.gain, states(state[0] != 0.0)).map_or(f64::NAN, |closed| closed.spectral_radius);
    if spectral_radius <= STABLE { Ok(found) } else { Err(DesignFailure::Unseen(spectral_radius)) }
}

/// [`design_lqr`] without the eigenvalues of the closed loop, and without the turning: for weights that see every mode.
pub(crate) fn gain(model: &BounceModel, state: [f64; 4], input: f64) -> Result<LqrDesign, DesignFailure> {
    let found = design(Step::Bounce, &model.a, &model.b, state, input)?;
    if model.sensed == Matrix4::identity() {
        return Ok(found);
    }
    // A law without x has no gain on it either way: x is the first of the state, and a sensed place is x less a way.
    let sensed = model.sensed.try_inverse().ok_or(DesignFailure::Diverging)?;
    Ok(LqrDesign { gain: (RowVector4::from(found.gain) * sensed).into(), ..found })
}

/// The law α = −K·s that minimizes the sum over bounces, or the integral over time, of sᵀ diag(`state`) s + `input` α²; A and B are of all four
/// states. Without a weight on x it is that for the other three.
pub(crate) fn design(
    step: Step,
    a: &Matrix4<f64>,
    b: &Vector4<f64>,
    state: [f64; 4],
    input: f64,
) -> Result<LqrDesign, DesignFailure> {
    let first = usize::from(state[0] == 0.0);
    let a = DMatrix::from_fn(4 - first, 4 - first, |row, column| a[(first + row, first + column)]);
    let b = DVector::from_column_slice(&b.as_slice()[first..]);
    let weights = DVector::from_column_slice(&state[first..]);
    let found = riccati::solve(step, &a, &b, &weights, input).ok_or(DesignFailure::Diverging)?;
    let RiccatiSolution { residual, iterations, .. } = found;
    if residual.is_nan() || residual > RESIDUAL {
        return Err(DesignFailure::Inaccurate(residual));
    }
    let mut gain = [0.0; 4];
    gain[first..].copy_from_slice(found.gain.as_slice());
    Ok(LqrDesign { gain, residual, iterations })
}
