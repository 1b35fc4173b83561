//! A verdict as OpenMetrics: gauges that Prometheus scrapes, so that it can draw the margins of a rig and raise alerts.
//!
//! A quantity that a scene does not have has no gauge. The order of the gauges is fixed, so the same request gives the same bytes.

use std::fmt;
use std::sync::atomic::AtomicU64;

use equipoise_physics::analysis::linear_verdict::AngleClass;
use equipoise_physics::run::ending::EndingKind;
use prometheus_client::encoding::text::encode;
use prometheus_client::encoding::{EncodeMetric, MetricEncoder};
use prometheus_client::metrics::MetricType;
use prometheus_client::metrics::gauge::Gauge;
use prometheus_client::registry::{Registry, Unit};

use crate::api::computed::stability;
use crate::api::computed::stability::StabilityAnswer;
use crate::api::computed::stability::verdict::CODES;
use crate::api::formats::Scraped;
use crate::api::shared::margins::{Margin, MarginEnd, Side};
use crate::api::shared::outcome::RunEnding;
use crate::api::shared::table::{Read, RowColumn};

/// A gauge for each of several names: 1 for the one that holds, 0 for the others.
#[derive(Debug)]
struct OneOf {
    label: &'static str,
    names: Vec<&'static str>,
    holds: Option<&'static str>,
}

impl EncodeMetric for OneOf {
    fn encode(&self, mut encoder: MetricEncoder<'_>) -> fmt::Result {
        for name in &self.names {
            let value = i64::from(self.holds == Some(name));
            encoder.encode_family(&[(self.label, *name)])?.encode_gauge(&value)?;
        }
        Ok(())
    }

    fn metric_type(&self) -> MetricType {
        MetricType::Gauge
    }
}

/// A gauge for each of several sets of labels.
#[derive(Debug)]
struct Labelled<const LABELS: usize>(Vec<([(&'static str, &'static str); LABELS], f64)>);

impl<const LABELS: usize> EncodeMetric for Labelled<LABELS> {
    fn encode(&self, mut encoder: MetricEncoder<'_>) -> fmt::Result {
        for (labels, value) in &self.0 {
            encoder.encode_family(labels)?.encode_gauge(value)?;
        }
        Ok(())
    }

    fn metric_type(&self) -> MetricType {
        MetricType::Gauge
    }
}

/// The gauges of an answer.
struct Gauges<'r>(&'r mut Registry);

