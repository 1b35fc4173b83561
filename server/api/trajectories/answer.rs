//! The answer of `trajectories`: the contacts of a run as a table, how it ended, and its flights where they are asked for.

use equipoise_physics::body::Body;
use equipoise_physics::run::method;
use equipoise_physics::run::method::{Impact, Method, choose_method, deviations_circle, run_by};
use equipoise_physics::run::orbit::{Contact, LOOK};
use equipoise_physics::scene::model::{Forced, Rung};
use equipoise_physics::scene::{Name, Scene};
use equipoise_physics::table::actuator_load::{Demand, Meter};
use serde::{Serialize, Serializer};

use crate::api::scene::{Resolved, has_angle};
use crate::api::shared::nearest_vertex::NearestVertex;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::table::Table;
use crate::api::trajectories::columns::{Contacts, Flights};
use crate::charts::{PhasePlanes, phase_planes};
use crate::http::Reader;
use crate::http::request::scalar::LARGEST_EXACT;
use crate::limits;

/// What a run is computed with, and why.
#[derive(Debug, Clone, Serialize)]
pub struct Choice {
    /// Its name.
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
    /// What of the scene asked for the rungs above the rod.
    pub forced: Vec<ForcedAnswer>,
}

/// [`Forced`] as it is written.
#[derive(Debug, Clone, Serialize)]
pub struct ForcedAnswer {
    rung: &'static str,
    field: &'static str,
    detail: String,
}

impl ForcedAnswer {
    /// The field that asked for it.
    pub fn field(&self) -> &'static str {
        self.field
    }
}

impl From<Forced> for ForcedAnswer {
    fn from(Forced { rung, path, detail }: Forced) -> Self {
        Self { rung: rung.name(), field: path, detail }
    }
}

impl Choice {
    /// The model of a scene.
    pub fn model(scene: &Scene) -> Self {
        let forced = scene.forced().into_iter().map(ForcedAnswer::from).collect();
        Self { name: scene.rung().name(), reason: scene.rung_reason(), forced }
    }

    /// The model that a method needs of it.
    fn model_by(scene: &Scene, method: Method) -> Self {
        if method != Method::Linear {
            return Self::model(scene);
        }
        let reason = "the linear solution is accurate enough here, or was asked for: the angle block in closed form";
        Self { name: Rung::Linear.name(), reason: reason.to_owned(), forced: Vec::new() }
    }
}

/// The body and the law of its table, in a few words.
fn law(scene: &Scene) -> String {
    let body = if has_angle(scene) { "a rod" } else { "a point" };
    match scene.number(Name::TiltGain) {
        Some(gain) => format!("{body} with κ = {gain}"),
        None => format!("{body} with state feedback"),
    }
}

/// [`Demand`] as it is written.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct DemandAnswer {
    tilt: f64,
    tilt_rate: f64,
    speed: f64,
    stroke: f64,
}

impl From<Demand> for DemandAnswer {
    fn from(Demand { tilt, tilt_rate, speed, stroke }: Demand) -> Self {
        Self { tilt, tilt_rate, speed, stroke }
    }
}

/// What is asked for beside the scene.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Request {
    /// How many contacts at most.
    pub impacts: u64,
    /// Points along each flight.
    pub samples_per_flight: u64,
    /// A method by name; none leaves the choice.
    #[serde(serialize_with = "name_of")]
    pub method: Option<Method>,
    /// Wanted bound on the error, m/s.
    pub tolerance: Option<f64>,
    /// When the body is released, unix ms; none leaves the column `time` out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub epoch: Option<u64>,
}

fn name_of<S: Serializer>(method: &Option<Method>, serializer: S) -> Result<S::Ok, S::Error> {
    method.map(Method::name).serialize(serializer)
}

/// Tolerances, m/s. Below, no method has the digits; above, no bound says anything.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-30..=1.0;

/// The tolerance, m/s, up to which impacts count as predictable where none is asked for.
const PREDICTABLE: f64 = 1e-3;

