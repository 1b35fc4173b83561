//! The linear verdict on a scene in closed form. Not here: the verdict that weighs it against the run
//! ([`crate::analysis::verdict`]).
//!
//! The angle is judged by Greene's residue R (J. M. Greene, 1979), never by |λ|: at R = 1 a computed double eigenvalue is
//! off by the square root of rounding.

use crate::analysis::contact_regime::{
    ContactRegime, DraggedAngle, contact_regime, dragging_turn, sticking_eigenvalues, turning_radius_squared,
};
use crate::analysis::delayed_height::DelayedHeight;
use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::jacobian::{modulus, sort_eigenvalues};
use crate::analysis::upright_in_air::UprightInAir;
use crate::control::bounce_model::{BounceModel, ClosedLoop};
use crate::map::flight::AirDrag;
use crate::map::strike::EnergyFeedback;
use crate::numbers::trig;
use crate::scene::{BodyShape, Scene};
use nalgebra::Complex;

/// |R| or |R − 1| up to which the angle is called parabolic; likewise for the energy eigenvalue at ±1.
pub const PARABOLIC: f64 = 1e-9;

/// Motion of the angle near the fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleClass {
    /// The angle returns to the fixed point.
    Attracting,
    /// The angle circles about it, 0 < R < 1.
    Elliptic,
    /// R = 0 or R = 1: a double eigenvalue ±1, on which the linear analysis is silent.
    Parabolic,
    /// The angle leaves it.
    Hyperbolic,
}

names!(
    AngleClass: Attracting => "attracting", Elliptic => "elliptic", Parabolic => "parabolic", Hyperbolic => "hyperbolic"
);

/// The linear verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearVerdict {
    /// Motion of the angle.
    pub class: AngleClass,
    /// R = (κ − 1)V²l/(Gρ²), with ρ² + l² for ρ² where a matched contact sticks; `None` for a point mass, where the contact sticks to
    /// a table that only tilts, where a turning table drags it, and where the air takes the spin.
    pub residue: Option<f64>,
    /// σ, rad per bounce, cos σ = 1 − 2R; where it is elliptic or parabolic.
    pub rotation: Option<f64>,
    /// Eigenvalues of the whole map, largest modulus first; with state feedback those of the closed loop, without the energy's.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Least κ that balances; infinite where none does.
    pub lower_tilt_gain: f64,
    /// κ_c, greatest κ that balances: 1 + Gρ²/(V²l), eq. (18), for every e and κ_E, with ρ² as in the residue; −∞ where none does.
    pub critical_tilt_gain: f64,
    /// Greatest κ_E that holds the energy, 2/((1 + e)V²), s²/m²; infinite where the law of the energy has no gain.
    pub upper_energy_gain: f64,
    /// 1 − (1 + e)κ_E V², for either measure: both are ½V² + Gl + V δẏ to first order. (e − ê)/(1 + ê) where one strike brings the
    /// energy to its target.
    pub energy_eigenvalue: f64,
    /// Closed loop of the state feedback, if the table has one.
    pub closed_loop: Option<ClosedLoop>,
}

impl LinearVerdict {
    /// Largest modulus of an eigenvalue; exactly 1 where the angle circles, whatever rounding says. With state feedback a height that
    /// nothing steers is left out, which would always be 1.
    pub fn spectral_radius(&self) -> f64 {
        if let Some(closed) = self.closed_loop.as_ref().filter(|_| self.energy_eigenvalue == 1.0) {
            return closed.spectral_radius;
        }
        let angle = match self.class {
            AngleClass::Elliptic | AngleClass::Parabolic => 1.0,
            AngleClass::Attracting | AngleClass::Hyperbolic => {
                self.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max)
            }
        };
        angle.max(self.energy_eigenvalue.abs())
    }

    /// Tells whether a small deviation stays small by this verdict.
    pub fn says_bounded(&self) -> bool {
        matches!(self.class, AngleClass::Attracting | AngleClass::Elliptic)
            && self.energy_eigenvalue.abs() <= 1.0 + PARABOLIC
    }
}

