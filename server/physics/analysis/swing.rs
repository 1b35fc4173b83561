//! The normal form of a swing about a repeating bounce: a pair of eigenvalues on the unit circle beside neutral directions.
//!
//! With w the complex amplitude of the swing and μ_j the coordinates along the neutral directions,
//!
//! w′ = λw(1 + d|w|² + Σ b_j μ_j), μ_j′ = μ_j + a_j|w|²,
//!
//! since |w|² resonates with every eigenvalue 1. The coefficients follow from the first three derivatives of the map alone (Y. A. Kuznetsov,
//! Elements of Applied Bifurcation Theory, § 5.4, with the singular inverse taken beside the neutral directions). With Aq = λq, pA = λp,
//! p·q = 1 (no conjugate), k_i·t_j = δ_ij:
//!
//! a_j = k_j·B(q, q̄), b_j = p·B(q, t_j)/λ, h₂₀ = (λ² − A)⁻¹B(q, q), (1 − A)h₁₁ = B(q, q̄) − Σ a_j t_j with k_j·h₁₁ = 0,
//! d = p·(C(q, q, q̄) + 2B(q, h₁₁) + B(q̄, h₂₀))/2λ.
//!
//! Near a root of unity of order n = 3 or 4 a term e_n w̄ⁿ⁻¹ turns nearly as w does ([`Resonance`]):
//!
//! e₃ = p·B(q̄, q̄)/2, e₄ = p·(C(q̄, q̄, q̄) + 3B(q̄, h̄₂₀))/6.

use crate::analysis::jacobian::modulus;
use crate::analysis::repeating::{Neutral, ON_CIRCLE, RepeatingBounce};
use crate::analysis::return_map::{ARC, Vector};
use crate::numbers::dual::{SecondOrder, ThirdOrder};
use crate::numbers::number::Arithmetic;
use nalgebra::{Complex, DMatrix, DVector};

/// Distance of λ, λ² and, where e₃ is not 0, λ³ from 1 up to which the coefficients are not defined.
pub const RESONANT: f64 = 1e-6;

/// Share of a resonance beyond which a normal form does not tell whether a swing leaves: half of the least at which one may.
const LARGEST_SHARE: f64 = 0.25;

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
    /// |e₃| and |e₄|, per rad and rad².
    resonant: [f64; 2],
}

/// Reason for which there is no such form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSwingForm {
    /// λ is a third of a turn, and the map has a term of w̄².
    Resonance,
    /// The eigenvalue is double, or within rounding of it.
    Double,
    /// The map has no derivative there.
    NoDerivative,
}

/// The strong resonance that a swing feels most.
///
/// With λⁿ = 1 + inδ and δ small, the swings beside the linear one move as dw/dn = iδw + e w̄ⁿ⁻¹. At n = 3 they are bounded within a triangle
/// with corners at |w| = |δ/e|, and its inscribed circle has half that radius. At n = 4 none leaves unless |e| > |d|, and then from
/// |w|² = |δ|/(|d| + |e|) > |δ/2e| on. So a swing does not leave while its share n|e||w|ⁿ⁻²/|λⁿ − 1| is below ½.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resonance {
    /// Order n.
    pub order: u32,
    /// n|e||w|ⁿ⁻²/|λⁿ − 1|.
    pub share: f64,
}

impl Resonance {
    fn of(eigenvalue: Complex<f64>, resonant: [f64; 2], amplitude: f64) -> Option<Self> {
        let found =
            [(3, resonant[0], amplitude), (4, resonant[1], amplitude * amplitude)].map(|(order, term, reach)| Self {
                order,
                share: if term == 0.0 { 0.0 } else { term * reach / detuning(eigenvalue, order) },
            });
        let most = found.into_iter().max_by(|one, other| one.share.total_cmp(&other.share));
        most.filter(|most| most.share > LARGEST_SHARE)
    }

    /// The resonance of a swing of this amplitude about a bounce, if it is felt. It needs no neutral directions.
    pub fn about(bounce: &RepeatingBounce, eigenvalue: Complex<f64>, amplitude: f64) -> Option<Self> {
        let pair = match Pair::new(bounce, eigenvalue) {
            Err(NoSwingForm::Resonance) => return Some(Self { order: 3, share: f64::INFINITY }),
            pair => pair.ok()?,
        };
        let (_, fourth) = pair.cubic(bounce, &DVector::zeros(pair.right.len()))?;
        Self::of(eigenvalue, [pair.third, fourth].map(modulus), amplitude)
    }
}

/// |λⁿ − 1|/n: how far a swing turns beside a strong resonance of order n a bounce, rad.
fn detuning(eigenvalue: Complex<f64>, order: u32) -> f64 {
    modulus(eigenvalue.powu(order) - Complex::new(1.0, 0.0)) / f64::from(order)
}

