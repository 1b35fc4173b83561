//! The normal form of the return map where small deviations change at a limit of a number ν: does the motion beyond it stay small?
//!
//! An eigenvalue λ of the map is on the unit circle there. For a pair that is the normal form of the swing ([`crate::analysis::swing`]). For λ = ±1
//! with right and left vectors q and p the map has, on the centre manifold s* + ξq + ξ²h, the image λξq + ξ²h + ξ³T, with
//!
//! (1 − A)h = ½B(q, q) beside the neutral directions (Y. A. Kuznetsov, Elements of Applied Bifurcation Theory, § 5.4).
//!
//! Along the neutral directions h has what keeps the kept quantities to second order: k·h + ½Q(q, q) = 0. Q is that of the energy, if strikes keep
//! it. At a double eigenvalue −1, with Aq₁ = −q₁ + q, it follows from the map: Q(q, q) = k·B(q, q₁). New orbits branch off along
//! ν − ν_c = γξ², γ = −p·T/p·A_νq, with A_ν the derivative of A along the bounces that repeat. Third derivatives come from dual numbers over
//! dual numbers over dual numbers ([`ThirdOrder`]).

use crate::analysis::jacobian::modulus;
use crate::analysis::limits::Parameter;
use crate::analysis::periodic_orbits::multipliers::Bifurcation;
use crate::analysis::repeating::{RepeatingBounce, energy_gradient, keeps_energy};
use crate::analysis::return_map::{ARC, Y_DOT};
use crate::analysis::swing::{SwingForm, bilinear, paired, split};
use crate::map::body::Body;
use crate::numbers::dual::ThirdOrder;
use crate::numbers::number::Arithmetic;
use crate::scene::{GAINS, Scene};
use nalgebra::{Complex, DMatrix, DVector};

/// Distance from the unit circle up to which an eigenvalue is at a limit; a double one is off by the square root of rounding.
const AT_LIMIT: f64 = 1e-6;

/// p·q of vectors of length 1, in scaled components, up to which an eigenvalue counts as double.
const DOUBLE: f64 = 1e-6;

/// Share of the parts of a coefficient up to which it is rounding.
const ROUNDING: f64 = 1e-9;

/// Normal form at a limit. ξ is the largest angle of the swing, rad, or the change of ẏ where the angle takes no part, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalForm {
    /// Bifurcation.
    pub bifurcation: Bifurcation,
    /// ℓ of dξ/dn = ℓξ³ at the limit, per bounce and ξ²; infinite at a double eigenvalue.
    pub growth: f64,
    /// γ of the branch ν − ν_c = γξ².
    pub branch: f64,
    /// Change of ν_c by kept quantities that the motion moves, a bounce and ξ²; 0 where none is moved.
    pub pumped: f64,
}

/// A vector of the components of the map.
type Found = Result<DVector<f64>, &'static str>;

/// Right and left vector of a critical eigenvalue 1.
type AtOne<'a> = Option<(&'a DVector<f64>, &'a DVector<f64>)>;

/// A scene's map at a limit of a number.
struct Critical<'a> {
    bounce: &'a RepeatingBounce,
    /// The body with the number as Y.
    body: Body<ThirdOrder<2>>,
}

impl CriticalForm {
    /// The form at a bounce of a scene that has the critical value of a number, for the eigenvalue near to one on the unit circle, or for the one
    /// nearest to the circle; or a sentence that says why there is none.
    pub fn new(
        scene: &Scene,
        parameter: Parameter,
        bounce: &RepeatingBounce,
        near: Option<Complex<f64>>,
    ) -> Result<Self, &'static str> {
        let away = |value: &Complex<f64>| near.map_or((modulus(*value) - 1.0).abs(), |near| modulus(*value - near));
        let nearest = bounce.eigenvalues.iter().min_by(|one, other| away(one).total_cmp(&away(other)));
        let eigenvalue =
            *nearest.filter(|value| away(value) < AT_LIMIT).ok_or("no eigenvalue is at the unit circle")?;
        let body = scene.body_by(|name, value| match parameter {
            Parameter::Field(moved) if moved == name => ThirdOrder::linear(value, [0.0, 1.0]),
            Parameter::FeedbackFactor if GAINS.contains(&name) => ThirdOrder::linear(value, [0.0, value]),
            Parameter::Field(_) | Parameter::FeedbackFactor => ThirdOrder::from_f64(value),
        });
        let own = &bounce.map.body;
        let body = Body { turning: body.turning.filter(|_| own.turning.is_some()), noise: None, outline: None, ..body };
        let critical = Critical { bounce, body };
        if eigenvalue.im.abs() > AT_LIMIT {
            critical.pair(Complex::new(eigenvalue.re, eigenvalue.im.abs()) / modulus(eigenvalue))
        } else {
            critical.real(eigenvalue.re.signum())
        }
    }
}

