//! The algebraic Riccati equation for one input, and the gain that belongs to it: over bounces
//! P = AᵀPA − AᵀPB(R + BᵀPB)⁻¹BᵀPA + Q, in time AᵀP + PA − PBR⁻¹BᵀP + Q = 0.
//!
//! Structured doubling (Chu, Fan, Lin and Wang, 2004) inverts neither A nor a symplectic pencil: the A of a sticking contact is singular. A
//! Cayley transform with a parameter γ > 0 turns the equation in time into one over bounces with the same P (Chu, Fan and Lin, 2005).

use nalgebra::{DMatrix, DVector, RowDVector};

/// Most doublings: then the sum of costs covers 2⁴⁰ bounces.
pub const DOUBLINGS: u32 = 40;

/// The result of A and B for a state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// The state after a bounce.
    Bounce,
    /// The derivative of the state by time.
    Time,
}

/// A solution and its accuracy.
#[derive(Clone, Debug, PartialEq)]
pub struct RiccatiSolution {
    /// P, symmetric.
    pub cost: DMatrix<f64>,
    /// K.
    pub gain: RowDVector<f64>,
    /// Residual of the equation over P, or in time over its largest term, as Frobenius norms.
    pub residual: f64,
    /// Doublings of the iteration.
    pub iterations: u32,
}

/// Solves the equation for weights Q = diag(`state`) ≥ 0 and R = `input` > 0.
///
/// `None` if the doubling does not converge. If the weights do not see a growing mode, the solution does not stabilize it: check the
/// eigenvalues of A − BK.
pub fn solve(
    step: Step,
    a: &DMatrix<f64>,
    b: &DVector<f64>,
    state: &DVector<f64>,
    input: f64,
) -> Option<RiccatiSolution> {
    let weights = DMatrix::from_diagonal(state);
    let reach = b * b.transpose() / input;
    let (cost, iterations) = match step {
        Step::Bounce => double(a.clone(), reach, weights.clone())?,
        Step::Time => {
            let identity = DMatrix::identity(a.nrows(), a.nrows());
            // Larger than the modulus of every eigenvalue of A, so that A − γ is regular.
            let cayley = 1.0 + 2.0 * a.abs().row_sum().max().min(a.abs().column_sum().max());
            let shifted = a - &identity * cayley;
            let inverse = shifted.clone().try_inverse()?;
            let onward = (&shifted + &reach * inverse.transpose() * &weights).try_inverse()?;
            let back = (shifted.transpose() + &weights * &inverse * &reach).try_inverse()?;
            double(
                identity + onward * (2.0 * cayley),
                symmetric(&(&inverse * &reach * &back * (2.0 * cayley))),
                symmetric(&(&back * &weights * &inverse * (2.0 * cayley))),
            )?
        }
    };
    let gain_of = |cost: &DMatrix<f64>| -> RowDVector<f64> {
        let pressed = cost * b;
        match step {
            Step::Bounce => pressed.transpose() * a / (input + b.dot(&pressed)),
            Step::Time => pressed.transpose() / input,
        }
    };
    // One step of Newton's iteration (Hewer, 1971; Kleinman, 1968): the cost of the law that belongs to P, as a sum in which nothing cancels. P
    // itself where that law does not stabilize.
    let gain = gain_of(&cost);
    let (closed, running) = (a - b * &gain, &weights + gain.transpose() * &gain * input);
    let summed = match step {
        Step::Bounce => doubled_sum(closed, running),
        Step::Time => {
            let (identity, cayley) = (DMatrix::identity(a.nrows(), a.nrows()), closed.norm());
            (closed - &identity * cayley).try_inverse().and_then(|inverse| {
                let sum = inverse.transpose() * running * &inverse * (2.0 * cayley);
                doubled_sum(identity + inverse * (2.0 * cayley), sum)
            })
        }
    };
    let cost = summed.unwrap_or(cost);
    let gain = gain_of(&cost);
    let (rest, scale) = match step {
        Step::Bounce => (a.transpose() * &cost * (a - b * &gain) + weights - &cost, cost.norm()),
        Step::Time => {
            let pulled = a.transpose() * &cost;
            let rest = &pulled + &cost * a - gain.transpose() * &gain * input + &weights;
            (rest, pulled.norm().max(weights.norm()))
        }
    };
    Some(RiccatiSolution { residual: rest.norm() / scale.max(f64::MIN_POSITIVE), cost, gain, iterations })
}

