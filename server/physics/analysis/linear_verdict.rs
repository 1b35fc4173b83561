//! The linear verdict on a bounce that repeats, and its closed form for the plain rod.
//!
//! The angle is judged by Greene's residue R (J. M. Greene, 1979), never by |λ|: at R = 1 a computed double eigenvalue is
//! off by the square root of rounding.

use crate::analysis::contact_regime::{contact_regime, turning_radius_squared};
use crate::analysis::fixed_point::FixedPoint;
use crate::analysis::jacobian::{modulus, sort_eigenvalues};
use crate::map::strike::{EnergyFeedback, Rod};
use crate::scene::Scene;
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
    /// σ, rad per bounce, cos σ = 1 − 2R; where the angle circles.
    pub rotation: Option<f64>,
    /// Eigenvalues of the whole map, largest modulus first; those of what is kept are exactly 1.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Least κ that balances; infinite where none does.
    pub lower_tilt_gain: f64,
    /// κ_c, greatest κ that balances: 1 + Gρ²/(V²l), eq. (18), for every e and κ_E, with ρ² as in the residue; −∞ where none does.
    pub critical_tilt_gain: f64,
    /// Least κ_E that holds the energy, s²/m²; above 0 where the table gives back too little, or so much that a small gain lets the body bounce too high.
    pub lower_energy_gain: f64,
    /// Greatest κ_E that holds the energy, 2/((1 + e)V²), s²/m²; infinite where the law of the energy has no gain, and where it has to be searched.
    pub upper_energy_gain: f64,
    /// 1 − (1 + e)κ_E V², for either measure: both are ½V² + Gl + V δẏ to first order. (e − ê)/(1 + ê) where one strike brings the
    /// energy to its target.
    pub energy_eigenvalue: f64,
}

impl LinearVerdict {
    /// Largest modulus of an eigenvalue beside those of what is kept, which are 1; exactly 1 where the angle circles, whatever rounding says.
    pub fn spectral_radius(&self) -> f64 {
        let angle = match self.class {
            AngleClass::Elliptic | AngleClass::Parabolic => 1.0,
            AngleClass::Attracting | AngleClass::Hyperbolic => {
                let beside = self.eigenvalues.iter().filter(|value| **value != Complex::new(1.0, 0.0));
                beside.copied().map(modulus).fold(0.0, f64::max)
            }
        };
        if self.energy_eigenvalue == 1.0 { angle } else { angle.max(self.energy_eigenvalue.abs()) }
    }

    /// Tells whether a small deviation stays small by this verdict.
    pub fn says_bounded(&self) -> bool {
        matches!(self.class, AngleClass::Attracting | AngleClass::Elliptic)
            && self.energy_eigenvalue.abs() <= 1.0 + PARABOLIC
    }
}

/// The linear verdict about the upright bounce of a plain rod, in closed form: eq. (14) with the energy term.
pub fn linear_verdict(scene: &Scene, fixed_point: &FixedPoint) -> LinearVerdict {
    let speed_squared = fixed_point.speed * fixed_point.speed;
    let Rod { contact_distance, gravity, restitution, tilt_gain, energy_feedback, .. } = scene.running_model.rod;
    let energy_eigenvalue = match energy_feedback {
        EnergyFeedback::Vertical | EnergyFeedback::Total => {
            1.0 - scene.energy_gain() * ((1.0 + restitution) * speed_squared)
        }
        EnergyFeedback::OneStrike => {
            let assumed = scene.assumed_restitution();
            (restitution - assumed) / (1.0 + assumed)
        }
    };
    let real = |value: f64| Complex::new(value, 0.0);
    let (class, residue, mut eigenvalues, [lower_tilt_gain, critical_tilt_gain]) = if scene.is_point() {
        // Eq. (4): the angle of the velocity is multiplied by 1 − 2κ.
        let angle = 1.0 - 2.0 * tilt_gain;
        let class = if angle.abs() < 1.0 { AngleClass::Attracting } else { AngleClass::Hyperbolic };
        (class, None, vec![real(angle)], [0.0, 1.0])
    } else {
        let model = scene.model();
        let turning = turning_radius_squared(&model.rod, contact_regime(&model));
        // a = κ_c − 1.
        let width = gravity * turning / (speed_squared * contact_distance);
        let residue = (tilt_gain - 1.0) / width;
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
        // The last one is that of the drift.
        (class, Some(residue), vec![pair[0], pair[1], real(1.0)], [1.0, 1.0 + width])
    };
    eigenvalues.push(real(energy_eigenvalue));
    sort_eigenvalues(&mut eigenvalues);
    let circles = matches!(class, AngleClass::Elliptic | AngleClass::Parabolic);
    let rotation = residue.filter(|_| circles).map(|residue| libm::acos((1.0 - 2.0 * residue).clamp(-1.0, 1.0)));
    let [lower_energy_gain, upper_energy_gain] = energy_gains(scene, fixed_point, residue);
    LinearVerdict {
        class,
        residue,
        rotation,
        eigenvalues,
        lower_tilt_gain,
        critical_tilt_gain,
        lower_energy_gain,
        upper_energy_gain,
        energy_eigenvalue,
    }
}

/// The least and the greatest energy gain, s²/m², at a bounce whose height moves apart from all else: 0 and 2/((1 + e)V²) where its energy is the target.
/// With a wrong belief V² = A + B/κ_E, so that the eigenvalue of the height is −1 at (2/(1 + e) − B)/A, the body is at rest at −B/A, and the residue, which
/// goes with V², is 1 at B/(V²/R − A). Infinite above where the flight, a delay, a program or a lean takes part, and where the law has no gain.
pub(super) fn energy_gains(scene: &Scene, fixed_point: &FixedPoint, residue: Option<f64>) -> [f64; 2] {
    const NONE: [f64; 2] = [0.0, f64::INFINITY];
    let body = scene.model();
    let falls_freely = body.drag.is_none_or(|drag| drag.linear == 0.0);
    let is_alone =
        falls_freely && !scene.moves_late() && body.program.is_none() && fixed_point.theta.abs() <= PARABOLIC;
    let Rod { contact_distance, gravity, restitution, energy_feedback, .. } = body.rod;
    if !is_alone || energy_feedback == EnergyFeedback::OneStrike {
        return NONE;
    }
    let (square, drift) = (fixed_point.speed * fixed_point.speed, fixed_point.x_dot);
    let held = if energy_feedback == EnergyFeedback::Total { drift * drift } else { 0.0 };
    let aimed = scene.target_height(1).map_or(square, |height| 2.0 * gravity * (height - contact_distance) - held);
    if (square - aimed).abs() <= PARABOLIC * aimed {
        return [0.0, 2.0 / ((1.0 + restitution) * square)];
    }
    let beside = (square - aimed) * scene.energy_gain();
    let of_angle = match residue {
        _ if aimed <= 0.0 || body.feedback().is_some() => return NONE,
        Some(residue) => beside / (square / residue - aimed),
        None if body.is_point => f64::INFINITY,
        None => return NONE,
    };
    let of_angle = if of_angle > 0.0 { of_angle } else { f64::INFINITY };
    let of_height = (2.0 / (1.0 + restitution) - beside) / aimed;
    match beside > 0.0 {
        true => [if of_angle.is_finite() { of_angle } else { 0.0 }, of_height],
        false => [-beside / aimed, of_height.min(of_angle)],
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