/// Why there are no bounds beside interventions.
const NO_BOUND: &str = "no bound is derived for a run that is changed under way";

/// Numbers in a row of contacts, and in one of flight samples.
const CONTACT_NUMBERS: u64 = 18;
const SAMPLE_NUMBERS: u64 = 8;

/// Price of each method an impact with its error estimate, in bounces, and what the linear solution costs once.
const LINEAR_ONCE: u64 = 2500;
const MAP_PRICE: u64 = 8;
const EXTENDED_PRICE: u64 = 50;

/// Price of a contact to be written down, compressed as well, in bounces; the same with 31 digits, and a sample of a flight.
const ROW_PRICE: u64 = 24;
const LONG_ROW_PRICE: u64 = 60;
const SAMPLE_PRICE: u64 = 10;

/// Price of an impact of the linear solution with its error estimate, in bounces. Where the angle does not circle, the estimate
/// of each looks at some of the bounces before it, with 31 digits: at 13, or at 39 where the table looks at the energy.
pub(crate) fn linear_price(scene: &Scene) -> u64 {
    match scene.number(Name::EnergyGain) {
        _ if deviations_circle(scene) => 20,
        None | Some(0.0) => 500,
        Some(_) => 1400,
    }
}

impl Request {
    /// Reads everything but the scene.
    pub fn read(reader: &mut Reader<'_, '_>) -> Self {
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(100);
        let samples_per_flight = reader.integer("samples_per_flight", 0..=limits::SAMPLES_PER_FLIGHT).unwrap_or(0);
        let [linear, map, extended] = Method::ALL.map(|method| (method.name(), Some(method)));
        let method = reader.choice("method", &[("auto", None), map, linear, extended]).flatten();
        let tolerance = reader.number("tolerance", TOLERANCES, "m/s");
        let epoch = reader.integer("epoch", 0..=LARGEST_EXACT);
        Self { impacts, samples_per_flight, method, tolerance, epoch }
    }

    /// Only the map runs on through a change, without a bound.
    fn admits_changes(&self) -> Result<(), Refused> {
        match (self.method, self.tolerance) {
            (None | Some(Method::Map), None) => Ok(()),
            (_, Some(_)) => Err(Some(("/tolerance", NO_BOUND.to_owned()))),
            (Some(other), None) => Err(Some(("/method", format!("{} does not apply: {NO_BOUND}", other.name())))),
        }
    }

    /// Numbers in its answer.
    pub fn numbers(&self) -> u64 {
        let time = u64::from(self.epoch.is_some());
        self.impacts.saturating_mul(CONTACT_NUMBERS + time + self.samples_per_flight * (SAMPLE_NUMBERS + time))
    }

    /// Its work, in bounces.
    pub fn price(&self, scene: &Scene) -> u64 {
        let (once, impact) = match (self.method, self.tolerance) {
            (Some(Method::Linear), _) => (LINEAR_ONCE, linear_price(scene) + ROW_PRICE),
            (Some(Method::Map), _) | (None, None) => (0, MAP_PRICE + ROW_PRICE),
            (Some(Method::Extended), _) => (0, EXTENDED_PRICE + LONG_ROW_PRICE),
            // Each may be tried, the linear one where the angle circles, and the dearest run again.
            (None, Some(_)) => {
                let linear = if deviations_circle(scene) { linear_price(scene) } else { 0 };
                (LINEAR_ONCE, linear + MAP_PRICE + 2 * EXTENDED_PRICE + LONG_ROW_PRICE)
            }
        };
        let each = impact + SAMPLE_PRICE * self.samples_per_flight;
        self.impacts.saturating_mul(each).saturating_add(limits::ANSWER_PRICE + once)
    }
}

/// The method of a run, why, and what it costs.
#[derive(Debug, Clone, Serialize)]
pub struct MethodChoice {
    /// Its name.
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
    /// What it costs by the fixed table that choices are made by, µs.
    pub cost_us: f64,
    /// The next dearer one that would have done.
    pub next: Option<Dearer>,
}