/// The linear verdict about a fixed point, in closed form: eq. (14) with the energy term.
///
/// A state feedback of θ alone is the tilt gain that it is.
pub fn linear_verdict(scene: &Scene, fixed_point: &FixedPoint) -> LinearVerdict {
    let scene = &scene.with_tilt_law();
    let speed_squared = fixed_point.speed * fixed_point.speed;
    let loop_gain = (1.0 + scene.restitution) * speed_squared;
    let (energy_eigenvalue, upper_energy_gain) = match scene.energy_feedback {
        EnergyFeedback::Vertical | EnergyFeedback::Total => (1.0 - scene.energy_gain * loop_gain, 2.0 / loop_gain),
        EnergyFeedback::OneStrike => (one_strike_eigenvalue(scene), f64::INFINITY),
    };
    // κ_E moves the height as well, so its upper end is not derived.
    let (energy_eigenvalue, upper_energy_gain) = match DelayedHeight::of(scene, fixed_point.x_dot) {
        Some(Ok(delayed)) => (delayed.eigenvalue, f64::INFINITY),
        Some(Err(_)) | None => (energy_eigenvalue, upper_energy_gain),
    };
    let in_air = bounce_in_air(scene, fixed_point.speed);
    let (energy_eigenvalue, upper_energy_gain) = match (&in_air, scene.drag()) {
        // The gain moves the height as well.
        (Some(bounce), Some(AirDrag { linear, .. })) if linear != 0.0 => (bounce.eigenvalue, f64::INFINITY),
        _ => (energy_eigenvalue, upper_energy_gain),
    };
    let real = |value: f64| Complex::new(value, 0.0);
    let model = scene.model();
    if let Some(closed) = closed_loop(scene, fixed_point) {
        return LinearVerdict {
            class: if closed.is_stable() { AngleClass::Attracting } else { AngleClass::Hyperbolic },
            residue: None,
            rotation: None,
            eigenvalues: closed.eigenvalues.clone(),
            lower_tilt_gain: f64::INFINITY,
            critical_tilt_gain: f64::NEG_INFINITY,
            upper_energy_gain,
            energy_eigenvalue,
            closed_loop: Some(closed),
        };
    }
    let BodyShape::Rod { contact_distance, .. } = scene.body else {
        // Eq. (4): the angle of the velocity is multiplied by 1 − 2κ.
        let angle = 1.0 - 2.0 * scene.tilt_gain;
        let class = if angle.abs() < 1.0 { AngleClass::Attracting } else { AngleClass::Hyperbolic };
        let mut eigenvalues = vec![real(angle), real(energy_eigenvalue)];
        sort_eigenvalues(&mut eigenvalues);
        return LinearVerdict {
            class,
            residue: None,
            rotation: None,
            eigenvalues,
            lower_tilt_gain: 0.0,
            critical_tilt_gain: 1.0,
            upper_energy_gain,
            energy_eigenvalue,
            closed_loop: None,
        };
    };
    let (rod, regime) = (&model.rod, contact_regime(&model));
    if let Some(bounce) = &in_air {
        return angle_in_air(scene, bounce, regime, (energy_eigenvalue, upper_energy_gain));
    }
    if regime == ContactRegime::Sticking {
        let turned = dragging_turn(&model).and_then(|_| {
            let gain = [0.0, -rod.tilt_gain, 0.0, 0.0];
            BounceModel::rising(&model, fixed_point.speed, 1.0).closed_loop(gain, false)
        });
        let mut eigenvalues = match turned {
            None => sticking_eigenvalues(rod, fixed_point.speed).to_vec(),
            Some(turned) => turned.eigenvalues,
        };
        eigenvalues.push(real(energy_eigenvalue));
        sort_eigenvalues(&mut eigenvalues);
        return LinearVerdict {
            class: AngleClass::Hyperbolic,
            residue: None,
            rotation: None,
            eigenvalues,
            lower_tilt_gain: f64::INFINITY,
            critical_tilt_gain: f64::NEG_INFINITY,
            upper_energy_gain,
            energy_eigenvalue,
            closed_loop: None,
        };
    }
    if let Some(turning) = dragging_turn(&model) {
        let angle = DraggedAngle::new(rod, fixed_point.speed, turning.depth);
        let pair = angle.eigenvalues();
        let mut eigenvalues = vec![pair[0], pair[1], real(1.0), real(energy_eigenvalue)];
        sort_eigenvalues(&mut eigenvalues);
        let decays = pair.into_iter().all(|value| modulus(value) <= 1.0 - PARABOLIC);
        let critical_tilt_gain = angle.critical_tilt_gain;
        return LinearVerdict {
            class: if decays { AngleClass::Attracting } else { AngleClass::Hyperbolic },
            residue: None,
            rotation: None,
            eigenvalues,
            lower_tilt_gain: if critical_tilt_gain > 1.0 { 1.0 } else { f64::INFINITY },
            critical_tilt_gain,
            upper_energy_gain,
            energy_eigenvalue,
            closed_loop: None,
        };
    }
    let turning = turning_radius_squared(rod, regime);
    // a = κ_c − 1.
    let width = scene.gravity * turning / (speed_squared * contact_distance);
    let residue = (scene.tilt_gain - 1.0) / width;
    let class = class(residue);
    let half_trace = 1.0 - 2.0 * residue;
    let pair = match class {
        AngleClass::Parabolic => [real(half_trace.signum()); 2],
        AngleClass::Elliptic => {
            // 1 − (1 − 2R)² without cancellation near R = 0 and R = 1.
            let imaginary = 2.0 * (residue * (1.0 - residue)).sqrt();
            [Complex::new(half_trace, imaginary), Complex::new(half_trace, -imaginary)]
        }
        AngleClass::Attracting | AngleClass::Hyperbolic => {
            let large = half_trace + half_trace.signum() * 2.0 * (residue * (residue - 1.0)).sqrt();
            [real(large), real(1.0 / large)]
        }
    };
    let mut eigenvalues = vec![pair[0], pair[1], real(1.0), real(energy_eigenvalue)];
    sort_eigenvalues(&mut eigenvalues);
    LinearVerdict {
        class,
        residue: Some(residue),
        rotation: matches!(class, AngleClass::Elliptic | AngleClass::Parabolic)
            .then(|| trig::acos(half_trace.clamp(-1.0, 1.0))),
        eigenvalues,
        lower_tilt_gain: 1.0,
        critical_tilt_gain: 1.0 + width,
        upper_energy_gain,
        energy_eigenvalue,
        closed_loop: None,
    }
}

