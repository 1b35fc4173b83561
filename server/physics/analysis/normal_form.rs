//! The normal form of the return map at an upright bounce whose linear map is silent: does a swing grow or shrink to third order?
//!
//! For a pair of eigenvalues e^{±iσ} that is the first Lyapunov coefficient (Y. A. Kuznetsov, Elements of Applied Bifurcation
//! Theory, §§ 5.4 and 7.3); for an eigenvalue ±1 it is the cubic coefficient of its centre manifold (§ 4.5). Second and third
//! derivatives come from truncated Taylor numbers ([`crate::numbers::taylor`]) over the formulas of the bounce.
//!
//! The mirror symmetry (θ, x, ẋ, θ̇) → −(θ, x, ẋ, θ̇) splits the state: these four are *odd*, ẏ alone is *even*. So the centre
//! manifold of an odd direction bends, to second order, along ẏ only; no odd quadratic term exists; and of the strong resonances
//! only those of order 1, 2 and 4 matter. Not here: what is concluded from a coefficient ([`crate::analysis::verdict`]).

use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::jacobian::{eigenvalues, modulus};
use crate::map::body::{Body, PreImpact};
use crate::map::friction::{Slide, actual_branch};
use crate::map::strike::{EnergyFeedback, State};
use crate::map::table::control_law::Steering;
use crate::numbers::number::Arithmetic;
use crate::numbers::taylor::Taylor;
use nalgebra::{Complex, DMatrix, DVector};

/// Distance of λᵏ from 1, for k = 1, 2 and 4, up to which the coefficient of a pair is not defined (strong resonance).
pub const RESONANT: f64 = 1e-6;

/// Share of the cubic coefficient up to which its part that grows or shrinks the swing is rounding.
pub const NEUTRAL: f64 = 1e-9;

/// Steps of inverse iteration for an eigenvector; each gains some six digits.
const ITERATIONS: usize = 4;

/// Distance from an eigenvalue at which inverse iteration solves, as a share of the matrix's largest entry.
const OFFSET: f64 = 1e-8;

/// Cosine of the angle between left and right eigenvector below which the eigenvalue counts as double.
const DEFECTIVE: f64 = 1e-7;

/// One bounce about an upright bounce in place, in any kind of number.
#[derive(Clone, Copy, Debug)]
pub struct UprightBounce {
    /// Without what the fixed point has no need of: a constant tilt, an outline.
    body: Body,
    /// V, m/s.
    speed: f64,
    /// Response of ẏ to itself: λ_E and the coefficients of δẏ² (s/m) and δẏ³ (s²/m²).
    height: [f64; 3],
}

/// Change of a swing in one direction over a bounce, to third order: w ↦ λw(1 + d|w|²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CubicCoefficient {
    /// ℓ of dA/dn = ℓA³ per bounce and rad², A the largest |θ| of the linear swing.
    pub growth: f64,
    /// |d| in the same unit: ℓ is its real part.
    pub size: f64,
    /// A of a swing that starts at the state asked for, rad.
    pub amplitude: f64,
}

impl CubicCoefficient {
    /// ℓ, or exactly 0 where it is rounding.
    pub fn growth_or_zero(&self) -> f64 {
        if self.growth.abs() <= NEUTRAL * self.size { 0.0 } else { self.growth }
    }
}

impl UprightBounce {
    /// The bounce of a model about its fixed point, as one in place: the drift that a table holds is taken off the target energy, and what
    /// it changes in the swing itself is left out.
    ///
    /// # Errors
    /// A sentence that says why it has no third derivatives.
    pub fn of(model: &Body, fixed_point: &FixedPoint) -> Result<Self, String> {
        // A fixed point with a constant tilt is that of a table without it, farther on: x counts from there.
        let Body {
            rod,
            is_point,
            steering,
            constant_tilt: _,
            turning,
            program,
            friction,
            noise,
            lag,
            drag,
            outline: _,
        } = *model;
        let underived = if is_point {
            Some("a point mass has no angle of its own")
        } else if turning.is_some() {
            Some("it is not derived for a table that turns as it strikes")
        } else if drag.is_some() {
            Some("it is not derived for flights through air that drags the body (air.drag, air.rotation_drag)")
        } else if noise.is_some() {
            Some("it is not derived with noise")
        } else if program.is_some() {
            Some("it is not derived for a program of heights")
        } else {
            None
        };
        if let Some(reason) = underived {
            return Err(reason.to_owned());
        }
        if friction.is_some_and(|friction| friction.coefficient != 0.0 && friction.slide == Slide::None) {
            // P_t depends on C²|v_t| there.
            return Err("friction on a table that only tilts has a kink of third order at the fixed point".to_owned());
        }
        let body = Body { steering, friction, lag, ..Body::plain(rod) };
        let mut bounce = Self { body, speed: fixed_point.speed, height: [0.0; 3] };
        // The energy that is held, less that of the drift.
        bounce.body.rod.target_energy -= 0.5 * fixed_point.x_dot * fixed_point.x_dot;
        let (_, y_dot) = bounce.image(&[0.0; 4].map(Taylor::from_f64), Taylor::linear(-bounce.speed, 1.0, 0.0));
        bounce.height = [y_dot.first()[0], y_dot.second()[0], y_dot.third()[0]];
        Ok(bounce)
    }

