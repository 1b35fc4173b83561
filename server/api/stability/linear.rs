//! The linear verdict in answers.

use equipoise_physics::analysis::linear_verdict::{AngleClass, LinearVerdict};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::eigenvalue::Eigenvalue;
use crate::words;

words! {
    /// Kind of the linear map.
    pub LinearKind = AngleClass::ALL.map(AngleClass::name);
}

/// The verdict of the linearization at the fixed point.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Linear")]
pub struct LinearPart {
    #[schemars(with = "LinearKind")]
    pub(super) kind: &'static str,
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
    /// Factor on a deviation of the height at each bounce.
    pub(super) energy_eigenvalue: f64,
}

impl LinearPart {
    /// The linear verdict on a scene with a tilt law.
    pub fn new(linear: &LinearVerdict) -> Self {
        Self {
            kind: linear.class.name(),
            residue: linear.residue,
            rotation: linear.rotation,
            spectral_radius: linear.spectral_radius(),
            eigenvalues: linear.eigenvalues.iter().map(|&value| value.into()).collect(),
            energy_eigenvalue: linear.energy_eigenvalue,
        }
    }
}
