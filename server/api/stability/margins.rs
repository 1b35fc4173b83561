//! The margins under tolerances, as part of the answer.

use equipoise_physics::analysis::limits::Parameter;
use equipoise_physics::analysis::margins;
use equipoise_physics::analysis::margins::{NoMargins, SampledBody, Tolerances, ValueRange, margins_over_tolerances};
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::scene::{Name, Scene};
use serde::Serialize;

use crate::api::shared::table::{Cells, Column};
use crate::api::stability::verdict_name::code;

/// The margins of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct MarginsAnswer {
    tolerances: BodySample,
    holds: Option<bool>,
    tilt_gain: Option<TiltGainMargin>,
    #[serde(skip_serializing_if = "Option::is_none")]
    feedback_factor: Option<FactorMargin>,
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

/// Ends of the factors on the gains of a state feedback that keep small deviations bounded; None without one for every body.
#[derive(Debug, Clone, Serialize)]
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

/// Names of the other parts of the margins in formats with columns or gauges.
pub(super) const HOLDS: &str = "margins_holds";
const WORST_PARAMETERS: &str = "margins_worst_parameters";

/// A number of the margins, under the name that it has in every format but JSON.
pub(super) struct MarginNumber {
    pub(super) name: &'static str,
    pub(super) unit: &'static str,
    pub(super) about: &'static str,
    pub(super) value: Option<f64>,
}

impl MarginsAnswer {
    /// All numbers but the worst values of further fields.
    pub(super) fn numbers(&self) -> [MarginNumber; 10] {
        let number = |name, unit, about, value| MarginNumber { name, unit, about, value };
        let tilt_gain = self.tilt_gain.as_ref();
        let worst = tilt_gain.map(|it| &it.worst);
        let (apex, energy) = (self.apex_height, self.energy_eigenvalue);
        let critical = ["margins_tilt_gain_critical_least", "margins_tilt_gain_critical_most"];
        let height = ["margins_apex_height_least", "margins_apex_height_most"];
        let eigenvalue = ["margins_energy_eigenvalue_least", "margins_energy_eigenvalue_most"];
        let least = tilt_gain.map(|it| it.critical.least);
        let above = tilt_gain.map(|it| it.margin_above);
        let l = worst.map(|it| it.contact_distance);
        let rho = worst.map(|it| it.radius_of_gyration);
        let e = worst.map(|it| it.restitution);
        [
            number(critical[0], "", "Smallest critical tilt gain within the tolerances", least),
            number(critical[1], "", "Largest critical tilt gain within them", tilt_gain.map(|it| it.critical.most)),
            number("margins_tilt_gain_margin_above", "", "Distance of the tilt gain below the smallest one", above),
            number(height[0], "m", "Lowest top of the bounce in place within the tolerances", apex.map(|it| it.least)),
            number(height[1], "m", "Highest top of the bounce in place within them", apex.map(|it| it.most)),
            number(
                eigenvalue[0],
                "",
                "Smallest eigenvalue of the height within the tolerances",
                energy.map(|it| it.least),
            ),
            number(eigenvalue[1], "", "Largest eigenvalue of the height within them", energy.map(|it| it.most)),
            number("margins_worst_contact_distance", "m", "Contact distance with the smallest critical tilt gain", l),
            number("margins_worst_radius_of_gyration", "m", "Radius of gyration with it", rho),
            number("margins_worst_restitution", "", "Restitution with it", e),
        ]
    }

    /// The columns of a table with one row.
    pub(super) fn columns(&self) -> Vec<Column> {
        let number = |MarginNumber { name, unit, value, .. }| Column { name, unit, cells: Cells::Sparse(vec![value]) };
        let worst: Vec<f64> = self.worst_parameters().map(|(_, _, value)| value).collect();
        let worst = (!worst.is_empty()).then_some(worst);
        let holds = Column { name: HOLDS, unit: "", cells: Cells::Flags(vec![self.holds]) };
        let further = Column { name: WORST_PARAMETERS, unit: "", cells: Cells::Lists(vec![worst]) };
        std::iter::once(holds).chain(self.numbers().map(number)).chain([further]).collect()
    }

    /// True if the verdict holds for every body within the tolerances.
    pub(super) fn holds(&self) -> Option<bool> {
        self.holds
    }

    /// Values of the further fields with the smallest critical tilt gain: path, unit and value.
    pub(super) fn worst_parameters(&self) -> impl Iterator<Item = (&'static str, &'static str, f64)> {
        let worst = self.tilt_gain.iter().flat_map(|it| &it.worst.parameters);
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