/// A method that was not needed.
#[derive(Debug, Clone, Serialize)]
pub struct Dearer {
    /// Its name.
    pub name: &'static str,
    /// As for the one chosen, µs.
    pub cost_us: f64,
}

/// Why there is no answer: nobody wants it any more (none), or a field and what is wrong with it.
pub type Refused = Option<(&'static str, String)>;

impl MethodChoice {
    fn of(scene: &Scene, request: &Request, go_on: &mut impl FnMut() -> bool) -> Result<(Method, Self), Refused> {
        let Request { impacts, method, tolerance, .. } = *request;
        if let (None, Some(tolerance)) = (method, tolerance) {
            if let Some(error) = scene.beyond(&[Rung::Friction]) {
                return Err(Some(("/tolerance", format!("no method bounds its error: {}", error.detail))));
            }
            let choice = choose_method(scene, impacts, tolerance, go_on)
                .ok_or(None)?
                .map_err(|refusal| Some(("/tolerance", refusal.detail)))?;
            let method::Choice { method, cost_us, next, reason, .. } = choice;
            let next = next.map(|(method, cost_us)| Dearer { name: method.name(), cost_us });
            return Ok((method, Self { name: method.name(), reason, cost_us, next }));
        }
        let reason = match method {
            Some(_) => "as asked for",
            None => "the map from contact to contact in closed form; no tolerance was asked for",
        };
        let method = method.unwrap_or(Method::Map);
        let cost_us = method.cost_us(impacts);
        Ok((method, Self { name: method.name(), reason: reason.to_owned(), cost_us, next: None }))
    }
}

/// The answer.
#[derive(Debug, Serialize)]
pub struct Trajectory<'a> {
    /// The scene, resolved.
    pub scene: Resolved<'a>,
    /// The model and why.
    pub model: Choice,
    /// The method and why.
    pub method: MethodChoice,
    /// How the run ended.
    pub outcome: Outcome,
    /// Its contacts.
    pub impacts: Table,
    /// The last contact before the error estimate passes the tolerance; none where it does not.
    pub predictable_impacts: Option<u64>,
    /// Samples of its flights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flights: Option<Table>,
    /// The most that it asked of the table.
    pub demand: DemandAnswer,
    /// Of a polygon: how near any other vertex came to the table at a contact.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nearest_vertex: Option<NearestVertex>,
    /// Reasons for what is null.
    pub notes: Vec<String>,
}

