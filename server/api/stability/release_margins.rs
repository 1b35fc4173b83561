//! The margins of the gain for the run of the release, as part of the answer.

use equipoise_physics::analysis::limits::{Limit, Parameter};
use equipoise_physics::analysis::margins::gains::{GainMargins, MOST_RUNS, gain_margins};
use equipoise_physics::analysis::margins::judgement::{LimitedBy, VerdictLimit};
use equipoise_physics::scene::Scene;

use crate::api::scene::bounce_price;
use crate::api::shared::margins::{FEEDBACK, Margin, MarginEnd, RELEASE, Side};
use crate::api::shared::outcome::BriefOutcome;
use crate::api::stability::budget::{LIMIT_PRICE, RUN_PRICE};

/// Highest price of the margins, in bounces.
pub(super) fn release_margins_price(scene: &Scene, impacts: u64) -> u64 {
    2 * LIMIT_PRICE + MOST_RUNS * (RUN_PRICE + impacts * bounce_price(scene))
}

/// Relative distance within which two limits are the same.
const SAME: f64 = 1e-6;

/// Adds the margins of the gain by runs of so many contacts, and what the search for the ends of small deviations tells: their accuracy, what is lost
/// there, and ends that are not known without it. Returns the number of bounces; None if `go_on` returned false.
pub(super) fn add_release_margins(
    margins: &mut Vec<Margin>,
    scene: &Scene,
    impacts: u64,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<u64> {
    let GainMargins { gain, small, release, bounces } = gain_margins(scene, impacts, go_on)?;
    let (field, unit) = match gain {
        Parameter::Field(name) => (name.row().path, name.row().unit),
        Parameter::FeedbackFactor => (FEEDBACK, "1"),
    };
    let value = small.value;
    // Outside of a stable range the limits are the near ends of those on both sides.
    let [lower, upper] = if small.bounded { [small.lower, small.upper] } else { [small.upper, small.lower] };
    if let Some(margin) = margins.iter_mut().find(|margin| margin.field == field) {
        told(&mut margin.below, lower, Side::Below, value);
        told(&mut margin.above, upper, Side::Above, value);
    }
    let end = |sign: f64, VerdictLimit { value: distance, accuracy, by, ending, detail, .. }: VerdictLimit| {
        let end = MarginEnd::new(value + sign * distance, distance)?;
        let end = MarginEnd {
            accuracy: Some(accuracy),
            outcome: ending.map(|kind| BriefOutcome { kind }),
            detail: Some(detail),
            ..end
        };
        (by != LimitedBy::Range).then_some(end)
    };
    let [below, above] = release;
    margins.push(Margin { field, unit, of: RELEASE, value, below: end(-1.0, below), above: end(1.0, above) });
    Some(bounces)
}

/// Adds to an end what a search found.
fn told(end: &mut Option<MarginEnd>, found: Option<Limit>, side: Side, value: f64) {
    let Some(Limit { value: limit, accuracy, kind }) = found else { return };
    if end.is_none() {
        *end = match side {
            Side::Below => MarginEnd::below(limit, value),
            Side::Above => MarginEnd::above(limit, value),
        };
    }
    if let Some(end) = end.as_mut().filter(|end| (end.limit - limit).abs() <= SAME * limit.abs().max(1.0)) {
        (end.accuracy, end.detail) = (Some(accuracy), Some(kind.to_string()));
    }
}
