//! The answer of `trajectories`: the contacts of a run as a table, how it ended, and its flights where they are asked for.

use equipoise_physics::impact::State;
use equipoise_physics::map::{Body, Contact, Ending, Orbit};
use equipoise_physics::model::Model;
use equipoise_physics::scene::{Name, Scene};
use serde::Serialize;

use super::scene::{Resolved, has_angle};
use super::table::{Cells, Column, Table};
use crate::picture::{PhasePlanes, phase_planes};

/// What a run is computed with, and why.
#[derive(Debug, Clone, Serialize)]
pub struct Choice {
    /// Its name.
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
}

impl Choice {
    /// The model of a scene.
    pub fn model(scene: &Scene) -> Self {
        Self { name: scene.rung().name(), reason: scene.rung_reason() }
    }
}

/// How a run ended.
#[derive(Debug, Clone, Serialize)]
pub struct Outcome {
    /// Its kind.
    pub kind: &'static str,
    /// Contacts, the last included.
    pub impacts: u64,
    /// When the last one was, s.
    pub t: f64,
    /// A sentence with the numbers.
    pub detail: String,
    /// What passed a limit, where something did.
    pub quantity: Option<&'static str>,
    /// Its value.
    pub value: Option<f64>,
    /// The limit.
    pub limit: Option<f64>,
    /// Unit of both.
    pub unit: Option<&'static str>,
    /// When a settling run comes to rest, s.
    pub settle_time: Option<f64>,
}

impl Outcome {
    /// Of a run that ended so at contact `impacts`, at time `t`.
    pub fn new(ending: Ending, impacts: u64, t: f64) -> Self {
        let at = format!("at contact {impacts}, t = {t} s");
        let (detail, decided) = match ending {
            Ending::Completed => (format!("all {impacts} contacts were computed, up to t = {t} s"), None),
            Ending::Toppled { theta, limit } => (
                format!("{at}, the angle {theta} rad had reached topple_angle {limit} rad"),
                Some(("theta", theta, limit, "rad")),
            ),
            Ending::Separating { approach } => (
                format!(
                    "{at}, the contact point left the table at {approach} m/s along its normal: it could only pull"
                ),
                Some(("approach", approach, 0.0, "m/s")),
            ),
            Ending::Sinking { contact_rise } => (
                format!(
                    "{at}, the strike left the contact point at {contact_rise} m/s vertically: it does not rise again"
                ),
                Some(("contact_rise", contact_rise, 0.0, "m/s")),
            ),
            Ending::Settled { flight_time, settle_time } => (
                format!("{at}, the next flight would take {flight_time} s; the bounces end at t = {settle_time} s"),
                Some(("flight_time", flight_time, 0.0, "s")),
            ),
            Ending::Diverged { speed } => (
                format!("{at}, the strike gave a speed of {speed} m/s, beyond what doubles resolve"),
                Some(("speed", speed, equipoise_physics::map::SPEED_LIMIT, "m/s")),
            ),
        };
        let settle_time = match ending {
            Ending::Settled { settle_time, .. } => Some(settle_time),
            _ => None,
        };
        Self {
            kind: ending.name(),
            impacts,
            t,
            detail,
            quantity: decided.map(|(quantity, ..)| quantity),
            value: decided.map(|(_, value, ..)| value).filter(|value| value.is_finite()),
            limit: decided.map(|(_, _, limit, _)| limit),
            unit: decided.map(|(.., unit)| unit),
            settle_time,
        }
    }
}

/// The contacts of a run, gathered one by one.
#[derive(Debug)]
pub struct Contacts {
    body: Model,
    has_angle: bool,
    n: Vec<u64>,
    numbers: [Vec<f64>; 8],
    theta_dot: Vec<Option<f64>>,
    strikes: [Vec<Option<f64>>; 4],
    contact_mode: Vec<Option<&'static str>>,
    flight_time: Vec<Option<f64>>,
}

impl Contacts {
    /// None yet, with room for some.
    pub fn new(scene: &Scene, expected: usize) -> Self {
        let room = expected.min(1 << 16);
        Self {
            body: scene.model(),
            has_angle: has_angle(scene),
            n: Vec::with_capacity(room),
            numbers: std::array::from_fn(|_| Vec::with_capacity(room)),
            theta_dot: Vec::with_capacity(room),
            strikes: std::array::from_fn(|_| Vec::with_capacity(room)),
            contact_mode: Vec::with_capacity(room),
            flight_time: Vec::with_capacity(room),
        }
    }

