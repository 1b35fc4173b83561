//! The request and the answer of `precision`: every method over its settings, what it costs and how far it is off.

use equipoise_physics::scene::Scene;
use serde::Serialize;

use crate::api::scene::Resolved;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::trajectories::answer::Choice;
use crate::charts::{Series, SpeedAccuracy, speed_accuracy};
use crate::comparison::{Chart, METHODS, Method, chart, most_points};
use crate::compute::{Cancelled, Price, Turn};
use crate::http::Reader;
use crate::http::request::scalar;
use crate::limits;

/// What is asked for beside the scene.
#[derive(Debug, Clone)]
pub struct Request {
    impacts: u64,
    methods: Vec<Method>,
    axis: Axis,
}

/// What cost is along the picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    Time,
    Evaluations,
}

impl Request {
    /// Reads everything but the scene.
    pub fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let before = reader.errors().len();
        let impacts = reader.integer("impacts", 1..=limits::PRECISION_IMPACTS).unwrap_or(100);
        let axis = reader.choice("axis", &[("time", Axis::Time), ("evaluations", Axis::Evaluations)]);
        let known = METHODS.map(|method| (method.name, method));
        let mut asked = Vec::new();
        let names = reader.array("methods", METHODS.len());
        for (index, name) in names.unwrap_or_default().iter().enumerate() {
            match scalar::choice(name, &known) {
                Ok(method) => asked.push(method),
                Err(error) => {
                    let pointer = format!("{}/{index}", reader.pointer_to("methods"));
                    reader.errors().push(pointer, format!("methods {index} {error}"));
                }
            }
        }
        if names.is_some_and(<[_]>::is_empty) {
            reader.refuse("methods", "methods is empty; leave it out for all of them");
        }
        if reader.errors().len() > before {
            return None;
        }
        let wanted = |method: &Method| names.is_none() || asked.contains(method);
        let methods = METHODS.into_iter().filter(wanted).collect();
        Some(Self { impacts, methods, axis: axis.unwrap_or(Axis::Time) })
    }

    /// What it costs: the clock runs as long for each of its points.
    pub fn price(&self) -> Price {
        Price::bounces(limits::PRECISION_PRICE).times(most_points(&self.methods))
    }
}

#[derive(Debug, Serialize)]
struct Named {
    name: &'static str,
    title: &'static str,
    about: &'static str,
}

#[derive(Debug, Serialize)]
struct Reference {
    method: &'static str,
    outcome: &'static str,
    impacts: u64,
    t: f64,
    rounding: f64,
}

#[derive(Debug, Serialize)]
struct Setting {
    name: &'static str,
    value: f64,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct Point {
    method: &'static str,
    setting: Option<Setting>,
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

/// The answer.
#[derive(Debug, Serialize)]
pub struct Precision<'a> {
    scene: Resolved<'a>,
    model: Choice,
    impacts: u64,
    reference: Reference,
    methods: Vec<Named>,
    points: Vec<Point>,
    notes: Vec<String>,
    #[serde(skip)]
    chart: Chart,
    #[serde(skip)]
    axis: Axis,
}

impl<'a> Precision<'a> {
    /// Runs and times all of it, and tells `progress` how much of how much is done.
    pub fn compute(
        scene: &'a Scene,
        request: &Request,
        progress: &mut dyn FnMut(u64, u64),
        turn: &Turn,
    ) -> Result<Self, Cancelled> {
        let chart = chart(scene, request.impacts, &request.methods, progress, turn)?;
        let named = |method: &Method| Named { name: method.name, title: method.title, about: method.about };
        let mut notes = vec![
            "cost is measured on this machine while it serves others; steps, evaluations and errors are the same everywhere"
                .to_owned(),
            "the cost of linear is that of its impacts with their bounds; its solution is made once before".to_owned(),
        ];
        notes.extend(chart.notes.iter().cloned());
        let crate::comparison::Reference { outcome, impacts, t, rounding } = chart.reference;
        Ok(Self {
            scene: Resolved(scene),
            model: Choice::model(scene),
            impacts: request.impacts,
            reference: Reference { method: "extended", outcome, impacts, t, rounding },
            methods: request.methods.iter().map(named).collect(),
            points: chart.points.iter().map(|point| Point::of(point, impacts)).collect(),
            notes,
            chart,
            axis: request.axis,
        })
    }

