//! The margins under tolerances, as part of the answer.

use equipoise_physics::scene::Scene;
use equipoise_physics::stability::margins;
use equipoise_physics::stability::margins::{SampledBody, Tolerances, ValueRange, margins_over_tolerances};
use serde::Serialize;

/// The margins of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct MarginsAnswer {
    tolerances: BodySample,
    holds: Option<bool>,
    tilt_gain: Option<TiltGainMargin>,
    apex_height: Option<SpanAnswer>,
    energy_eigenvalue: Option<SpanAnswer>,
    reason: String,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct BodySample {
    contact_distance: f64,
    radius_of_gyration: f64,
    restitution: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct SpanAnswer {
    least: f64,
    most: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct TiltGainMargin {
    value: f64,
    critical: SpanAnswer,
    margin_above: f64,
    worst: BodySample,
}

impl From<margins::ValueRange> for SpanAnswer {
    fn from(margins::ValueRange { least, most }: margins::ValueRange) -> Self {
        Self { least, most }
    }
}

impl MarginsAnswer {
    /// The margins of a scene with a tilt gain.
    pub fn compute(scene: &Scene, tolerances: &Tolerances, tilt_gain: f64) -> Self {
        let Tolerances { contact_distance, radius_of_gyration, restitution } = *tolerances;
        let said = BodySample { contact_distance, radius_of_gyration, restitution };
        match margins_over_tolerances(scene, tolerances) {
            Err(reason) => Self {
                tolerances: said,
                holds: None,
                tilt_gain: None,
                apex_height: None,
                energy_eigenvalue: None,
                reason,
            },
            Ok(margins) => {
                let SampledBody { contact_distance, radius_of_gyration, restitution } = margins.worst;
                let tilts = scene.tilt_factor();
                let ValueRange { least, most } = margins.critical_tilt_gain;
                let critical = ValueRange { least: least / tilts, most: most / tilts };
                let reason = if margins.holds {
                    "the linear verdict is stable for every body within the tolerances"
                } else {
                    "some body within the tolerances is unstable by the linear verdict"
                };
                Self {
                    tolerances: said,
                    holds: Some(margins.holds),
                    // `None` if every tilt gain is unstable.
                    tilt_gain: critical.least.is_finite().then_some(TiltGainMargin {
                        value: tilt_gain,
                        critical: critical.into(),
                        margin_above: critical.least - tilt_gain,
                        worst: BodySample { contact_distance, radius_of_gyration, restitution },
                    }),
                    apex_height: Some(margins.apex_height.into()),
                    energy_eigenvalue: Some(margins.energy_eigenvalue.into()),
                    reason: reason.to_owned(),
                }
            }
        }
    }
}