/// 2/((1 + e)V²), s²/m²: the greatest energy gain, at a bounce whose height moves apart from all else. `None` where the flight, a delay, a program
/// or a lean takes part in it.
pub(super) fn upper_energy_gain(scene: &Scene, fixed_point: &FixedPoint) -> Option<f64> {
    let body = scene.model();
    let falls_freely = body.drag.is_none_or(|drag| drag.linear == 0.0);
    let is_alone =
        falls_freely && !scene.moves_late() && body.program.is_none() && fixed_point.theta.abs() <= PARABOLIC;
    let has_gain = body.rod.energy_feedback != EnergyFeedback::OneStrike;
    (is_alone && has_gain).then(|| 2.0 / ((1.0 + scene.restitution) * fixed_point.speed * fixed_point.speed))
}

/// (e − ê)/(1 + ê): the eigenvalue of the energy where one strike brings it to its target.
fn one_strike_eigenvalue(scene: &Scene) -> f64 {
    let assumed = scene.assumed_restitution();
    (scene.restitution - assumed) / (1.0 + assumed)
}

/// The linear model of the upright bounce of a scene that comes down at `speed`, m/s.
pub fn bounce_model(scene: &Scene, speed: f64) -> BounceModel {
    let ratio = bounce_in_air(scene, speed).map_or(1.0, |bounce| bounce.rise / bounce.speed);
    BounceModel::rising(&scene.model(), speed, ratio)
}

