//! The normal form of a swing about a repeating bounce: a pair of eigenvalues on the unit circle beside neutral directions.
//!
//! With w the complex amplitude of the swing and μ_j the coordinates along the neutral directions,
//!
//! w′ = λw(1 + d|w|² + Σ b_j μ_j), μ_j′ = μ_j + a_j|w|²,
//!
//! since |w|² resonates with every eigenvalue 1. The coefficients follow from the first three derivatives of the map alone (Y. A. Kuznetsov,
//! Elements of Applied Bifurcation Theory, § 5.4, with the singular inverse bordered by the neutral directions). With Aq = λq, pA = λp,
//! p·q = 1 (no conjugate), k_i·t_j = δ_ij:
//!
//! a_j = k_j·B(q, q̄), b_j = p·B(q, t_j)/λ, h₂₀ = (λ² − A)⁻¹B(q, q), (1 − A)h₁₁ = B(q, q̄) − Σ a_j t_j with k_j·h₁₁ = 0,
//! d = p·(C(q, q, q̄) + 2B(q, h₁₁) + B(q̄, h₂₀))/2λ.

use crate::analysis::jacobian::modulus;
use crate::analysis::repeating::RepeatingBounce;
use crate::analysis::return_map::{ARC, ReturnMap, Vector};
use crate::numbers::number::Arithmetic;
use crate::numbers::taylor::Taylor;
use nalgebra::{Complex, DMatrix, DVector};

/// Distance of λᵏ from 1, for k = 1 to 4 (3 without mirror symmetry alone), up to which the coefficients are not defined (strong resonance).
pub const RESONANT: f64 = 1e-6;

/// Share of |d|, and of the parts of B(q, q̄), up to which a coefficient is rounding.
pub const ROUNDING: f64 = 1e-8;

/// Steps of inverse iteration for an eigenvector; each gains some six digits.
const ITERATIONS: usize = 4;

/// Distance from an eigenvalue at which inverse iteration solves.
const OFFSET: f64 = 1e-8;

/// Cosine of the angle between left and right eigenvector below which the eigenvalue counts as double.
const DEFECTIVE: f64 = 1e-7;

/// Normal form of a swing. |w| is the largest angle of the linear swing, rad.
#[derive(Clone, Debug, PartialEq)]
pub struct SwingForm {
    /// The eigenvalue λ above the real axis.
    pub eigenvalue: Complex<f64>,
    /// d per bounce and rad²: the real part is ℓ of dA/dn = ℓA³ where nothing is neutral.
    pub cubic: Complex<f64>,
    /// Change of each kept quantity a bounce and rad², along its neutral direction; exactly 0 where it is rounding.
    pub shifts: Vec<f64>,
    /// Re b_j: growth of the swing a bounce by a unit of each neutral direction.
    pub growths: Vec<f64>,
    /// Re d, or exactly 0 where it is rounding.
    pub growth: f64,
    /// Right eigenvector q, in the components of the map.
    pub right: DVector<Complex<f64>>,
    /// Left eigenvector p: |p·(s − s*)| is |w|.
    pub(crate) left: DVector<Complex<f64>>,
}

/// Reason for which there is no such form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSwingForm {
    /// λ is at a strong resonance of this order.
    Resonance(u32),
    /// The eigenvalue is double.
    Double,
    /// The map has no derivative there.
    NoDerivative,
}

