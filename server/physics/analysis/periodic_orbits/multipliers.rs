//! The derivative over a period, judged: eigenvalues, Greene's residue, and whether small deviations stay small.
//!
//! If something is free along an orbit (the energy, the drift, the place), the derivative has eigenvalues 1 and is defective. They are
//! divided out of its characteristic polynomial, and the others come from what is left, never from an iteration on the matrix.

use crate::analysis::jacobian::{eigenvalues, modulus, sort_eigenvalues};
use crate::analysis::limits::characteristic;
use crate::analysis::linear_verdict::PARABOLIC;
use nalgebra::{Complex, DMatrix};

/// The verdict on an orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Multipliers {
    /// All eigenvalues, largest modulus first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Greene's residue R = (2 − λ − λ')/4 of the pair that belongs to the angle; `None` for a point mass.
    pub residue: Option<f64>,
    /// True if small deviations stay small; `None` on the boundary, where the linear analysis is silent.
    pub stable: Option<bool>,
    /// Functions that change sign where an eigenvalue passes 1 or −1, and where a complex pair passes the unit circle.
    tests: [f64; 3],
}

/// Change of stability.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bifurcation {
    /// An eigenvalue passes −1 (R = 1); also where the branch itself springs from an orbit of half its period.
    PeriodDoubling,
    /// The branch turns back: an eigenvalue passes 1 (R = 0).
    Fold,
    /// An eigenvalue passes 1 and the branch goes on: another crosses it.
    Pitchfork,
    /// A complex pair leaves the unit circle.
    NeimarkSacker,
}

names!(
    Bifurcation: PeriodDoubling => "period_doubling", Fold => "fold", Pitchfork => "pitchfork",
        NeimarkSacker => "neimark_sacker"
);

impl Multipliers {
    /// The verdict on the derivative over a period. Of its eigenvalues 1, at least and at most so many are not judged.
    pub(super) fn new(product: &DMatrix<f64>, least: usize, most: usize) -> Option<Self> {
        let size = product.nrows();
        let identity = DMatrix::identity(size, size);
        // A point mass has no more than two velocities and x.
        let has_angle = size >= 4;
        let most = most.min(size - if has_angle { 2 } else { 1 });
        let ones = multiplicity(&(product - &identity)).clamp(least, most);
        // det(z − (1 − A)) is the product of all z − (1 − λ).
        let polynomial = &characteristic(&(&identity - product))[ones..];
        let count = size - ones;
        let beside = if ones == 0 { product.clone() } else { DMatrix::identity(count, count) - companion(polynomial) };
        let mut values = eigenvalues(&beside)?;
        let (one, sign) = (Complex::new(1.0, 0.0), if count.is_multiple_of(2) { 1.0 } else { -1.0 });
        let circle: Complex<f64> = pairs(count).map(|(i, j)| one - values[i] * values[j]).product();
        let halves = (0..ones).fold(1.0, |half, _| 0.5 * half);
        let tests = [sign * polynomial[0], halves * (&identity + product).determinant(), circle.re];
        // The rounding error of the coefficients grows with the entries.
        let slack = 1e-8 + 1e-14 * product.norm_squared();
        let inside = values.iter().all(|value| modulus(*value) <= 1.0 + slack);
        // Two that are reciprocal meet there before they leave the circle.
        let is_at = |place: Complex<f64>| {
            let away = |value: Complex<f64>| modulus(value - place);
            let mut near = values.clone();
            near.sort_by(|a, b| away(*a).total_cmp(&away(*b)));
            let meets = |next: &Complex<f64>| {
                modulus(near[0] * next - one) <= slack && away(near[0]) * away(*next) <= 4.0 * PARABOLIC
            };
            away(near[0]) <= PARABOLIC || near.get(1).is_some_and(meets)
        };
        let stable = (!is_at(one) && !is_at(-one)).then_some(inside);
        let residue = has_angle.then(|| 0.25 * (2.0 - pair(&values).re));
        values.extend(std::iter::repeat_n(one, ones));
        sort_eigenvalues(&mut values);
        residue.is_none_or(f64::is_finite).then_some(Self { eigenvalues: values, residue, stable, tests })
    }

    /// A function that changes sign at this change of stability.
    pub(super) fn test(&self, kind: Bifurcation) -> f64 {
        let [one, minus_one, pair] = self.tests;
        match kind {
            Bifurcation::Fold | Bifurcation::Pitchfork => one,
            Bifurcation::PeriodDoubling => minus_one,
            Bifurcation::NeimarkSacker => pair,
        }
    }

    /// Largest modulus.
    pub fn spectral_radius(&self) -> f64 {
        self.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max)
    }
}

/// The matrix whose eigenvalues are the roots of a polynomial with the leading coefficient 1, its constant one first.
fn companion(polynomial: &[f64]) -> DMatrix<f64> {
    let degree = polynomial.len() - 1;
    DMatrix::from_fn(degree, degree, |row, column| match row {
        0 => -polynomial[degree - 1 - column],
        _ => f64::from(u8::from(column + 1 == row)),
    })
}

/// Share of the largest singular value up to which one of a power of A − 1 is 0.
const NULL: f64 = 1e-11;

/// Multiplicity of the eigenvalue 1 of A: the dimension of the null space of powers of A − 1, as long as it grows.
fn multiplicity(less: &DMatrix<f64>) -> usize {
    let (mut power, mut count) = (less.clone(), 0);
    loop {
        let values = power.singular_values();
        let largest = values.max().max(1.0);
        let null = values.iter().filter(|value| **value <= NULL * largest).count();
        if null <= count {
            return count;
        }
        (power, count) = (&power * less, null);
    }
}

/// λ + λ' of the pair that belongs to the angle: the complex one, or that whose product is nearest to 1, as it is exactly
/// where the orbit is its own reverse.
fn pair(roots: &[Complex<f64>]) -> Complex<f64> {
    let away = |one: usize, other: usize| {
        let complex = roots[one].im != 0.0 && roots[other].im == -roots[one].im;
        if complex { -1.0 } else { modulus(roots[one] * roots[other] - Complex::new(1.0, 0.0)) }
    };
    let (one, other) = pairs(roots.len()).min_by(|x, y| away(x.0, x.1).total_cmp(&away(y.0, y.1))).unwrap_or((0, 1));
    roots[one] + roots[other]
}

/// Every pair of places below `count`, the first before the second.
fn pairs(count: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..count).flat_map(move |one| (one + 1..count).map(move |other| (one, other)))
}
