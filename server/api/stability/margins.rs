//! The margins under tolerances, as part of the answer.

use equipoise_physics::analysis::limits::Parameter;
use equipoise_physics::analysis::margins;
use equipoise_physics::analysis::margins::{NoMargins, SampledBody, Tolerances, ValueRange, margins_over_tolerances};
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::scene::{Name, Scene};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::table::columns::{RowColumn, flag, number};
use crate::api::shared::table::gather::Read;
use crate::api::stability::verdict_name::code;

/// Small deviations over all bodies within the tolerances, if tolerances are requested. Everything except `tolerances` is null, with a `reason`
/// that names the values, for a point mass, and if no bounce of one of the bodies repeats, as with a constant tilt without feedback of x.
/// `tilt_gain` is also null if no tilt gain is stable, and with state feedback, which has `feedback_factor`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Margins")]
pub struct MarginsAnswer {
    tolerances: BodySample,
    /// True if small deviations stay bounded for all of them, and the `verdict_code` of the scene is `stable_in_place`, `stable_drifting`,
    /// `weakly_attracting` or `elliptic`.
    holds: Option<bool>,
    tilt_gain: Option<TiltGainMargin>,
    #[serde(skip_serializing_if = "Option::is_none")]
    feedback_factor: Option<FactorMargin>,
    /// Height of the centre of gravity at the top of the bounce in place, m.
    apex_height: Option<SpanAnswer>,
    energy_eigenvalue: Option<SpanAnswer>,
    reason: String,
}

/// A body, or the tolerances of one.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "MarginsBody")]
struct BodySample {
    /// Contact distance, m.
    contact_distance: f64,
    /// Radius of gyration, m.
    radius_of_gyration: f64,
    restitution: f64,
    /// Further fields, with the tolerance or the value of each in its unit. Absent without tolerances of further fields.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parameters: Vec<ParameterSample>,
}

/// A further field: its tolerance, or its value.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "MarginsParameter")]
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

/// Least and greatest value.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "Span")]
struct SpanAnswer {
    least: f64,
    most: f64,
}

/// The margin of the tilt gain.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct TiltGainMargin {
    value: f64,
    critical: SpanAnswer,
    /// Distance from the tilt gain to the smallest critical one.
    margin_above: f64,
    /// The body with the smallest critical tilt gain.
    worst: BodySample,
}

/// Ends of the factors on the gains of a state feedback that keep small deviations bounded, over all bodies. Only with state feedback. An end is
/// null if a body has none.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct FactorMargin {
    lower: Option<SpanAnswer>,
    upper: Option<SpanAnswer>,
}

impl FactorMargin {
    fn new(lower: ValueRange, upper: ValueRange) -> Self {
        let finite =
            |range: ValueRange| (range.least.is_finite() && range.most.is_finite()).then(|| SpanAnswer::from(range));
        Self { lower: finite(lower), upper: finite(upper) }
    }
}

impl From<margins::ValueRange> for SpanAnswer {
    fn from(margins::ValueRange { least, most }: margins::ValueRange) -> Self {
        Self { least, most }
    }
}

/// Columns and gauges of the margins.
pub(super) const COLUMNS: [RowColumn<MarginsAnswer>; 12] = [
    flag("margins_holds", "True if the verdict holds for every body within the tolerances.", |it| it.holds),
    number("margins_tilt_gain_critical_least", "", "Smallest critical tilt gain within the tolerances.", |it| {
        Some(it.tilt_gain.as_ref()?.critical.least)
    }),
    number("margins_tilt_gain_critical_most", "", "Largest critical tilt gain within them.", |it| {
        Some(it.tilt_gain.as_ref()?.critical.most)
    }),
    number("margins_tilt_gain_margin_above", "", "Distance of the tilt gain below the smallest one.", |it| {
        Some(it.tilt_gain.as_ref()?.margin_above)
    }),
    number("margins_apex_height_least", "m", "Lowest top of the bounce in place within the tolerances.", |it| {
        Some(it.apex_height?.least)
    }),
    number("margins_apex_height_most", "m", "Highest top of the bounce in place within them.", |it| {
        Some(it.apex_height?.most)
    }),
    number("margins_energy_eigenvalue_least", "", "Smallest eigenvalue of the height within the tolerances.", |it| {
        Some(it.energy_eigenvalue?.least)
    }),
    number("margins_energy_eigenvalue_most", "", "Largest eigenvalue of the height within them.", |it| {
        Some(it.energy_eigenvalue?.most)
    }),
    number("margins_worst_contact_distance", "m", "Contact distance with the smallest critical tilt gain.", |it| {
        Some(it.worst()?.contact_distance)
    }),
    number("margins_worst_radius_of_gyration", "m", "Radius of gyration with it.", |it| {
        Some(it.worst()?.radius_of_gyration)
    }),
    number("margins_worst_restitution", "", "Restitution with it.", |it| Some(it.worst()?.restitution)),
    RowColumn::new(
        "margins_worst_parameters",
        "",
        "Values of the further fields, in the order of `tolerances.parameters`.",
        Read::List(|it| {
            Some(it.worst_parameters().map(|(_, _, value)| value).collect()).filter(|worst: &Vec<_>| !worst.is_empty())
        }),
    ),
];

impl MarginsAnswer {
    /// The body with the smallest critical tilt gain.
    fn worst(&self) -> Option<&BodySample> {
        self.tilt_gain.as_ref().map(|it| &it.worst)
    }

    /// Values of the further fields with the smallest critical tilt gain: path, unit and value.
    pub(super) fn worst_parameters(&self) -> impl Iterator<Item = (&'static str, &'static str, f64)> {
        let worst = self.worst().into_iter().flat_map(|it| &it.parameters);
        worst.map(|ParameterSample { parameter, unit, value }| (*parameter, *unit, *value))
    }

    /// Takes back that the margins hold where the verdict on the scene itself does not.
    pub(super) fn weigh(&mut self, verdict: Verdict) {
        if self.holds.is_some() && !verdict.holds() {
            self.holds = Some(false);
            self.reason = format!("the verdict on the scene itself is `{}`; {}", code(verdict), self.reason);
        }
    }

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
                feedback_factor: None,
                apex_height: None,
                energy_eigenvalue: None,
                reason,
            },
            Ok(margins) => {
                let SampledBody { contact_distance, radius_of_gyration, restitution, further } = margins.worst;
                let parameters = further.into_iter().flatten().map(ParameterSample::new).collect();
                let critical = margins.critical;
                let is_factor = margins.gain == Parameter::FeedbackFactor;
                let reason = if margins.holds {
                    "small deviations stay bounded for every body within the tolerances"
                } else {
                    "small deviations grow for some body within the tolerances"
                };
                Self {
                    tolerances: said,
                    holds: Some(margins.holds),
                    // `None` if every tilt gain is unstable.
                    tilt_gain: (!is_factor && critical.least.is_finite()).then_some(TiltGainMargin {
                        value: tilt_gain,
                        critical: critical.into(),
                        margin_above: critical.least - tilt_gain,
                        worst: BodySample { contact_distance, radius_of_gyration, restitution, parameters },
                    }),
                    feedback_factor: is_factor.then(|| FactorMargin::new(margins.lower, critical)),
                    apex_height: Some(margins.apex_height.into()),
                    energy_eigenvalue: Some(margins.energy_eigenvalue.into()),
                    reason: reason.to_owned(),
                }
            }
        })
    }
}