impl SwingForm {
    /// The normal form at a repeating bounce for an eigenvalue λ on the unit circle, off the real axis.
    ///
    /// # Errors
    /// [`NoSwingForm`].
    pub fn new(map: &ReturnMap, bounce: &RepeatingBounce, eigenvalue: Complex<f64>) -> Result<Self, NoSwingForm> {
        let mut power = eigenvalue;
        let mut is_third = false;
        for order in 1..=4 {
            match modulus(power - Complex::new(1.0, 0.0)) < RESONANT {
                true if order != 3 => return Err(NoSwingForm::Resonance(order)),
                is_resonant => is_third |= is_resonant,
            }
            power *= eigenvalue;
        }
        let rho = map.body().rod.radius_of_gyration;
        let (q, p) = eigenvectors(&bounce.matrix, eigenvalue).ok_or(NoSwingForm::Double)?;
        let arc = map.components().iter().position(|&index| index == ARC).ok_or(NoSwingForm::NoDerivative)?;
        // 2|q_θ| = 1: |w| is the largest angle.
        let scale = 0.5 * rho / modulus(q[arc]);
        let (q, p) = (q * Complex::new(scale, 0.0), p / Complex::new(scale, 0.0));
        let (u, v) = (q.map(|part| part.re), q.map(|part| part.im));
        let second = |one: &DVector<f64>, other: &DVector<f64>| bilinear(map, bounce, one, other);
        let of_pair = quadratic(map, bounce, &u, &v).ok_or(NoSwingForm::NoDerivative)?;
        // B(q, q̄) and B(q, q).
        let mixed = (&of_pair[0] + &of_pair[2]) * 2.0;
        let square = (&of_pair[0] - &of_pair[2]) * 2.0;
        let square = DVector::from_fn(square.len(), |n, _| Complex::new(square[n], 2.0 * of_pair[1][n]));
        // w̄² resonates at order 3, unless the mirror symmetry of the swing leaves no such part.
        let part: Complex<f64> = p.iter().zip(square.iter()).map(|(p, square)| p * square.conj()).sum();
        if is_third && modulus(part) > ROUNDING * modulus(p[arc]) * square.camax() {
            return Err(NoSwingForm::Resonance(3));
        }
        let size = bounce.matrix.nrows();
        let noise = ROUNDING * of_pair.iter().map(DVector::amax).fold(0.0, f64::max);
        let shifts: Vec<f64> = bounce
            .neutral
            .iter()
            .map(|neutral| neutral.left.dot(&mixed))
            .zip(&bounce.neutral)
            .map(|(shift, neutral)| if shift.abs() <= noise * neutral.left.amax() { 0.0 } else { shift })
            .collect();
        let mut rest = mixed.clone();
        for neutral in &bounce.neutral {
            rest -= &neutral.right * neutral.left.dot(&mixed);
        }
        let h_mixed = bordered(&bounce.matrix, bounce, &rest).ok_or(NoSwingForm::Resonance(1))?;
        let shifted = DMatrix::from_fn(size, size, |row, column| {
            let own = Complex::new(-bounce.matrix[(row, column)], 0.0);
            if row == column { own + eigenvalue * eigenvalue } else { own }
        });
        let h_square = shifted.lu().solve(&square).ok_or(NoSwingForm::Resonance(2))?;
        // s = s* + 2 Re(wq) + h₁₁|w|² + Re(h₂₀w²) with w = X + iY.
        let components = map.components();
        let mut start: Vector<Taylor> = bounce.at.map(Taylor::from_f64);
        for (place, &index) in components.iter().enumerate() {
            let (real, imaginary) = (h_square[place].re, h_square[place].im);
            start[index] = Taylor::linear(bounce.at[index], 2.0 * u[place], -2.0 * v[place]).plus_quadratic([
                h_mixed[place] + real,
                -2.0 * imaginary,
                h_mixed[place] - real,
            ]);
        }
        let image = map.image(&start).ok_or(NoSwingForm::NoDerivative)?;
        let project = |term: usize| -> Complex<f64> {
            components.iter().zip(p.iter()).map(|(&index, p)| p * image[index].third()[term]).sum()
        };
        let [xxx, xxy, xyy, yyy] = std::array::from_fn(project);
        // The coefficient of w²w̄ in a cubic polynomial of X = (w + w̄)/2 and Y = (w − w̄)/2i.
        let resonant = (xxx * 3.0 + xyy) / 8.0 + (xxy + yyy * 3.0) / Complex::new(0.0, 8.0);
        let cubic = resonant / eigenvalue;
        let growths = bounce
            .neutral
            .iter()
            .map(|neutral| {
                let (along, across) = (second(&u, &neutral.right)?, second(&v, &neutral.right)?);
                let part: Complex<f64> = p.iter().enumerate().map(|(n, p)| p * Complex::new(along[n], across[n])).sum();
                Some((part / eigenvalue).re)
            })
            .collect::<Option<Vec<f64>>>()
            .ok_or(NoSwingForm::NoDerivative)?;
        let growth = if cubic.re.abs() <= ROUNDING * modulus(cubic) { 0.0 } else { cubic.re };
        Ok(Self { eigenvalue, cubic, shifts, growths, growth, right: q, left: p })
    }

