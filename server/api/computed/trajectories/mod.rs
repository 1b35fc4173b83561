//! `/v1/trajectories`: the contacts of a run.

pub mod columns;

use std::cell::RefCell;

use equipoise_physics::analysis::method::{ComputedImpact, RunMethod, choose_method, run_by};
use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::actuator_load::LoadTracker;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene};

use crate::api::computed::trajectories::columns::{
    COLUMNS, DATES, ExtendedRow, HoldAnswer, HoldEnd, HoldSamples, ImpactColumn, ImpactRow, Impacts as ImpactColumns,
    OF_HOLD, date, phase_words, phases, trajectory_words,
};
use crate::api::prelude::*;
use crate::api::shared::answer_parts::NearestVertex;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::table::{Cells, Column, Gathered};
use crate::charts::{PhasePlanes, phase_planes};
use crate::runs::interventions::HeldRunSpec;
use crate::runs::playback::Playback;
use crate::runs::run::Run;

impl ComputedResource for TrajectoryRequest {
    const NAME: &'static str = "trajectories";
    const SINGULAR: &'static str = "Trajectory";
    type Format = ChartFormat;
    const WORK: Work<Self, ChartFormat> = Work::Pure {
        canonical: canonical_of,
        compute: |request, format, slice, bounces| {
            let run = &request.run;
            // Without interventions, and where the body never meets the table, it is the scene's own run.
            let is_changed = !run.interventions().is_empty() && run.scene().orbit().is_ok();
            let mut playback = is_changed.then(|| Playback::new(run, request.bounces));
            let answer = TrajectoryAnswer::compute(request, playback.as_mut(), || slice.should_continue())?;
            bounces.inc_by(answer.outcome.bounces);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<TrajectoryAnswer<'static>>()
            .table("One row for each impact.", trajectory_words())
            .table(
                "With `hold` above 0, one row for each impact, then one for each moment of the contact.",
                phase_words(),
            )
            .end::<TrajectoryEnd<'static>>();
    }
}

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
    fn answer_numbers(&self) -> u64 {
        let dated = self.epoch_ms.is_some();
        let (impact, sample) = (columns::of_trajectories(dated).count(), columns(dated).count());
        // In CSV and NDJSON each row has the columns of both phases.
        let (row, samples) =
            if self.run.hold() > 0.0 { (impact + OF_HOLD.len(), limits::HOLD_SAMPLES) } else { (impact, 0) };
        let (row, held) = (row as u64, samples * row as u64);
        self.bounces.saturating_mul(row + self.samples_per_flight * sample as u64).saturating_add(held)
    }

    fn bytes(&self) -> u64 {
        // Without a tolerance or a method with 31 digits, no column has them.
        let is_long = self.tolerance.is_some() || self.method == Some(RunMethod::Extended);
        self.answer_numbers().saturating_mul(if is_long { limits::LONG_NUMBER_BYTES } else { limits::NUMBER_BYTES })
    }

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

/// Default tolerance, m/s, up to which impacts count as predictable.
const PREDICTABLE: f64 = 1e-3;

/// Highest number of impacts for which memory is reserved before a run.
const ROOM: usize = 1 << 16;

/// The reason why a run with interventions has no error bounds.
const NO_BOUND: &str = "no bound is derived for a run that is changed under way";

/// Refuses methods and tolerances for a run that is changed under way: only the map runs on through a change, without a bound.
fn admits_changes(request: &TrajectoryRequest) -> Result<(), Refusal> {
    match (request.method, request.tolerance) {
        (None | Some(RunMethod::Map), None) => Ok(()),
        (_, Some(_)) => Err(Refusal::At("/tolerance", NO_BOUND.to_owned())),
        (Some(other), None) => Err(Refusal::At("/method", format!("{} does not apply: {NO_BOUND}", other.name()))),
    }
}

words! {
    /// Method of computation.
    RunMethodName = RunMethod::ALL.map(RunMethod::name);
}

/// The method of computation.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct MethodChoice {
    /// Name of the method.
    #[schemars(with = "RunMethodName")]
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
}

impl MethodChoice {
    fn of(
        scene: &Scene,
        request: &TrajectoryRequest,
        go_on: &mut impl FnMut() -> bool,
    ) -> Result<(RunMethod, Self), Refusal> {
        let TrajectoryRequest { bounces, method, tolerance, .. } = *request;
        let (method, reason) = match (method, tolerance) {
            (Some(method), _) => (method, "as asked for".to_owned()),
            (None, None) => {
                let reason = "the map from contact to contact in closed form; no tolerance was asked for";
                (RunMethod::Map, reason.to_owned())
            }
            (None, Some(tolerance)) => {
                let choice = choose_method(scene, bounces, tolerance, go_on)
                    .ok_or(Refusal::Cancelled)?
                    .map_err(|refusal| ("/tolerance", refusal.detail))?;
                (choice.method, choice.reason)
            }
        };
        Ok((method, Self { name: method.name(), reason }))
    }
}