/// The map along a pair of eigenvalues up to second order, with |w| the largest angle: 2|q_θ| = 1.
struct Pair {
    /// q.
    right: Direction,
    /// p.
    left: Direction,
    /// The second derivatives B(u, u)/2, B(u, v) and B(v, v)/2.
    second: [DVector<f64>; 3],
    /// h₂₀.
    square: Direction,
    /// e₃; exactly 0 where it is rounding, as mirror symmetry leaves it.
    third: Complex<f64>,
}

/// q and p of an eigenvalue.
fn directions(bounce: &RepeatingBounce, eigenvalue: Complex<f64>) -> Option<(Direction, Direction)> {
    let RepeatingBounce { map, matrix, .. } = bounce;
    let (q, p) = eigenvectors(matrix, eigenvalue)?;
    let scale = 0.5 * map.body.rod.radius_of_gyration / modulus(q[map.place_of(ARC)?]);
    Some((q * Complex::new(scale, 0.0), p / Complex::new(scale, 0.0)))
}

/// |w| of a state by a pair of eigenvalues, rad, to first order.
pub fn amplitude_of(bounce: &RepeatingBounce, eigenvalue: Complex<f64>, state: &Vector) -> Option<f64> {
    directions(bounce, eigenvalue).map(|(_, left)| amplitude(&left, bounce, state))
}

impl Pair {
    fn new(bounce: &RepeatingBounce, eigenvalue: Complex<f64>) -> Result<Self, NoSwingForm> {
        let RepeatingBounce { map, matrix, .. } = bounce;
        let square = eigenvalue * eigenvalue;
        let away = |power: Complex<f64>| modulus(power - Complex::new(1.0, 0.0));
        if away(eigenvalue) < RESONANT || away(square) < RESONANT {
            return Err(NoSwingForm::Double);
        }
        let arc = map.place_of(ARC).ok_or(NoSwingForm::NoDerivative)?;
        let (right, left) = directions(bounce, eigenvalue).ok_or(NoSwingForm::Double)?;
        let [u, v] = split(&right);
        let second = quadratic(bounce, [&u, &v]).ok_or(NoSwingForm::NoDerivative)?;
        // B(q, q).
        let own = (&second[0] - &second[2]) * 2.0;
        let own = DVector::from_fn(own.len(), |n, _| Complex::new(own[n], 2.0 * second[1][n]));
        let third: Complex<f64> =
            left.iter().zip(own.iter()).map(|(p, own)| p * own.conj()).sum::<Complex<f64>>() * 0.5;
        let is_rounding = modulus(third) <= ROUNDING * modulus(left[arc]) * own.camax();
        let third = if is_rounding { Complex::new(0.0, 0.0) } else { third };
        if third.norm_sqr() > 0.0 && away(square * eigenvalue) < RESONANT {
            return Err(NoSwingForm::Resonance);
        }
        let size = matrix.nrows();
        let shifted = DMatrix::from_fn(size, size, |row, column| {
            let own = Complex::new(-matrix[(row, column)], 0.0);
            if row == column { own + square } else { own }
        });
        let square = shifted.lu().solve(&own).ok_or(NoSwingForm::Resonance)?;
        Ok(Self { right, left, second, square, third })
    }

    /// λd and e₄: the coefficients of w²w̄ and w̄³, given h₁₁. e₄ does not depend on that.
    fn cubic(&self, bounce: &RepeatingBounce, mixed: &DVector<f64>) -> Option<(Complex<f64>, Complex<f64>)> {
        // s = s* + 2 Re(wq) + h₁₁|w|² + Re(h₂₀w²) with w = X + iY.
        let [u, v] = split(&self.right);
        let RepeatingBounce { map, at, .. } = bounce;
        let image = map.expanded(&map.body.map(ThirdOrder::from_f64), at, |place, value| {
            let Complex { re, im } = self.square[place];
            ThirdOrder::linear(value, [2.0 * u[place], -2.0 * v[place]]).plus_quadratic([
                mixed[place] + re,
                -2.0 * im,
                mixed[place] - re,
            ])
        })?;
        let project = |term: usize| -> Complex<f64> {
            image.iter().zip(self.left.iter()).map(|(image, p)| p * image.third()[term]).sum()
        };
        let [xxx, xxy, xyy, yyy] = std::array::from_fn(project);
        // Of a cubic polynomial of X = (w + w̄)/2 and Y = (w − w̄)/2i.
        let i = Complex::new(0.0, 1.0);
        let own = (xxx * 3.0 + xyy) / 8.0 - i * (xxy + yyy * 3.0) / 8.0;
        Some((own, (xxx - xyy) / 8.0 + i * (xxy - yyy) / 8.0))
    }
}

