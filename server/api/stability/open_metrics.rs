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

use crate::api::formats::Scraped;
use crate::api::stability::answer::StabilityAnswer;
use crate::api::stability::margins::{HOLDS, MarginNumber, MarginsAnswer};
use crate::api::stability::verdict_name::CODES;

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

/// A gauge for the worst value of each further field.
#[derive(Debug)]
struct WorstParameters(Vec<(&'static str, &'static str, f64)>);

impl EncodeMetric for WorstParameters {
    fn encode(&self, mut encoder: MetricEncoder<'_>) -> fmt::Result {
        for (parameter, unit, value) in &self.0 {
            encoder.encode_family(&[("parameter", *parameter), ("unit", *unit)])?.encode_gauge(value)?;
        }
        Ok(())
    }

    fn metric_type(&self) -> MetricType {
        MetricType::Gauge
    }
}

/// The gauges of an answer.
struct Gauges(Registry);

impl Gauges {
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

    /// The margins over tolerances.
    fn margins(&mut self, margins: &MarginsAnswer) {
        self.flag(HOLDS, "1 if the verdict holds for every body within the tolerances", margins.holds());
        for MarginNumber { name, unit, about, value } in margins.numbers() {
            self.number(name, if unit == "m" { "meters" } else { unit }, about, value);
        }
        let worst: Vec<_> = margins.worst_parameters().collect();
        if !worst.is_empty() {
            let help = "Value of a further field with the smallest critical tilt gain";
            self.0.register("margins_worst_parameter", help, WorstParameters(worst));
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

impl Scraped for StabilityAnswer<'_> {
    fn to_open_metrics(&self) -> Result<String, fmt::Error> {
        let mut gauges = Gauges(Registry::with_prefix("equipoise_stability"));
        let linear = self.linear.as_ref();
        let tilt = linear.and_then(|it| it.tilt_gain.as_ref());
        let energy = linear.map(|it| &it.energy_gain);
        let lyapunov = self.lyapunov.as_ref();
        let run = &self.nonlinear;
        gauges.one_of(("verdict", "verdict_code"), "Verdict: 1 for the one that holds", &CODES, self.verdict_code);
        let classes = [AngleClass::Attracting, AngleClass::Elliptic, AngleClass::Parabolic, AngleClass::Hyperbolic]
            .map(AngleClass::name);
        gauges.one_of(("linear_class", "class"), "Class of the linear map", &classes, linear.map(|it| it.class));
        gauges.flag("agree", "1 if the linear verdict and the run agree", self.agree);
        gauges.number("tilt_gain", "", "Tilt gain", tilt.map(|it| it.value));
        gauges.number("tilt_gain_lower", "", "Lower end of the stable tilt gains", tilt.map(|it| it.lower));
        gauges.number("tilt_gain_critical", "", "Upper end of the stable tilt gains", tilt.map(|it| it.critical));
        let below = tilt.map(|it| it.margin_below);
        gauges.number("tilt_gain_margin_below", "", "Distance of the tilt gain above its lower end", below);
        let above = tilt.map(|it| it.margin_above);
        gauges.number("tilt_gain_margin_above", "", "Distance of the tilt gain below its upper end", above);
        gauges.number("energy_gain", "s2_per_m2", "Energy gain", energy.map(|it| it.value));
        let upper = energy.and_then(|it| it.upper);
        gauges.number("energy_gain_upper", "s2_per_m2", "Upper end of the stable energy gains", upper);
        let margin = energy.and_then(|it| it.margin);
        gauges.number("energy_gain_margin", "s2_per_m2", "Distance of the energy gain from its nearer end", margin);
        gauges.number("energy_eigenvalue", "", "Eigenvalue of the height", energy.map(|it| it.eigenvalue));
        gauges.number("residue", "", "Greene's residue, stable between 0 and 1", linear.and_then(|it| it.residue));
        gauges.number("rotation", "radians", "Rotation per bounce", linear.and_then(|it| it.rotation));
        gauges.number("spectral_radius", "", "Largest modulus of the eigenvalues", linear.map(|it| it.spectral_radius));
        let boundary = self.boundary.as_ref().map(|it| it.coefficient);
        gauges.number("boundary_coefficient", "", "Loss of stability at the upper end: soft if positive", boundary);
        let coefficient = lyapunov.map(|it| it.coefficient);
        let help = "First Lyapunov coefficient, per bounce: swings grow if positive";
        gauges.number("lyapunov_coefficient", "per_rad2", help, coefficient);
        let escape = lyapunov.and_then(|it| it.escape_impacts).map(count);
        gauges.number("escape_impacts", "", "Impacts in which the swing leaves upright", escape);
        gauges.number("drift_speed", "meters_per_second", "Permanent horizontal velocity", self.drift_speed);
        let survived = run.outcome == EndingKind::Completed.name();
        gauges.flag("run_survived", "1 if the run lasted for all impacts", Some(survived));
        gauges.number("run_impacts", "", "Contacts of the run", Some(count(run.impacts)));
        gauges.number("run_duration", "seconds", "Run time of the last contact", Some(run.t));
        gauges.number("run_max_theta", "radians", "Largest angle at a contact, either way", Some(run.max_theta));
        let basin = self.basin.as_ref();
        gauges.number("basin_theta", "radians", "Largest angle of release that survives", basin.map(|it| it.theta));
        let help = "Largest angle of release below which all survive";
        gauges.number("basin_unbroken", "radians", help, basin.map(|it| it.unbroken));
        if let Some(margins) = &self.margins {
            gauges.margins(margins);
        }
        let mut text = String::new();
        encode(&mut text, &gauges.0)?;
        Ok(text)
    }
}
