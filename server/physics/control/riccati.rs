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
