//! Loss of stability at the ends of the stable range of the linear verdict. A soft loss leads to a small swing that grows with the
//! distance from the end. After a hard loss the body falls from every small deviation.
//!
//! At each end an eigenvalue of the map is on the unit circle, and the cubic coefficient of its normal form decides
//! ([`crate::analysis::normal_form`]). For the tilt gain that is C of [`BoundaryCoefficient`]. For the energy gain the bounce
//! height doubles its period. For state feedback a pair or a real eigenvalue leaves the circle at a factor on the gains.

use crate::analysis::boundary::BoundaryCoefficient;
use crate::analysis::contact_regime::contact_regime;
use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::jacobian::{eigenvalues, jacobian, modulus};
use crate::analysis::linear_verdict::{LinearVerdict, PARABOLIC};
use crate::analysis::normal_form::UprightBounce;
use crate::analysis::periodic_orbits::branch::Bifurcation;
use crate::control::bounce_model::{BounceModel, STABLE};
use crate::control::margin::critical_factors;
use crate::map::strike::State;
use crate::scene::{Name, Scene};
use nalgebra::{Complex, DMatrix};

/// Largest modulus of an eigenvalue of the angle, over two bounces of different height, for which the angle counts as bounded.
const CIRCLING: f64 = 1.0 + 1e-7;

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

    /// Tells whether the loss is soft.
    pub fn is_soft(&self) -> bool {
        self.coefficient > 0.0
    }
}

/// The losses of stability at the ends of a scene's linear verdict, and notes on those that cannot be derived.
pub fn losses(
    scene: &Scene,
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
    boundary: Option<BoundaryCoefficient>,
) -> (Vec<StabilityLoss>, Vec<String>) {
    let (mut found, mut notes) = (Vec::new(), Vec::new());
    if scene.acting_turn().is_some() {
        notes.push("loss_of_stability is empty: it is not derived for a table that turns as it strikes".to_owned());
        return (found, notes);
    }
    if scene.drag().is_some() {
        notes.push("loss_of_stability is empty: it is not derived in air that drags the body".to_owned());
        return (found, notes);
    }
    if let Some(BoundaryCoefficient { coefficient }) = boundary {
        found.push(StabilityLoss {
            end: CriticalParameter::TiltGain,
            value: linear.critical_tilt_gain,
            bifurcation: Bifurcation::PeriodDoubling,
            coefficient,
            settles: None,
        });
    }
    if linear.energy_eigenvalue < 1.0 && linear.upper_energy_gain.is_finite() {
        found.push(energy_gain(scene, fixed_point, linear));
    }
    if linear.closed_loop.is_some() {
        match feedback(scene, fixed_point) {
            Ok(ends) => found.extend(ends),
            Err(why) => notes.push(format!("loss_of_stability says nothing of table.feedback: {why}")),
        }
    }
    (found, notes)
}

/// The loss at the upper end of κ_E. The speeds of upright bounces follow u ↦ u(1 + ½K(V² − u²)), K = (1 + e)κ_E. This map doubles
/// its period at KV² = 2 with the coefficient 4K = 8/V².
fn energy_gain(scene: &Scene, fixed_point: &FixedPoint, linear: &LinearVerdict) -> StabilityLoss {
    let speed_squared = fixed_point.speed * fixed_point.speed;
    StabilityLoss {
        end: CriticalParameter::EnergyGain,
        value: linear.upper_energy_gain,
        bifurcation: Bifurcation::PeriodDoubling,
        coefficient: 8.0 / speed_squared,
        settles: two_heights(scene, fixed_point, 1.0 - linear.energy_eigenvalue),
    }
}

/// The bounces of two alternating heights beyond the period doubling; `None` if they do not attract. With D = 1 + ½KV² their speeds
/// are u² = 2s/K and 2/(Ks), s + 1/s = D. Over both bounces a deviation is multiplied by 9 − 2D².
fn two_heights(scene: &Scene, fixed_point: &FixedPoint, loop_gain: f64) -> Option<SettledMotion> {
    let sum = 1.0 + 0.5 * loop_gain;
    let multiplier = 9.0 - 2.0 * sum * sum;
    if loop_gain <= 2.0 || multiplier.abs() >= 1.0 {
        return None;
    }
    let share = 0.5 * (sum + (sum * sum - 4.0).sqrt());
    // 2/K, m²/s².
    let mean = 2.0 * fixed_point.speed * fixed_point.speed / loop_gain;
    let (low, high) = (mean / share, mean * share);
    let rod = scene.parameters::<f64>();
    let height = |speed_squared: f64| rod.contact_distance + speed_squared / (2.0 * rod.gravity);
    let state = State { y_dot: -high.sqrt(), ..fixed_point.state() };
    let model = scene.model();
    let angle_bounded = jacobian(&model, &state, 2).ok().and_then(|twice| {
        let odd = odd_part(&twice.matrix, model.feedback().is_some_and(|gain| gain[0] != 0.0));
        Some(eigenvalues(&odd)?.into_iter().all(|value| modulus(value) <= CIRCLING))
    });
    Some(SettledMotion::Heights { heights: [height(low), height(high)], angle_bounded: angle_bounded.unwrap_or(false) })
}

