//! `/v1/precision`: speed against accuracy of all methods. The answer has measured times, so it is never cached.

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::scene::Scene;
use serde_json::json;

use crate::api::prelude::*;
use crate::api::shared::write::Progress;
use crate::charts::{CostAndError, SYMBOLS, Series, SpeedAccuracy, speed_accuracy};
use crate::comparison::{
    ComparedMethod, METHODS, MethodSetting, ReferenceRun, Unavailable, WorkPrecisionChart, WorkPrecisionPoint, chart,
    most_points,
};
use crate::http::request::reader;

impl ComputedResource for PrecisionRequest {
    const NAME: &'static str = "precision";
    const SINGULAR: &'static str = "Precision";
    type Format = ProgressFormat;
    const WORK: Work<Self, ProgressFormat> = Work::Measured {
        streamed: &[Format::Progress],
        compute: |request, format, slice, out, bounces| {
            let mut lines = Progress::default();
            let mut tell = |done, of| {
                if format == ProgressFormat::Progress {
                    out.send(lines.line(done, of));
                }
            };
            let answer = PrecisionAnswer::compute(request, &mut tell, slice)?;
            bounces.inc_by(answer.bounces());
            Ok(out.send_whole(format.write(&answer, slice)?, slice)?)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<PrecisionAnswer>()
            .table("One row for each point.", COLUMNS.iter().map(RowColumn::word))
            .end_of::<PrecisionAnswer>(PrecisionAnswer::END)
            .progress(&CostAxis::ALL.map(|(name, _)| name));
    }
}

request_fields! {
    /// A request for the comparison.
    #[derive(Debug, Clone)]
    pub struct PrecisionRequest {
        /// The scene.
        pub scene: Scene = SceneSpec,
        /// Impacts of every run.
        pub bounces: u64 = whole(1..=limits::PRECISION_BOUNCES).or(100),
        /// Measure of cost along the axis of the picture.
        pub axis: CostAxis = choice(&CostAxis::ALL).or(CostAxis::Time),
        /// The methods to run; by default all. Answers keep their own order.
        pub methods: Vec<ComparedMethod> = Methods,
    }
}

/// The cost that is drawn along the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostAxis {
    /// Clock time.
    Time,
    /// Evaluations of motion and gap.
    Evaluations,
    /// Steps. Steps of different methods are different work, so no point is better than another by them.
    Steps,
}

