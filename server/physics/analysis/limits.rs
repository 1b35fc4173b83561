//! Limits of any number of a scene: the values nearest to its own at which the motion of small deviations becomes another one.
//!
//! The scene is built with the number moved, and its bounce that repeats is found again, with the drift and the energy that the one of the scene
//! itself has, but for a change of the release. Small deviations stay bounded there while no eigenvalue beside the neutral directions is outside
//! the unit circle. A change of that is bracketed by steps outward, and then found as the root of a test function: det(1 − A), det(1 + A) or
//! Π(1 − λ_iλ_j), each beside the neutral directions (Y. A. Kuznetsov, Elements of Applied Bifurcation Theory, § 10.2). Where no bounce repeats
//! from a value on, that is a limit too.

use crate::analysis::jacobian::modulus;
use crate::analysis::repeating::{
    NoRepeatingBounce, ON_CIRCLE, ON_CIRCLE_TWICE, RepeatingBounce, SceneMap, find_planned, upright,
};
use crate::analysis::return_map::{COMPONENTS, Vector, X};
use crate::analysis::root::{Bracket, root};
use crate::analysis::small_deviations::settled_bounce;
use crate::map::table::control_law::Steering;
use crate::scene::{GAINS, Name, Scene};
use nalgebra::{Complex, DMatrix};
use thiserror::Error;

/// Steps on either side, each twice as far, from 1e-7 of the way on. A change taken back within a step is missed.
const STEPS: u32 = 23;

/// Halvings of a bracket before its test function is chosen.
const HALVINGS: usize = 12;

/// Most further halvings where no test function changes its sign.
const MOST_HALVINGS: usize = 60;

/// The same where no bounce is found beyond, which takes Newton's iteration long: its bounce goes to rest there.
const TO_REST: usize = 8;

/// Distance from ±1 within which two eigenvalues count as one that is double, which rounding moves by its square root.
const DOUBLE: f64 = 1e-6;

/// Rounding of a test function at an eigenvalue on the unit circle, in parts of its estimate.
const OF_ROUNDING: f64 = 1e3;

/// A number of a scene that is moved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// A field.
    Field(Name),
    /// A factor on the four gains of the state feedback.
    FeedbackFactor,
}

/// Way in which small deviations change at a limit.
#[derive(Clone, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum LimitKind {
    /// An eigenvalue is on the unit circle: 1, −1, or of a pair the one above the real axis.
    #[error("{}", passage(*.0))]
    Eigenvalue(Complex<f64>),
    #[error("no bounce repeats: {0}")]
    NoBounce(NoRepeatingBounce),
    #[error("the bounce that repeats is off the table")]
    OffTable,
    #[error("the release comes to no contact")]
    NoContact,
    #[error("{0}")]
    Refused(String),
}

/// A limit of a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Value, in the unit of the field.
    pub value: f64,
    /// Bound on its error.
    pub accuracy: f64,
    /// Change there.
    pub kind: LimitKind,
}

/// Limits of a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Value in the scene.
    pub value: f64,
    /// True if small deviations stay bounded at this value.
    pub bounded: bool,
    /// The nearest limit below; `None` if nothing changes down to the end of the range.
    pub lower: Option<Limit>,
    /// The nearest limit above.
    pub upper: Option<Limit>,
}

/// Reason for which there are no limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoLimits {
    /// The search was cancelled.
    Stopped,
    /// The scene has no such number.
    NoNumber,
}

impl Parameter {
    /// The tilt gain.
    pub const TILT_GAIN: Self = Self::Field(Name::TiltGain);
    /// The energy gain.
    pub const ENERGY_GAIN: Self = Self::Field(Name::EnergyGain);

