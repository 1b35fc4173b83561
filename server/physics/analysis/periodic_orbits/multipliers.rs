//! The derivative over a period, judged: eigenvalues, Greene's residue, and whether small deviations stay small.
//!
//! Without energy feedback, one eigenvalue is 1 by the energy and one by the drift. With energy feedback the one of the
//! drift is 1 at the upright bounce and at mirror-symmetric orbits of period 2, and not at others. Such eigenvalues make the matrix
//! defective, so the others come from the characteristic polynomial with those factors divided out, never from an iteration on it.

use crate::analysis::jacobian::{modulus, sort_eigenvalues};
use crate::analysis::linear_verdict::PARABOLIC;
use nalgebra::{Complex, DMatrix, Matrix3, Matrix4, Schur};

/// det(I − M) up to which an eigenvalue of M is 1, for an M of entries about 1.
const ONE: f64 = 1e-11;

/// The slope of the characteristic polynomial at 1, up to which an eigenvalue 1 is double.
const ONE_TWICE: f64 = 1e-9;

/// The eigenvalues of an orbit that are 1 for a reason known beforehand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum TrivialMultipliers {
    /// One of the energy and one of the drift: nothing steers the energy.
    EnergyAndDrift,
    /// At most one, of the drift: with energy feedback.
    Drift,
    /// As many as the derivative has.
    Any,
}

impl TrivialMultipliers {
    /// Those of an orbit with friction, by its derivative: a contact that sticks to a matched table is reversible, as one without friction,
    /// and has both; contacts that slide, or stick to a table that only tilts, may have none.
    pub(super) fn with_friction(product: &DMatrix<f64>) -> Self {
        let product = &four(product);
        let trace = product.trace();
        let second = 0.5 * (trace * trace - (product * product).trace());
        let at_one = (Matrix4::identity() - product).determinant();
        // The slope of the characteristic polynomial at 1.
        let slope = 3.0 - 2.0 * trace + second - product.determinant() + at_one;
        let is_double = has_one(product) && slope.abs() <= ONE_TWICE * (1.0 + product.norm_squared());
        if is_double { Self::EnergyAndDrift } else { Self::Drift }
    }
}

/// The verdict on an orbit.
#[derive(Clone, Debug, PartialEq)]
pub struct Multipliers {
    /// All eigenvalues, largest modulus first.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Greene's residue R = (2 − λ − λ')/4 of the pair that belongs to the angle; `None` for a point mass.
    pub residue: Option<f64>,
    /// True if small deviations stay small; `None` on the boundary, where the linear analysis is silent.
    pub stable: Option<bool>,
    /// The test functions of the bifurcations.
    pub(super) tests: TestFunctions,
}

/// The places where eigenvalues cross the unit circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crossing {
    /// An eigenvalue passes 1.
    One,
    /// An eigenvalue passes −1.
    MinusOne,
    /// A complex pair passes the circle.
    ComplexPair,
}

impl Crossing {
    pub(super) const ALL: [Self; 3] = [Self::One, Self::MinusOne, Self::ComplexPair];
}

/// A function for each crossing that changes sign there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TestFunctions {
    at_one: f64,
    at_minus_one: f64,
    complex_pair: f64,
}

impl TestFunctions {
    pub(super) fn value(&self, crossing: Crossing) -> f64 {
        match crossing {
            Crossing::One => self.at_one,
            Crossing::MinusOne => self.at_minus_one,
            Crossing::ComplexPair => self.complex_pair,
        }
    }
}

impl Multipliers {
    /// The verdict on the derivative over a period.
    pub(super) fn new(product: &DMatrix<f64>, known: TrivialMultipliers) -> Option<Self> {
        // The rounding error of the coefficients grows with the entries.
        let slack = 1e-8 + 1e-14 * product.norm_squared();
        if known == TrivialMultipliers::Any {
            return Self::beside(product, multiplicity(product), slack).filter(Self::is_finite);
        }
        let product = &four(product);
        let trace = product.trace();
        let second = 0.5 * (trace * trace - (product * product).trace());
        let found = match known {
            TrivialMultipliers::Drift | TrivialMultipliers::Any if !has_one(product) => {
                Self::beside(&DMatrix::from_fn(4, 4, |row, column| product[(row, column)]), 0, slack)?
            }
            TrivialMultipliers::Drift | TrivialMultipliers::Any => {
                // (λ − 1)(λ³ − aλ² + bλ − c)
                let a = trace - 1.0;
                let b = second - a;
                let c = product.determinant();
                let companion = Matrix3::new(a, -b, c, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0);
                let schur = Schur::try_new(companion, f64::EPSILON, 10_000)?;
                let roots: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
                let tests = TestFunctions {
                    at_one: 1.0 - a + b - c,
                    at_minus_one: 1.0 + a + b + c,
                    complex_pair: 1.0 - b + c * (a - c),
                };
                Self::from_tests(roots.clone(), 0.25 * (2.0 - pair(&roots).re), tests, c.abs() < 1.0, slack)
            }
            TrivialMultipliers::EnergyAndDrift => {
                // (λ − 1)²(λ² − aλ + b)
                let a = trace - 2.0;
                let b = second - 2.0 * a - 1.0;
                let half = 0.5 * a;
                let under = half * half - b;
                let roots = if under < 0.0 {
                    let height = (-under).sqrt();
                    vec![Complex::new(half, height), Complex::new(half, -height)]
                } else {
                    let large = half + if half < 0.0 { -under.sqrt() } else { under.sqrt() };
                    let small = if large == 0.0 { 0.0 } else { b / large };
                    vec![Complex::new(large, 0.0), Complex::new(small, 0.0)]
                };
                let mut all = roots;
                all.push(Complex::new(1.0, 0.0));
                let tests = TestFunctions { at_one: 1.0 - a + b, at_minus_one: 1.0 + a + b, complex_pair: 1.0 - b };
                Self::from_tests(all, 0.25 * (2.0 - a), tests, true, slack)
            }
        };
        Some(found).filter(Self::is_finite)
    }

