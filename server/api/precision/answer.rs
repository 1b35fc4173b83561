//! The answer of `precision`: every method over its settings, with its cost and its error.

use std::borrow::Cow;

use equipoise_physics::scene::Scene;
use serde::Serialize;

use crate::api::formats::Tabular;
use crate::api::precision::request::{CostAxis, PrecisionRequest};
use crate::api::scene::Resolved;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::{lacking, noiseless};
use crate::api::shared::table::{Cells, Column, Table};
use crate::comparison::{
    ComparedMethod, MethodSetting, ReferenceRun, Unavailable, WorkPrecisionChart, WorkPrecisionPoint, chart,
};
use crate::compute::{Cancelled, TimeSlice};

#[derive(Debug, Serialize)]
pub(super) struct ComparedMethodAnswer {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    about: &'static str,
}

#[derive(Debug, Serialize)]
pub(super) struct ReferenceAnswer {
    method: &'static str,
    pub(super) outcome: &'static str,
    pub(super) impacts: u64,
    t: f64,
    pub(super) rounding: f64,
}

#[derive(Debug, Serialize)]
struct SettingAnswer {
    name: &'static str,
    value: f64,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct PointAnswer {
    method: &'static str,
    setting: Option<SettingAnswer>,
    cost_ns_per_impact: Option<f64>,
    spread_ns_per_impact: Option<[f64; 2]>,
    repeats: usize,
    impacts: u64,
    steps: u64,
    evaluations: Option<u64>,
    error: Option<f64>,
    error_at: Option<u64>,
    outcome: &'static str,
    completed: bool,
    reason: Option<String>,
    pareto: bool,
    pareto_evaluations: bool,
}

/// Answer of `/v1/precision`.
#[derive(Debug, Serialize)]
pub struct PrecisionAnswer<'a> {
    scene: Resolved<'a>,
    pub(super) model: ModelChoice,
    impacts: u64,
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
        let chart = chart(&scene.without_noise(), request.impacts, &request.methods, progress, slice)?;
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
        let ReferenceRun { outcome, impacts, t, rounding } = chart.reference;
        Ok(Self {
            scene: Resolved(scene),
            model: ModelChoice::of(scene),
            impacts: request.impacts,
            reference: ReferenceAnswer { method: "extended", outcome, impacts, t, rounding },
            methods: request.methods.iter().map(named).collect(),
            points: chart.points.iter().map(|point| PointAnswer::of(scene, point, impacts)).collect(),
            notes,
            chart,
            axis: request.axis,
        })
    }

    /// Approximate number of bounces computed.
    pub fn bounces(&self) -> u64 {
        self.points.iter().map(|point| point.impacts * (point.repeats as u64 + 1)).sum()
    }
}

impl Tabular for PrecisionAnswer<'_> {
    /// A row for each method and setting.
    fn to_table(&self) -> Cow<'_, Table> {
        let points = || self.points.iter();
        let setting = |point: &PointAnswer| point.setting.as_ref().map(|setting| setting.value);
        let words = |of: fn(&PointAnswer) -> Option<&'static str>| Cells::Words(points().map(of).collect());
        let numbers = |of: fn(&PointAnswer) -> Option<f64>| Cells::Sparse(points().map(of).collect());
        let counts = |of: fn(&PointAnswer) -> u64| Cells::Counts(points().map(of).collect());
        let flags = |of: fn(&PointAnswer) -> bool| Cells::Flags(points().map(|point| Some(of(point))).collect());
        let columns = [
            ("method", "", words(|point| Some(point.method))),
            ("setting", "", words(|point| Some(point.setting.as_ref()?.name))),
            ("setting_value", "", Cells::Sparse(points().map(setting).collect())),
            ("setting_unit", "", words(|point| Some(point.setting.as_ref()?.unit))),
            ("cost", "ns_per_impact", numbers(|point| point.cost_ns_per_impact)),
            ("cost_lower", "ns_per_impact", numbers(|point| Some(point.spread_ns_per_impact?[0]))),
            ("cost_upper", "ns_per_impact", numbers(|point| Some(point.spread_ns_per_impact?[1]))),
            ("repeats", "", counts(|point| point.repeats as u64)),
            ("impacts", "", counts(|point| point.impacts)),
            ("steps", "", counts(|point| point.steps)),
            ("evaluations", "", Cells::SparseCounts(points().map(|point| point.evaluations).collect())),
            ("error", "m_per_s", numbers(|point| point.error)),
            ("error_at", "", Cells::SparseCounts(points().map(|point| point.error_at).collect())),
            ("outcome", "", words(|point| Some(point.outcome))),
            ("completed", "", flags(|point| point.completed)),
            ("reason", "", Cells::Texts(points().map(|point| point.reason.clone()).collect())),
            ("pareto", "", flags(|point| point.pareto)),
            ("pareto_evaluations", "", flags(|point| point.pareto_evaluations)),
        ];
        Cow::Owned(Table(columns.map(|(name, unit, cells)| Column { name, unit, cells }).into()))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["points"]
    }

    fn end(&self) -> impl Serialize {
        serde_json::json!({ "reference": self.reference, "notes": self.notes })
    }
}

impl PointAnswer {
    fn of(scene: &Scene, point: &WorkPrecisionPoint, error_at: u64) -> Self {
        let cost = point.cost_ns();
        let setting = point.setting.map(|MethodSetting { name, value, unit }| SettingAnswer { name, value, unit });
        Self {
            method: point.method.name,
            setting,
            cost_ns_per_impact: cost.map(|cost| cost[1]),
            spread_ns_per_impact: cost.map(|cost| [cost[0], cost[2]]),
            repeats: point.timing.map_or(0, |timing| timing.repeats),
            impacts: point.impacts,
            steps: point.steps,
            evaluations: point.evaluations,
            error: point.error,
            error_at: point.error.map(|_| error_at),
            outcome: point.outcome,
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
