//! The budget of the errors of a rig, as part of the answer.

use equipoise_physics::analysis::margins::budget::{
    self, CommonBudget, ErrorBudget, find_budget, most_runs, most_searches,
};
use equipoise_physics::analysis::margins::judgement::NoBudget;
use equipoise_physics::analysis::margins::judgement::VerdictLimit;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::scene::{Name, Scene};
use serde::Serialize;

use crate::api::scene::bounce_price;
use crate::api::stability::verdict_name::code;

/// Price of a run of the budget without its bounces, in bounces: the scene, its small deviations and normal forms.
pub(super) const RUN_PRICE: u64 = 400;

/// Price of a limit of small deviations, in bounces: the bounce that repeats at several dozen values.
pub(super) const LIMIT_PRICE: u64 = 8_000;

/// Highest price of a budget, in bounces.
pub(super) fn budget_price(scene: &Scene, impacts: u64) -> u64 {
    let of_runs = |(runs, dearest): &(u64, Scene)| runs * (RUN_PRICE + impacts * bounce_price(dearest));
    most_searches(scene) * LIMIT_PRICE + most_runs(scene).iter().map(of_runs).sum::<u64>()
}

#[derive(Debug, Clone, Serialize)]
struct LimitAnswer {
    value: f64,
    accuracy: f64,
    spacing: f64,
    decided_by: &'static str,
    outcome: Option<&'static str>,
    linear: Option<f64>,
    detail: String,
}

impl From<VerdictLimit> for LimitAnswer {
    fn from(limit: VerdictLimit) -> Self {
        let VerdictLimit { value, accuracy, spacing, by, ending, detail, linear } = limit;
        Self { value, accuracy, spacing, decided_by: by.name(), outcome: ending, linear, detail }
    }
}

#[derive(Debug, Clone, Serialize)]
struct ErrorAnswer {
    path: &'static str,
    unit: &'static str,
    value: f64,
    reference: f64,
    below: Option<LimitAnswer>,
    above: Option<LimitAnswer>,
    reason: Option<String>,
}

impl From<ErrorBudget> for ErrorAnswer {
    fn from(ErrorBudget { name, value, reference, below, above, reason }: ErrorBudget) -> Self {
        let row = name.row();
        Self {
            path: row.path,
            unit: row.unit,
            value,
            reference,
            below: below.map(Into::into),
            above: above.map(Into::into),
            reason,
        }
    }
}

#[derive(Debug, Clone, Serialize)]
struct SizeAnswer {
    path: &'static str,
    unit: &'static str,
    value: f64,
}

#[derive(Debug, Clone, Serialize)]
struct CommonAnswer {
    sizes: Vec<SizeAnswer>,
    factor: LimitAnswer,
}

impl From<CommonBudget> for CommonAnswer {
    fn from(CommonBudget { sizes, factor }: CommonBudget) -> Self {
        let size = |(name, value): (Name, f64)| SizeAnswer { path: name.row().path, unit: name.row().unit, value };
        Self { sizes: sizes.into_iter().map(size).collect(), factor: factor.into() }
    }
}

/// The budget of a scene.
#[derive(Debug, Clone, Serialize)]
pub struct BudgetAnswer {
    verdict: Option<&'static str>,
    verdict_code: Option<&'static str>,
    impacts: u64,
    errors: Option<Vec<ErrorAnswer>>,
    together: Option<CommonAnswer>,
    present: Option<CommonAnswer>,
    reason: String,
    #[serde(skip)]
    pub(super) bounces: u64,
}

impl BudgetAnswer {
    /// The budget of a scene by runs of so many contacts. None if `go_on` returned false.
    pub(super) fn compute(scene: &Scene, impacts: u64, go_on: &mut impl FnMut() -> bool) -> Option<Self> {
        match find_budget(scene, impacts, go_on) {
            Err(NoBudget::Stopped) => None,
            Err(NoBudget::Because(reason)) => Some(Self {
                verdict: None,
                verdict_code: None,
                impacts,
                errors: None,
                together: None,
                present: None,
                reason,
                bounces: 0,
            }),
            Ok(budget::Budget { verdict, errors, together, present, bounces }) => {
                let survives = format!("its run survives {impacts} contacts");
                let kept = match verdict.map(Verdict::name) {
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
                    verdict: verdict.map(Verdict::name),
                    verdict_code: verdict.map(code),
                    impacts,
                    errors: Some(errors.into_iter().map(Into::into).collect()),
                    together: together.map(Into::into),
                    present: present.map(Into::into),
                    reason: format!("{kept}{ends}"),
                    bounces,
                })
            }
        }
    }
}