impl CostAxis {
    /// All axes, by their names in requests.
    pub const ALL: [(&'static str, Self); 3] =
        [("time", Self::Time), ("evaluations", Self::Evaluations), ("steps", Self::Steps)];
}

/// Some of the methods, in their own order; all by default.
#[derive(Debug, Clone, Copy)]
struct Methods;

impl FieldSpec<Vec<ComparedMethod>> for Methods {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Vec<ComparedMethod>> {
        if !reader.has(name) {
            return Some(METHODS.into());
        }
        let names = reader.array(name, METHODS.len())?;
        if names.is_empty() {
            reader.refuse(name, format!("{name} is empty; leave it out for all of them"));
        }
        let known = METHODS.map(|method| (method.name, method));
        let mut asked = Vec::new();
        for (index, word) in names.iter().enumerate() {
            match reader::choice(word, &known) {
                Ok(method) => asked.push(method),
                Err(error) => {
                    let pointer = format!("{}/{index}", reader.pointer_to(name));
                    reader.errors().push(pointer, format!("{name} {index} {error}"));
                }
            }
        }
        Some(METHODS.into_iter().filter(|method| asked.contains(method)).collect())
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let word = json!({"$ref": "#/components/schemas/PrecisionMethod"});
        list.property(name, about, &json!({"type": "array", "minItems": 1, "maxItems": METHODS.len(), "items": word}));
        for index in 0..METHODS.len() {
            list.parameter(&format!("{name}.{index}"), "A method to run. Indices have no gaps.", word.clone(), None);
        }
    }
}

impl ResourceRequest for PrecisionRequest {
    /// The clock runs for the same time at each point.
    fn work(&self) -> u64 {
        limits::PRECISION_PRICE * most_points(&self.methods)
    }
}

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
struct PrecisionMethodInWords {
    #[schemars(with = "PrecisionMethod")]
    name: &'static str,
    /// For a legend.
    title: &'static str,
    about: &'static str,
}

/// Outcome of a run.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct PrecisionOutcome {
    #[schemars(with = "PrecisionOutcomeKind")]
    kind: &'static str,
    /// Impacts that the method detected, including the last.
    bounces: u64,
    /// Time of the last impact, s. Of the reference alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    t: Option<f64>,
}

/// The run that errors are taken from.
#[derive(Debug, Serialize, JsonSchema)]
struct PrecisionReference {
    /// The map with 31 digits.
    #[schemars(with = "PrecisionMethod")]
    method: &'static str,
    /// Errors are taken just before its last impact.
    outcome: PrecisionOutcome,
    /// One unit in the last place of a double as large as its last state, m/s.
    rounding: f64,
}

/// Setting of a method.
#[derive(Debug, Serialize, JsonSchema)]
struct PrecisionSetting {
    #[schemars(with = "SettingName")]
    name: &'static str,
    value: f64,
    #[schemars(with = "SettingUnit")]
    unit: &'static str,
}

/// A method with a setting.
#[derive(Debug, Serialize, JsonSchema)]
struct PrecisionPoint {
    #[schemars(with = "PrecisionMethod")]
    method: &'static str,
    /// Null for methods without a setting.
    setting: Option<PrecisionSetting>,
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
pub struct PrecisionAnswer {
    scene: Resolved,
    model: ModelChoice,
    /// Impacts requested.
    bounces: u64,
    reference: PrecisionReference,
    methods: Vec<PrecisionMethodInWords>,
    points: Vec<PrecisionPoint>,
    notes: Vec<String>,
    #[serde(skip)]
    chart: WorkPrecisionChart,
    #[serde(skip)]
    axis: CostAxis,
}

impl PrecisionAnswer {
    /// Runs and times all methods. Calls `progress` with the work done and the whole work.
    pub fn compute(
        request: &PrecisionRequest,
        progress: &mut dyn FnMut(u64, u64),
        slice: &TimeSlice,
    ) -> Result<Self, Cancelled> {
        let scene = &request.scene;
        let chart = chart(&scene.without_noise(), request.bounces, &request.methods, progress, slice)?;
        let named = |method: &ComparedMethod| PrecisionMethodInWords {
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
            scene: Resolved(*scene),
            model: ModelChoice::of(scene),
            bounces: request.bounces,
            reference: PrecisionReference { method: "extended", outcome, rounding },
            methods: request.methods.iter().map(named).collect(),
            points: chart.points.iter().map(|point| PrecisionPoint::of(scene, point, bounces)).collect(),
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

impl Tabular for PrecisionAnswer {
    const END: &'static [&'static str] = &["reference", "notes"];

    /// A row for each method and setting.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(table_of(&COLUMNS, &self.points))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["points"]
    }
}

/// Columns of the points.
#[rustfmt::skip]
const COLUMNS: [RowColumn<PrecisionPoint>; 18] = [
    RowColumn::new("method", "", "", Read::Word(|point: &PrecisionPoint| Some(point.method))).among("PrecisionMethod"),
    RowColumn::new("setting", "", "", Read::Word(|point: &PrecisionPoint| Some(point.setting.as_ref()?.name))).among("SettingName"),
    RowColumn::new("setting_value", "", "", Read::Sparse(|point| Some(point.setting.as_ref()?.value))),
    RowColumn::new("setting_unit", "", "", Read::Word(|point: &PrecisionPoint| Some(point.setting.as_ref()?.unit))).among("SettingUnit"),
    RowColumn::new("cost", "ns_per_bounce", "Median of the clock time.", Read::Sparse(|point| point.cost_ns_per_bounce)),
    RowColumn::new("cost_lower", "ns_per_bounce", "Its lower quartile.", Read::Sparse(|point| Some(point.spread_ns_per_bounce?[0]))),
    RowColumn::new("cost_upper", "ns_per_bounce", "Its upper quartile.", Read::Sparse(|point| Some(point.spread_ns_per_bounce?[1]))),
    RowColumn::new("repeats", "", "", Read::Count(|point| point.repeats)),
    RowColumn::new("bounces", "", "", Read::Count(|point| point.outcome.bounces)),
    RowColumn::new("steps", "", "", Read::Count(|point| point.steps)),
    RowColumn::new("evaluations", "", "", Read::SparseCount(|point| point.evaluations)),
    RowColumn::new("error", "m_per_s", "", Read::Sparse(|point| point.error)),
    RowColumn::new("error_at", "", "Impact at which the error is taken.", Read::SparseCount(|point| point.error_at)),
    RowColumn::new("outcome", "", "", Read::Word(|point: &PrecisionPoint| Some(point.outcome.kind))).among("PrecisionOutcomeKind"),
    RowColumn::new("completed", "", "", Read::Flag(|point| Some(point.completed))),
    RowColumn::new("reason", "", "", Read::Text(|point| point.reason.clone())),
    RowColumn::new("pareto", "", "", Read::Flag(|point| Some(point.pareto))),
    RowColumn::new("pareto_evaluations", "", "", Read::Flag(|point| Some(point.pareto_evaluations))),
];

impl PrecisionPoint {
    fn of(scene: &Scene, point: &WorkPrecisionPoint, error_at: u64) -> Self {
        let cost = point.cost_ns();
        let setting = point.setting.map(|MethodSetting { name, value, unit }| PrecisionSetting { name, value, unit });
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

const _: () = assert!(SYMBOLS.len() == METHODS.len(), "each method has a symbol of its own");

impl Pictured for PrecisionAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        Ok(self.draw(self.axis))
    }
}

impl Watched for PrecisionAnswer {
    /// The picture over each cost: no second request has the same measurement.
    fn to_pictures(&self) -> Result<Vec<(&'static str, String)>, Problem> {
        Ok(CostAxis::ALL.map(|(name, axis)| (name, self.draw(axis))).into())
    }
}

impl PrecisionAnswer {
    fn draw(&self, axis: CostAxis) -> String {
        let (cost_name, unit) = match axis {
            CostAxis::Time => ("clock time", "ns per impact"),
            CostAxis::Evaluations => ("evaluations of motion and gap", "per impact"),
            CostAxis::Steps => ("steps", "per impact"),
        };
        let cost = |point: &WorkPrecisionPoint| match axis {
            CostAxis::Time => point.cost_ns(),
            CostAxis::Evaluations => point.evaluations_per_bounce().map(|count| [count; 3]),
            CostAxis::Steps => point.steps_per_bounce().map(|count| [count; 3]),
        };
        let is_first = |point: &WorkPrecisionPoint| match axis {
            CostAxis::Time => point.pareto,
            CostAxis::Evaluations => point.pareto_evaluations,
            CostAxis::Steps => false,
        };
        let points = &self.chart.points;
        let place = |point: &WorkPrecisionPoint| cost(point).filter(|cost| cost[1] > 0.0).zip(point.error);
        let series: Vec<Series<'_>> = METHODS
            .iter()
            .zip(SYMBOLS)
            .map(|(method, symbol)| {
                let own = points.iter().enumerate().filter(|(_, point)| point.method == *method);
                let own = own
                    .filter_map(|(index, point)| place(point).map(|(cost, error)| CostAndError { index, cost, error }));
                Series { symbol, name: method.name, label: method.title, points: own.collect() }
            })
            .filter(|series| !series.points.is_empty())
            .collect();
        let front: Vec<_> = points
            .iter()
            .filter(|point| is_first(point))
            .filter_map(|point| place(point).map(|(cost, error)| (cost[1], error)))
            .collect();
        let PrecisionOutcome { kind, bounces, .. } = self.reference.outcome;
        let missing: Vec<String> = self
            .methods
            .iter()
            .filter(|method| method.name != "extended" && series.iter().all(|series| series.label != method.title))
            .map(|method| method.title.to_owned())
            .collect();
        let bars = if axis == CostAxis::Time { "; bars are quartiles" } else { "" };
        let front_in_words = match axis {
            CostAxis::Time | CostAxis::Evaluations => "No point lies below the Pareto front.",
            CostAxis::Steps => "Steps of different methods are different work, so there is no front.",
        };
        let mut caption = format!("Each point is a step or a tolerance{bars}. {front_in_words}");
        if let Some([_, cost_ns, _]) =
            points.iter().find(|point| point.method.name == "extended").and_then(WorkPrecisionPoint::cost_ns)
        {
            caption += &format!(" The reference takes {cost_ns:.0} ns per impact.");
        }
        if !missing.is_empty() {
            caption += &format!(" Not drawn, since their runs end otherwise or not at all: {}.", missing.join(", "));
        }
        speed_accuracy(&SpeedAccuracy {
            title: "Speed against accuracy",
            subtitle: &format!(
                "{}, {bounces} bounces, {kind}: how far methods end from the run with 31 digits",
                self.model.name.replace('_', " ")
            ),
            caption: &caption,
            cost: (cost_name, unit),
            error: &format!("error at impact {bounces}"),
            series: &series,
            front: &front,
            rounding: self.reference.rounding,
        })
    }
}