impl Critical<'_> {
    /// The image of s* + uX + vY + hX² for the number moved by Y, as coefficients of a monomial.
    fn image(
        &self,
        u: &DVector<f64>,
        v: &DVector<f64>,
        h: &DVector<f64>,
        term: impl Fn(&ThirdOrder<2>) -> f64,
    ) -> Found {
        let RepeatingBounce { map, at, .. } = self.bounce;
        let varied =
            |place: usize, value| ThirdOrder::linear(value, [u[place], v[place]]).plus_quadratic([h[place], 0.0, 0.0]);
        let image = map.expanded(&self.body, at, varied);
        let image = image.ok_or("the map has no third derivatives there")?;
        Ok(DVector::from_iterator(image.len(), image.iter().map(term)))
    }

    /// Rate of A along a direction with the number, by the bounces that repeat: A_νq.
    fn rate(&self, q: &DVector<f64>, critical: AtOne<'_>) -> Found {
        let none = DVector::zeros(q.len());
        let moved = self.image(&none, &none, &none, |it| it.first()[1])?;
        let along = self.solve(&(self.bounce.beside() * moved), critical)?;
        self.image(q, &along, &none, |it| it.value.second()[1])
    }

    /// h with (1 − A)h = right side beside the neutral directions, and beside a critical one of eigenvalue 1.
    fn solve(&self, right: &DVector<f64>, critical: AtOne<'_>) -> Found {
        let size = right.len();
        let mut system = DMatrix::identity(size, size) - self.bounce.matrix_beside();
        let mut rest = right.clone();
        if let Some((q, p)) = critical {
            let overlap = p.dot(q);
            system += q * p.transpose() / overlap;
            rest -= q * (p.dot(right) / overlap);
        }
        system.lu().solve(&rest).ok_or("a second eigenvalue is 1")
    }

    /// The neutral direction that changes the energy most, and the way along it that makes up for second derivatives of the energy, if strikes
    /// keep it.
    fn keeping_energy(&self, second: f64) -> Option<(usize, f64)> {
        if !keeps_energy(&self.bounce.map, &self.bounce.at) {
            return None;
        }
        let gradient = energy_gradient(&self.bounce.map, &self.bounce.at);
        let rates: Vec<f64> = self.bounce.neutral.iter().map(|it| gradient.dot(&it.right) / it.right.amax()).collect();
        let most = (0..rates.len()).max_by(|&one, &other| rates[one].abs().total_cmp(&rates[other].abs()))?;
        Some((most, -second / gradient.dot(&self.bounce.neutral[most].right)))
    }

    /// Second derivative of the energy along a direction.
    fn bend_of_energy(&self, u: &DVector<f64>) -> f64 {
        let rod = &self.bounce.map.body.rod;
        let weight = rod.gravity * rod.contact_distance / (rod.radius_of_gyration * rod.radius_of_gyration);
        let of = [-weight, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
        let components = self.bounce.map.components();
        components.into_iter().enumerate().map(|(place, index)| u[place] * of[index] * u[place]).sum()
    }

    fn pair(&self, eigenvalue: Complex<f64>) -> Result<CriticalForm, &'static str> {
        let form =
            SwingForm::new(self.bounce, eigenvalue).map_err(|_| "the eigenvalue is double or at a strong resonance")?;
        let [u, v] = split(&form.right);
        let kept = self.keeping_energy(self.bend_of_energy(&u) + self.bend_of_energy(&v));
        let growth = form.cubic.re + kept.map_or(0.0, |(n, along)| form.growths[n] * along);
        let rates = [self.rate(&u, None)?, self.rate(&v, None)?];
        let rate = (paired(&form.left, &rates) / form.eigenvalue).re;
        let growth = if growth.abs() <= ROUNDING * modulus(form.cubic) { 0.0 } else { growth };
        Ok(CriticalForm {
            bifurcation: Bifurcation::NeimarkSacker,
            growth,
            branch: -growth / rate,
            pumped: form.pumped() / rate,
        })
    }

    fn real(&self, sign: f64) -> Result<CriticalForm, &'static str> {
        let size = self.bounce.matrix.nrows();
        let shifted = self.bounce.matrix_beside() - DMatrix::identity(size, size) * sign;
        let svd = shifted.clone().try_svd(true, true, f64::EPSILON, 10_000).ok_or("its vectors do not converge")?;
        let (Some(left), Some(right)) = (&svd.u, &svd.v_t) else { return Err("its vectors do not converge") };
        let least = svd.singular_values.imin();
        let (mut q, p) = (right.row(least).transpose(), left.column(least).into_owned());
        let is_double = p.dot(&q).abs() < DOUBLE;
        let map = &self.bounce.map;
        let angle = map.place_of(ARC).map(|arc| q[arc] / map.body.rod.radius_of_gyration);
        let unit = angle.filter(|angle| angle.abs() > ROUNDING).or(map.place_of(Y_DOT).map(|fall| q[fall]));
        q /= unit.filter(|unit| *unit != 0.0).ok_or("neither the angle nor the height takes part")?;
        let critical = (sign > 0.0 && !is_double).then_some((&q, &p));
        if sign > 0.0 && is_double {
            return Err("the eigenvalue 1 is double");
        }
        let none = DVector::zeros(size);
        let half_square = self.image(&q, &none, &none, |it| it.value.second()[0])?;
        let overlap = p.dot(&q);
        let rate = p.dot(&self.rate(&q, critical)?);
        if let Some((q, p)) = critical {
            // Fixed points turn back where the quadratic term stays.
            let quadratic = p.dot(&half_square);
            if quadratic.abs() > ROUNDING * p.dot(&self.image(q, &none, &none, |it| it.third()[0])?).abs() {
                let growth = (quadratic / overlap).abs();
                return Ok(CriticalForm { bifurcation: Bifurcation::Fold, growth, branch: f64::NAN, pumped: 0.0 });
            }
        }
        let mut bend = self.solve(&(self.bounce.beside() * &half_square), critical)?;
        let second = |one: &DVector<f64>, other: &DVector<f64>| {
            bilinear(self.bounce, one, other).ok_or("the map has no second derivatives there")
        };
        if let Some((n, along)) = self.keeping_energy(0.5 * self.bend_of_energy(&q)) {
            bend += &self.bounce.neutral[n].right * along;
        } else if is_double {
            // A part of q₁ along q changes nothing, since the quantities are kept.
            let next = svd.solve(&q, ROUNDING)?;
            let mixed = second(&q, &next)?;
            for neutral in &self.bounce.neutral {
                bend -= &neutral.right * (0.5 * neutral.left.dot(&mixed));
            }
        }
        let cubic = p.dot(&self.image(&q, &none, &bend, |it| it.third()[0])?);
        let noise = ROUNDING * q.amax() * q.amax() / self.bounce.at[Y_DOT].abs();
        let mut pumped = 0.0;
        for neutral in &self.bounce.neutral {
            let shift = neutral.left.dot(&half_square);
            if shift.abs() > noise * neutral.left.amax() {
                pumped += shift * p.dot(&second(&q, &neutral.right)?) / rate;
            }
        }
        Ok(CriticalForm {
            bifurcation: if sign < 0.0 { Bifurcation::PeriodDoubling } else { Bifurcation::Pitchfork },
            growth: if is_double { f64::INFINITY } else { sign * cubic / overlap },
            branch: -cubic / rate,
            pumped,
        })
    }
}