    /// Adds one.
    pub fn push(&mut self, contact: &Contact) {
        let State { theta, x_dot, y_dot, theta_dot } = contact.state;
        // A table that does not strike tilts all the same.
        let strike = contact.strike.unwrap_or_else(|| self.body.strike(&contact.state));
        // + 0.0: a table at rest moves by 0, not by −0.
        let struck = |value: f64| contact.strike.is_some().then_some(value + 0.0).filter(|value| value.is_finite());
        let numbers = [
            contact.t,
            contact.x,
            theta,
            x_dot,
            y_dot,
            strike.alpha,
            self.body.energy(&contact.state),
            self.body.contact_speed(&contact.state),
        ];
        self.n.push(contact.n);
        for (column, value) in self.numbers.iter_mut().zip(numbers) {
            column.push(value);
        }
        self.theta_dot.push(self.has_angle.then_some(theta_dot));
        let (table_x, table_y) = strike.table_velocity;
        for (column, value) in self.strikes.iter_mut().zip([table_x, table_y, strike.impulse_normal, 0.0]) {
            column.push(struck(value));
        }
        self.contact_mode.push(contact.strike.map(|_| "frictionless"));
        self.flight_time.push(contact.flight_time);
    }

    /// All of them, in the order of the contract.
    pub fn into_table(self) -> Table {
        let rows = self.n.len();
        let [t, x, theta, x_dot, y_dot, alpha, energy, contact_speed] = self.numbers.map(Cells::Numbers);
        let [table_x, table_y, normal, tangential] = self.strikes.map(Cells::Sparse);
        let columns = [
            ("n", "", Cells::Counts(self.n)),
            ("t", "s", t),
            ("x", "m", x),
            ("theta", "rad", theta),
            ("x_dot", "m_per_s", x_dot),
            ("y_dot", "m_per_s", y_dot),
            ("theta_dot", "rad_per_s", Cells::Sparse(self.theta_dot)),
            ("alpha", "rad", alpha),
            ("table_velocity_x", "m_per_s", table_x),
            ("table_velocity_y", "m_per_s", table_y),
            ("impulse_normal", "m_per_s", normal),
            ("impulse_tangential", "m_per_s", tangential),
            ("contact_mode", "", Cells::Words(self.contact_mode)),
            ("energy", "m2_per_s2", energy),
            ("flight_time", "s", Cells::Sparse(self.flight_time)),
            ("contact_speed", "m_per_s", contact_speed),
            ("error_estimate", "m_per_s", Cells::Sparse(vec![None; rows])),
        ];
        Table(columns.map(|(name, unit, cells)| Column { name, unit, cells }).into())
    }
}

/// Samples of the flights between contacts, evenly in time, each flight from its start.
#[derive(Debug, Default)]
pub struct Flights {
    impact: Vec<u64>,
    numbers: [Vec<f64>; 5],
    theta: Vec<Option<f64>>,
    theta_dot: Vec<Option<f64>>,
}

impl Flights {
    /// Adds `samples` of the flight that follows contact `impact` (0: the fall from the release) at time `t`, place `x`
    /// and height `y` of the centre of gravity.
    #[expect(clippy::too_many_arguments, reason = "a flight is that many numbers")]
    pub fn push(
        &mut self,
        scene: &Scene,
        impact: u64,
        t: f64,
        x: f64,
        y: f64,
        start: &State,
        length: f64,
        samples: u64,
    ) {
        let gravity = scene.gravity();
        for sample in 0..samples {
            let since = length * sample as f64 / samples as f64;
            let numbers = [
                t + since,
                x + start.x_dot * since,
                y + since * (start.y_dot - 0.5 * gravity * since),
                start.x_dot,
                start.y_dot - gravity * since,
            ];
            self.impact.push(impact);
            for (column, value) in self.numbers.iter_mut().zip(numbers) {
                column.push(value);
            }
            let has_angle = has_angle(scene);
            self.theta.push(has_angle.then_some(start.theta + start.theta_dot * since));
            self.theta_dot.push(has_angle.then_some(start.theta_dot));
        }
    }