/// The closed loop of a scene's state feedback at a bounce in place; `None` without state feedback.
fn closed_loop(scene: &Scene, fixed_point: &FixedPoint) -> Option<ClosedLoop> {
    let gain = scene.model().feedback()?;
    let bounce = bounce_model(scene, fixed_point.speed);
    bounce.closed_loop_of(gain, bounce.fed_back(gain))
}

/// The upright bounce of a scene that comes down at `speed`, m/s, if air drags the body.
fn bounce_in_air(scene: &Scene, speed: f64) -> Option<UprightInAir> {
    UprightInAir::at(&scene.parameters(), scene.drag()?, speed)
}

/// The linear verdict on a tilt gain in air. With w = (U + V)l/ρ² per rad, ρ² + l² where a matched contact sticks, the angle has the derivative
/// ((1 − s_θw(κ − 1), s_θ), (−dw(κ − 1), d)), d = e^(−c_θτ): its determinant is d, and it is stable for 1 < κ < 1 + 2(1 + d)/(s_θw).
fn angle_in_air(
    scene: &Scene,
    bounce: &UprightInAir,
    regime: ContactRegime,
    (energy_eigenvalue, upper_energy_gain): (f64, f64),
) -> LinearVerdict {
    let model = scene.model();
    let rod = &model.rod;
    let UprightInAir { speed, rise, place, turn, .. } = *bounce;
    let turned = (rise + speed) * rod.contact_distance / turning_radius_squared(rod, regime);
    let determinant = turn.left;
    let width = 2.0 * (1.0 + determinant) / (turn.way * turned);
    // The trace is 1 + d − 2(1 + d)R; for d = 1 it is Greene's residue.
    let share = (scene.tilt_gain - 1.0) / width;
    let circles = determinant == 1.0;
    let found = match class(share) {
        AngleClass::Elliptic if !circles => AngleClass::Attracting,
        other => other,
    };
    let half_trace = 0.5 * (1.0 + determinant) * (1.0 - 2.0 * share);
    let square = half_trace * half_trace - determinant;
    let real = |value: f64| Complex::new(value, 0.0);
    let pair = if found == AngleClass::Parabolic && circles {
        [real(half_trace.signum()); 2]
    } else if square < 0.0 {
        let imaginary = (-square).sqrt();
        [Complex::new(half_trace, imaginary), Complex::new(half_trace, -imaginary)]
    } else {
        let large = half_trace + half_trace.signum() * square.sqrt();
        [real(large), real(determinant / large)]
    };
    let mut eigenvalues = vec![pair[0], pair[1], real(place.left), real(energy_eigenvalue)];
    sort_eigenvalues(&mut eigenvalues);
    let rotates = matches!(found, AngleClass::Elliptic | AngleClass::Parabolic) && circles;
    LinearVerdict {
        class: found,
        residue: circles.then_some(share),
        rotation: rotates.then(|| trig::acos((1.0 - 2.0 * share).clamp(-1.0, 1.0))),
        eigenvalues,
        lower_tilt_gain: 1.0,
        critical_tilt_gain: 1.0 + width,
        upper_energy_gain,
        energy_eigenvalue,
        closed_loop: None,
    }
}

/// The class of a residue.
pub fn class(residue: f64) -> AngleClass {
    if residue.abs() <= PARABOLIC || (residue - 1.0).abs() <= PARABOLIC {
        AngleClass::Parabolic
    } else if residue > 0.0 && residue < 1.0 {
        AngleClass::Elliptic
    } else {
        AngleClass::Hyperbolic
    }
}
