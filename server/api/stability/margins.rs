//! Margins under tolerances, as they are asked for and answered.

use equipoise_physics::scene::Scene;
use equipoise_physics::stability::margins;
use equipoise_physics::stability::margins::{Sample, Tolerances, margins_over_tolerances};
use serde::Serialize;

use crate::http::Reader;

/// Reads `tolerances`; none if they are not asked for.
pub fn read(reader: &mut Reader<'_, '_>) -> Option<Tolerances> {
    reader.within("tolerances", |reader| Tolerances {
        contact_distance: reader.number("contact_distance", 0.0..=1.0, "m").unwrap_or(0.0),
        radius_of_gyration: reader.number("radius_of_gyration", 0.0..=1.0, "m").unwrap_or(0.0),
        restitution: reader.number("restitution", 0.0..=1.0, "(no unit)").unwrap_or(0.0),
    })
}

/// The answer.
#[derive(Debug, Clone, Serialize)]
pub struct Margins {
    tolerances: Body,
    holds: Option<bool>,
    tilt_gain: Option<TiltGain>,
    apex_height: Option<Span>,
    energy_eigenvalue: Option<Span>,
    reason: String,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Body {
    contact_distance: f64,
    radius_of_gyration: f64,
    restitution: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct Span {
    least: f64,
    most: f64,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct TiltGain {
    value: f64,
    critical: Span,
    margin_above: f64,
    worst: Body,
}

impl From<margins::Span> for Span {
    fn from(margins::Span { least, most }: margins::Span) -> Self {
        Self { least, most }
    }
}

impl Margins {
    /// The margins of a scene with a tilt gain.
    pub fn compute(scene: &Scene, tolerances: &Tolerances, tilt_gain: f64) -> Self {
        let Tolerances { contact_distance, radius_of_gyration, restitution } = *tolerances;
        let said = Body { contact_distance, radius_of_gyration, restitution };
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
                let Sample { contact_distance, radius_of_gyration, restitution } = margins.worst;
                let critical = margins.critical_tilt_gain;
                let reason = if margins.holds {
                    "the linear verdict is stable for every body within the tolerances"
                } else {
                    "some body within the tolerances is unstable by the linear verdict"
                };
                Self {
                    tolerances: said,
                    holds: Some(margins.holds),
                    // None where no tilt gain balances.
                    tilt_gain: critical.least.is_finite().then_some(TiltGain {
                        value: tilt_gain,
                        critical: critical.into(),
                        margin_above: critical.least - tilt_gain,
                        worst: Body { contact_distance, radius_of_gyration, restitution },
                    }),
                    apex_height: Some(margins.apex_height.into()),
                    energy_eigenvalue: Some(margins.energy_eigenvalue.into()),
                    reason: reason.to_owned(),
                }
            }
        }
    }
}
