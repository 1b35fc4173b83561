//! The answer of `trajectories`: the contacts of a run as a table, its end, and its flights if they are asked for.

use std::borrow::Cow;
use std::cell::RefCell;

use equipoise_physics::analysis::method::{ComputedImpact, RunMethod, choose_method, run_by};
use equipoise_physics::map::table::actuator_load::LoadTracker;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::capability::Analysis;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::catches::columns::{HoldSamples, OF_HOLD};
use crate::api::formats::Tabular;
use crate::api::scene::{Derived, Resolved, has_angle};
use crate::api::shared::actuator_load::LoadAnswer;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::nearest_vertex::NearestVertex;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::refusal::{Refusal, lacking};
use crate::api::shared::table::Table;
use crate::api::shared::table::columns::table_of;
use crate::api::trajectories::columns::{COLUMNS, ExtendedRow, ImpactRow, Impacts as ImpactColumns, date};
use crate::api::trajectories::flights::{FlightSamples, Flights, SampledFlight};
use crate::api::trajectories::hold::{HoldAnswer, HoldEnd, phases};
use crate::api::trajectories::impacts::Impacts;
use crate::api::trajectories::request::TrajectoryRequest;
use crate::runs::playback::Playback;
use crate::words;

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
#[schemars(rename = "MethodChoice")]
pub struct MethodAnswer {
    /// Name of the method.
    #[schemars(with = "RunMethodName")]
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
}

impl MethodAnswer {
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
    pub(super) scene: Resolved<'a>,
    derived: Derived,
    model: ModelChoice,
    method: MethodAnswer,
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
pub(super) struct TrajectoryEnd<'a> {
    outcome: &'a Outcome,
    method: &'a MethodAnswer,
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
        let (method, choice) = MethodAnswer::of(scene, request, &mut go_on)?;
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
            scene: Resolved(scene),
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
