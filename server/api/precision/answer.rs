//! The answer of `precision`: every method over its settings, with its cost and its error.

use std::borrow::Cow;

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::scene::Scene;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::formats::Tabular;
use crate::api::precision::request::{CostAxis, PrecisionRequest};
use crate::api::scene::Resolved;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::{lacking, noiseless};
use crate::api::shared::table::Table;
use crate::api::shared::table::columns::{RowColumn, table_of};
use crate::api::shared::table::gather::Read;
use crate::comparison::{
    ComparedMethod, METHODS, MethodSetting, ReferenceRun, Unavailable, WorkPrecisionChart, WorkPrecisionPoint, chart,
};
use crate::compute::{Cancelled, TimeSlice};
use crate::words;

words! {
    /// A method.
    PrecisionMethod = METHODS.map(|method| method.name);
    /// Ending of a run: as in `trajectories`; `missed`, if it went below the table without detecting the contact; `out_of_steps`; or `unavailable`,
    /// without a run, for the reason in `reason`.
    PrecisionOutcomeKind = EndingKind::ALL.map(EndingKind::name).into_iter().chain(["out_of_steps", "unavailable"]);
    /// A setting.
    SettingName = ["step", "tolerance"];
    /// Unit of a setting.
    SettingUnit = ["s", "1"];
}

/// A method in words.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PrecisionMethodInWords")]
pub(super) struct ComparedMethodAnswer {
    #[schemars(with = "PrecisionMethod")]
    pub(super) name: &'static str,
    /// For a legend.
    pub(super) title: &'static str,
    about: &'static str,
}

/// Outcome of a run.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(super) struct PrecisionOutcome {
    #[schemars(with = "PrecisionOutcomeKind")]
    pub(super) kind: &'static str,
    /// Impacts that the method detected, including the last.
    pub(super) bounces: u64,
    /// Time of the last impact, s. Of the reference alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    t: Option<f64>,
}

/// The run that errors are taken from.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PrecisionReference")]
pub(super) struct ReferenceAnswer {
    /// The map with 31 digits.
    #[schemars(with = "PrecisionMethod")]
    method: &'static str,
    /// Errors are taken just before its last impact.
    pub(super) outcome: PrecisionOutcome,
    /// One unit in the last place of a double as large as its last state, m/s.
    pub(super) rounding: f64,
}

/// Setting of a method.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PrecisionSetting")]
struct SettingAnswer {
    #[schemars(with = "SettingName")]
    name: &'static str,
    value: f64,
    #[schemars(with = "SettingUnit")]
    unit: &'static str,
}

/// A method with a setting.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PrecisionPoint")]
pub(super) struct PointAnswer {
    #[schemars(with = "PrecisionMethod")]
    method: &'static str,
    /// Null for methods without a setting.
    setting: Option<SettingAnswer>,
    /// Clock time of a run divided by its impacts, ns. The median of repeats. Null without an impact.
    cost_ns_per_bounce: Option<f64>,
    /// Lower and upper quartile of the cost, ns.
    spread_ns_per_bounce: Option<[f64; 2]>,
    /// Number of measurements for the median; each repeats short runs several times.
    repeats: u64,
    /// Steps, samples or bounces of the whole run. The same on every machine.
    steps: u64,
    /// Evaluations of the equations of motion and of the gap in the whole run, or of the closed form. The same on every machine. Null for numbers
    /// of 31 digits, whose evaluations are not comparable.
    evaluations: Option<u64>,
    /// The largest of |ρδθ|, |δx_dot|, |δy_dot| and |ρδθ_dot| just before impact `error_at`, m/s. Null if the method ends differently from the
    /// reference, and for the reference itself; `reason` says so.
    error: Option<f64>,
    /// The last impact of the reference, unless there is no error.
    error_at: Option<u64>,
    outcome: PrecisionOutcome,
    /// True if the run reached the last impact requested.
    completed: bool,
    /// Reason for a missing error or run.
    reason: Option<String>,
    /// True if no other point has at most its clock time and at most its error, and less of one.
    pareto: bool,
    /// The same with evaluations per impact in place of time.
    pareto_evaluations: bool,
}

/// Answer of `/v1/precision`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Precision")]
pub struct PrecisionAnswer<'a> {
    scene: Resolved<'a>,
    pub(super) model: ModelChoice,
    /// Impacts requested.
    bounces: u64,
    pub(super) reference: ReferenceAnswer,
    pub(super) methods: Vec<ComparedMethodAnswer>,
    points: Vec<PointAnswer>,
    notes: Vec<String>,
    #[serde(skip)]
    pub(super) chart: WorkPrecisionChart,
    #[serde(skip)]
    pub(super) axis: CostAxis,
}

