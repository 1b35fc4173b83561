//! The request for `trajectories`: a run, the method that computes it, and the numbers that are asked for.

use equipoise_physics::analysis::method::RunMethod;
use equipoise_physics::scene::model::ModelLevel;
use serde::{Serialize, Serializer};

use crate::api::catches::columns::OF_HOLD;
use crate::api::resource::{CanonicalRequest, ResourceRequest};
use crate::api::shared::write::canonical_of;
use crate::api::trajectories::{columns, flights};
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::http::request::fields::{Absence, Fields, choice, exact_whole, number, whole};
use crate::limits;
use crate::limits::Limits;
use crate::request_fields;
use crate::runs::interventions::HeldRunSpec;
use crate::runs::run::Run;

request_fields! {
    /// A request for a run.
    #[derive(Debug, Clone, Serialize)]
    pub struct TrajectoryRequest {
        /// The run.
        pub run: Run = HeldRunSpec,
        /// Largest number of impacts to follow.
        pub bounces: u64 = whole(1..=limits::BOUNCES).or(100),
        /// Points along each flight. 0 leaves `flights` out.
        pub samples_per_flight: u64 = whole(0..=limits::SAMPLES_PER_FLIGHT).or(0),
        /// Method of computation. `linear` is the solution about the fixed point in closed form, of a rod whose bounces repeat; its error estimate is
        /// the distance from the run of the map beside it, with the error estimate of that. `map` goes from impact to impact in doubles.
        /// `extended` does so with 31 digits; its numbers are decimal strings, the errors of a table with noise and endings are those of doubles.
        /// `auto` is the map. With a `tolerance` it is `extended` if the error estimate of the map exceeds it at an impact; if that of `extended`
        /// does too, the answer is a 422 that says for how many impacts it would hold.
        #[serde(serialize_with = "name_of_method")]
        pub method: Option<RunMethod> = choice(&METHODS).or(None),
        /// Largest error of a state to accept, m/s. It is compared with `error_estimate`; `predictable_bounces` takes 0.001 by default. With noise
        /// it is the error against the run with the same errors of the table.
        pub tolerance: Option<f64> = number(TOLERANCES, "m/s").optional(),
        /// Wall time of the release since 1970 (UTC), ms. With it `impacts` and `flights`, and the rows of CSV and NDJSON, have the column `time_ms`: `epoch_ms` +
        /// 1000 t, to the nearest millisecond, as a whole number in every format, which dashboards read directly. `t` has all the digits.
        pub epoch_ms: Option<u64> = exact_whole().optional(),
    }
}

/// Methods by their names in requests.
const METHODS: [(&str, Option<RunMethod>); 4] = [
    ("auto", None),
    (RunMethod::Linear.name(), Some(RunMethod::Linear)),
    (RunMethod::Map.name(), Some(RunMethod::Map)),
    (RunMethod::Extended.name(), Some(RunMethod::Extended)),
];

fn name_of_method<S: Serializer>(method: &Option<RunMethod>, serializer: S) -> Result<S::Ok, S::Error> {
    method.map(RunMethod::name).serialize(serializer)
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
        Self::read_fields(reader)
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
        canonical_of(self)
    }
}

impl TrajectoryRequest {
    /// Size of the answer, in numbers.
    pub fn numbers(&self) -> u64 {
        let dated = self.epoch_ms.is_some();
        let (impact, sample) = (columns::of_trajectories(dated).count(), flights::columns(dated).count());
        // In CSV and NDJSON each row has the columns of both phases.
        let row = if self.run.hold() > 0.0 { impact + OF_HOLD.len() } else { impact } as u64;
        let held = self.held_samples() * row;
        self.bounces.saturating_mul(row + self.samples_per_flight * sample as u64).saturating_add(held)
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
        self.bounces.saturating_mul(each).saturating_add(limits::ANSWER_PRICE + once + self.run.guidance_price())
    }
}