/// Answer of `/v1/trajectories`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Trajectory")]
pub struct TrajectoryAnswer<'a> {
    scene: Resolved,
    derived: Derived,
    model: ModelChoice,
    method: MethodChoice,
    /// Outcome of the run.
    pub outcome: Outcome,
    /// Contacts of the run.
    #[schemars(with = "ImpactColumns")]
    pub impacts: Table,
    /// The last impact before the error estimate exceeds the tolerance (by default 0.001 m/s). Null if it does not; 0 if no bound is known at all.
    predictable_bounces: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<Flights>")]
    flights: Option<Table>,
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<HoldSamples>")]
    hold: Option<Table>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hold_end: Option<HoldEnd>,
    demand: LoadAnswer,
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest_vertex: Option<NearestVertex>,
    /// Reasons for nulls.
    notes: Vec<String>,
    #[serde(skip)]
    request: &'a TrajectoryRequest,
}

/// The last line of NDJSON.
#[derive(Debug, Serialize, JsonSchema)]
struct TrajectoryEnd<'a> {
    outcome: &'a Outcome,
    method: &'a MethodChoice,
    /// As in the answer in JSON.
    predictable_bounces: Option<u64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    hold_end: Option<&'a HoldEnd>,
    demand: LoadAnswer,
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest_vertex: Option<NearestVertex>,
    notes: &'a [String],
}

