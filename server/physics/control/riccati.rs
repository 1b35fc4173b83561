//! The discrete algebraic Riccati equation P = AᵀPA − AᵀPB(R + BᵀPB)⁻¹BᵀPA + Q by structured doubling, and the gain that
//! belongs to it.
//!
//! Doubling (Chu, Fan, Lin and Wang, 2004) inverts neither A nor a symplectic pencil: the A of a sticking contact is singular.
//! Not here: the choice of A and B, and the judgement of the law.

use nalgebra::{Const, DimMin, RowSVector, SMatrix, SVector};

/// Most doublings: then the sum of costs covers 2⁴⁰ bounces.
pub const DOUBLINGS: u32 = 40;

/// A solution and its accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RiccatiSolution<const N: usize> {
    /// P, symmetric.
    pub cost: SMatrix<f64, N, N>,
    /// K = (R + BᵀPB)⁻¹BᵀPA.
    pub gain: RowSVector<f64, N>,
    /// Residual of the equation over P, both as Frobenius norms.
    pub residual: f64,
    /// Doublings of the iteration.
    pub iterations: u32,
}

/// Solves the equation for one input with weights Q = diag(`state`) ≥ 0 and R = `input` > 0.
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
    let weights = SMatrix::from_diagonal(state);
    let (cost, iterations) = double(*a, b * b.transpose() / input, weights)?;
    let cost = refined(a, b, &weights, input, &cost);
    let gain = gain(a, b, input, &cost);
    let next = a.transpose() * cost * (a - b * gain) + weights;
    let residual = (next - cost).norm() / cost.norm().max(f64::MIN_POSITIVE);
    Some(RiccatiSolution { cost, gain, residual, iterations })
}

/// Structured doubling from A, B R⁻¹Bᵀ and Q: the stabilizing P and the number of doublings. `None` if it does not converge.
pub(crate) fn double<const N: usize>(
    mut power: SMatrix<f64, N, N>,
    mut reach: SMatrix<f64, N, N>,
    mut cost: SMatrix<f64, N, N>,
) -> Option<(SMatrix<f64, N, N>, u32)>
where
    Const<N>: DimMin<Const<N>, Output = Const<N>>,
{
    let identity = SMatrix::<f64, N, N>::identity();
    for iterations in 1..=DOUBLINGS {
        let factors = (identity + reach * cost).lu();
        let (onward, spread) = (factors.solve(&power)?, factors.solve(&reach)?);
        let more = power.transpose() * cost * onward;
        reach = symmetric(&(reach + power * spread * power.transpose()));
        power *= onward;
        cost = symmetric(&(cost + more));
        let (step, size) = (more.norm(), cost.norm());
        if !size.is_finite() {
            return None;
        }
        if step <= f64::EPSILON * size {
            return Some((cost, iterations));
        }
    }
    None
}

/// K = (R + BᵀPB)⁻¹BᵀPA.
fn gain<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    input: f64,
    cost: &SMatrix<f64, N, N>,
) -> RowSVector<f64, N> {
    let pressed = cost * b;
    pressed.transpose() * a / (input + b.dot(&pressed))
}

/// One step of Newton's iteration (Hewer, 1971): the cost of the law that belongs to P, as a sum over all bounces, in which nothing
/// cancels. P itself where that law does not stabilize.
fn refined<const N: usize>(
    a: &SMatrix<f64, N, N>,
    b: &SVector<f64, N>,
    weights: &SMatrix<f64, N, N>,
    input: f64,
    cost: &SMatrix<f64, N, N>,
) -> SMatrix<f64, N, N> {
    let gain = gain(a, b, input, cost);
    doubled_sum(a - b * gain, weights + gain.transpose() * gain * input).unwrap_or(*cost)
}

/// W + AᵀWA + (Aᵀ)²WA² + … for A = `power` and W = `sum`, twice as many terms at each step. `None` if it does not converge.
pub(crate) fn doubled_sum<const N: usize>(
    mut power: SMatrix<f64, N, N>,
    mut sum: SMatrix<f64, N, N>,
) -> Option<SMatrix<f64, N, N>> {
    for _ in 0..DOUBLINGS {
        let more = power.transpose() * sum * power;
        sum = symmetric(&(sum + more));
        if more.norm() <= f64::EPSILON * sum.norm() {
            return Some(sum);
        }
        power *= power;
    }
    None
}

pub(crate) fn symmetric<const N: usize>(matrix: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    (matrix + matrix.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_state_has_its_closed_form() {
        // p = q + a²p − a²p²b²/(r + b²p), here with a = 2, b = q = r = 1: p² − 4p − 1 = 0.
        let solution = solve(&SMatrix::from([[2.0]]), &SVector::from([1.0]), &SVector::from([1.0]), 1.0).unwrap();
        let expected = 2.0 + 5.0_f64.sqrt();
        assert!((solution.cost[0] - expected).abs() < 1e-14 * expected, "{solution:?}");
        assert!((solution.gain[0] - 2.0 * expected / (1.0 + expected)).abs() < 1e-14 && solution.residual < 1e-15);
    }

    #[test]
    fn a_singular_matrix_is_no_hindrance() {
        let a = SMatrix::<f64, 2, 2>::new(1.2, 1.0, 0.0, 0.0);
        let solution = solve(&a, &SVector::from([0.0, 1.0]), &SVector::from([1.0, 0.0]), 0.5).unwrap();
        assert!(solution.residual < 1e-14, "{solution:?}");
    }

    #[test]
    fn what_nothing_can_hold_does_not_converge() {
        // The input does not reach the state, which grows.
        assert_eq!(solve(&SMatrix::from([[1.5]]), &SVector::from([0.0]), &SVector::from([1.0]), 1.0), None);
        // Neither does a cost that grows for ever because the state stays.
        assert_eq!(solve(&SMatrix::from([[1.0]]), &SVector::from([0.0]), &SVector::from([1.0]), 1.0), None);
    }
}
