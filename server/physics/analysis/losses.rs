//! Loss of stability at the ends of the stable range of a gain. A soft loss leads to a small swing that grows with the distance from the end.
//! After a hard loss the body falls from every small deviation.
//!
//! At each end an eigenvalue of the map is on the unit circle, and the normal form there decides ([`crate::analysis::normal_form`]). For the
//! tilt gain that is C of [`BoundaryCoefficient`]. Not here: the ends themselves ([`crate::analysis::linear_verdict`],
//! [`crate::analysis::gain_range`], [`crate::analysis::limits`]).

use crate::analysis::boundary::BoundaryCoefficient;
use crate::analysis::fixed_point::{FixedPoint, is_plain};
use crate::analysis::gain_range::{StableGains, stable_gains};
use crate::analysis::jacobian::modulus;
use crate::analysis::limits::{Limit, LimitKind, Limits, Moving, NoLimits, Parameter, Place, limits_of};
use crate::analysis::linear_verdict::PARABOLIC;
use crate::analysis::normal_form::CriticalForm;
use crate::analysis::periodic_orbits::branch::Bifurcation;
use crate::analysis::repeating;
use crate::analysis::return_map::{ReturnMap, Y_DOT};
use crate::analysis::small_deviations::{Motion, SmallDeviations};
use crate::scene::{Name, Scene};
use nalgebra::Complex;

/// Largest modulus of an eigenvalue of the angle, over two bounces of different height, for which the angle counts as bounded.
const CIRCLING: f64 = 1.0 + 1e-7;

/// Most values of a gain that a search of its ends tries.
pub const MOST_VALUES: u64 = 300;

/// Number of gains of a scene whose ends may have to be searched.
pub fn searched_gains(scene: &Scene) -> u64 {
    let model = scene.model();
    if is_plain(&scene.with_tilt_law()) || scene.has_noise() {
        return 0;
    }
    u64::from(!model.is_point) + u64::from(model.rod.strike_gain_per_energy != 0.0)
}

/// Parameter whose stable range ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CriticalParameter {
    /// κ_c, the upper end of the tilt gain.
    TiltGain,
    /// The upper end of the energy gain.
    EnergyGain,
    /// A factor on the gains of the state feedback.
    FeedbackFactor,
}

impl CriticalParameter {
    /// Name in answers: the dotted name of a field of the scene, or of the group that the factor is on.
    pub fn name(self) -> &'static str {
        match self {
            Self::TiltGain => Name::TiltGain.row().path,
            Self::EnergyGain => Name::EnergyGain.row().path,
            Self::FeedbackFactor => "table.feedback",
        }
    }
}

/// The motion on which a scene beyond a soft end settles, by the normal form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SettledMotion {
    /// A swing with this largest |θ|, rad.
    Swing(f64),
    /// Bounces of two alternating heights.
    Heights {
        /// Apex heights of the centre of gravity, m, the lower one first.
        heights: [f64; 2],
        /// True if the angle stays bounded, by the eigenvalues over two bounces.
        angle_bounded: bool,
    },
}

/// Loss of stability at an end of the stable range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityLoss {
    /// The parameter whose range ends.
    pub end: CriticalParameter,
    /// Critical value: κ, κ_E (s²/m²) or the factor on the gains.
    pub value: f64,
    /// Bifurcation by which eigenvalues leave the unit circle there.
    pub bifurcation: Bifurcation,
    /// The coefficient whose sign decides; positive for a soft loss. It is C for the tilt gain, in s²/m² of the bounce speed for
    /// the energy gain, and per bounce and rad² for feedback.
    pub coefficient: f64,
    /// The motion on which this scene settles, if it is beyond a soft end and the normal form gives one.
    pub settles: Option<SettledMotion>,
}

