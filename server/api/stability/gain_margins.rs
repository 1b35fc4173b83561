//! The margins of the gain, as part of the answer.

use equipoise_physics::analysis::limits::{Limit, Parameter};
use equipoise_physics::analysis::margins::gains::{GainMargins, MOST_RUNS, gain_margins};
use equipoise_physics::analysis::margins::judgement::LimitedBy;
use equipoise_physics::analysis::margins::judgement::VerdictLimit;
use equipoise_physics::scene::Scene;
use serde::Serialize;

use crate::api::scene::bounce_price;
use crate::api::stability::budget::{LIMIT_PRICE, RUN_PRICE};

/// Highest price of the margins, in bounces.
pub(super) fn gain_margins_price(scene: &Scene, impacts: u64) -> u64 {
    2 * LIMIT_PRICE + MOST_RUNS * (RUN_PRICE + impacts * bounce_price(scene))
}

/// The margins of a gain, of small deviations or of the release.
#[derive(Debug, Clone, Serialize)]
pub struct GainMarginAnswer {
    field: &'static str,
    of: &'static str,
    value: f64,
    below: Option<EndAnswer>,
    above: Option<EndAnswer>,
}

/// The nearest value on one side at which something else happens.
#[derive(Debug, Clone, Serialize)]
struct EndAnswer {
    value: f64,
    accuracy: f64,
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
            Parameter::FeedbackFactor => "table.feedback",
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