impl SwingForm {
    /// The normal form at a repeating bounce for an eigenvalue λ on the unit circle, off the real axis.
    pub fn new(bounce: &RepeatingBounce, eigenvalue: Complex<f64>) -> Result<Self, NoSwingForm> {
        let pair = Pair::new(bounce, eigenvalue)?;
        // B(q, q̄).
        let mixed = (&pair.second[0] + &pair.second[2]) * 2.0;
        let noise = ROUNDING * pair.second.iter().map(DVector::amax).fold(0.0, f64::max);
        let shift = |neutral: &Neutral| {
            let shift = neutral.left.dot(&mixed);
            if shift.abs() <= noise * neutral.left.amax() { 0.0 } else { shift }
        };
        let shifts: Vec<f64> = bounce.neutral.iter().map(shift).collect();
        let (size, beside) = (mixed.len(), bounce.beside());
        let less = DMatrix::identity(size, size) - bounce.matrix_beside();
        let h_mixed = less.lu().solve(&(beside * mixed)).ok_or(NoSwingForm::Double)?;
        let (cubic, fourth) = pair.cubic(bounce, &h_mixed).ok_or(NoSwingForm::NoDerivative)?;
        let Pair { right, left, third, .. } = pair;
        let cubic = cubic / eigenvalue;
        let [u, v] = split(&right);
        let growth = |neutral: &Neutral| {
            let parts = [bilinear(bounce, &u, &neutral.right)?, bilinear(bounce, &v, &neutral.right)?];
            Some((paired(&left, &parts) / eigenvalue).re)
        };
        let growths: Option<Vec<f64>> = bounce.neutral.iter().map(growth).collect();
        let growths = growths.ok_or(NoSwingForm::NoDerivative)?;
        let growth = if cubic.re.abs() <= ROUNDING * modulus(cubic) { 0.0 } else { cubic.re };
        let resonant = [third, fourth].map(modulus);
        Ok(Self { eigenvalue, cubic, shifts, growths, growth, right, left, resonant })
    }

    /// The strong resonance of a swing, if it is felt.
    pub fn resonance(&self, amplitude: f64) -> Option<Resonance> {
        Resonance::of(self.eigenvalue, self.resonant, amplitude)
    }

    /// Tells whether a swing of this amplitude locks to a quarter turn and grows there: in dw/dn = iδw + d|w|²w + e₄w̄³ it does where
    /// |e₄||w|² > |δ| + |Im d||w|² and Re d + √(|e₄|² − (Im d)²) > 0. A δ of rounding counts as none.
    pub fn locks(&self, amplitude: f64) -> bool {
        let (term, Complex { re, im }) = (self.resonant[1], self.cubic);
        let (off, square) = (detuning(self.eigenvalue, 4), amplitude * amplitude);
        let is_held = term > im.abs() && (off <= ON_CIRCLE || (term - im.abs()) * square > off);
        is_held && re + (term * term - im * im).sqrt() > 0.0
    }

    /// Re Σ b_j a_j, per bounce² and rad²: above 0 a swing grows by the kept quantities that it pumps.
    pub fn pumped(&self) -> f64 {
        self.shifts.iter().zip(&self.growths).map(|(shift, growth)| shift * growth).sum()
    }

    /// |w| of a state, rad.
    pub fn amplitude(&self, bounce: &RepeatingBounce, state: &Vector) -> f64 {
        amplitude(&self.left, bounce, state)
    }
}

/// |p·(s − s*)|.
fn amplitude(left: &Direction, bounce: &RepeatingBounce, state: &Vector) -> f64 {
    let off = bounce.map.reduced(state) - bounce.map.reduced(&bounce.at);
    modulus(left.iter().zip(off.iter()).map(|(p, off)| p * *off).sum())
}

/// Real and imaginary part of a direction.
pub(crate) fn split(direction: &Direction) -> [DVector<f64>; 2] {
    [direction.map(|part| part.re), direction.map(|part| part.im)]
}

/// p·(u + iv).
pub(crate) fn paired(left: &Direction, [u, v]: &[DVector<f64>; 2]) -> Complex<f64> {
    left.iter().enumerate().map(|(n, p)| p * Complex::new(u[n], v[n])).sum()
}

/// Second derivatives along two directions: the coefficients of X², XY and Y² of the image of s* + uX + vY.
fn quadratic(bounce: &RepeatingBounce, [u, v]: [&DVector<f64>; 2]) -> Option<[DVector<f64>; 3]> {
    let RepeatingBounce { map, at, .. } = bounce;
    let varied = |place: usize, value| SecondOrder::linear(value, [u[place], v[place]]);
    let image = map.expanded(&map.body.map(SecondOrder::from_f64), at, varied)?;
    let terms = |term: usize| image.iter().map(move |component| component.second()[term]);
    Some(std::array::from_fn(|term| DVector::from_iterator(image.len(), terms(term))))
}

/// B(u, v).
pub(crate) fn bilinear(bounce: &RepeatingBounce, u: &DVector<f64>, v: &DVector<f64>) -> Option<DVector<f64>> {
    quadratic(bounce, [u, v]).map(|[_, mixed, _]| mixed)
}

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