impl StabilityLoss {
    /// `soft`, `hard` or `degenerate`.
    pub fn kind(&self) -> &'static str {
        BoundaryCoefficient { coefficient: self.coefficient }.kind()
    }

    /// C, if this is the loss at κ_c by orbits of two bounces.
    pub fn boundary(&self) -> Option<BoundaryCoefficient> {
        let is_c = self.end == CriticalParameter::TiltGain && self.bifurcation == Bifurcation::PeriodDoubling;
        is_c.then_some(BoundaryCoefficient { coefficient: self.coefficient })
    }

    /// Tells whether the loss is soft.
    pub fn is_soft(&self) -> bool {
        self.coefficient > 0.0
    }
}

/// The losses of stability at the ends of the gains that are known without a search, and notes on those that cannot be derived.
pub fn losses(
    scene: &Scene,
    small: &SmallDeviations,
    boundary: Option<BoundaryCoefficient>,
) -> (Vec<StabilityLoss>, Vec<String>) {
    let (mut found, mut notes) = (Vec::new(), Vec::new());
    let SmallDeviations { fixed_point, linear, .. } = small;
    let mut add = |loss: Result<StabilityLoss, String>| match loss {
        Ok(loss) => found.push(loss.settled(scene, small)),
        Err(why) => notes.push(why),
    };
    let at = |end, value, coefficient| StabilityLoss {
        end,
        value,
        bifurcation: Bifurcation::PeriodDoubling,
        coefficient,
        settles: None,
    };
    let critical = linear.critical_tilt_gain;
    if let Some(BoundaryCoefficient { coefficient }) = boundary.filter(|_| critical.is_finite()) {
        add(Ok(at(CriticalParameter::TiltGain, critical, coefficient)));
    } else if critical > 1.0 && critical.is_finite() && !scene.model().is_point {
        add(loss_at(scene, fixed_point, CriticalParameter::TiltGain, critical));
    }
    if linear.energy_eigenvalue < 1.0 && linear.upper_energy_gain.is_finite() {
        add(match boundary {
            // The speeds of upright bounces follow u ↦ u(1 + ½K(V² − u²)), K = (1 + e)κ_E, which doubles its period at KV² = 2 with 4K = 8/V².
            Some(_) => {
                let coefficient = 8.0 / (fixed_point.speed * fixed_point.speed);
                Ok(at(CriticalParameter::EnergyGain, linear.upper_energy_gain, coefficient))
            }
            None => loss_at(scene, fixed_point, CriticalParameter::EnergyGain, linear.upper_energy_gain),
        });
    }
    if scene.model().feedback().is_some()
        && let Some(StableGains { lower, upper }) =
            small.on_map(scene).ok().and_then(|(map, bounce)| stable_gains(&map, &bounce))
    {
        let near = if lower > 1.0 {
            [Some(lower), None]
        } else if upper < 1.0 {
            [None, Some(upper)]
        } else {
            [Some(lower), Some(upper)]
        };
        for factor in near.into_iter().flatten().filter(|factor| *factor > 0.0 && factor.is_finite()) {
            add(loss_at(scene, fixed_point, CriticalParameter::FeedbackFactor, factor));
        }
    }
    (found, notes)
}