    /// Its points as a table.
    pub fn to_table(&self) -> Table {
        let points = || self.points.iter();
        let setting = |point: &Point| point.setting.as_ref().map(|setting| setting.value);
        let words = |of: fn(&Point) -> Option<&'static str>| Cells::Words(points().map(of).collect());
        let numbers = |of: fn(&Point) -> Option<f64>| Cells::Sparse(points().map(of).collect());
        let counts = |of: fn(&Point) -> u64| Cells::Counts(points().map(of).collect());
        let flags = |of: fn(&Point) -> bool| Cells::Flags(points().map(|point| Some(of(point))).collect());
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
        Table(columns.map(|(name, unit, cells)| Column { name, unit, cells }).into())
    }

    /// What ends it as NDJSON.
    pub fn end(&self) -> impl Serialize {
        serde_json::json!({ "reference": self.reference, "notes": self.notes })
    }

    /// Error over cost, as SVG.
    pub fn to_picture(&self) -> String {
        let (cost_name, unit) = match self.axis {
            Axis::Time => ("clock time", "ns per impact"),
            Axis::Evaluations => ("evaluations of motion and gap", "per impact"),
        };
        let cost = |point: &crate::comparison::Point| match self.axis {
            Axis::Time => point.cost_ns(),
            Axis::Evaluations => point.evaluations_per_impact().map(|count| [count; 3]),
        };
        let is_first = |point: &crate::comparison::Point| match self.axis {
            Axis::Time => point.pareto,
            Axis::Evaluations => point.pareto_evaluations,
        };
        let points = &self.chart.points;
        let place = |point: &crate::comparison::Point| cost(point).zip(point.error);
        let series: Vec<Series<'_>> = METHODS
            .iter()
            .enumerate()
            .map(|(number, method)| {
                let own = points.iter().filter(|point| point.method == *method);
                Series { number, label: method.title, points: own.filter_map(place).collect() }
            })
            .filter(|series| !series.points.is_empty())
            .collect();
        let front: Vec<_> = points
            .iter()
            .filter(|point| is_first(point))
            .filter_map(|point| place(point).map(|(cost, error)| (cost[1], error)))
            .collect();
        let Reference { outcome, impacts, .. } = self.reference;
        let missing: Vec<String> = self
            .methods
            .iter()
            .filter(|method| method.name != "extended" && series.iter().all(|series| series.label != method.title))
            .map(|method| method.title.to_owned())
            .collect();
        let bars = if self.axis == Axis::Time { "; bars are quartiles" } else { "" };
        let mut caption = format!("Each point is a step or a tolerance{bars}. No point lies below the Pareto front.");
        if let Some([_, cost_ns, _]) =
            points.iter().find(|point| point.method.name == "extended").and_then(crate::comparison::Point::cost_ns)
        {
            caption += &format!(" The reference takes {cost_ns:.0} ns per impact.");
        }
        if !missing.is_empty() {
            caption += &format!(" Not drawn, since their runs end otherwise or not at all: {}.", missing.join(", "));
        }
        speed_accuracy(&SpeedAccuracy {
            title: "Speed against accuracy",
            subtitle: &format!(
                "{}, {impacts} impacts, {outcome}: how far methods end from the run with 31 digits",
                self.model.name.replace('_', " ")
            ),
            caption: &caption,
            cost: (cost_name, unit),
            error: &format!("error at impact {impacts}"),
            series: &series,
            front: &front,
            rounding: self.reference.rounding,
        })
    }

    /// How many bounces were computed for it, about.
    pub fn bounces(&self) -> u64 {
        self.points.iter().map(|point| point.impacts * (point.repeats as u64 + 1)).sum()
    }
}

impl Point {
    fn of(point: &crate::comparison::Point, error_at: u64) -> Self {
        let cost = point.cost_ns();
        let setting =
            point.setting.map(|crate::comparison::Setting { name, value, unit }| Setting { name, value, unit });
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
            reason: point.reason.clone(),
            pareto: point.pareto,
            pareto_evaluations: point.pareto_evaluations,
        }
    }
}