impl<'a> PrecisionAnswer<'a> {
    /// Runs and times all methods. Calls `progress` with the work done and the whole work.
    pub fn compute(
        request: &'a PrecisionRequest,
        progress: &mut dyn FnMut(u64, u64),
        slice: &TimeSlice,
    ) -> Result<Self, Cancelled> {
        let scene = &request.scene;
        let chart = chart(&scene.without_noise(), request.bounces, &request.methods, progress, slice)?;
        let named = |method: &ComparedMethod| ComparedMethodAnswer {
            name: method.name,
            title: method.title,
            about: method.about,
        };
        let mut notes = vec![
            "cost is measured on this machine while it serves others; steps, evaluations and errors are the \
                 same everywhere"
                .to_owned(),
            "the cost of linear is that of its impacts with their bounds; its solution is made once before".to_owned(),
        ];
        notes.extend(noiseless(scene, "the comparison"));
        notes.extend(chart.notes.iter().cloned());
        let ReferenceRun { outcome: kind, bounces, t, rounding } = chart.reference;
        let outcome = PrecisionOutcome { kind, bounces, t: Some(t) };
        Ok(Self {
            scene: Resolved(scene),
            model: ModelChoice::of(scene),
            bounces: request.bounces,
            reference: ReferenceAnswer { method: "extended", outcome, rounding },
            methods: request.methods.iter().map(named).collect(),
            points: chart.points.iter().map(|point| PointAnswer::of(scene, point, bounces)).collect(),
            notes,
            chart,
            axis: request.axis,
        })
    }

    /// Approximate number of bounces computed.
    pub fn bounces(&self) -> u64 {
        self.points.iter().map(|point| point.outcome.bounces * (point.repeats + 1)).sum()
    }
}

impl Tabular for PrecisionAnswer<'_> {
    /// A row for each method and setting.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(table_of(&COLUMNS, &self.points))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["points"]
    }

    fn end(&self) -> impl Serialize {
        End { reference: &self.reference, notes: &self.notes }
    }
}

/// Columns of the points.
pub(super) const COLUMNS: [RowColumn<PointAnswer>; 18] = [
    RowColumn::new("method", "", "", Read::Word(|point: &PointAnswer| Some(point.method))).among("PrecisionMethod"),
    RowColumn::new("setting", "", "", Read::Word(|point: &PointAnswer| Some(point.setting.as_ref()?.name)))
        .among("SettingName"),
    RowColumn::new("setting_value", "", "", Read::Sparse(|point| Some(point.setting.as_ref()?.value))),
    RowColumn::new("setting_unit", "", "", Read::Word(|point: &PointAnswer| Some(point.setting.as_ref()?.unit)))
        .among("SettingUnit"),
    RowColumn::new(
        "cost",
        "ns_per_bounce",
        "Median of the clock time.",
        Read::Sparse(|point| point.cost_ns_per_bounce),
    ),
    RowColumn::new(
        "cost_lower",
        "ns_per_bounce",
        "Its lower quartile.",
        Read::Sparse(|point| Some(point.spread_ns_per_bounce?[0])),
    ),
    RowColumn::new(
        "cost_upper",
        "ns_per_bounce",
        "Its upper quartile.",
        Read::Sparse(|point| Some(point.spread_ns_per_bounce?[1])),
    ),
    RowColumn::new("repeats", "", "", Read::Count(|point| point.repeats)),
    RowColumn::new("bounces", "", "", Read::Count(|point| point.outcome.bounces)),
    RowColumn::new("steps", "", "", Read::Count(|point| point.steps)),
    RowColumn::new("evaluations", "", "", Read::SparseCount(|point| point.evaluations)),
    RowColumn::new("error", "m_per_s", "", Read::Sparse(|point| point.error)),
    RowColumn::new("error_at", "", "Impact at which the error is taken.", Read::SparseCount(|point| point.error_at)),
    RowColumn::new("outcome", "", "", Read::Word(|point: &PointAnswer| Some(point.outcome.kind)))
        .among("PrecisionOutcomeKind"),
    RowColumn::new("completed", "", "", Read::Flag(|point| Some(point.completed))),
    RowColumn::new("reason", "", "", Read::Text(|point| point.reason.clone())),
    RowColumn::new("pareto", "", "", Read::Flag(|point| Some(point.pareto))),
    RowColumn::new("pareto_evaluations", "", "", Read::Flag(|point| Some(point.pareto_evaluations))),
];

/// The last line of NDJSON.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PrecisionEnd")]
pub(super) struct End<'a> {
    reference: &'a ReferenceAnswer,
    notes: &'a [String],
}

impl PointAnswer {
    fn of(scene: &Scene, point: &WorkPrecisionPoint, error_at: u64) -> Self {
        let cost = point.cost_ns();
        let setting = point.setting.map(|MethodSetting { name, value, unit }| SettingAnswer { name, value, unit });
        Self {
            method: point.method.name,
            setting,
            cost_ns_per_bounce: cost.map(|cost| cost[1]),
            spread_ns_per_bounce: cost.map(|cost| [cost[0], cost[2]]),
            repeats: point.timing.map_or(0, |timing| timing.repeats as u64),
            steps: point.steps,
            evaluations: point.evaluations,
            error: point.error,
            error_at: point.error.map(|_| error_at),
            outcome: PrecisionOutcome { kind: point.outcome, bounces: point.bounces, t: None },
            completed: point.outcome == "completed",
            reason: point.reason.as_ref().map(|reason| match reason {
                Unavailable::Lacks(analysis) => lacking(scene, *analysis).unwrap_or_default(),
                Unavailable::Because(why) => why.clone(),
            }),
            pareto: point.pareto,
            pareto_evaluations: point.pareto_evaluations,
        }
    }
}