impl<'a> TrajectoryAnswer<'a> {
    /// Runs a scene, or plays a `changed` run. Asks `go_on` now and then.
    ///
    /// # Errors
    /// [`Refusal`]: if `go_on` returned false, if no method holds the tolerance, or if the method does not apply.
    pub fn compute(
        request: &'a TrajectoryRequest,
        changed: Option<&mut Playback>,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<Self, Refusal> {
        let scene = request.run.scene();
        if changed.is_some() {
            admits_changes(request)?;
        }
        let was_changed = changed.is_some();
        let (method, choice) = MethodChoice::of(scene, request, &mut go_on)?;
        let go_on = RefCell::new(go_on);
        let go_on = || (go_on.borrow_mut())();
        let TrajectoryRequest { bounces, samples_per_flight: samples, tolerance, epoch_ms: epoch, .. } = *request;
        let room = usize::try_from(bounces).unwrap_or(usize::MAX).min(ROOM);
        let mut rows = Impacts::with_capacity(room, epoch.is_some(), method == RunMethod::Extended);
        let mut flights = (samples > 0).then(|| FlightSamples::new(scene, samples, epoch));
        let (body, has_angle) = (scene.model(), has_angle(scene));
        let (mut last, mut unknown, mut predictable) = (None::<Contact>, 0, None);
        let mut tracker = LoadTracker::default();
        let mut nearest_vertex = None;
        let mut visit = |impact: &ComputedImpact<'_>| {
            let ComputedImpact { contact, error_estimate, .. } = impact;
            let row = ImpactRow {
                time_ms: epoch.map(|epoch| date(epoch, contact.t)),
                error_estimate: Some(*error_estimate).filter(|bound| bound.is_finite()),
                ..ImpactRow::new(&body, has_angle, *contact)
            };
            let extended = impact.extended.map(|(orbit, contact)| ExtendedRow { orbit, contact, has_angle });
            rows.push(row, extended.as_ref());
            if let Some(flights) = &mut flights {
                if contact.n == 1 {
                    let release = scene.release();
                    let (x, y, start) = (release.x, release.height, release.state);
                    flights.push(&SampledFlight { impact: 0, t: 0.0, x, y, start, length: contact.t });
                }
                if let (Some(strike), Some(length)) = (contact.strike, contact.flight_time) {
                    let y = body.contact_height(&contact.state) + contact.clearance;
                    let (impact, t, x, start) = (contact.n, contact.t, contact.x, strike.after);
                    flights.push(&SampledFlight { impact, t, x, y, start, length });
                }
            }
            if let Some(strike) = &contact.strike {
                tracker.track(strike, contact.flight_time);
            }
            if let Some(outline) = scene.outline() {
                nearest_vertex = Some(NearestVertex::or(nearest_vertex, outline, contact));
            }
            last = Some(*contact);
            unknown += u64::from(!error_estimate.is_finite());
            let lost = error_estimate.is_nan() || *error_estimate > tolerance.unwrap_or(PREDICTABLE);
            if predictable.is_none() && lost {
                predictable = Some(contact.n - 1);
            }
            !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
        };
        let lack = (method == RunMethod::Linear).then(|| lacking(scene, Analysis::LinearRun)).flatten();
        if let Some(why) = lack {
            return Err(Refusal::At("/method", why));
        }
        let (mut played, mut rest) = (None, None);
        let run = match changed {
            None => run_by(scene, method, bounces, visit),
            Some(playback) => {
                while let Some((contact, _)) = playback.next_impact(&request.run, &mut || go_on())? {
                    if !visit(&ComputedImpact { contact, error_estimate: f64::INFINITY, extended: None }) {
                        return Err(Refusal::Cancelled);
                    }
                }
                played = playback.outcome().cloned();
                rest = playback.rest().map(|(samples, end)| HoldAnswer { samples: samples.to_vec(), end: end.clone() });
                Ok(None)
            }
        };
        let ending = run.map_err(|why| ("/method", format!("{} does not apply: {why}", choice.name)))?;
        let (contacts_made, t) = last.map_or((0, 0.0), |last| (last.n, last.t));
        let made = |ending| Outcome::new(ending, contacts_made, t).turning(last.as_ref().filter(|_| has_angle));
        let ending = ending.or(last.and_then(|last| last.ending));
        let outcome = played.or_else(|| ending.map(made)).ok_or(Refusal::Cancelled)?;
        let mut notes = Vec::new();
        let (mut hold, mut hold_end) = (None, None);
        if request.run.hold() > 0.0 {
            let in_force = request.run.restarted(contacts_made);
            let held = match (rest, ending) {
                (Some(rest), _) => Ok(rest),
                (None, Some(ending)) => {
                    HoldAnswer::compute(in_force.scene(), (ending, last.as_ref()), request.run.hold(), &mut || go_on())?
                }
                (None, None) => {
                    Err("hold is null: the table caught the body, and `/v1/catches` tells of the hold of a catch"
                        .to_owned())
                }
            };
            match held {
                Ok(HoldAnswer { samples, end }) => {
                    (hold, hold_end) = (Some(table_of(&OF_HOLD, &samples)), Some(end));
                }
                Err(reason) => notes.push(reason),
            }
        }
        if was_changed {
            notes.push(format!("error_estimate is null and predictable_bounces 0: {NO_BOUND}"));
        } else if unknown > 0 {
            notes.push(format!(
                "error_estimate is null at {unknown} impacts: past a graze, or once rounding has grown to the \
                 size of the run, no bound is known"
            ));
        }
        if !has_angle {
            notes.push(
                "theta is the angle of the velocity from straight down, and theta_dot is null: a point mass has no \
                 angle of its own"
                    .to_owned(),
            );
        }
        Ok(Self {
            scene: Resolved(**scene),
            derived: Derived::of(scene),
            model: ModelChoice::by_method(scene, method),
            method: choice,
            outcome,
            impacts: rows.into_table(),
            predictable_bounces: predictable,
            flights: flights.map(FlightSamples::into_table),
            hold,
            hold_end,
            notes,
            demand: tracker.most.into(),
            nearest_vertex,
            request,
        })
    }
}

impl Tabular for TrajectoryAnswer<'_> {
    fn to_table(&self) -> Cow<'_, Table> {
        if self.request.run.hold() > 0.0 {
            Cow::Owned(phases(&self.impacts, self.hold.as_ref(), self.request.epoch_ms))
        } else {
            Cow::Borrowed(&self.impacts)
        }
    }

    fn about(&self, name: &str) -> &'static str {
        let of_impacts = COLUMNS.iter().map(|column| (column.row.name, column.row.about));
        let of_hold = OF_HOLD.iter().map(|column| (column.name, column.about));
        of_impacts.chain(of_hold).find(|(own, _)| *own == name).map_or("", |(_, about)| about)
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["impacts", "hold"]
    }

    fn end(&self) -> impl Serialize {
        let Self { outcome, method, hold_end, notes, .. } = self;
        let Self { predictable_bounces, demand, nearest_vertex, .. } = *self;
        let hold_end = hold_end.as_ref();
        TrajectoryEnd { outcome, method, predictable_bounces, hold_end, demand, nearest_vertex, notes }
    }

    fn cells(&self) -> usize {
        [Some(&self.impacts), self.flights.as_ref(), self.hold.as_ref()].into_iter().flatten().map(Table::cells).sum()
    }
}

