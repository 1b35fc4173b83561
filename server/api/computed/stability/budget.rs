//! The budget of the errors of a rig, and the margins of the gain for the run of the release, as parts of the answer.

use equipoise_physics::analysis::limits::Limit;
use equipoise_physics::analysis::margins::budget;
use equipoise_physics::analysis::margins::budget::{CommonBudget, ErrorBudget, find_budget, most_runs, most_searches};
use equipoise_physics::analysis::margins::judgement::{
    GainMargins, LimitedBy, MOST_RUNS, NoMargins, VerdictLimit, gain_margins,
};
use equipoise_physics::scene::{Name, Scene};

use crate::api::computed::stability::verdict::{VerdictAnswer, code, words};
use crate::api::prelude::*;
use crate::api::shared::margins::{Margin, MarginEnd, RELEASE, Side};
use crate::api::shared::outcome::BriefOutcome;

/// Price of a run of the budget without its bounces, in bounces: the scene, its small deviations and normal forms.
pub(super) const RUN_PRICE: u64 = 400;

/// Price of a limit of small deviations, in bounces: the bounce that repeats at several dozen values.
pub(super) const LIMIT_PRICE: u64 = 8_000;

/// Highest price of a budget, in bounces.
pub(super) fn budget_price(scene: &Scene, bounces: u64) -> u64 {
    let of_runs = |(runs, dearest): &(u64, Scene)| runs * (RUN_PRICE + bounces * bounce_price(dearest));
    most_searches(scene) * LIMIT_PRICE + most_runs(scene).iter().map(of_runs).sum::<u64>()
}

words! {
    /// Criterion that is lost beyond a limit. `linear`, `nonlinear` (the run), `boundary` and `lyapunov`: as `decided_by` of the verdict.
    /// `fixed_point`: no bounce repeats on the table any more. `refused`: no scene can have a larger size. `range`: nothing is lost up to the end
    /// of the range of the field; for `together` up to all single limits at once.
    pub LimitDecidedBy = LimitedBy::NAMES;
}

/// The size of an error or of a deviation from `reference`, without its sign, in its unit, or a factor without a unit.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct BudgetLimit {
    /// Largest size that keeps the verdict, with all smaller ones tried. 0 if no size tried keeps it.
    value: f64,
    /// Distance to the nearest size found that loses it. 0 if nothing is lost in the range.
    accuracy: f64,
    /// Largest distance of the sizes tried below the limit; a narrower gap can be missed.
    spacing: f64,
    #[schemars(with = "LimitDecidedBy")]
    decided_by: &'static str,
    /// End of the run beyond the limit. Null if the run is not what is lost.
    outcome: Option<BriefOutcome>,
    /// Limit for small deviations of the state alone, by the linear verdict. Null where the error leaves no linear verdict, and if it is kept over
    /// the whole range.
    small: Option<f64>,
    /// Loss in one sentence.
    detail: String,
}

impl From<VerdictLimit> for BudgetLimit {
    fn from(limit: VerdictLimit) -> Self {
        let VerdictLimit { value, accuracy, spacing, by, ending, detail, linear: small } = limit;
        Self {
            value,
            accuracy,
            spacing,
            decided_by: by.name(),
            outcome: ending.map(|kind| BriefOutcome { kind }),
            small,
            detail,
        }
    }
}

/// An error of the rig, and the limits of its size.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct BudgetError {
    /// Dotted path of the error in a scene.
    field: &'static str,
    /// Unit of the error; 1 if it has none.
    unit: &'static str,
    /// Value in the scene, in this unit; `reference` if it has none. The limits are of the scene without any other error.
    value: f64,
    /// Value from which the limits count: that of the scene for `contact.friction`, `gravity` and `table.assumed_restitution`, which is the true
    /// restitution if the scene names none; 0 for an error.
    reference: f64,
    /// Limit below `reference`. Null if there are no such values, and with a `reason`.
    below: Option<BudgetLimit>,
    /// Limit above `reference`. Null with a `reason`.
    above: Option<BudgetLimit>,
    /// Reason for which there are no limits (the scene cannot have this error, or it does nothing here, as the pivot of a table that does not
    /// turn as it strikes), or for which the error is not in `together`.
    reason: Option<String>,
}

