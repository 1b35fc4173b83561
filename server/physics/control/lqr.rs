//! The linear-quadratic regulator (LQR): the gain that is optimal for given weights on the state and on the tilt.

use crate::control::bounce_model::{BounceModel, STABLE};
use crate::control::care;
use crate::control::riccati;
use crate::control::riccati::RiccatiSolution;
use nalgebra::{Matrix3, Matrix4, RowVector4, SMatrix, SVector, Vector3, Vector4};

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
///
/// # Errors
/// [`DesignFailure`].
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
        model.closed_loop(found.gain, state[0] != 0.0).map_or(f64::NAN, |closed| closed.spectral_radius);
    if spectral_radius <= STABLE { Ok(found) } else { Err(DesignFailure::Unseen(spectral_radius)) }
}

/// [`design_lqr`] without the eigenvalues of the closed loop, and without the turning: for weights that see every mode.
///
/// # Errors
/// [`DesignFailure::Diverging`] and [`DesignFailure::Inaccurate`].
pub(crate) fn gain(model: &BounceModel, state: [f64; 4], input: f64) -> Result<LqrDesign, DesignFailure> {
    let found = design(&model.a, &model.b, state, riccati::solve, riccati::solve, input)?;
    if model.sensed == Matrix4::identity() {
        return Ok(found);
    }
    // A law without x has no gain on it either way: x is the first of the state, and a sensed place is x less a way.
    let sensed = model.sensed.try_inverse().ok_or(DesignFailure::Diverging)?;
    Ok(LqrDesign { gain: (RowVector4::from(found.gain) * sensed).into(), ..found })
}

/// The law α = −K·s that minimizes the integral of sᵀ diag(`state`) s + `input` α² for ṡ = As + Bα, s as in
/// [`crate::control::bounce_model::STATE`].
///
/// # Errors
/// As for [`gain`].
pub(crate) fn design_continuous(
    a: &Matrix4<f64>,
    b: &Vector4<f64>,
    state: [f64; 4],
    input: f64,
) -> Result<LqrDesign, DesignFailure> {
    design(a, b, state, care::solve, care::solve, input)
}

/// A solver of a Riccati equation with N states: A, B, the weights on the states and on the input.
type Solver<const N: usize> =
    fn(&SMatrix<f64, N, N>, &SVector<f64, N>, &SVector<f64, N>, f64) -> Option<RiccatiSolution<N>>;

/// The law by a solver for all four states, or for three if x has no weight.
fn design(
    a: &Matrix4<f64>,
    b: &Vector4<f64>,
    state: [f64; 4],
    all: Solver<4>,
    without_x: Solver<3>,
    input: f64,
) -> Result<LqrDesign, DesignFailure> {
    let (gain, residual, iterations) = if state[0] == 0.0 {
        let (a, b): (Matrix3<f64>, Vector3<f64>) = (a.fixed_view::<3, 3>(1, 1).into(), b.fixed_rows::<3>(1).into());
        let found = without_x(&a, &b, &Vector3::new(state[1], state[2], state[3]), input);
        let found = found.ok_or(DesignFailure::Diverging)?;
        ([0.0, found.gain[0], found.gain[1], found.gain[2]], found.residual, found.iterations)
    } else {
        let found = all(a, b, &state.into(), input).ok_or(DesignFailure::Diverging)?;
        (found.gain.into(), found.residual, found.iterations)
    };
    if residual.is_nan() || residual > RESIDUAL {
        return Err(DesignFailure::Inaccurate(residual));
    }
    Ok(LqrDesign { gain, residual, iterations })
}