    /// All of them, in the order of the contract.
    pub fn into_table(self) -> Table {
        let [t, x, y, x_dot, y_dot] = self.numbers.map(Cells::Numbers);
        let columns = [
            ("impact", "", Cells::Counts(self.impact)),
            ("t", "s", t),
            ("x", "m", x),
            ("y", "m", y),
            ("theta", "rad", Cells::Sparse(self.theta)),
            ("x_dot", "m_per_s", x_dot),
            ("y_dot", "m_per_s", y_dot),
            ("theta_dot", "rad_per_s", Cells::Sparse(self.theta_dot)),
        ];
        Table(columns.map(|(name, unit, cells)| Column { name, unit, cells }).into())
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
    pub method: Choice,
    /// How the run ended.
    pub outcome: Outcome,
    /// Its contacts.
    pub impacts: Table,
    /// Up to which contact the states mean something.
    pub predictable_impacts: Option<u64>,
    /// Samples of its flights.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flights: Option<Table>,
    /// Reasons for what is null.
    pub notes: Vec<String>,
    #[serde(skip)]
    tilt_gain: f64,
}

impl<'a> Trajectory<'a> {
    /// Runs a scene for up to `impacts` contacts; `go_on` is asked now and then, and a `false` gives none.
    pub fn compute(
        scene: &'a Scene,
        impacts: u64,
        samples_per_flight: u64,
        mut go_on: impl FnMut() -> bool,
    ) -> Option<Self> {
        // The ranges of a scene bound its first flight, so there always is an orbit.
        let mut orbit: Orbit<Model> = scene.orbit().ok()?;
        let mut contacts = Contacts::new(scene, usize::try_from(impacts).unwrap_or(usize::MAX));
        let mut flights = (samples_per_flight > 0).then(Flights::default);
        if let Some(flights) = &mut flights {
            let release = scene.release();
            flights.push(scene, 0, 0.0, release.x, release.height, &release.state, orbit.t(), samples_per_flight);
        }
        let body = scene.model();
        let mut last_t = 0.0;
        let ending = equipoise_physics::map::run(&mut orbit, impacts, |contact| {
            contacts.push(contact);
            last_t = contact.t;
            if let (Some(flights), Some(strike), Some(length)) = (&mut flights, contact.strike, contact.flight_time) {
                let y = body.contact_height(&contact.state);
                flights.push(scene, contact.n, contact.t, contact.x, y, &strike.after, length, samples_per_flight);
            }
            !contact.n.is_multiple_of(256) || go_on()
        })?;
        let mut notes =
            vec!["error_estimate and predictable_impacts are null: this version does not estimate errors".to_owned()];
        if !has_angle(scene) {
            notes.push(
                "theta is the angle of the velocity from straight down, and theta_dot is null: a point mass has no \
                        angle of its own"
                    .to_owned(),
            );
        }
        Some(Self {
            scene: Resolved(scene),
            model: Choice::model(scene),
            method: Choice {
                name: "map",
                reason: "the map from contact to contact in closed form, the only method of this version".to_owned(),
            },
            outcome: Outcome::new(ending, orbit.contacts(), last_t),
            impacts: contacts.into_table(),
            predictable_impacts: None,
            flights: flights.map(Flights::into_table),
            notes,
            tilt_gain: scene.number(Name::TiltGain).unwrap_or_default(),
        })
    }

    /// The phase planes, as SVG.
    pub fn to_picture(&self) -> String {
        let column = |name: &str| self.impacts.0.iter().find(|column| column.name == name).map(|column| &column.cells);
        let numbers = |name| match column(name) {
            Some(Cells::Numbers(cells)) => cells.as_slice(),
            _ => &[],
        };
        let theta_dot: Option<Vec<f64>> = match column("theta_dot") {
            Some(Cells::Sparse(cells)) => cells.iter().copied().collect(),
            _ => None,
        };
        phase_planes(&PhasePlanes {
            title: &format!("Contacts of a {} with κ = {}", self.model.name.replace('_', " "), self.tilt_gain),
            subtitle: &format!("{}: {}", self.outcome.kind, self.outcome.detail),
            theta: numbers("theta"),
            theta_dot: theta_dot.as_deref(),
            x_dot: numbers("x_dot"),
            y_dot: numbers("y_dot"),
        })
    }

    /// What ends it as NDJSON.
    pub fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End {
            outcome: Outcome,
            notes: Vec<String>,
        }
        End { outcome: self.outcome.clone(), notes: self.notes.clone() }
    }
}
