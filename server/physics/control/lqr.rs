//! The linear-quadratic regulator (LQR): the gain that is optimal for given weights on the state and on the tilt.

use crate::control::bounce_model::{BounceModel, STABLE};
use crate::control::care;
use crate::control::riccati;
use crate::control::riccati::RiccatiSolution;
use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3, Vector4};

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

/// The law α = −K·s that minimizes the sum of sᵀ diag(`state`) s + `input` α² over all bounces.
///
/// With a weight of 0 on x the design leaves x out, and its gain is 0.
///
/// # Errors
/// [`DesignFailure`].
pub fn design_lqr(model: &BounceModel, state: [f64; 4], input: f64) -> Result<LqrDesign, DesignFailure> {
    let design = gain(model, state, input)?;
    let spectral_radius =
        model.closed_loop(design.gain, state[0] != 0.0).map_or(f64::NAN, |closed| closed.spectral_radius);
    if spectral_radius <= STABLE { Ok(design) } else { Err(DesignFailure::Unseen(spectral_radius)) }
}

/// [`design_lqr`] without the eigenvalues of the closed loop: for weights that see every mode.
///
/// # Errors
/// [`DesignFailure::Diverging`] and [`DesignFailure::Inaccurate`].
pub(crate) fn gain(model: &BounceModel, state: [f64; 4], input: f64) -> Result<LqrDesign, DesignFailure> {
    design(&model.a, &model.b, state, riccati::solve, riccati::solve, input)
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
