//! The margins of the gain, as part of the answer.

use equipoise_physics::analysis::limits::{Limit, Parameter};
use equipoise_physics::analysis::margins::gains::{GainMargins, MOST_RUNS, gain_margins};
use equipoise_physics::analysis::margins::judgement::LimitedBy;
use equipoise_physics::analysis::margins::judgement::VerdictLimit;
use equipoise_physics::scene::{Name, Scene};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::scene::bounce_price;
use crate::api::stability::budget::{LIMIT_PRICE, RUN_PRICE};
use crate::words;

/// Highest price of the margins, in bounces.
pub(super) fn gain_margins_price(scene: &Scene, impacts: u64) -> u64 {
    2 * LIMIT_PRICE + MOST_RUNS * (RUN_PRICE + impacts * bounce_price(scene))
}

words! {
    /// The gain: with `table.feedback` a factor on its four gains.
    pub GainField = [Name::TiltGain.row().path, FEEDBACK];

    /// `small`: small deviations from the bounce that repeats, for any table, air and contact. `release`: the run of this release over
    /// `impacts` contacts.
    pub GainMarginKind = ["small", "release"];
}

const FEEDBACK: &str = "table.feedback";

/// The margins of a gain.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "GainMargin")]
pub struct GainMarginAnswer {
    #[schemars(with = "GainField")]
    field: &'static str,
    #[schemars(with = "GainMarginKind")]
    of: &'static str,
    /// Value in the scene; 1 for the factor.
    value: f64,
    /// The nearest value below at which they are bounded and no longer, or unbounded and no longer, or the run ends otherwise. Null if there is
    /// none in the range.
    below: Option<EndAnswer>,
    /// The nearest above.
    above: Option<EndAnswer>,
}

/// The nearest value on one side at which something else happens.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "GainEnd")]
struct EndAnswer {
    value: f64,
    /// Bound on the error of the limit of small deviations; for a release the distance to the nearest value found at which the run ends
    /// otherwise.
    accuracy: f64,
    /// End of that run. Null for small deviations, and where no scene has a value beyond.
    outcome: Option<&'static str>,
    detail: String,
}

impl From<Limit> for EndAnswer {
    fn from(Limit { value, accuracy, kind }: Limit) -> Self {
        Self { value, accuracy, outcome: None, detail: kind.to_string() }
    }
}

impl GainMarginAnswer {
    /// The margins of a scene by runs of so many contacts, with the number of their bounces. None if `go_on` returned false.
    pub(super) fn compute(scene: &Scene, impacts: u64, go_on: &mut dyn FnMut() -> bool) -> Option<([Self; 2], u64)> {
        let GainMargins { gain, small, release, bounces } = gain_margins(scene, impacts, go_on)?;
        let field = match gain {
            Parameter::Field(name) => name.row().path,
            Parameter::FeedbackFactor => FEEDBACK,
        };
        let value = small.value;
        let end = |sign: f64, VerdictLimit { value: distance, accuracy, by, ending, detail, .. }: VerdictLimit| {
            let end = EndAnswer { value: value + sign * distance, accuracy, outcome: ending, detail };
            (by != LimitedBy::Range).then_some(end)
        };
        let [below, above] = release;
        let (below, above) = (end(-1.0, below), end(1.0, above));
        let (lower, upper) = (small.lower.map(Into::into), small.upper.map(Into::into));
        let margins = [
            Self { field, of: "small", value, below: lower, above: upper },
            Self { field, of: "release", value, below, above },
        ];
        Some((margins, bounces))
    }
}
