//! The margins under tolerances, as part of the answer.

use equipoise_physics::scene::{Name, Scene};
use equipoise_physics::stability::margins;
use equipoise_physics::stability::margins::{NoMargins, SampledBody, Tolerances, ValueRange, margins_over_tolerances};
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

#[derive(Debug, Clone, Serialize)]
struct BodySample {
    contact_distance: f64,
    radius_of_gyration: f64,
    restitution: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parameters: Vec<ParameterSample>,
}

/// A further field: its tolerance, or its value.
#[derive(Debug, Clone, Copy, Serialize)]
struct ParameterSample {
    parameter: &'static str,
    unit: &'static str,
    value: f64,
}

impl ParameterSample {
    fn new((name, value): (Name, f64)) -> Self {
        Self { parameter: name.row().path, unit: name.row().unit, value }
    }
}

#[derive(Debug, Clone, Copy, Serialize)]
struct SpanAnswer {
    least: f64,
    most: f64,
}

#[derive(Debug, Clone, Serialize)]
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
    /// The margins of a scene with a tilt gain. None if `go_on` returned false.
    pub fn compute(
        scene: &Scene,
        tolerances: &Tolerances,
        tilt_gain: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<Self> {
        let Tolerances { contact_distance, radius_of_gyration, restitution, further } = *tolerances;
        let parameters = further.iter().flatten().map(|field| ParameterSample::new((field.name, field.off))).collect();
        let said = BodySample { contact_distance, radius_of_gyration, restitution, parameters };
        Some(match margins_over_tolerances(scene, tolerances, go_on) {
            Err(NoMargins::Stopped) => return None,
            Err(NoMargins::Because(reason)) => Self {
                tolerances: said,
                holds: None,
                tilt_gain: None,
                apex_height: None,
                energy_eigenvalue: None,
                reason,
            },
            Ok(margins) => {
                let SampledBody { contact_distance, radius_of_gyration, restitution, further } = margins.worst;
                let parameters = further.into_iter().flatten().map(ParameterSample::new).collect();
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
                        worst: BodySample { contact_distance, radius_of_gyration, restitution, parameters },
                    }),
                    apex_height: Some(margins.apex_height.into()),
                    energy_eigenvalue: Some(margins.energy_eigenvalue.into()),
                    reason: reason.to_owned(),
                }
            }
        })
    }
}