    /// Name in answers: the dotted name of a field of the scene, or of the group that the factor is on.
    pub fn name(self) -> &'static str {
        match self {
            Self::Field(name) => name.row().path,
            Self::FeedbackFactor => "table.feedback",
        }
    }

    /// Unit; 1 for none.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Field(name) => name.row().unit,
            Self::FeedbackFactor => "1",
        }
    }

    /// The gain of a scene: the tilt gain, or a factor on its state feedback.
    pub fn of_gain(scene: &Scene) -> Self {
        match scene.running_model.steering {
            Steering::Feedback(_) => Self::FeedbackFactor,
            Steering::TiltGain => Self::TILT_GAIN,
        }
    }

    /// Value in a scene; a field of an error that the scene has not is 0.
    pub fn value(self, scene: &Scene) -> Option<f64> {
        match self {
            Self::Field(Name::AssumedRestitution) => Some(scene.assumed_restitution()),
            Self::Field(name) => scene.number(name).or_else(|| {
                let (minimum, maximum) = self.range(scene);
                (scene.value(name).is_none() && minimum < maximum && (minimum..=maximum).contains(&0.0)).then_some(0.0)
            }),
            Self::FeedbackFactor => matches!(scene.running_model.steering, Steering::Feedback(_)).then_some(1.0),
        }
    }

    pub(super) fn range(self, scene: &Scene) -> (f64, f64) {
        match self {
            Self::Field(name) => name.row().range(),
            Self::FeedbackFactor => {
                let most = |name: Name| {
                    Self::Field(name).range(scene).1 / scene.number(name).map_or(f64::MIN_POSITIVE, f64::abs)
                };
                (0.0, GAINS.into_iter().map(most).fold(f64::MAX, f64::min))
            }
        }
    }

    /// The scene with another value, or a sentence that says why there is none.
    pub fn moved(self, scene: &Scene, value: f64) -> Result<Scene, String> {
        match self {
            Self::Field(name) => scene.with([(name, Some(value))]),
            Self::FeedbackFactor => {
                scene.with(GAINS.map(|name| (name, Some(value * scene.number(name).unwrap_or(0.0)))))
            }
        }
    }
}

impl RepeatingBounce {
    pub(super) fn is_bounded(&self) -> bool {
        self.growing().is_none()
    }

    /// The largest eigenvalue outside the unit circle.
    fn growing(&self) -> Option<Complex<f64>> {
        let is_outside = |&(n, value): &(usize, &Complex<f64>)| {
            let near = |(m, other): (usize, &Complex<f64>)| m != n && modulus(*other - *value) <= DOUBLE;
            let is_double = value.im == 0.0 && self.eigenvalues.iter().enumerate().any(near);
            modulus(*value) > 1.0 + if is_double { ON_CIRCLE_TWICE } else { ON_CIRCLE }
        };
        self.eigenvalues.iter().enumerate().find(is_outside).map(|(_, value)| *value)
    }

    /// The test function of an eigenvalue that leaves the unit circle beside so many neutral ones, and its rounding.
    /// With m neutral ones Π(1 ∓ λ) over the others is the coefficient of zᵐ in the characteristic polynomial of 1 ∓ A, but for signs: it
    /// needs no neutral direction, which would be lost where another eigenvalue is close to 1.
    fn test(&self, leaving: Complex<f64>, neutral: usize) -> (f64, f64) {
        let values = &self.eigenvalues;
        if leaving.im != 0.0 {
            let pairs = (0..values.len()).flat_map(|n| (0..n).map(move |m| values[n] * values[m]));
            let (product, size) = pairs.fold((Complex::new(1.0, 0.0), 1.0), |(product, size), pair| {
                (product * (Complex::new(1.0, 0.0) - pair), size * (1.0 + modulus(pair)))
            });
            return (product.re, 4.0 * f64::EPSILON * size);
        }
        let (matrix, sign) = (&self.matrix, leaving.re.signum());
        let shifted = DMatrix::identity(matrix.nrows(), matrix.nrows()) - matrix * sign;
        let coefficients = characteristic(&shifted);
        let product = if sign > 0.0 { coefficients[neutral] } else { coefficients[0] };
        let size: f64 = values.iter().map(|value| 1.0 + modulus(*value)).product();
        (product, 4.0 * f64::EPSILON * size)
    }
}

/// A bounce, or the kind of a limit beyond which there is none.
type Found = Result<RepeatingBounce, LimitKind>;

fn is_bounded(found: &Found) -> Option<bool> {
    found.as_ref().ok().map(RepeatingBounce::is_bounded)
}

/// Scenes along a number.
pub(super) struct Moving<'a> {
    scenes: Box<dyn Fn(f64) -> Result<Scene, String> + 'a>,
    /// Bounce of the scene itself.
    pub(super) own: Found,
    /// That less the upright state of its release; 0 if there is none.
    beside: Vector,
    go_on: &'a mut dyn FnMut() -> bool,
}

/// The limits of a number of a scene, for the map without its noise. `go_on` is asked at each value.
pub fn limits_of(scene: &Scene, parameter: Parameter, go_on: &mut dyn FnMut() -> bool) -> Result<Limits, NoLimits> {
    let value = parameter.value(scene).ok_or(NoLimits::NoNumber)?;
    let (minimum, maximum) = parameter.range(scene);
    let mut moving = Moving::new(scene, parameter, go_on);
    let (lower, upper) = (moving.toward(minimum, value)?, moving.toward(maximum, value)?);
    Ok(Limits { value, bounded: is_bounded(&moving.own) == Some(true), lower, upper })
}