    /// This bounce with `factor` times the gains of its tilt.
    #[must_use]
    pub fn with_gains_times(mut self, factor: f64) -> Self {
        match self.body.steering {
            Steering::Feedback(gains) => self.body.steering = Steering::Feedback(gains.map(|gain| factor * gain)),
            Steering::TiltGain => self.body.rod.tilt_gain *= factor,
        }
        self
    }

    /// (ρθ, ẋ, ρθ̇, x) and ẏ just before the next contact, from the same before this one; third derivatives are exact.
    fn image(&self, odd: &[Taylor; 4], y_dot: Taylor) -> ([Taylor; 4], Taylor) {
        let body: Body<Taylor> = self.body.map(Taylor::from_f64);
        let [angle, x_dot, spin, x] = *odd;
        let rho = body.rod.radius_of_gyration;
        let state = State { theta: angle / rho, x_dot, y_dot, theta_dot: spin / rho };
        let coming = PreImpact { n: 1, x, state, clearance: Taylor::from_f64(0.0), plan: None };
        let flight = body.rod.flight(&body.strike_deciding(&coming, actual_branch));
        let t = flight.lift_root(2.0 * self.speed / self.body.rod.gravity);
        let State { theta, x_dot, y_dot, theta_dot } = flight.end(t);
        ([rho * theta, x_dot, rho * theta_dot, x + t * x_dot], y_dot)
    }

    /// Number of odd components that act on each other; x is one of them only if it is fed back.
    fn odd_size(&self) -> usize {
        match self.body.steering {
            Steering::Feedback(gains) if gains.x != 0.0 => 4,
            Steering::Feedback(_) | Steering::TiltGain => 3,
        }
    }

    /// The derivative of the odd components (ρθ, ẋ, ρθ̇, and x where it is fed back) by themselves.
    pub fn odd_derivative(&self) -> DMatrix<f64> {
        let size = self.odd_size();
        let column = |n: usize| {
            let odd = std::array::from_fn(|row| Taylor::linear(0.0, f64::from(u8::from(row == n)), 0.0));
            let (image, _) = self.image(&odd, Taylor::from_f64(-self.speed));
            image.map(|component| component.first()[0])
        };
        let columns: Vec<_> = (0..size).map(column).collect();
        DMatrix::from_fn(size, size, |row, n| columns[n][row])
    }

    /// The eigenvalues of the odd components on or above the real axis, largest modulus first, without that of a drift that a state
    /// feedback leaves as it is; `None` if the iteration does not converge.
    pub fn odd_eigenvalues(&self) -> Option<Vec<Complex<f64>>> {
        let mut matrix = self.odd_derivative();
        let drifts = match self.body.steering {
            Steering::Feedback(gains) => gains.x == 0.0 && gains.x_dot == 0.0,
            Steering::TiltGain => self.body.lag != 0.0,
        };
        if drifts && matrix[(0, 1)] == 0.0 && matrix[(2, 1)] == 0.0 {
            matrix = matrix.remove_row(1).remove_column(1);
        }
        let mut values = eigenvalues(&matrix)?;
        values.retain(|value| value.im >= 0.0);
        Some(values)
    }

    /// λ_E, the eigenvalue of ẏ.
    pub fn height_eigenvalue(&self) -> f64 {
        self.height[0]
    }

    /// c of ξ ↦ −ξ + cξ³, s²/m², for the bounce speed where λ_E is −1: with f the map of ẏ, (f″/2)² + f‴/6. Positive is soft.
    pub fn height_flip(&self) -> f64 {
        let [_, second, third] = self.height;
        second * second + third
    }

    /// Tells whether strikes keep the energy, so that the motion stays on a surface of constant energy.
    fn keeps_energy(&self) -> bool {
        self.body.friction.is_none_or(|friction| friction.coefficient == 0.0)
            && self.body.rod.strike_gain == 2.0
            && self.body.rod.strike_gain_per_energy == 0.0
            && self.body.rod.energy_feedback != EnergyFeedback::OneStrike
    }