/// A derivative without the row and column of ẏ, and without those of x unless x is fed back.
fn odd_part(matrix: &DMatrix<f64>, with_x: bool) -> DMatrix<f64> {
    let kept: &[usize] = match (matrix.nrows(), with_x) {
        (2, _) => &[0],
        (_, false) => &[0, 1, 3],
        (_, true) => &[0, 1, 3, 4],
    };
    DMatrix::from_fn(kept.len(), kept.len(), |row, column| matrix[(kept[row], kept[column])])
}

/// The losses at the ends of the stable range of a factor on a state feedback. A stable loop gets both ends of its range, an
/// unstable one the near end of an adjacent stable range, if there is one.
fn feedback(scene: &Scene, fixed_point: &FixedPoint) -> Result<Vec<StabilityLoss>, String> {
    let model = scene.model();
    let Some(gain) = model.feedback() else { return Ok(Vec::new()) };
    let bounce = UprightBounce::of(&model, fixed_point)?;
    let start = first_contact(scene)?;
    let linear = BounceModel::new(&model.rod, fixed_point.speed, contact_regime(&model));
    let states = linear.fed_back(gain);
    let mut factors = critical_factors(&linear.part([0.0; 4], states), &linear.part(gain, states));
    factors.retain(|factor| factor.is_finite() && *factor > 0.0);
    factors.extend([0.0, f64::INFINITY]);
    factors.sort_by(f64::total_cmp);
    let radius = |factor: f64| {
        linear.closed_loop_of(gain.map(|gain| factor * gain), states).map_or(f64::INFINITY, |it| it.spectral_radius)
    };
    let is_stable =
        |low: f64, high: f64| radius(if high.is_finite() { 0.5 * (low + high) } else { 2.0 * low + 1.0 }) <= STABLE;
    // The range between adjacent crossings that contains 1.
    let above = factors.partition_point(|factor| *factor <= 1.0).min(factors.len() - 1);
    let (low, high) = (factors[above - 1], factors[above]);
    let ends = if radius(1.0) <= STABLE {
        vec![low, high]
    } else if above >= 2 && is_stable(factors[above - 2], low) {
        vec![low]
    } else if above + 1 < factors.len() && is_stable(high, factors[above + 1]) {
        vec![high]
    } else {
        Vec::new()
    };
    let own = bounce.odd_eigenvalues().and_then(|values| values.first().copied());
    let own = own.filter(|value| modulus(*value) > 1.0 + PARABOLIC);
    ends.into_iter()
        .filter(|factor| *factor > 0.0 && factor.is_finite())
        .map(|factor| feedback_end(&bounce, factor, own, start))
        .collect()
}

/// The loss at one factor; `own` is the eigenvalue of the scene itself that is outside the unit circle, if there is one.
fn feedback_end(
    bounce: &UprightBounce,
    factor: f64,
    own: Option<Complex<f64>>,
    start: [f64; 4],
) -> Result<StabilityLoss, String> {
    let there = bounce.with_gains_times(factor);
    let away = |value: &Complex<f64>| (modulus(*value) - 1.0).abs();
    let nearest = |values: Vec<Complex<f64>>| values.into_iter().min_by(|one, other| away(one).total_cmp(&away(other)));
    let eigenvalue = there.odd_eigenvalues().and_then(nearest).ok_or("its eigenvalues do not converge")?;
    let cubic = there.cubic(eigenvalue, start)?;
    let coefficient = -cubic.growth_or_zero();
    let bifurcation = if eigenvalue.im != 0.0 {
        Bifurcation::NeimarkSacker
    } else if eigenvalue.re < 0.0 {
        Bifurcation::PeriodDoubling
    } else {
        Bifurcation::Pitchfork
    };
    // The amplitude A solves ln |λ| + ℓA² = 0.
    let settles = own
        .filter(|_| coefficient > 0.0)
        .map(|own| SettledMotion::Swing((libm::log(modulus(own)) / coefficient).sqrt()));
    Ok(StabilityLoss { end: CriticalParameter::FeedbackFactor, value: factor, bifurcation, coefficient, settles })
}

/// (ρθ, ẋ, ρθ̇, x) just before the first contact of a scene's run.
fn first_contact(scene: &Scene) -> Result<[f64; 4], String> {
    let orbit = scene.orbit().map_err(|_| "the release comes to no contact".to_owned())?;
    let rho = scene.parameters::<f64>().radius_of_gyration;
    let state = orbit.state();
    Ok([rho * state.theta, state.x_dot, rho * state.theta_dot, orbit.x()])
}
