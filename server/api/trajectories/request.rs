//! The request for `trajectories`: a run, the method that computes it, and the numbers that are asked for.

use equipoise_physics::analysis::method::RunMethod;
use equipoise_physics::scene::model::ModelLevel;

use crate::api::catches::columns::OF_HOLD;
use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::shared::write;
use crate::api::trajectories::{columns, flights};
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::scalar::LARGEST_EXACT;
use crate::limits;
use crate::limits::Limits;
use crate::runs::interventions::{intervention_parameters, read_hold, read_run};
use crate::runs::run::Run;

/// A request for a run.
#[derive(Debug, Clone)]
pub struct TrajectoryRequest {
    /// The run: a scene and its interventions.
    pub run: Run,
    /// Highest number of contacts.
    pub impacts: u64,
    /// Points along each flight.
    pub samples_per_flight: u64,
    /// The method, if one is named.
    pub method: Option<RunMethod>,
    /// Wanted bound on the error, m/s, if any.
    pub tolerance: Option<f64>,
    /// Time of the release, unix ms. Without it there is no column `time`.
    pub epoch: Option<u64>,
}

/// Range of tolerances, m/s. Below it no method has enough digits; above it a bound carries no information.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-30..=1.0;

/// Price of an impact with its error estimate by each method, in bounces, and of the linear solution once.
const LINEAR_ONCE: u64 = 2500;
pub(crate) const LINEAR_PRICE: u64 = 20;
const MAP_PRICE: u64 = 8;
const EXTENDED_PRICE: u64 = 50;

/// Price of an error estimate with state feedback or noise, in bounces: its derivatives have more states.
const FULL_ESTIMATE_PRICE: u64 = 120;

/// Price of writing and compressing a contact, in bounces; of a contact with 31 digits; and of a sample of a flight.
const ROW_PRICE: u64 = 24;
const LONG_ROW_PRICE: u64 = 60;
const SAMPLE_PRICE: u64 = 10;

impl ResourceRequest for TrajectoryRequest {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let run = read_run(reader);
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(100);
        let samples_per_flight = reader.integer("samples_per_flight", 0..=limits::SAMPLES_PER_FLIGHT).unwrap_or(0);
        let [linear, map, extended] = RunMethod::ALL.map(|method| (method.name(), Some(method)));
        let method = reader.choice("method", &[("auto", None), map, linear, extended]).flatten();
        let tolerance = reader.number("tolerance", TOLERANCES, "m/s");
        let epoch = reader.integer("epoch", 0..=LARGEST_EXACT);
        let hold = read_hold(reader);
        Some(Self { run: run?.holding(hold), impacts, samples_per_flight, method, tolerance, epoch })
    }

    fn price(&self, limits: &Limits) -> Result<Price, OverBudget> {
        limits.of_answer().admit(self.numbers())?;
        // Without a tolerance or a method with 31 digits, no column has them.
        let is_long = self.tolerance.is_some() || self.method == Some(RunMethod::Extended);
        let bytes = if is_long { limits::LONG_NUMBER_BYTES } else { limits::NUMBER_BYTES };
        Price::bounces(self.work()).taking(self.numbers().saturating_mul(bytes)).within(&limits.of_work())
    }
}

impl CanonicalRequest for TrajectoryRequest {
    fn canonical(&self) -> Vec<u8> {
        let Self { run, impacts, samples_per_flight, method, tolerance, epoch } = self;
        let rest = (impacts, samples_per_flight, method.map(RunMethod::name), tolerance, epoch, run.hold());
        write::canonical(run.scene(), &(rest, intervention_parameters(run)))
    }
}

impl TrajectoryRequest {
    /// Size of the answer, in numbers.
    pub fn numbers(&self) -> u64 {
        let dated = self.epoch.is_some();
        let (impact, sample) = (columns::of_trajectories(dated).count(), flights::columns(dated).count());
        // In CSV and NDJSON each row has the columns of both phases.
        let row = if self.run.hold() > 0.0 { impact + OF_HOLD.len() } else { impact } as u64;
        let held = self.held_samples() * row;
        self.impacts.saturating_mul(row + self.samples_per_flight * sample as u64).saturating_add(held)
    }

    /// Most samples of the contact after the bounces.
    fn held_samples(&self) -> u64 {
        if self.run.hold() > 0.0 { limits::HOLD_SAMPLES } else { 0 }
    }

    /// Price of the work, in bounces.
    fn work(&self) -> u64 {
        let scene = self.run.scene();
        let (once, impact) = match (self.method, self.tolerance) {
            (Some(RunMethod::Linear), _) => (LINEAR_ONCE, LINEAR_PRICE + ROW_PRICE),
            (Some(RunMethod::Map), _) | (None, None) => (0, MAP_PRICE + ROW_PRICE),
            (Some(RunMethod::Extended), _) => (0, EXTENDED_PRICE + LONG_ROW_PRICE),
            // Each method may be tried, and the dearest run twice.
            (None, Some(_)) => (0, MAP_PRICE + 2 * EXTENDED_PRICE + LONG_ROW_PRICE),
        };
        let full = match (self.method, self.tolerance) {
            (Some(RunMethod::Linear), _) => 0,
            (Some(RunMethod::Map | RunMethod::Extended), _) | (None, None) => FULL_ESTIMATE_PRICE,
            (None, Some(_)) => 3 * FULL_ESTIMATE_PRICE,
        };
        let is_full = !scene.needs_at_most(&[ModelLevel::Friction]) || scene.rounds_parameters();
        let impact = if is_full { impact + full } else { impact };
        let each = impact + SAMPLE_PRICE * self.samples_per_flight;
        self.impacts.saturating_mul(each).saturating_add(limits::ANSWER_PRICE + once + self.run.guidance_price())
    }
}
