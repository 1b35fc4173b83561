//! The linear verdict in answers, with the limits of the gains as they are set.

use equipoise_physics::analysis::linear_verdict::{AngleClass, LinearVerdict};
use equipoise_physics::scene::{Name, Scene};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::eigenvalue::Eigenvalue;
use crate::words;

words! {
    /// Class of the linear map.
    pub LinearClass = AngleClass::ALL.map(AngleClass::name);
}

/// The tilt gain and its stable interval. Null if no tilt gain is stable, as with friction on a table that only tilts, and with state feedback.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "TiltGainInterval")]
pub(super) struct TiltGainAnswer {
    pub(super) value: f64,
    pub(super) lower: f64,
    #[schemars(with = "Option<f64>")]
    pub(super) critical: f64,
    /// Distance of the value above `lower`.
    pub(super) margin_below: f64,
    /// Distance of the value below `critical`.
    #[schemars(with = "Option<f64>")]
    pub(super) margin_above: f64,
}

/// The gain of the energy feedback and the upper end of its stable interval.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "EnergyGainInterval")]
pub(super) struct EnergyGainAnswer {
    /// Gain, s²/m².
    pub(super) value: f64,
    /// Gain above which deviations of the height grow, 2/((1 + e)V²), s²/m². Null where the law of the energy has no gain.
    pub(super) upper: Option<f64>,
    pub(super) eigenvalue: f64,
    /// Distance from the nearer end of the stable interval, the smaller of `value` and `upper` − `value`, s²/m². 0 without an energy gain,
    /// negative outside the interval.
    pub(super) margin: Option<f64>,
}

/// The verdict of the linearization at the fixed point, with the limits of the gains as they are set.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Linear")]
pub struct LinearPart {
    #[schemars(with = "LinearClass")]
    pub(super) class: &'static str,
    /// Greene's residue R of the angle block: elliptic for 0 < R < 1. Null for a point mass, with state feedback, and if friction couples the
    /// angle with the other components.
    pub(super) residue: Option<f64>,
    /// Rotation about the fixed point per bounce, rad. Null if the residue is null, below 0 or above 1.
    pub(super) rotation: Option<f64>,
    /// Largest modulus of the eigenvalues. With state feedback, of the components that are fed back, and of the height if an energy gain
    /// controls it.
    pub(super) spectral_radius: f64,
    /// Eigenvalues of the return map, largest modulus first. What is kept has the eigenvalue 1.
    pub(super) eigenvalues: Vec<Eigenvalue>,
    pub(super) tilt_gain: Option<TiltGainAnswer>,
    pub(super) energy_gain: EnergyGainAnswer,
}

impl LinearPart {
    /// The linear verdict on a scene with a tilt law.
    pub fn new(scene: &Scene, linear: &LinearVerdict) -> Self {
        let kappa = scene.number(Name::TiltGain).unwrap_or_default();
        let energy_gain = scene.number(Name::EnergyGain).unwrap_or_default();
        // Limits of the gains as they are set, whatever the table makes of them.
        let (tilts, moves) = (scene.tilt_factor(), scene.speed_factor());
        let upper = Some(linear.upper_energy_gain / moves).filter(|upper| upper.is_finite());
        let (lower_gain, critical_gain) = (linear.lower_tilt_gain / tilts, linear.critical_tilt_gain / tilts);
        Self {
            class: linear.class.name(),
            residue: linear.residue,
            rotation: linear.rotation,
            spectral_radius: linear.spectral_radius(),
            eigenvalues: linear.eigenvalues.iter().map(|&value| value.into()).collect(),
            tilt_gain: linear.lower_tilt_gain.is_finite().then_some(TiltGainAnswer {
                value: kappa,
                lower: lower_gain,
                critical: critical_gain,
                margin_below: kappa - lower_gain,
                margin_above: critical_gain - kappa,
            }),
            energy_gain: EnergyGainAnswer {
                value: energy_gain,
                upper,
                eigenvalue: linear.energy_eigenvalue,
                margin: upper.map(|upper| energy_gain.min(upper - energy_gain)),
            },
        }
    }

    /// Distances from the ends of the linear verdict by name: above 0 where it is stable.
    pub fn margins(&self) -> Vec<(&'static str, f64)> {
        let tilt = match &self.tilt_gain {
            Some(gain) => vec![("tilt_gain_below", gain.margin_below), ("tilt_gain_above", gain.margin_above)],
            None => vec![("spectral_radius", 1.0 - self.spectral_radius)],
        };
        tilt.into_iter().chain(self.energy_gain.margin.map(|margin| ("energy_gain", margin))).collect()
    }
}