    /// Re Σ b_j a_j, per bounce² and rad²: above 0 a swing grows by the kept quantities that it pumps.
    pub fn pumped(&self) -> f64 {
        self.shifts.iter().zip(&self.growths).map(|(shift, growth)| shift * growth).sum()
    }

    /// |w| of a state, rad.
    pub fn amplitude(&self, map: &ReturnMap, bounce: &RepeatingBounce, state: &Vector) -> f64 {
        let off = map.reduced(state) - map.reduced(&bounce.at);
        modulus(self.left.iter().zip(off.iter()).map(|(p, off)| p * *off).sum())
    }
}

/// Second derivatives along two directions: the coefficients of X², XY and Y² of the image of s* + uX + vY.
fn quadratic(
    map: &ReturnMap,
    bounce: &RepeatingBounce,
    u: &DVector<f64>,
    v: &DVector<f64>,
) -> Option<[DVector<f64>; 3]> {
    let components = map.components();
    let mut start: Vector<Taylor> = bounce.at.map(Taylor::from_f64);
    for (place, &index) in components.iter().enumerate() {
        start[index] = Taylor::linear(bounce.at[index], u[place], v[place]);
    }
    let image = map.image(&start)?;
    Some(std::array::from_fn(|term| {
        DVector::from_iterator(components.len(), components.iter().map(|&index| image[index].second()[term]))
    }))
}

/// B(u, v).
pub(crate) fn bilinear(
    map: &ReturnMap,
    bounce: &RepeatingBounce,
    u: &DVector<f64>,
    v: &DVector<f64>,
) -> Option<DVector<f64>> {
    let [_, mixed, _] = quadratic(map, bounce, u, v)?;
    Some(mixed)
}

/// The solution h of (1 − A)h = right side with k_j·h = 0.
fn bordered(matrix: &DMatrix<f64>, bounce: &RepeatingBounce, right: &DVector<f64>) -> Option<DVector<f64>> {
    let (size, count) = (matrix.nrows(), bounce.neutral.len());
    let mut system = DMatrix::zeros(size + count, size + count);
    for row in 0..size {
        for column in 0..size {
            system[(row, column)] = if row == column { 1.0 } else { 0.0 } - matrix[(row, column)];
        }
    }
    for (n, neutral) in bounce.neutral.iter().enumerate() {
        for row in 0..size {
            system[(row, size + n)] = neutral.right[row];
            system[(size + n, row)] = neutral.left[row];
        }
    }
    let whole = DVector::from_fn(size + count, |row, _| if row < size { right[row] } else { 0.0 });
    let solution = system.lu().solve(&whole)?;
    Some(solution.rows(0, size).into_owned())
}

/// A complex direction.
pub(super) type Direction = DVector<Complex<f64>>;

/// The right eigenvector of an eigenvalue, and the left one with left·right = 1 (no conjugate); `None` if it is double.
pub(super) fn eigenvectors(matrix: &DMatrix<f64>, eigenvalue: Complex<f64>) -> Option<(Direction, Direction)> {
    let right = null_vector(matrix, eigenvalue)?;
    let left = null_vector(&matrix.transpose(), eigenvalue)?;
    let overlap: Complex<f64> = left.iter().zip(right.iter()).map(|(left, right)| left * right).sum();
    (modulus(overlap) > DEFECTIVE).then(|| (right, left.map(|part| part / overlap)))
}

/// A vector of length 1 that (M − λ) takes to nothing, by inverse iteration.
fn null_vector(matrix: &DMatrix<f64>, eigenvalue: Complex<f64>) -> Option<Direction> {
    let size = matrix.nrows();
    let offset = OFFSET * matrix.amax().max(1.0);
    let shifted = matrix.map(|entry| Complex::new(entry, 0.0))
        - DMatrix::identity(size, size) * (eigenvalue + Complex::new(offset, 0.0));
    let factors = shifted.lu();
    let mut vector = DVector::from_fn(size, |row, _| Complex::new(1.0, 0.3 * row as f64));
    for _ in 0..ITERATIONS {
        vector = factors.solve(&vector)?;
        let length = vector.iter().map(|part| part.norm_sqr()).sum::<f64>().sqrt();
        vector = vector.map(|part| part / length);
    }
    vector.iter().all(|part| part.re.is_finite() && part.im.is_finite()).then_some(vector)
}
