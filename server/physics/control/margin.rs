//! Gain margins of a state feedback: the factors on its gain at which an eigenvalue of the closed loop reaches the unit circle.
//!
//! The result is exact up to rounding, without a search over factors. With p(z) = det(zI − A) and n(z) = det(zI − A + BK) − p(z),
//! which is linear in the gain, z is an eigenvalue for the factor −p(z)/n(z). On the circle this factor is real at few points.

use nalgebra::DMatrix;

/// The range of factors on the gain, about 1, for which the closed loop is stable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StableGainRange {
    /// The largest factor below 1 that makes the loop unstable, if there is one.
    pub lower: Option<f64>,
    /// The smallest factor above 1 that makes the loop unstable, if there is one.
    pub upper: Option<f64>,
}

/// The stable range of a stable closed loop, from A (`open`) and A − BK (`closed`) of at most four states.
pub fn stable_gain_range(open: &DMatrix<f64>, closed: &DMatrix<f64>) -> StableGainRange {
    let mut margin = StableGainRange { lower: None, upper: None };
    for factor in critical_factors(open, closed) {
        if factor < 1.0 {
            margin.lower = Some(margin.lower.map_or(factor, |lower| lower.max(factor)));
        } else if factor > 1.0 && factor.is_finite() {
            margin.upper = Some(margin.upper.map_or(factor, |upper| upper.min(factor)));
        }
    }
    margin
}

/// The factors on the gain that put an eigenvalue on the unit circle, in no order; some of them may be infinite or NaN.
pub fn critical_factors(open: &DMatrix<f64>, closed: &DMatrix<f64>) -> Vec<f64> {
    let p = characteristic(open);
    let n: Vec<f64> = characteristic(closed).iter().zip(&p).map(|(closed, open)| closed - open).collect();
    let mut places = imaginary_part(&n, &p);
    places.extend([-1.0, 1.0]);
    places.into_iter().map(|cosine| -real_part(&p, &n, cosine) / real_part(&n, &n, cosine)).collect()
}

/// Coefficients of det(zI − M), the constant one first, by the algorithm of Faddeev and Le Verrier.
pub fn characteristic(matrix: &DMatrix<f64>) -> Vec<f64> {
    let size = matrix.nrows();
    let mut coefficients = vec![0.0; size + 1];
    coefficients[size] = 1.0;
    let mut product = DMatrix::identity(size, size);
    for k in 1..=size {
        let next = matrix * product;
        coefficients[size - k] = -next.trace() / k as f64;
        product = next + DMatrix::identity(size, size) * coefficients[size - k];
    }
    coefficients
}

/// Re p(z) n(z̄) at z on the unit circle with this real part, by Chebyshev's T.
fn real_part(p: &[f64], n: &[f64], cosine: f64) -> f64 {
    let mut sum: f64 = p.iter().zip(n).map(|(p, n)| p * n).sum();
    let (mut before, mut chebyshev) = (1.0, cosine);
    for apart in 1..p.len() {
        let pairs = (apart..p.len()).map(|j| p[j] * n[j - apart] + p[j - apart] * n[j]);
        sum += chebyshev * pairs.sum::<f64>();
        (before, chebyshev) = (chebyshev, 2.0 * cosine * chebyshev - before);
    }
    sum
}

/// Zeros of Im n(z) p(z̄) on the upper half of the unit circle, as real parts of z. The function is sin ω times a polynomial in
/// cos ω, by Chebyshev's U.
fn imaginary_part(n: &[f64], p: &[f64]) -> Vec<f64> {
    let mut polynomial = vec![0.0; n.len() - 1];
    let (mut before, mut chebyshev) = (vec![0.0; n.len()], vec![0.0; n.len()]);
    chebyshev[0] = 1.0;
    for apart in 1..n.len() {
        let pairs: f64 = (apart..n.len()).map(|j| n[j] * p[j - apart] - n[j - apart] * p[j]).sum();
        for (sum, term) in polynomial.iter_mut().zip(&chebyshev) {
            *sum += pairs * term;
        }
        let next = (0..n.len()).map(|power| {
            let shifted = if power > 0 { 2.0 * chebyshev[power - 1] } else { 0.0 };
            shifted - before[power]
        });
        let next = next.collect();
        (before, chebyshev) = (chebyshev, next);
    }
    roots(&polynomial)
}

/// Sign changes between −1 and 1 of a polynomial, its constant coefficient first. Between two neighbouring ones of the derivative
/// there is at most one.
fn roots(polynomial: &[f64]) -> Vec<f64> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let derivative: Vec<f64> =
        polynomial.iter().enumerate().skip(1).map(|(power, value)| power as f64 * value).collect();
    let at = |x: f64| polynomial.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient);
    let mut ends = vec![-1.0];
    ends.extend(roots(&derivative));
    ends.push(1.0);
    let crossing = |pair: &[f64]| {
        let (mut low, mut high) = (pair[0], pair[1]);
        let side = at(low) < 0.0;
        (side != (at(high) < 0.0)).then(|| {
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                if (at(middle) < 0.0) == side { low = middle } else { high = middle }
            }
            0.5 * (low + high)
        })
    };
    ends.windows(2).filter_map(crossing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_state_has_its_closed_form() {
        // z = 2 − 1.8 g is on the circle at g = 1/1.8 and 3/1.8.
        let matrix = |value| DMatrix::from_element(1, 1, value);
        let StableGainRange { lower, upper } = stable_gain_range(&matrix(2.0), &matrix(0.2));
        assert!((lower.unwrap() - 1.0 / 1.8).abs() < 1e-15 && (upper.unwrap() - 3.0 / 1.8).abs() < 1e-15);
        // Stable without feedback, so no factor between 0 and 1 is critical.
        assert_eq!(stable_gain_range(&matrix(0.5), &matrix(0.0)).lower, Some(-1.0));
    }

    #[test]
    fn roots_are_found_between_those_of_the_derivative() {
        // (x − 0.5)(x + 0.25)(x − 0.75)
        let found = roots(&[0.09375, 0.0625, -1.0, 1.0]);
        assert!(found.len() == 3 && (found[0] + 0.25).abs() < 1e-15 && (found[2] - 0.75).abs() < 1e-15, "{found:?}");
        assert!(roots(&[1.0, 0.0, 1.0]).is_empty());
    }
}
