//! Loss of stability at the ends of the stable range of a gain. A soft loss leads to a small swing that grows with the distance from the end.
//! After a hard loss the body falls from every small deviation.
//!
//! At each end an eigenvalue is on the unit circle, and the normal form decides ([`crate::analysis::normal_form`]).
//! For the tilt gain that is C of [`crate::analysis::boundary`].

use crate::analysis::boundary::loss_kind;
use crate::analysis::fixed_point::{FixedPoint, is_plain};
use crate::analysis::gain_range::StableGains;
use crate::analysis::jacobian::modulus;
use crate::analysis::limits::{LimitKind, Limits, NoLimits, Parameter, limits_of};
use crate::analysis::linear_verdict::PARABOLIC;
use crate::analysis::normal_form::CriticalForm;
use crate::analysis::periodic_orbits::multipliers::Bifurcation;
use crate::analysis::repeating::{self, RepeatingBounce, find_planned};
use crate::analysis::return_map::{ReturnMap, Vector, Y_DOT};
use crate::analysis::small_deviations::{Motion, SmallDeviations};
use crate::map::body::Body;
use crate::map::strike::EnergyFeedback;
use crate::scene::Scene;
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
    u64::from(!model.is_point) + u64::from(has_energy_gain(&model))
}

/// Tells whether the law of the energy has a gain.
fn has_energy_gain(body: &Body) -> bool {
    body.rod.strike_gain_per_energy != 0.0 && body.rod.energy_feedback != EnergyFeedback::OneStrike
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
    /// The parameter whose range ends: the tilt gain, the energy gain, or the factor on the feedback.
    pub end: Parameter,
    /// Critical value, as it is told to the table: κ, κ_E (s²/m²) or the factor on the gains.
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
        loss_kind(self.coefficient)
    }

    /// C, if this is the loss at κ_c by orbits of two bounces.
    pub fn boundary(&self) -> Option<f64> {
        let is_c = self.end == Parameter::TILT_GAIN && self.bifurcation == Bifurcation::PeriodDoubling;
        is_c.then_some(self.coefficient)
    }

    /// Tells whether the loss is soft.
    pub fn is_soft(&self) -> bool {
        self.coefficient > 0.0
    }
}

/// Losses that are known, and notes on those that cannot be derived.
type Losses = (Vec<StabilityLoss>, Vec<String>);

/// The losses of stability at the ends of the gains that are known without a search.
pub fn losses(scene: &Scene, small: &SmallDeviations, boundary: Option<f64>) -> Losses {
    let SmallDeviations { fixed_point, linear, .. } = small;
    // Ends with their coefficients in closed form, where they have one.
    let mut ends: Vec<(Parameter, f64, Option<f64>)> = Vec::new();
    let critical = linear.critical_tilt_gain;
    if critical.is_finite() && (boundary.is_some() || (critical > 1.0 && !scene.model().is_point)) {
        ends.push((Parameter::TILT_GAIN, critical / scene.tilt_factor(), boundary));
    }
    if linear.energy_eigenvalue < 1.0 && linear.upper_energy_gain.is_finite() {
        // The speeds of upright bounces follow u ↦ u(1 + ½K(V² − u²)), K = (1 + e)κ_E, which doubles its period at KV² = 2 with 4K = 8/V².
        // With a wrong belief V is another one there.
        let believes = scene.assumed_restitution() == scene.parameters::<f64>().restitution;
        let coefficient = boundary.filter(|_| believes).map(|_| 8.0 / (fixed_point.speed * fixed_point.speed));
        ends.push((Parameter::ENERGY_GAIN, linear.upper_energy_gain / scene.speed_factor(), coefficient));
    }
    if scene.model().feedback().is_some()
        && let Some(StableGains { lower, upper }) = small.found.as_ref().and_then(RepeatingBounce::stable_gains)
    {
        // Outside the range the near end.
        let near = [(lower, lower > 1.0 || upper >= 1.0), (upper, lower <= 1.0)];
        let near = near.into_iter().filter(|(factor, is_near)| *is_near && *factor > 0.0 && factor.is_finite());
        ends.extend(near.map(|(factor, _)| (Parameter::FeedbackFactor, factor, None)));
    }
    let bifurcation = Bifurcation::PeriodDoubling;
    let at = ReturnMap::new(&scene.model(), 1).vector(&fixed_point.state(), fixed_point.x);
    let losses = ends.into_iter().map(|(end, value, coefficient)| match coefficient {
        Some(coefficient) => Ok(StabilityLoss { end, value, bifurcation, coefficient, settles: None }),
        None => {
            let near = (end != Parameter::FeedbackFactor).then_some(Complex::new(-1.0, 0.0));
            loss_at(scene, &at, end, value, near)
        }
    });
    settled(scene, small, losses)
}