impl<'a> Trajectory<'a> {
    /// Runs a scene, or takes the contacts of a run of it that was `changed` under way; `go_on` is asked now and then.
    ///
    /// # Errors
    /// [`Refused`]: where `go_on` said no, where no method holds the tolerance, and where the method does not apply.
    pub fn compute(
        scene: &'a Scene,
        request: &Request,
        changed: Option<&mut dyn Iterator<Item = Contact>>,
        mut go_on: impl FnMut() -> bool,
    ) -> Result<Self, Refused> {
        if changed.is_some() {
            request.admits_changes()?;
        }
        let was_changed = changed.is_some();
        let (method, choice) = MethodChoice::of(scene, request, &mut go_on)?;
        let Request { impacts, samples_per_flight: samples, tolerance, epoch, .. } = *request;
        let mut contacts = Contacts::new(scene, epoch, usize::try_from(impacts).unwrap_or(usize::MAX));
        let mut flights = (samples > 0).then(|| Flights::new(epoch));
        let body = scene.model();
        let (mut last, mut unknown, mut predictable) = (None, 0, None);
        let mut meter = Meter::default();
        let mut nearest_vertex = None;
        let mut visit = |impact: &Impact<'_>| {
            let Impact { contact, error_estimate, .. } = impact;
            contacts.push(impact);
            if let Some(flights) = &mut flights {
                if contact.n == 1 {
                    let release = scene.release();
                    flights.push(scene, 0, 0.0, release.x, release.height, &release.state, contact.t, samples);
                }
                if let (Some(strike), Some(length)) = (contact.strike, contact.flight_time) {
                    let y = body.contact_height(&contact.state) + contact.clearance;
                    flights.push(scene, contact.n, contact.t, contact.x, y, &strike.after, length, samples);
                }
            }
            meter.look(contact);
            if let Some(outline) = scene.outline() {
                nearest_vertex = Some(NearestVertex::or(nearest_vertex, outline, contact));
            }
            last = Some((contact.n, contact.t));
            unknown += u64::from(!error_estimate.is_finite());
            let lost = error_estimate.is_nan() || *error_estimate > tolerance.unwrap_or(PREDICTABLE);
            if predictable.is_none() && lost {
                predictable = Some(contact.n - 1);
            }
            !contact.n.is_multiple_of(LOOK) || go_on()
        };
        let run = match changed {
            None => run_by(scene, method, impacts, visit),
            Some(contacts) => {
                let mut ending = None;
                for contact in contacts {
                    ending = contact.ending;
                    if !visit(&Impact { contact, error_estimate: f64::INFINITY, extended: None }) {
                        ending = None;
                        break;
                    }
                }
                Ok(ending)
            }
        };
        let ending = run.map_err(|why| Some(("/method", format!("{} does not apply: {why}", choice.name))))?;
        let ending = ending.ok_or(None)?;
        let (contacts_made, t) = last.unwrap_or((0, 0.0));
        let mut notes = Vec::new();
        if was_changed {
            notes.push(format!("error_estimate is null and predictable_impacts 0: {NO_BOUND}"));
        } else if let Some(error) = scene.beyond(&[Rung::Friction]) {
            notes.push(format!(
                "error_estimate is null and predictable_impacts 0, since no bound is derived: {}",
                error.detail
            ));
        } else if unknown > 0 {
            notes.push(format!(
                "error_estimate is null at {unknown} impacts: past a graze, or once rounding has grown to the size of the \
                 run, no bound is known"
            ));
        }
        if !has_angle(scene) {
            notes.push(
                "theta is the angle of the velocity from straight down, and theta_dot is null: a point mass has no \
                 angle of its own"
                    .to_owned(),
            );
        }
        Ok(Self {
            scene: Resolved(scene),
            model: Choice::model_by(scene, method),
            method: choice,
            outcome: Outcome::new(ending, contacts_made, t),
            impacts: contacts.into_table(),
            predictable_impacts: predictable,
            flights: flights.map(Flights::into_table),
            notes,
            demand: meter.most.into(),
            nearest_vertex,
        })
    }

    /// The phase planes, as SVG.
    pub fn to_picture(&self) -> String {
        let column = |name: &str| self.impacts.0.iter().find(|column| column.name == name)?.cells.numbers();
        let numbers = |name| column(name).unwrap_or_default();
        let theta_dot = column("theta_dot");
        phase_planes(&PhasePlanes {
            title: &format!("Contacts of {}", law(self.scene.0)),
            subtitle: &format!("{}: {}", self.outcome.kind, self.outcome.detail),
            theta: &numbers("theta"),
            theta_dot: theta_dot.as_deref(),
            x_dot: &numbers("x_dot"),
            y_dot: &numbers("y_dot"),
        })
    }

    /// What ends it as NDJSON.
    pub fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End {
            outcome: Outcome,
            method: MethodChoice,
            predictable_impacts: Option<u64>,
            demand: DemandAnswer,
            #[serde(skip_serializing_if = "Option::is_none")]
            nearest_vertex: Option<NearestVertex>,
            notes: Vec<String>,
        }
        let Self { outcome, method, predictable_impacts, demand, nearest_vertex, notes, .. } = self;
        let (outcome, method, notes) = (outcome.clone(), method.clone(), notes.clone());
        let (predictable_impacts, demand, nearest_vertex) = (*predictable_impacts, *demand, *nearest_vertex);
        End { outcome, method, predictable_impacts, demand, nearest_vertex, notes }
    }
}
