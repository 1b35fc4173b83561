//! The first Lyapunov coefficient of a bounce whose angle circles while its height settles: is upright weakly repelling or
//! weakly attracting?
//!
//! The linear verdict calls such a bounce elliptic. With energy feedback (eq. 28) that is wrong either way: the loop holds
//! η = Gl cos θ + ẏ²/2, which is not the energy; the swing modulates η at twice its own rotation, the table answers with a lag,
//! and the modulated height pumps or damps the swing. A table that holds the energy itself does nothing of this: ℓ is 0.

use crate::analysis::fixed_point::{FixedPoint, drift_speed};
use crate::analysis::jacobian::modulus;
use crate::analysis::linear_verdict::{AngleClass, LinearVerdict, PARABOLIC};
use crate::analysis::normal_form::{CubicCoefficient, RESONANT, UprightBounce};
use crate::analysis::repeating;
use crate::analysis::return_map::{ARC, ReturnMap, SPIN, X, X_DOT};
use crate::analysis::swing::SwingForm;
use crate::map::body::Body;
use crate::map::strike::State;
use crate::scene::Scene;
use nalgebra::Complex;

/// Fate of a swing about upright in the long run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwingFate {
    /// The swing grows, from every start but upright itself.
    Repelling,
    /// The swing dies out.
    Attracting,
    /// To third order it does neither.
    Neutral,
}

impl SwingFate {
    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repelling => "repelling",
            Self::Attracting => "attracting",
            Self::Neutral => "neutral",
        }
    }
}

/// The first Lyapunov coefficient at the fixed point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LyapunovCoefficient {
    /// ℓ of dA/dn = ℓA³, per bounce and rad²; A is the largest |θ| of the linear swing.
    pub coefficient: f64,
    /// Sign of the coefficient.
    pub kind: SwingFate,
    /// A₀ of this release, rad.
    pub amplitude: f64,
    /// Distance of the rotation from a quarter turn a bounce, in turns: the strong resonance at which ℓ is not defined.
    pub from_quarter: f64,
}

impl LyapunovCoefficient {
    /// 1/(2ℓA₀²), contacts after which a swing like this release's has left; `None` if it does not leave.
    pub fn escape_impacts(&self) -> Option<u64> {
        let contacts = 0.5 / (self.coefficient * self.amplitude * self.amplitude);
        // A cast keeps to the range of the type.
        (self.kind == SwingFate::Repelling && contacts.is_finite()).then_some(contacts as u64)
    }
}

/// The coefficient of a scene about its fixed point, with the amplitude of the scene's release.
///
/// # Errors
/// A sentence that says why it does not apply.
pub fn lyapunov_coefficient(
    scene: &Scene,
    fixed_point: &FixedPoint,
    linear: &LinearVerdict,
) -> Result<LyapunovCoefficient, String> {
    if linear.closed_loop.is_some() {
        return Err("with state feedback small deviations die out or grow in first order already".to_owned());
    }
    let bounce = UprightBounce::of(&scene.model(), fixed_point)?;
    let height = linear.energy_eigenvalue;
    if height == 1.0 {
        return Err(
            "energy_gain is 0, so no direction contracts and a swing has nothing to grow or shrink by".to_owned()
        );
    }
    if height.abs() > 1.0 - PARABOLIC {
        return Err(format!("the bounce height does not settle (its eigenvalue is {height})"));
    }
    let (AngleClass::Elliptic, Some(residue)) = (linear.class, linear.residue) else {
        return Err("the angle does not circle at this tilt_gain".to_owned());
    };
    let cos = 1.0 - 2.0 * residue;
    let eigenvalue = Complex::new(cos, 2.0 * (residue * (1.0 - residue)).sqrt());
    let square = eigenvalue * eigenvalue;
    let away = |value: Complex<f64>| (value - Complex::new(1.0, 0.0)).norm_sqr();
    if [eigenvalue, square, square * square].into_iter().any(|power| away(power) < RESONANT * RESONANT) {
        return Err(format!("residue {residue} is at a strong resonance (rotation 0, 1/2 or 1/4 of a turn a bounce)"));
    }
    let start = first_contact(scene)?;
    let mut cubic = bounce.cubic(eigenvalue, start)?;
    let drift = if fixed_point.x_dot == 0.0 { drift_speed(scene).unwrap_or(0.0) } else { fixed_point.x_dot };
    if drift != 0.0 && cubic.growth_or_zero() != 0.0 {
        cubic = beside_drift(&scene.with_tilt_law().model(), fixed_point, drift, eigenvalue, start)?;
    }
    let coefficient = cubic.growth_or_zero();
    let kind = if coefficient > 0.0 {
        SwingFate::Repelling
    } else if coefficient < 0.0 {
        SwingFate::Attracting
    } else {
        SwingFate::Neutral
    };
    let turns = linear.rotation.unwrap_or_default() / std::f64::consts::TAU;
    Ok(LyapunovCoefficient { coefficient, kind, amplitude: cubic.amplitude, from_quarter: (turns - 0.25).abs() })
}

/// The cubic coefficient of a swing about a bounce that drifts at a speed `drift` (m/s), from the return map there.
fn beside_drift(
    model: &Body,
    fixed_point: &FixedPoint,
    drift: f64,
    eigenvalue: Complex<f64>,
    [arc, x_dot, spin, x]: [f64; 4],
) -> Result<CubicCoefficient, String> {
    let map = ReturnMap::new(model, 1);
    let at = map.vector(&State { x_dot: drift, ..fixed_point.state() }, fixed_point.x);
    let bounce = repeating::find(&map, &at, &at).map_err(|_| "no bounce repeats beside the drift".to_owned())?;
    let form = SwingForm::new(&map, &bounce, eigenvalue)
        .map_err(|_| "the eigenvalue is double or at a strong resonance".to_owned())?;
    let mut start = bounce.at;
    (start[ARC], start[X_DOT], start[SPIN], start[X]) = (arc, x_dot, spin, x);
    Ok(CubicCoefficient {
        growth: form.growth,
        size: modulus(form.cubic),
        amplitude: form.amplitude(&map, &bounce, &start),
    })
}

/// (ρθ, ẋ, ρθ̇, x) just before the first contact of a scene's run.
///
/// # Errors
/// A sentence that says that there is none.
pub(crate) fn first_contact(scene: &Scene) -> Result<[f64; 4], String> {
    let orbit = scene.orbit().map_err(|_| "the release comes to no contact".to_owned())?;
    let rho = scene.parameters::<f64>().radius_of_gyration;
    let state = orbit.state();
    Ok([rho * state.theta, state.x_dot, rho * state.theta_dot, orbit.x()])
}
