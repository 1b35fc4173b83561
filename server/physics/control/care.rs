//! The continuous algebraic Riccati equation AᵀP + PA − PBR⁻¹BᵀP + Q = 0, and the gain that belongs to it.
//!
//! A Cayley transform with a parameter γ > 0 turns it into a discrete one with the same P (Chu, Fan and Lin 2005), which structured
//! doubling solves ([`crate::control::riccati`]). Not here: the choice of A and B.

use crate::control::riccati::{RiccatiSolution, double, doubled_sum, symmetric};
use nalgebra::{Const, DimMin, SMatrix, SVector};

/// Solves the equation for one input with weights Q = diag(`state`) ≥ 0 and R = `input` > 0: K = R⁻¹BᵀP.
///
/// `None` if the doubling does not converge. If the weights do not see a growing mode, the solution does not stabilize it: check the
/// eigenvalues of A − BK.
pub fn solve<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    state: &SVector<f64, N>,
    input: f64,
) -> Option<RiccatiSolution<N>>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    let identity = SMatrix::<f64, N, N>::identity();
    let weights = SMatrix::from_diagonal(state);
    let reach = b * b.transpose() / input;
    // Larger than the modulus of every eigenvalue of A, so that A − γ is regular.
    let cayley = 1.0 + 2.0 * a.abs().row_sum().max().min(a.abs().column_sum().max());
    let shifted = a - identity * cayley;
    let inverse = shifted.try_inverse()?;
    let onward = (shifted + reach * inverse.transpose() * weights).try_inverse()?;
    let back = (shifted.transpose() + weights * inverse * reach).try_inverse()?;
    let (cost, iterations) = double(
        identity + onward * (2.0 * cayley),
        symmetric(&(inverse * reach * back * (2.0 * cayley))),
        symmetric(&(back * weights * inverse * (2.0 * cayley))),
    )?;
    let cost = refined(a, b, &weights, input, &cost);
    let gain = (cost * b).transpose() / input;
    let rest = a.transpose() * cost + cost * a - gain.transpose() * gain * input + weights;
    let scale = (a.transpose() * cost).norm().max(weights.norm()).max(f64::MIN_POSITIVE);
    Some(RiccatiSolution { cost, gain, residual: rest.norm() / scale, iterations })
}

/// One step of Newton's iteration (Kleinman 1968): the cost of the law that belongs to P, from Lyapunov's equation by doubling. P itself
/// if that law does not stabilize.
fn refined<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    weights: &SMatrix<f64, N, N>,
    input: f64,
    cost: &SMatrix<f64, N, N>,
) -> SMatrix<f64, N, N>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    let identity = SMatrix::<f64, N, N>::identity();
    let gain = (cost * b).transpose() / input;
    let closed = a - b * gain;
    let cayley = closed.norm();
    let Some(inverse) = (closed - identity * cayley).try_inverse() else { return *cost };
    let power = identity + inverse * (2.0 * cayley);
    let sum = inverse.transpose() * (weights + gain.transpose() * gain * input) * inverse * (2.0 * cayley);
    doubled_sum(power, sum).unwrap_or(*cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_state_has_its_closed_form() {
        // 2ap − p²b²/r + q = 0 with a = 1, b = q = r = 1: p = 1 + √2.
        let solution = solve(&SMatrix::from([[1.0]]), &SVector::from([1.0]), &SVector::from([1.0]), 1.0).unwrap();
        let expected = 1.0 + 2.0_f64.sqrt();
        assert!((solution.cost[0] - expected).abs() < 1e-15 * 4.0, "{solution:?}");
        assert!((solution.gain[0] - expected).abs() < 4e-15 && solution.residual < 1e-15, "{solution:?}");
    }

    #[test]
    fn a_double_integrator_has_its_closed_form() {
        // Q = diag(1, 0), R = 1: K = (1, √2).
        let a = SMatrix::<f64, 2, 2>::new(0.0, 1.0, 0.0, 0.0);
        let solution = solve(&a, &SVector::from([0.0, 1.0]), &SVector::from([1.0, 0.0]), 1.0).unwrap();
        assert!((solution.gain[0] - 1.0).abs() < 1e-14 && (solution.gain[1] - 2.0_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn a_rod_in_contact_has_the_gain_of_the_paper_s_body() {
        // ẍ = −Gα, θ̈ = (Gl/ρ²)(θ − α), with Q = diag(1, 10, 0.1, 0.1) and R = 10.
        let (gravity, l, rho) = (9.81, 0.4 / 3.0, 2.0_f64.sqrt() / 15.0);
        let turn = gravity * l / (rho * rho);
        let mut a = SMatrix::<f64, 4, 4>::zeros();
        (a[(0, 2)], a[(1, 3)], a[(3, 1)]) = (1.0, 1.0, turn);
        let b = SVector::from([0.0, 0.0, -gravity, -turn]);
        let solution = solve(&a, &b, &SVector::from([1.0, 10.0, 0.1, 0.1]), 10.0).unwrap();
        let expected = [0.316_227_766_016_837_44, -2.907_809_175_545_411_4];
        assert!((solution.gain[0] - expected[0]).abs() < 1e-12 && (solution.gain[1] - expected[1]).abs() < 1e-12);
        assert!(solution.residual < 1e-13, "{solution:?}");
    }

    #[test]
    fn what_nothing_can_hold_does_not_converge() {
        assert_eq!(solve(&SMatrix::from([[1.5]]), &SVector::from([0.0]), &SVector::from([1.0]), 1.0), None);
    }
}