    fn is_finite(&self) -> bool {
        self.residue.is_none_or(f64::is_finite)
    }

    /// The verdict on a derivative with so many eigenvalues 1 that are not judged: those nearest to it.
    fn beside(product: &DMatrix<f64>, ones: usize, slack: f64) -> Option<Self> {
        let schur = Schur::try_new(product.clone(), f64::EPSILON, 10_000)?;
        let one = Complex::new(1.0, 0.0);
        let mut eigenvalues: Vec<Complex<f64>> = schur.complex_eigenvalues().iter().copied().collect();
        eigenvalues.sort_by(|a, b| modulus(*a - one).total_cmp(&modulus(*b - one)));
        eigenvalues.drain(..ones);
        sort_eigenvalues(&mut eigenvalues);
        let distances =
            |from: Complex<f64>| eigenvalues.iter().map(move |value| from - value).product::<Complex<f64>>();
        let circle: Complex<f64> =
            pairs(eigenvalues.len()).map(|(i, j)| one - eigenvalues[i] * eigenvalues[j]).product();
        // Π(1 + λ) is Π(−1 − λ) with a sign for each.
        let sign = if eigenvalues.len().is_multiple_of(2) { 1.0 } else { -1.0 };
        let tests = TestFunctions {
            at_one: distances(one).re,
            at_minus_one: sign * distances(-one).re,
            complex_pair: circle.re,
        };
        let inside = eigenvalues.iter().all(|value| modulus(*value) <= 1.0 + slack);
        let at = |place: f64| eigenvalues.iter().any(|value| modulus(*value - Complex::new(place, 0.0)) <= PARABOLIC);
        let stable = (!at(1.0) && !at(-1.0)).then_some(inside);
        let residue = has_angle(product).then(|| 0.25 * (2.0 - pair(&eigenvalues).re));
        eigenvalues.extend(std::iter::repeat_n(one, ones));
        sort_eigenvalues(&mut eigenvalues);
        Some(Self { eigenvalues, residue, stable, tests })
    }

    fn from_tests(roots: Vec<Complex<f64>>, residue: f64, tests: TestFunctions, contracts: bool, slack: f64) -> Self {
        let mut eigenvalues = roots;
        eigenvalues.push(Complex::new(1.0, 0.0));
        sort_eigenvalues(&mut eigenvalues);
        let TestFunctions { at_one, at_minus_one, complex_pair } = tests;
        let silent = at_one.abs() <= 4.0 * PARABOLIC || at_minus_one.abs() <= 4.0 * PARABOLIC;
        let inside = at_one > 0.0 && at_minus_one > 0.0 && complex_pair >= -slack && contracts;
        Self { eigenvalues, residue: Some(residue), stable: (!silent).then_some(inside), tests }
    }

    /// Largest modulus.
    pub fn spectral_radius(&self) -> f64 {
        self.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max)
    }
}

/// Tells whether a derivative is of a body with an angle; that of a point mass has no more than two velocities and x.
fn has_angle(product: &DMatrix<f64>) -> bool {
    product.nrows() >= 4
}

/// A derivative by four components.
fn four(product: &DMatrix<f64>) -> Matrix4<f64> {
    Matrix4::from_fn(|row, column| product[(row, column)])
}

/// Share of the largest singular value up to which one of a power of A − 1 is 0.
const NULL: f64 = 1e-11;

/// Multiplicity of the eigenvalue 1, at most that which leaves two others, or one of a point mass: the dimension of the null space of powers of A − 1, as long as it grows.
fn multiplicity(product: &DMatrix<f64>) -> usize {
    let size = product.nrows();
    let less = product - DMatrix::identity(size, size);
    let (mut power, mut count) = (less.clone(), 0);
    loop {
        let values = power.singular_values();
        let largest = values.max().max(1.0);
        let null = values.iter().filter(|value| **value <= NULL * largest).count();
        if null <= count {
            return count.min(size - if has_angle(product) { 2 } else { 1 });
        }
        (power, count) = (&power * &less, null);
    }
}

/// Tells whether an eigenvalue is 1 but for rounding.
fn has_one(product: &Matrix4<f64>) -> bool {
    let distance = (Matrix4::identity() - product).determinant();
    distance.abs() <= ONE * (1.0 + product.norm_squared())
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