    /// The cubic coefficient of the direction that belongs to an eigenvalue λ on the unit circle, and the amplitude along it of a
    /// swing through (ρθ, ẋ, ρθ̇, x).
    ///
    /// # Errors
    /// A sentence that says why there is none.
    pub fn cubic(&self, eigenvalue: Complex<f64>, start: [f64; 4]) -> Result<CubicCoefficient, String> {
        let size = self.odd_size();
        let odd_derivative = self.odd_derivative();
        let vectors = eigenvectors(&odd_derivative, eigenvalue);
        let (right, left) = vectors.ok_or("the eigenvalue is double, so it has no normal form of this kind")?;
        // s = 2 Re(wq) with w = X + iY for a pair, s = Xq for a real eigenvalue.
        let pair = eigenvalue.im != 0.0;
        let (along_x, along_y) = if pair { (2.0, -2.0) } else { (1.0, 0.0) };
        let odd: [Taylor; 4] = std::array::from_fn(|n| {
            let part = right.get(n).copied().unwrap_or_default();
            Taylor::linear(0.0, along_x * part.re, along_y * part.im)
        });
        let bend = self.bend(&odd, eigenvalue)?;
        let (image, _) = self.image(&odd, Taylor::linear(-self.speed, 0.0, 0.0).plus_quadratic(bend));
        let project = |part: &dyn Fn(usize) -> f64| -> Complex<f64> {
            (0..size).map(|n| left[n] * Complex::new(part(n), 0.0)).sum()
        };
        let [xxx, xxy, xyy, yyy] = std::array::from_fn(|term| project(&|n| image[n].third()[term]));
        // The coefficient of w²w̄ in a cubic polynomial of X = (w + w̄)/2 and Y = (w − w̄)/2i.
        let resonant = if pair { (xxx * 3.0 + xyy) / 8.0 + (xxy + yyy * 3.0) / Complex::new(0.0, 8.0) } else { xxx };
        let d = resonant / eigenvalue;
        // A = |w| times this.
        let scale = (if pair { 2.0 } else { 1.0 }) * modulus(right[0]) / self.body.rod.radius_of_gyration;
        Ok(CubicCoefficient {
            growth: d.re / (scale * scale),
            size: modulus(d) / (scale * scale),
            amplitude: modulus(project(&|n| start[n])) * scale,
        })
    }

    /// δẏ on the centre manifold, to second order: its coefficients of X², XY and Y².
    fn bend(&self, odd: &[Taylor; 4], eigenvalue: Complex<f64>) -> Result<[f64; 3], String> {
        if self.keeps_energy() {
            // ½(ẋ² + ρ²θ̇²) + ½ẏ² + Gl cos θ = ½V² + Gl.
            let [angle, x_dot, spin, _] = *odd;
            let rho_squared = self.body.rod.radius_of_gyration * self.body.rod.radius_of_gyration;
            let weight = Taylor::from_f64(self.body.rod.gravity * self.body.rod.contact_distance / rho_squared);
            let energy = x_dot * x_dot + spin * spin - weight * angle * angle;
            return Ok(energy.second().map(|term| 0.5 * term / self.speed));
        }
        let height_eigenvalue = self.height_eigenvalue();
        if height_eigenvalue.abs() >= 1.0 - RESONANT {
            return Err(format!(
                "the bounce height neither keeps its energy nor settles (its eigenvalue is {height_eigenvalue})"
            ));
        }
        // h(f(w)) = λ_E h(w) + e(w), term by term.
        let (_, image) = self.image(odd, Taylor::from_f64(-self.speed));
        let [xx, xy, yy] = image.second();
        let real = |value: f64| Complex::new(value, 0.0);
        let square = eigenvalue * eigenvalue - real(height_eigenvalue);
        if eigenvalue.im == 0.0 {
            return Ok([xx / square.re, 0.0, 0.0]);
        }
        // e = e₂w² + ē₂w̄² + e₁|w|² with X and Y as in `cubic`.
        let e_square = Complex::new(0.25 * (xx - yy), -0.25 * xy);
        let e_mixed = 0.5 * (xx + yy);
        let h_square = e_square / square;
        let h_mixed = e_mixed / (modulus(eigenvalue) * modulus(eigenvalue) - height_eigenvalue);
        Ok([h_mixed + 2.0 * h_square.re, -4.0 * h_square.im, h_mixed - 2.0 * h_square.re])
    }
}

/// A complex direction of the odd components.
type Direction = DVector<Complex<f64>>;

/// The right eigenvector of an eigenvalue, and the left one with left·right = 1 (no conjugate); `None` if it is double.
fn eigenvectors(matrix: &DMatrix<f64>, eigenvalue: Complex<f64>) -> Option<(Direction, Direction)> {
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