/// Structured doubling from A, B R⁻¹Bᵀ and Q: the stabilizing P and the number of doublings. `None` if it does not converge.
fn double(mut power: DMatrix<f64>, mut reach: DMatrix<f64>, mut cost: DMatrix<f64>) -> Option<(DMatrix<f64>, u32)> {
    let identity = DMatrix::identity(power.nrows(), power.nrows());
    for iterations in 1..=DOUBLINGS {
        let factors = (&identity + &reach * &cost).lu();
        let (onward, spread) = (factors.solve(&power)?, factors.solve(&reach)?);
        let more = power.transpose() * &cost * &onward;
        reach = symmetric(&(&reach + &power * spread * power.transpose()));
        power *= onward;
        cost = symmetric(&(cost + &more));
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

/// W + AᵀWA + (Aᵀ)²WA² + … for A = `power` and W = `sum`, twice as many terms at each step. `None` if it does not converge.
fn doubled_sum(mut power: DMatrix<f64>, mut sum: DMatrix<f64>) -> Option<DMatrix<f64>> {
    for _ in 0..DOUBLINGS {
        let more = power.transpose() * &sum * &power;
        sum = symmetric(&(sum + &more));
        if more.norm() <= f64::EPSILON * sum.norm() {
            return Some(sum);
        }
        power = &power * &power;
    }
    None
}

fn symmetric(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    (matrix + matrix.transpose()) * 0.5
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scalar(step: Step, a: f64, b: f64) -> Option<RiccatiSolution> {
        let one = |value| DVector::from_element(1, value);
        solve(step, &DMatrix::from_element(1, 1, a), &one(b), &one(1.0), 1.0)
    }

    #[test]
    fn one_state_has_its_closed_form() {
        // p = q + a²p − a²p²b²/(r + b²p), here with a = 2, b = q = r = 1: p² − 4p − 1 = 0.
        let solution = scalar(Step::Bounce, 2.0, 1.0).unwrap();
        let expected = 2.0 + 5.0_f64.sqrt();
        assert!((solution.cost[0] - expected).abs() < 1e-14 * expected, "{solution:?}");
        assert!((solution.gain[0] - 2.0 * expected / (1.0 + expected)).abs() < 1e-14 && solution.residual < 1e-15);
        // 2ap − p²b²/r + q = 0 with a = 1, b = q = r = 1: p = 1 + √2.
        let solution = scalar(Step::Time, 1.0, 1.0).unwrap();
        let expected = 1.0 + 2.0_f64.sqrt();
        assert!((solution.cost[0] - expected).abs() < 1e-15 * 4.0, "{solution:?}");
        assert!((solution.gain[0] - expected).abs() < 4e-15 && solution.residual < 1e-15, "{solution:?}");
    }

    #[test]
    fn a_singular_matrix_is_no_hindrance() {
        let (one, zero) = (DVector::from_vec(vec![0.0, 1.0]), DVector::from_vec(vec![1.0, 0.0]));
        let solution =
            solve(Step::Bounce, &DMatrix::from_row_slice(2, 2, &[1.2, 1.0, 0.0, 0.0]), &one, &zero, 0.5).unwrap();
        assert!(solution.residual < 1e-14, "{solution:?}");
        // A double integrator with Q = diag(1, 0), R = 1: K = (1, √2).
        let solution =
            solve(Step::Time, &DMatrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]), &one, &zero, 1.0).unwrap();
        assert!((solution.gain[0] - 1.0).abs() < 1e-14 && (solution.gain[1] - 2.0_f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn a_rod_in_contact_has_the_gain_of_the_paper_s_body() {
        // ẍ = −Gα, θ̈ = (Gl/ρ²)(θ − α), with Q = diag(1, 10, 0.1, 0.1) and R = 10.
        let (gravity, l, rho) = (9.81, 0.4 / 3.0, 2.0_f64.sqrt() / 15.0);
        let turn = gravity * l / (rho * rho);
        let mut a = DMatrix::zeros(4, 4);
        (a[(0, 2)], a[(1, 3)], a[(3, 1)]) = (1.0, 1.0, turn);
        let b = DVector::from_vec(vec![0.0, 0.0, -gravity, -turn]);
        let solution = solve(Step::Time, &a, &b, &DVector::from_vec(vec![1.0, 10.0, 0.1, 0.1]), 10.0).unwrap();
        let expected = [0.316_227_766_016_837_44, -2.907_809_175_545_411_4];
        assert!((solution.gain[0] - expected[0]).abs() < 1e-12 && (solution.gain[1] - expected[1]).abs() < 1e-12);
        assert!(solution.residual < 1e-13, "{solution:?}");
    }

    #[test]
    fn what_nothing_can_hold_does_not_converge() {
        // The input does not reach the state, which grows.
        assert_eq!((scalar(Step::Bounce, 1.5, 0.0), scalar(Step::Time, 1.5, 0.0)), (None, None));
        // Neither does a cost that grows for ever because the state stays.
        assert_eq!(scalar(Step::Bounce, 1.0, 0.0), None);
    }
}