impl<'a> Moving<'a> {
    /// A scene with a number to be moved, about the bounce on which its run settles.
    pub(super) fn new(scene: &'a Scene, parameter: Parameter, go_on: &'a mut dyn FnMut() -> bool) -> Self {
        let settled = |of_scene: &SceneMap| settled_bounce(scene, of_scene).map(|(bounce, _)| bounce);
        Self::about(scene, move |value| parameter.moved(scene, value), settled, go_on)
    }

    pub(super) fn about(
        scene: &Scene,
        scenes: impl Fn(f64) -> Result<Scene, String> + 'a,
        bounce: impl Fn(&SceneMap) -> Result<RepeatingBounce, NoRepeatingBounce>,
        go_on: &'a mut dyn FnMut() -> bool,
    ) -> Self {
        let mut beside = [0.0; COMPONENTS];
        let own = SceneMap::of(scene).map_err(|_| LimitKind::NoContact).and_then(|of_scene| {
            let own = bounce(&of_scene).map_err(LimitKind::NoBounce)?;
            let upright = upright(&of_scene.map, &of_scene.reference);
            beside = std::array::from_fn(|index| own.at[index] - upright[index]);
            Ok(own)
        });
        Self { scenes: Box::new(scenes), own, beside, go_on }
    }

    pub(super) fn bounce(&self, value: f64, near: &Found) -> Found {
        let scene = (self.scenes)(value).map_err(LimitKind::Refused)?;
        let SceneMap { map, reference, guess } = SceneMap::of(&scene).map_err(|_| LimitKind::NoContact)?;
        let upright = upright(&map, &reference);
        let reference = std::array::from_fn(|index| upright[index] + self.beside[index]);
        let found = near.as_ref().ok().and_then(|near| find_planned(&map, &near.at, &reference).ok());
        let bounce = found.map_or_else(|| find_planned(&map, &guess, &reference), Ok).map_err(LimitKind::NoBounce)?;
        if bounce.at[X].abs() > scene.rules().half_length && map.has_place {
            return Err(LimitKind::OffTable);
        }
        Ok(bounce)
    }

    fn at(&mut self, value: f64, near: &Found) -> Result<Found, NoLimits> {
        if (self.go_on)() { Ok(self.bounce(value, near)) } else { Err(NoLimits::Stopped) }
    }

    /// The nearest limit on the way from a value to the end of a range.
    pub(super) fn toward(&mut self, end: f64, from: f64) -> Result<Option<Limit>, NoLimits> {
        let way = end - from;
        if way == 0.0 {
            return Ok(None);
        }
        let of_own = is_bounded(&self.own);
        let mut kept = (from, self.own.clone());
        for step in (0..=STEPS).rev() {
            let value = if step == 0 { end } else { from + way / f64::from(1_u32 << step) };
            let found = self.at(value, &kept.1)?;
            if is_bounded(&found) == of_own {
                kept = (value, found);
                continue;
            }
            if let (Err(kind), true) = (&found, step == STEPS) {
                let accuracy = if matches!(kind, LimitKind::Refused(_)) { 0.0 } else { (value - from).abs() };
                return Ok(Some(Limit { value: from, accuracy, kind: kind.clone() }));
            }
            let mut bracket = Bracket { kept, lost: (value, found) };
            self.halve(&mut bracket, HALVINGS)?;
            // A bounce far from the last one may be missed, and found from near by.
            let again = self.at(value, &bracket.kept.1)?;
            if is_bounded(&again) == of_own {
                kept = (value, again);
                continue;
            }
            return self.narrowed(bracket, from).map(Some);
        }
        Ok(None)
    }

    fn halve(&mut self, bracket: &mut Bracket<Found>, most: usize) -> Result<(), NoLimits> {
        bracket.halve(most, |value, near| {
            let found = self.at(value, near)?;
            let is_kept = is_bounded(&found) == is_bounded(&self.own);
            Ok((found, is_kept))
        })
    }