/// Impacts that are put into the columns together: they stay in the nearest cache until then.
const BLOCK: usize = 32;

/// The impacts so far.
#[derive(Debug)]
pub(crate) struct Impacts {
    /// The last impacts, which are not yet in the columns of doubles.
    rows: Vec<ImpactRow>,
    columns: Vec<(&'static ImpactColumn, ColumnValues)>,
    /// True if there are columns with 31 digits.
    is_extended: bool,
}

/// The values of a column so far.
#[derive(Debug)]
enum ColumnValues {
    Doubles(Gathered<ImpactRow>),
    Digits(fn(&ExtendedRow<'_>) -> Option<DoubleDouble>, Vec<Option<DoubleDouble>>),
}

impl Impacts {
    /// An empty table with room for some impacts. `dated` adds dates, `extended` columns with 31 digits.
    pub(crate) fn with_capacity(room: usize, dated: bool, extended: bool) -> Self {
        let values = |column: &ImpactColumn| match column.digits.filter(|_| extended) {
            Some(digits) => ColumnValues::Digits(digits, Vec::with_capacity(room)),
            None => ColumnValues::Doubles(Gathered::with_capacity(column.row.read, room)),
        };
        let columns = columns::of_trajectories(dated).map(|column| (column, values(column))).collect();
        Self { rows: Vec::with_capacity(BLOCK), columns, is_extended: extended }
    }

    /// Adds an impact.
    pub(crate) fn push(&mut self, row: ImpactRow, extended: Option<&ExtendedRow<'_>>) {
        if self.is_extended {
            for (_, values) in &mut self.columns {
                if let ColumnValues::Digits(read, cells) = values {
                    cells.push(extended.and_then(|row| read(row)));
                }
            }
        }
        self.rows.push(row);
        if self.rows.len() == BLOCK {
            self.put_into_columns();
        }
    }

    fn put_into_columns(&mut self) {
        for (_, values) in &mut self.columns {
            if let ColumnValues::Doubles(gathered) = values {
                gathered.extend(&self.rows);
            }
        }
        self.rows.clear();
    }

    /// The table of all impacts.
    pub(crate) fn into_table(mut self) -> Table {
        self.put_into_columns();
        let column = |(column, values): (&ImpactColumn, ColumnValues)| {
            let cells = match values {
                ColumnValues::Doubles(gathered) => gathered.into_cells(),
                ColumnValues::Digits(_, cells) => Cells::Decimals(cells),
            };
            Column { name: column.row.name, unit: column.row.unit, cells }
        };
        Table(self.columns.into_iter().map(column).collect())
    }
}

/// A body in flight.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(inline)]
pub(crate) struct FreeBody {
    /// Run time, s.
    t: f64,
    /// Horizontal position of the centre of gravity, m.
    x: f64,
    /// Height of the centre of gravity, m.
    y: f64,
    /// Angle, rad. Null for a point mass.
    theta: Option<f64>,
    /// Horizontal velocity, m/s.
    x_dot: f64,
    /// Vertical velocity, m/s.
    y_dot: f64,
    /// Angular velocity, rad/s. Null for a point mass.
    theta_dot: Option<f64>,
}

impl FreeBody {
    /// A body, with an angle or without, at a time (s), a place (m) and a state.
    pub(crate) fn new(has_angle: bool, t: f64, [x, y]: [f64; 2], state: &State) -> Self {
        let angle = |value| has_angle.then_some(value);
        let (theta, theta_dot) = (angle(state.theta), angle(state.theta_dot));
        Self { t, x, y, theta, x_dot: state.x_dot, y_dot: state.y_dot, theta_dot }
    }
}

/// A point of a flight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FlightSample {
    impact: u64,
    time_ms: Option<u64>,
    at: FreeBody,
}

/// The columns of samples. Dates are left out if the time of release is unknown.
static FLIGHT_COLUMNS: [RowColumn<FlightSample>; 9] = [
    RowColumn::new("impact", "", "Number of the impact before it.", Read::Count(|sample| sample.impact)),
    RowColumn::new(DATES, "", "Wall time since 1970 (UTC), ms.", Read::SparseCount(|sample| sample.time_ms)),
    RowColumn::new("t", "s", "Time since the release.", Read::Number(|sample| sample.at.t)),
    RowColumn::new("x", "m", "Horizontal position of the centre of gravity.", Read::Number(|sample| sample.at.x)),
    RowColumn::new("y", "m", "Height of the centre of gravity.", Read::Number(|sample| sample.at.y)),
    RowColumn::new("theta", "rad", "Angle. Null for a point mass.", Read::Sparse(|sample| sample.at.theta)),
    RowColumn::new("x_dot", "m/s", "", Read::Number(|sample| sample.at.x_dot)),
    RowColumn::new("y_dot", "m/s", "", Read::Number(|sample| sample.at.y_dot)),
    RowColumn::new("theta_dot", "rad/s", "Null for a point mass.", Read::Sparse(|sample| sample.at.theta_dot)),
];

/// The columns of an answer.
pub(crate) fn columns(dated: bool) -> impl Iterator<Item = &'static RowColumn<FlightSample>> {
    FLIGHT_COLUMNS.iter().filter(move |column| dated || column.name != DATES)
}

column_lists! {
    /// Points along the flights: columns of one length. Impact 0 is the fall from the release.
    pub(crate) Flights = columns(true).map(RowColumn::word).map(|word| match word.name {
        DATES => ColumnWord { kind: (word.kind.0, false), ..word.only("with `epoch_ms`") },
        _ => word,
    });
}

/// A flight: its start and its length.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SampledFlight {
    /// Number of the contact before it; 0 for the fall from the release.
    pub(crate) impact: u64,
    /// Time of the start, s.
    pub(crate) t: f64,
    /// Place of the centre of gravity at the start, m.
    pub(crate) x: f64,
    /// Height of the centre of gravity at the start, m.
    pub(crate) y: f64,
    /// Angle and velocities at the start.
    pub(crate) start: State,
    /// Time to the next contact, s.
    pub(crate) length: f64,
}