impl From<ErrorBudget> for BudgetError {
    fn from(ErrorBudget { name, value, reference, below, above, reason }: ErrorBudget) -> Self {
        let row = name.row();
        Self {
            field: row.path,
            unit: row.unit,
            value,
            reference,
            below: below.map(Into::into),
            above: above.map(Into::into),
            reason,
        }
    }
}

/// Deviation of a field from its `reference` at the factor 1.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct BudgetSize {
    field: &'static str,
    unit: &'static str,
    value: f64,
}

/// Several errors at once, in proportion.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "CommonBudget")]
struct CommonAnswer {
    sizes: Vec<BudgetSize>,
    factor: BudgetLimit,
}

impl From<CommonBudget> for CommonAnswer {
    fn from(CommonBudget { sizes, factor }: CommonBudget) -> Self {
        let size = |(name, value): (Name, f64)| BudgetSize { field: name.row().path, unit: name.row().unit, value };
        Self { sizes: sizes.into_iter().map(size).collect(), factor: factor.into() }
    }
}

/// The largest errors of the rig that keep the verdict, if requested: for friction, gravity and the restitution that the table assumes, and for
/// each error of `table.errors`, `body.offset`, `table.delay`, `table.pivot` and `noise`, alone and all together. A scene that names drag of the
/// air has lines for it too. The scene without errors (no delay, the pivot under the contact) has the verdict to keep. A value keeps it if the
/// scene with it has a verdict no worse and its run survives `bounces` contacts, noise with the draws of the scene's seed. Where no bounce
/// repeats beside that without the error (a constant tilt without state feedback of x, a speed that no energy feedback corrects), and with
/// noise, the run alone decides. `errors`, `together` and `present` are null, with the `reason`, if the scene without errors does not survive or
/// is unstable.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Budget")]
pub struct BudgetAnswer {
    /// The verdict that is kept: of the rig without errors. Null where the run alone decides.
    verdict: Option<VerdictAnswer>,
    /// Number of contacts that a run has to survive.
    bounces: u64,
    errors: Option<Vec<BudgetError>>,
    /// All errors at once that have a limit above 0, each at the same share of the nearer of its limits. Of errors that contradict each other (a
    /// delay, and drag of the air) one is left out, with the `reason` in its line. Signs are turned one by one where that is worse; other signs
    /// may still be worse. Null if fewer than two errors have such a limit.
    together: Option<CommonAnswer>,
    /// The errors of the scene, all in proportion. A factor of 1 or more keeps the verdict. Null for a scene without errors.
    present: Option<CommonAnswer>,
    reason: String,
    #[serde(skip)]
    pub(super) computed: u64,
}

impl BudgetAnswer {
    /// The budget of a scene by runs of so many contacts. None if `go_on` returned false.
    pub(super) fn compute(scene: &Scene, bounces: u64, go_on: &mut impl FnMut() -> bool) -> Option<Self> {
        match find_budget(scene, bounces, go_on) {
            Err(NoMargins::Stopped) => None,
            Err(NoMargins::Because(reason)) => {
                Some(Self { verdict: None, bounces, errors: None, together: None, present: None, reason, computed: 0 })
            }
            Ok(budget::Budget { verdict, errors, together, present, bounces: computed }) => {
                let survives = format!("its run survives {bounces} contacts");
                let kept = match verdict.map(|(verdict, _)| verdict.name()) {
                    Some(verdict) => format!(
                        "a value is kept if the scene with it has a verdict no worse than `{verdict}` and {survives}"
                    ),
                    None => format!("the rig without errors has no linear verdict: a value is kept if {survives}"),
                };
                let ends = if scene.rules().half_length.is_finite() {
                    ""
                } else {
                    "; the table has no ends here (table.length), so a drift aside ends no run by itself"
                };
                Some(Self {
                    verdict: verdict.map(|(verdict, by)| VerdictAnswer {
                        code: code(verdict),
                        text: words(verdict, bounces),
                        decided_by: by.name(),
                        reason: format!("of the rig without errors, by the evidence `{}`", by.name()),
                    }),
                    bounces,
                    errors: Some(errors.into_iter().map(Into::into).collect()),
                    together: together.map(Into::into),
                    present: present.map(Into::into),
                    reason: format!("{kept}{ends}"),
                    computed,
                })
            }
        }
    }
}

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
    let (field, unit) = (gain.name(), gain.unit());
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