    fn narrowed(&mut self, mut bracket: Bracket<Found>, from: f64) -> Result<Limit, NoLimits> {
        let growing = |(_, found): &(f64, Found)| found.as_ref().ok().and_then(RepeatingBounce::growing);
        let leaving = |bracket: &Bracket<Found>| growing(&bracket.kept).or_else(|| growing(&bracket.lost));
        if let Some(leaving) = leaving(&bracket) {
            let (nearest, beyond) = ((bracket.kept.0 - from).abs(), (bracket.lost.0 - from).abs());
            if nearest == 0.0 {
                // No value that was tried keeps the motion. The bounce is known to rounding, which may itself slide or stick: none is sought nearer.
                return Ok(Limit { value: from, accuracy: beyond, kind: kind(leaving) });
            }
            if let Some((value, accuracy)) = self.root(&bracket, leaving)? {
                return Ok(Limit { value, accuracy, kind: kind(leaving) });
            }
            if has_left(&self.own, &bracket, leaving) {
                return Ok(Limit { value: from, accuracy: nearest, kind: kind(leaving) });
            }
        }
        let most = if matches!(bracket.lost.1, Err(LimitKind::NoBounce(_))) { TO_REST } else { MOST_HALVINGS };
        self.halve(&mut bracket, most)?;
        let leaving = leaving(&bracket);
        let Bracket { kept: (value, kept), lost: (beyond, lost) } = bracket;
        let kind = match (lost, kept) {
            (Err(why), _) | (_, Err(why)) => why,
            _ => kind(leaving.unwrap_or(Complex::new(1.0, 0.0))),
        };
        Ok(Limit { value, accuracy: (beyond - value).abs(), kind })
    }

    /// Root of a test function in a bracket with a bound on its error; `None` without a root.
    fn root(&mut self, bracket: &Bracket<Found>, leaving: Complex<f64>) -> Result<Option<(f64, f64)>, NoLimits> {
        let Bracket { kept: (one, Ok(first)), lost: (other, Ok(second)) } = bracket else { return Ok(None) };
        let (count, neutral) = (first.matrix.nrows(), first.neutral.len());
        let ((f_first, rounding), (f_second, _)) = (first.test(leaving, neutral), second.test(leaving, neutral));
        let alike = second.matrix.nrows() == count && second.neutral.len() == neutral;
        if !alike || f_first * f_second >= 0.0 {
            return Ok(None);
        }
        let slope = ((f_second - f_first) / (other - one)).abs();
        let mut near = bracket.kept.1.clone();
        let (value, step) = root([(*other, f_second), (*one, f_first)], rounding, |at| {
            let found = self.at(at, &near)?;
            // Close to the root the neutral directions may not be told from the one that joins them.
            let alike = found.as_ref().ok().filter(|bounce| bounce.matrix.nrows() == count);
            let test = alike.map(|bounce| bounce.test(leaving, neutral).0);
            near = found;
            Ok(test)
        })?;
        let accuracy = step + rounding / slope + f64::EPSILON * value.abs();
        Ok(value.is_finite().then_some((value, accuracy)))
    }
}

/// Tells whether an eigenvalue that is on the unit circle at the start of a search has left it where it counts as on the circle, within rounding.
fn has_left(own: &Found, bracket: &Bracket<Found>, leaving: Complex<f64>) -> bool {
    let (Ok(own), Ok(kept), Ok(lost)) = (own, &bracket.kept.1, &bracket.lost.1) else { return false };
    let test = |bounce: &RepeatingBounce| {
        let (value, rounding) = bounce.test(leaving, bounce.neutral.len());
        if value.abs() <= OF_ROUNDING * rounding { 0.0 } else { value }
    };
    test(own) == 0.0 && test(kept) * test(lost) > 0.0
}

/// The kind of a limit at which this eigenvalue leaves the unit circle.
fn kind(leaving: Complex<f64>) -> LimitKind {
    LimitKind::Eigenvalue(if leaving.im == 0.0 {
        Complex::new(leaving.re.signum(), 0.0)
    } else {
        Complex::new(leaving.re, leaving.im.abs()) / modulus(leaving)
    })
}

/// The passage of an eigenvalue in words.
fn passage(value: Complex<f64>) -> &'static str {
    match (value.im == 0.0, value.re > 0.0) {
        (true, true) => "a real eigenvalue passes 1",
        (true, false) => "a real eigenvalue passes -1",
        (false, _) => "a pair of eigenvalues passes the unit circle",
    }
}

/// Coefficients of det(zI − M), the constant one first, by the algorithm of Faddeev and Le Verrier.
pub(super) fn characteristic(matrix: &DMatrix<f64>) -> Vec<f64> {
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