/// Samples so far.
#[derive(Debug)]
pub(crate) struct FlightSamples {
    epoch: Option<u64>,
    body: Body,
    has_angle: bool,
    per_flight: u64,
    columns: Vec<(&'static RowColumn<FlightSample>, Gathered<FlightSample>)>,
}

impl FlightSamples {
    /// No samples yet. With an `epoch_ms`, unix ms, they have dates.
    pub(crate) fn new(scene: &Scene, per_flight: u64, epoch: Option<u64>) -> Self {
        let columns =
            columns(epoch.is_some()).map(|column| (column, Gathered::with_capacity(column.read, 0))).collect();
        Self { epoch, body: scene.running_model(), has_angle: has_angle(scene), per_flight, columns }
    }

    /// Adds the samples of a flight.
    pub(crate) fn push(&mut self, flight: &SampledFlight) {
        let SampledFlight { impact, t, x, y, start, length } = *flight;
        let flight = self.body.flight(start, 0.0);
        for number in 0..self.per_flight {
            let since = length * number as f64 / self.per_flight as f64;
            let (end, (way, rise)) = (flight.end(since), flight.travel(since));
            let sample = FlightSample {
                impact,
                time_ms: self.epoch.map(|epoch| date(epoch, t + since)),
                at: FreeBody::new(self.has_angle, t + since, [x + way, y + rise], &end),
            };
            for (_, gathered) in &mut self.columns {
                gathered.extend(&[sample]);
            }
        }
    }

    /// All of them.
    pub(crate) fn into_table(self) -> Table {
        let column = |(column, gathered): (&RowColumn<_>, Gathered<_>)| Column {
            name: column.name,
            unit: column.unit,
            cells: gathered.into_cells(),
        };
        Table(self.columns.into_iter().map(column).collect())
    }
}

impl Pictured for TrajectoryAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        let column = |name: &str| self.impacts.0.iter().find(|column| column.name == name)?.cells.numbers();
        let numbers = |name| column(name).unwrap_or_default();
        let theta_dot = column("theta_dot");
        Ok(phase_planes(&PhasePlanes {
            title: &format!("Contacts of {}", law(&self.scene.0)),
            subtitle: &format!("{}: {}", self.outcome.kind, self.outcome.detail),
            theta: &numbers("theta"),
            theta_dot: theta_dot.as_deref(),
            x_dot: &numbers("x_dot"),
            y_dot: &numbers("y_dot"),
        }))
    }
}

/// Describes the body and the law of its table in a few words.
fn law(scene: &Scene) -> String {
    let body = if has_angle(scene) { "a rod" } else { "a point" };
    match scene.number(Name::TiltGain) {
        Some(gain) => format!("{body} with κ = {gain}"),
        None => format!("{body} with state feedback"),
    }
}
