//! The linear verdict in answers, with the limits of the gains as they are set.

use equipoise_physics::analysis::linear_verdict::LinearVerdict;
use equipoise_physics::scene::{Name, Scene};
use serde::Serialize;

use crate::api::shared::eigenvalue::Eigenvalue;

#[derive(Debug, Clone, Serialize)]
pub(super) struct TiltGainAnswer {
    pub(super) value: f64,
    pub(super) lower: f64,
    pub(super) critical: f64,
    pub(super) margin_below: f64,
    pub(super) margin_above: f64,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct EnergyGainAnswer {
    pub(super) value: f64,
    /// None where the law of the energy has no gain.
    pub(super) upper: Option<f64>,
    pub(super) eigenvalue: f64,
    pub(super) margin: Option<f64>,
}

/// The linear verdict, with the limits of the gains as they are set.
#[derive(Debug, Clone, Serialize)]
pub struct LinearPart {
    pub(super) class: &'static str,
    pub(super) residue: Option<f64>,
    pub(super) rotation: Option<f64>,
    pub(super) spectral_radius: f64,
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
