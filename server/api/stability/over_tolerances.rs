//! Small deviations over tolerances, as part of the answer.

use equipoise_physics::analysis::limits::Parameter;
use equipoise_physics::analysis::margins;
use equipoise_physics::analysis::margins::extra::ExtraTolerance;
use equipoise_physics::analysis::margins::{NoMargins, ValueRange, margins_over_tolerances};
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::scene::Scene;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::margins::{FEEDBACK, Margin, SMALL};
use crate::api::shared::table::columns::{RowColumn, flag, number};
use crate::api::shared::table::gather::Read;
use crate::api::stability::request::{Tolerated, box_of};
use crate::api::stability::verdict_name::code;

/// Small deviations over all bodies within the tolerances, if tolerances are requested; the least margins of the gain are in `margins`. Everything
/// except `tolerances` is null, with a `reason` that names the values, for a point mass, and if no bounce of one of the bodies repeats, as with a
/// constant tilt without feedback of x.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "OverTolerances")]
pub struct OverTolerances {
    /// In the order of the request.
    tolerances: Vec<FieldTolerance>,
    /// True if small deviations stay bounded for all of them, and the `verdict_code` of the scene is `stable_in_place`, `stable_drifting`,
    /// `weakly_attracting` or `elliptic`.
    holds: Option<bool>,
    /// The body with the least upper limit of the gain: the values of the fields of `tolerances`, in their order. Also null if no tilt gain is
    /// stable.
    worst: Option<Vec<FieldValue>>,
    /// Height of the centre of gravity at the top of the bounce in place, m.
    apex_height: Option<SpanAnswer>,
    energy_eigenvalue: Option<SpanAnswer>,
    reason: String,
    /// The gain, and the spans of its lower and its upper limit.
    #[serde(skip)]
    gain: Option<(&'static str, [ValueRange; 2])>,
}

/// A field with its tolerance.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "FieldTolerance")]
struct FieldTolerance {
    field: &'static str,
    unit: &'static str,
    tolerance: f64,
}

/// A field with its value.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "FieldValue")]
pub(super) struct FieldValue {
    pub(super) field: &'static str,
    pub(super) unit: &'static str,
    pub(super) value: f64,
}

/// Least and greatest value.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "Span")]
struct SpanAnswer {
    least: f64,
    most: f64,
}

impl From<margins::ValueRange> for SpanAnswer {
    fn from(margins::ValueRange { least, most }: margins::ValueRange) -> Self {
        Self { least, most }
    }
}

/// Columns and gauges.
pub(super) const COLUMNS: [RowColumn<OverTolerances>; 6] = [
    flag("over_tolerances_holds", "True if the verdict holds for every body within the tolerances.", |it| it.holds),
    number(
        "over_tolerances_apex_height_least",
        "m",
        "Lowest top of the bounce in place within the tolerances.",
        |it| Some(it.apex_height?.least),
    ),
    number("over_tolerances_apex_height_most", "m", "Highest top of the bounce in place within them.", |it| {
        Some(it.apex_height?.most)
    }),
    number(
        "over_tolerances_energy_eigenvalue_least",
        "",
        "Smallest eigenvalue of the height within the tolerances.",
        |it| Some(it.energy_eigenvalue?.least),
    ),
    number("over_tolerances_energy_eigenvalue_most", "", "Largest eigenvalue of the height within them.", |it| {
        Some(it.energy_eigenvalue?.most)
    }),
    RowColumn::new(
        "over_tolerances_worst",
        "",
        "Values of the fields of `tolerances` with the least upper limit of the gain.",
        Read::List(|it| {
            Some(it.worst().iter().map(|field| field.value).collect()).filter(|it: &Vec<_>| !it.is_empty())
        }),
    ),
];

impl OverTolerances {
    /// Values of the fields of `tolerances` with the least upper limit of the gain.
    pub(super) fn worst(&self) -> &[FieldValue] {
        self.worst.as_deref().unwrap_or_default()
    }

    /// Adds the least and the greatest margins to those of the scene.
    pub(super) fn widen(&self, margins: &mut [Margin]) {
        let Some((field, [lower, upper])) = self.gain else { return };
        for margin in margins.iter_mut().filter(|margin| margin.field == field && margin.of == SMALL) {
            let value = margin.value;
            for (end, least, most) in [
                (&mut margin.below, value - lower.most, value - lower.least),
                (&mut margin.above, upper.least - value, upper.most - value),
            ] {
                if let Some(end) = end {
                    let finite = |margin: f64| margin.is_finite().then_some(margin);
                    (end.least, end.most) = (finite(least), finite(most));
                }
            }
        }
    }

    /// Takes back that the margins hold where the verdict on the scene itself does not.
    pub(super) fn weigh(&mut self, verdict: Verdict) {
        if self.holds.is_some() && !verdict.holds() {
            self.holds = Some(false);
            self.reason = format!("the verdict on the scene itself is `{}`; {}", code(verdict), self.reason);
        }
    }

    /// Those of a scene with a tilt law. None if `go_on` returned false.
    pub fn compute(scene: &Scene, tolerated: &Tolerated, go_on: &mut dyn FnMut() -> bool) -> Option<Self> {
        let fields = || tolerated.iter().flatten();
        let tolerances = fields()
            .map(|field| FieldTolerance {
                field: field.name.row().path,
                unit: field.name.row().unit,
                tolerance: field.off,
            })
            .collect();
        Some(match margins_over_tolerances(scene, &box_of(tolerated), go_on) {
            Err(NoMargins::Stopped) => return None,
            Err(NoMargins::Because(reason)) => Self {
                tolerances,
                holds: None,
                worst: None,
                apex_height: None,
                energy_eigenvalue: None,
                reason,
                gain: None,
            },
            Ok(margins) => {
                let worst = |field: &ExtraTolerance| {
                    let row = field.name.row();
                    Some(FieldValue { field: row.path, unit: row.unit, value: margins.worst.value(field.name)? })
                };
                let field = match margins.gain {
                    Parameter::Field(name) => name.row().path,
                    Parameter::FeedbackFactor => FEEDBACK,
                };
                let reason = if margins.holds {
                    "small deviations stay bounded for every body within the tolerances"
                } else {
                    "small deviations grow for some body within the tolerances"
                };
                Self {
                    tolerances,
                    holds: Some(margins.holds),
                    worst: margins.critical.least.is_finite().then(|| fields().filter_map(worst).collect()),
                    apex_height: Some(margins.apex_height.into()),
                    energy_eigenvalue: Some(margins.energy_eigenvalue.into()),
                    reason: reason.to_owned(),
                    gain: Some((field, [margins.lower, margins.critical])),
                }
            }
        })
    }
}