/// Searches the ends of the gains that are not known without a search, for the linear verdict, and the losses there. `None` once `go_on` returned
/// false.
pub fn search_ends(
    scene: &Scene,
    small: &mut SmallDeviations,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<(Vec<StabilityLoss>, Vec<String>)> {
    let (mut found, mut notes, mut ends) = (Vec::new(), Vec::new(), Vec::new());
    let model = scene.model();
    let is_known = small.is_closed()
        || model.is_point
        || small.on_map(scene).is_ok_and(|(map, bounce)| stable_gains(&map, &bounce).is_some());
    if !is_known {
        let of_tilt = model.feedback().map_or(CriticalParameter::TiltGain, |_| CriticalParameter::FeedbackFactor);
        ends.push(of_tilt);
    }
    if model.rod.strike_gain_per_energy != 0.0 && small.linear.upper_energy_gain.is_infinite() {
        ends.push(CriticalParameter::EnergyGain);
    }
    for end in ends {
        let mut tried = 0;
        let limits = limits_of(scene, end.parameter(), &mut || {
            tried += 1;
            tried <= MOST_VALUES && go_on()
        });
        let limits = match limits {
            Ok(limits) => limits,
            Err(NoLimits::Stopped) if tried > MOST_VALUES => {
                notes.push(end.note(&format!("its end is not found within {MOST_VALUES} values")));
                continue;
            }
            Err(NoLimits::Stopped) => return None,
            Err(NoLimits::NoNumber) => continue,
        };
        let Limits { bounded, lower, upper, .. } = limits;
        if bounded && end == CriticalParameter::TiltGain {
            small.linear.lower_tilt_gain = lower.as_ref().map_or(f64::NEG_INFINITY, |limit| limit.value);
            small.linear.critical_tilt_gain = upper.as_ref().map_or(f64::INFINITY, |limit| limit.value);
        }
        if end == CriticalParameter::FeedbackFactor {
            // Outside the range the near end.
            let (lower, upper) = if bounded { (&lower, &upper) } else { (&upper, &lower) };
            let value = |limit: &Option<Limit>, none: f64| limit.as_ref().map_or(none, |limit| limit.value);
            let (lower, upper) = (value(lower, f64::NEG_INFINITY), value(upper, f64::INFINITY));
            small.feedback_range = Some(StableGains { lower, upper });
        }
        if let (true, CriticalParameter::EnergyGain, Some(upper)) = (bounded, end, &upper) {
            small.linear.upper_energy_gain = upper.value;
        }
        // Gains that do not feed back a state have one end, below which nothing settles.
        let one_end = end != CriticalParameter::FeedbackFactor;
        let near = match (one_end, bounded) {
            (true, true) => [None, upper],
            (true, false) => [lower, None],
            (false, _) => [lower, upper],
        };
        for limit in near.into_iter().flatten() {
            match end.loss_at_limit(scene, &limit) {
                Some(Ok(loss)) => found.push(loss.settled(scene, small)),
                Some(Err(why)) => notes.push(why),
                None => {}
            }
        }
    }
    Some((found, notes))
}

impl StabilityLoss {
    /// The same with the motion on which a scene beyond this end settles.
    fn settled(self, scene: &Scene, small: &SmallDeviations) -> Self {
        let settles = match (self.end, small.motion) {
            _ if !self.is_soft() => None,
            (CriticalParameter::EnergyGain, _) => {
                two_heights(scene, &small.fixed_point, 1.0 - small.linear.energy_eigenvalue)
            }
            // The amplitude A solves ln |λ| + ℓA² = 0.
            (CriticalParameter::FeedbackFactor, Motion::Grows(own)) => {
                Some(SettledMotion::Swing((libm::log(own) / self.coefficient).sqrt()))
            }
            (CriticalParameter::TiltGain | CriticalParameter::FeedbackFactor, _) => None,
        };
        Self { settles, ..self }
    }
}

/// The loss where a gain has a critical value, about the bounce of a fixed point.
fn loss_at(
    scene: &Scene,
    fixed_point: &FixedPoint,
    end: CriticalParameter,
    value: f64,
) -> Result<StabilityLoss, String> {
    let place = end.parameter().moved(scene, value).map_err(|why| end.note(&why)).and_then(|there| {
        let map = ReturnMap::new(&there.model(), 1);
        let at = map.vector(&fixed_point.state(), fixed_point.x);
        Place::of(&map, &at, &at).map(|place| (there, place)).map_err(|_| end.note("no bounce repeats there"))
    });
    let (there, place) = place?;
    let near = (end != CriticalParameter::FeedbackFactor).then_some(Complex::new(-1.0, 0.0));
    end.loss(&there, &place, value, near)
}

impl CriticalParameter {
    fn parameter(self) -> Parameter {
        match self {
            Self::TiltGain => Parameter::Field(Name::TiltGain),
            Self::EnergyGain => Parameter::Field(Name::EnergyGain),
            Self::FeedbackFactor => Parameter::FeedbackFactor,
        }
    }

    fn note(self, why: &str) -> String {
        format!("loss_of_stability says nothing of {}: {why}", self.name())
    }

    /// The loss at a limit at which an eigenvalue leaves the unit circle; `None` at others.
    fn loss_at_limit(self, scene: &Scene, limit: &Limit) -> Option<Result<StabilityLoss, String>> {
        let near = match limit.kind {
            LimitKind::PlusOne => Complex::new(1.0, 0.0),
            LimitKind::MinusOne => Complex::new(-1.0, 0.0),
            LimitKind::Pair(value) => value,
            LimitKind::NoBounce(_) | LimitKind::OffTable | LimitKind::NoContact | LimitKind::Refused(_) => return None,
        };
        let (moving, own) = Moving::new(scene, self.parameter());
        let place = moving.at(limit.value, own.as_ref().ok()).map_err(|_| self.note("no bounce repeats there"));
        Some(place.and_then(|place| {
            let there = self.parameter().moved(scene, limit.value).map_err(|why| self.note(&why))?;
            self.loss(&there, &place, limit.value, Some(near))
        }))
    }

    /// The loss at a place of a scene with the critical value, where an eigenvalue is near to one on the unit circle.
    fn loss(
        self,
        scene: &Scene,
        place: &Place,
        value: f64,
        near: Option<Complex<f64>>,
    ) -> Result<StabilityLoss, String> {
        let form = CriticalForm::new(scene, self.parameter(), place, near).map_err(|why| self.note(why))?;
        let CriticalForm { bifurcation, growth, branch, pumped } = form;
        if pumped != 0.0 {
            return Err(self.note("a motion there moves a kept quantity"));
        }
        let coefficient = match self {
            Self::TiltGain => branch / (value - 1.0),
            Self::EnergyGain | Self::FeedbackFactor => -growth,
        };
        if !coefficient.is_finite() {
            return Err(self.note("its normal form has no coefficient"));
        }
        Ok(StabilityLoss { end: self, value, bifurcation, coefficient, settles: None })
    }
}

/// The bounces of two alternating heights beyond the period doubling; `None` if they do not attract. The speeds of upright bounces without
/// air follow u ↦ u(1 + ½K(V² − u²)). With D = 1 + ½KV² those of the two heights are u² = 2s/K and 2/(Ks), s + 1/s = D.
fn two_heights(scene: &Scene, fixed_point: &FixedPoint, loop_gain: f64) -> Option<SettledMotion> {
    let sum = 1.0 + 0.5 * loop_gain;
    if loop_gain <= 2.0 {
        return None;
    }
    let share = 0.5 * (sum + (sum * sum - 4.0).sqrt());
    // 2/K, m²/s².
    let mean = 2.0 * fixed_point.speed * fixed_point.speed / loop_gain;
    let model = scene.model();
    let twice = ReturnMap::new(&model, 2);
    let mut at = twice.vector(&fixed_point.state(), fixed_point.x);
    at[Y_DOT] = -(mean * share).sqrt();
    let bounce = repeating::find(&twice, &at, &at).ok()?;
    let fall = twice.components().iter().position(|&index| index == Y_DOT)?;
    let first = bounce.at[Y_DOT];
    let second = ReturnMap::new(&model, 1).image(&bounce.at)?[Y_DOT];
    if bounce.matrix[(fall, fall)].abs() >= 1.0 || (first - second).abs() <= PARABOLIC * fixed_point.speed {
        return None;
    }
    let height = |y_dot: f64| model.rod.contact_distance + y_dot * y_dot / (2.0 * model.rod.gravity);
    let angle_bounded = bounce.eigenvalues_beside()?.into_iter().all(|value| modulus(value) <= CIRCLING);
    let heights = [height(second), height(first)];
    let heights = if heights[0] <= heights[1] { heights } else { [heights[1], heights[0]] };
    Some(SettledMotion::Heights { heights, angle_bounded })
}