/// Searches the ends that closed forms do not give, for the linear verdict, and the losses there; `None` if cancelled.
pub fn search_ends(scene: &Scene, small: &mut SmallDeviations, go_on: &mut dyn FnMut() -> bool) -> Option<Losses> {
    let model = scene.model();
    let is_known = model.is_point || small.found.as_ref().is_none_or(|bounce| bounce.stable_gains().is_some());
    let gain = (!is_known).then(|| model.feedback().map_or(Parameter::TILT_GAIN, |_| Parameter::FeedbackFactor));
    let steers = has_energy_gain(&model) && small.linear.upper_energy_gain.is_infinite();
    let at = small.found.as_ref().map(|bounce| bounce.at);
    let at = at.unwrap_or_else(|| ReturnMap::new(&model, 1).vector(&small.state(), small.fixed_point.x));
    let mut losses = Vec::new();
    for end in gain.into_iter().chain(steers.then_some(Parameter::ENERGY_GAIN)) {
        let mut tried = 0;
        let limits = limits_of(scene, end, &mut || {
            tried += 1;
            tried <= MOST_VALUES && go_on()
        });
        let Limits { bounded, lower, upper, .. } = match limits {
            Ok(limits) => limits,
            Err(NoLimits::Stopped) if tried > MOST_VALUES => {
                losses.push(Err(note(end, &format!("its end is not found within {MOST_VALUES} values"))));
                continue;
            }
            Err(NoLimits::Stopped) => return None,
            Err(NoLimits::NoNumber) => continue,
        };
        // Outside the range the near end.
        let (below, above) = if bounded { (&lower, &upper) } else { (&upper, &lower) };
        let below = below.as_ref().map_or(f64::NEG_INFINITY, |limit| limit.value);
        let above = above.as_ref().map_or(f64::INFINITY, |limit| limit.value);
        match end {
            Parameter::FeedbackFactor => small.feedback_range = Some(StableGains { lower: below, upper: above }),
            Parameter::Field(_) if !bounded => {}
            // Those by which the table acts.
            Parameter::ENERGY_GAIN => {
                let acts = scene.speed_factor();
                (small.linear.lower_energy_gain, small.linear.upper_energy_gain) =
                    (below.max(0.0) * acts, above * acts);
            }
            Parameter::Field(_) => {
                let acts = scene.tilt_factor();
                (small.linear.lower_tilt_gain, small.linear.critical_tilt_gain) = (below * acts, above * acts);
            }
        }
        // Gains that do not feed back a state have one end, below which nothing settles.
        let near = match (end, bounded) {
            (Parameter::FeedbackFactor, _) => [lower, upper],
            (Parameter::Field(_), true) => [None, upper],
            (Parameter::Field(_), false) => [lower, None],
        };
        losses.extend(near.iter().flatten().filter_map(|limit| match limit.kind {
            LimitKind::Eigenvalue(near) => Some(loss_at(scene, &at, end, limit.value, Some(near))),
            _ => None,
        }));
    }
    Some(settled(scene, small, losses))
}

/// Losses with the motions on which a scene beyond them settles.
fn settled(
    scene: &Scene,
    small: &SmallDeviations,
    losses: impl IntoIterator<Item = Result<StabilityLoss, String>>,
) -> Losses {
    let (mut found, mut notes) = Losses::default();
    for loss in losses {
        match loss {
            Ok(loss) => found.push(loss.settled(scene, small)),
            Err(why) => notes.push(why),
        }
    }
    (found, notes)
}

impl StabilityLoss {
    /// The same with the motion on which a scene beyond this end settles.
    fn settled(self, scene: &Scene, small: &SmallDeviations) -> Self {
        let settles = match (self.end, small.motion) {
            _ if !self.is_soft() => None,
            (Parameter::ENERGY_GAIN, _) => two_heights(scene, &small.fixed_point, 1.0 - small.linear.energy_eigenvalue),
            // The amplitude A solves ln |λ| + ℓA² = 0.
            (Parameter::FeedbackFactor, Motion::Grows(own)) => {
                Some(SettledMotion::Swing((libm::log(own) / self.coefficient).sqrt()))
            }
            (Parameter::Field(_) | Parameter::FeedbackFactor, _) => None,
        };
        Self { settles, ..self }
    }
}

fn note(end: Parameter, why: &str) -> String {
    format!("loss_of_stability says nothing of {}: {why}", end.name())
}

/// The loss where a gain has a critical value, about the bounce near a state, whose kept quantities it has, for the eigenvalue near to one on the
/// unit circle or the one nearest to the circle.
fn loss_at(
    scene: &Scene,
    at: &Vector,
    end: Parameter,
    value: f64,
    near: Option<Complex<f64>>,
) -> Result<StabilityLoss, String> {
    let there = end.moved(scene, value).map_err(|why| note(end, &why))?;
    let map = ReturnMap::of_cycle(&there.model());
    let bounce = find_planned(&map, at, at).map_err(|_| note(end, "no bounce repeats there"))?;
    let form = CriticalForm::new(&there, end, &bounce, near).map_err(|why| note(end, why))?;
    let CriticalForm { bifurcation, growth, branch, pumped } = form;
    if pumped != 0.0 {
        return Err(note(end, "a motion there moves a kept quantity"));
    }
    let coefficient = if end == Parameter::TILT_GAIN { branch / (value * scene.tilt_factor() - 1.0) } else { -growth };
    if !coefficient.is_finite() {
        return Err(note(end, "its normal form has no coefficient"));
    }
    Ok(StabilityLoss { end, value, bifurcation, coefficient, settles: None })
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
    let fall = twice.place_of(Y_DOT)?;
    let first = bounce.at[Y_DOT];
    let second = ReturnMap::new(&model, 1).image(&bounce.at)?[Y_DOT];
    if bounce.matrix[(fall, fall)].abs() >= 1.0 || (first - second).abs() <= PARABOLIC * fixed_point.speed {
        return None;
    }
    let height = |y_dot: f64| model.rod.contact_distance + y_dot * y_dot / (2.0 * model.rod.gravity);
    let angle_bounded = bounce.eigenvalues.iter().all(|value| modulus(*value) <= CIRCLING);
    let heights = [height(second), height(first)];
    let heights = if heights[0] <= heights[1] { heights } else { [heights[1], heights[0]] };
    Some(SettledMotion::Heights { heights, angle_bounded })
}