impl Gauges<'_> {
    /// A number, if the scene has it. A unit ends the name.
    fn number(&mut self, name: &str, unit: &str, help: &str, value: Option<f64>) {
        let Some(value) = value.filter(|value| value.is_finite()) else { return };
        let gauge = Gauge::<f64, AtomicU64>::default();
        gauge.set(value);
        if unit.is_empty() {
            self.0.register(name, help, gauge);
        } else {
            self.0.register_with_unit(name, help, Unit::Other(unit.to_owned()), gauge);
        }
    }

    fn flag(&mut self, name: &str, help: &str, value: Option<bool>) {
        self.number(name, "", help, value.map(|value| f64::from(u8::from(value))));
    }

    /// The columns of a row that have numbers.
    fn columns<'c, Row: 'c>(&mut self, row: &Row, columns: impl IntoIterator<Item = &'c RowColumn<Row>>) {
        for column in columns {
            let name = match column.name {
                "bounces" => "run_bounces",
                "t" => "run_duration",
                "max_theta" => "run_max_theta",
                name => name,
            };
            let unit = match column.unit {
                "rad" => "radians",
                "m" => "meters",
                "s" => "seconds",
                "m/s" => "meters_per_second",
                "s²/m²" => "s2_per_m2",
                unit => unit,
            };
            let help = column.about.trim_end_matches('.');
            match column.read {
                Read::Count(read) => self.number(name, unit, help, Some(count(read(row)))),
                Read::SparseCount(read) => self.number(name, unit, help, read(row).map(count)),
                Read::Number(read) => self.number(name, unit, help, Some(read(row))),
                Read::Sparse(read) => self.number(name, unit, help, read(row)),
                Read::Flag(read) => self.flag(name, &help.replacen("True", "1", 1), read(row)),
                Read::Word(_) | Read::Text(_) | Read::List(_) => {}
            }
        }
    }

    fn one_of(
        &mut self,
        (name, label): (&str, &'static str),
        help: &str,
        names: &[&'static str],
        holds: Option<&'static str>,
    ) {
        if holds.is_some() {
            self.0.register(name, help, OneOf { label, names: names.to_vec(), holds });
        }
    }
}

#[expect(clippy::cast_precision_loss, reason = "numbers of impacts are far below 2^53")]
fn count(value: u64) -> f64 {
    value as f64
}

/// Columns that are gauges, in the order of the gauges.
const GAUGES: [&str; 11] = [
    "agree",
    "tilt_gain",
    "energy_gain",
    "energy_eigenvalue",
    "residue",
    "rotation",
    "spectral_radius",
    "boundary_coefficient",
    "lyapunov_coefficient",
    "escape_bounces",
    "drift_speed",
];

/// Likewise of the run.
const RUN_GAUGES: [&str; 5] = ["bounces", "t", "max_theta", "basin_theta", "basin_unbroken"];

impl Scraped for StabilityAnswer {
    fn to_open_metrics(&self) -> Result<String, fmt::Error> {
        let mut all = Registry::with_prefix("equipoise");
        self.register_margins(&mut all);
        let mut gauges = Gauges(all.sub_registry_with_prefix("stability"));
        gauges.one_of(
            ("verdict", "verdict_code"),
            "Verdict: 1 for the one that holds",
            &CODES,
            Some(self.verdict.code),
        );
        let (kinds, kind) = (AngleClass::ALL.map(AngleClass::name), self.linear.as_ref().map(|it| it.kind));
        gauges.one_of(("linear_kind", "kind"), "Kind of the linear map", &kinds, kind);
        let columns = |names: &'static [&'static str]| {
            names.iter().flat_map(|name| Self::COLUMNS.iter().find(|column| column.name == *name))
        };
        gauges.columns(self, columns(&GAUGES));
        let survived = self.nonlinear.outcome.ending == RunEnding::Bouncing(EndingKind::Completed);
        gauges.flag("run_survived", "1 if the run lasted for all impacts", Some(survived));
        gauges.columns(self, columns(&RUN_GAUGES));
        if let Some(over_tolerances) = &self.over_tolerances {
            gauges.columns(over_tolerances, &stability::COLUMNS);
            if !over_tolerances.worst().is_empty() {
                let help = "Value of a field of `tolerances` with the least upper limit of the gain";
                let worst =
                    over_tolerances.worst().iter().map(|it| ([("field", it.field), ("unit", it.unit)], it.value));
                gauges.0.register("over_tolerances_worst", help, Labelled(worst.collect()));
            }
        }
        let mut text = String::new();
        encode(&mut text, &all)?;
        Ok(text)
    }
}

/// Gauges of margins: name, help, and the number of an end.
type MarginGauge = (&'static str, &'static str, fn(&MarginEnd) -> Option<f64>);

const MARGINS: [MarginGauge; 3] = [
    ("margin", "Distance of a field from the value at which it is lost, negative beyond", |end| Some(end.margin)),
    ("margin_limit", "Value of a field at which it is lost", |end| Some(end.limit)),
    ("margin_least", "Least margin of a field over the tolerances", |end| end.least),
];

impl StabilityAnswer {
    fn register_margins(&self, registry: &mut Registry) {
        for (name, help, read) in MARGINS {
            let ends = |margin: &Margin| {
                let labels = |side: Side| {
                    [("field", margin.field), ("side", side.name()), ("of", margin.of), ("unit", margin.unit)]
                };
                Side::ALL.map(|side| Some((labels(side), read(margin.end(side)?)?)))
            };
            let found: Vec<_> = self.margins.iter().flat_map(ends).flatten().collect();
            if !found.is_empty() {
                registry.register(name, help, Labelled(found));
            }
        }
    }
}
