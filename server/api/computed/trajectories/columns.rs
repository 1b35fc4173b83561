//! The columns of impacts, each described once: trajectories, live runs and strikes of catches take theirs from this table. The contact after
//! the last bounce of a run that settles, and the columns of it.

use equipoise_physics::catching::outcome::CatchStrike;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::friction::Slide;
use equipoise_physics::map::strike::{State, Strike};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::{
    Hold, HoldEnding, HoldRequest, HoldSample, LONGEST_HOLD, hold, rest_of_run,
};
use equipoise_physics::run::orbit::{Contact, ExtendedContact, ExtendedOrbit};
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::capability::Analysis;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::outcome::ended;
use crate::api::shared::refusal::{Refusal, lacking};
use crate::api::shared::stacked::{stacked, stacked_words};
use crate::api::shared::table::{Cells, Column, ColumnKind, ColumnWord, Read, RowColumn, Table, table_of};
use crate::column_lists;
use crate::words;

/// An impact in doubles: the state just before it, the strike, and the velocities just after it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImpactRow {
    /// The contact.
    pub contact: Contact,
    /// False for a point mass, which has no angle of its own.
    pub has_angle: bool,
    /// Energy per unit mass just before, m²/s².
    pub energy: f64,
    /// Vertical velocity of the contact point just before, m/s.
    pub contact_velocity: f64,
    /// Wall time, unix ms, if the time of release is known.
    pub time_ms: Option<u64>,
    /// Bound on the error of the state, m/s, if there is one.
    pub error_estimate: Option<f64>,
}

impl ImpactRow {
    /// The impact of a body at a contact.
    pub fn new(body: &Body, has_angle: bool, contact: Contact) -> Self {
        let energy = body.energy(&contact.state) + body.rod.gravity * contact.clearance;
        let contact_velocity = body.contact_speed(&contact.state);
        Self { contact, has_angle, energy, contact_velocity, time_ms: None, error_estimate: None }
    }

    /// A number of the strike. None without a strike, or if the run has diverged beyond doubles.
    fn struck(&self, read: impl FnOnce(&Strike) -> f64) -> Option<f64> {
        // + 0.0 turns −0, the velocity of a table at rest, into 0.
        self.contact.strike.as_ref().map(|strike| read(strike) + 0.0).filter(|value| value.is_finite())
    }

    /// An angular velocity. A point mass has none.
    pub fn angle(&self, value: f64) -> Option<f64> {
        self.has_angle.then_some(value)
    }

    /// The velocities just after.
    fn after(&self) -> Option<After> {
        let State { x_dot, y_dot, theta_dot, .. } = self.contact.strike.as_ref()?.after;
        let exist = [x_dot, y_dot, theta_dot].iter().all(|value| value.is_finite());
        exist.then(|| After { x_dot, y_dot, theta_dot: self.angle(theta_dot) })
    }

    /// Horizontal velocity of the table, m/s.
    fn table_velocity_x(&self) -> Option<f64> {
        self.struck(|strike| strike.table_velocity.0)
    }

    /// Vertical velocity of the table, m/s.
    fn table_velocity_y(&self) -> Option<f64> {
        self.struck(|strike| strike.table_velocity.1)
    }

    /// Impulse along the normal of the table per unit mass, m/s.
    pub fn impulse_normal(&self) -> Option<f64> {
        self.struck(|strike| strike.impulse_normal)
    }

    /// Impulse along the table per unit mass, m/s.
    pub fn impulse_tangential(&self) -> Option<f64> {
        self.struck(|strike| strike.impulse_tangential)
    }

    /// Name of the contact mode.
    pub fn contact_mode(&self) -> Option<&'static str> {
        self.contact.strike.as_ref().map(|strike| strike.mode.name())
    }
}

/// Velocities just after an impact.
#[derive(Debug, Clone, Copy)]
struct After {
    /// Horizontal velocity, m/s.
    x_dot: f64,
    /// Vertical velocity, m/s.
    y_dot: f64,
    /// Angular velocity, rad/s. Null for a point mass.
    theta_dot: Option<f64>,
}

/// An impact with 31 digits.
#[derive(Debug, Clone, Copy)]
pub struct ExtendedRow<'a> {
    /// The run.
    pub orbit: &'a ExtendedOrbit,
    /// The contact.
    pub contact: &'a ExtendedContact,
    /// False for a point mass.
    pub has_angle: bool,
}

impl ExtendedRow<'_> {
    fn struck(&self, read: impl FnOnce(&Strike<DoubleDouble>) -> DoubleDouble) -> Option<DoubleDouble> {
        self.contact.strike.as_ref().map(read)
    }
}

/// The answers that have a column.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColumnScope {
    /// Trajectories and live runs.
    Everywhere,
    /// Trajectories alone.
    Trajectories,
    /// Trajectories whose time of release is given, and live runs.
    Dated,
    /// Live runs alone.
    Live,
}

/// A column of impacts.
#[derive(Debug)]
pub struct ImpactColumn {
    /// The column in doubles.
    pub row: RowColumn<ImpactRow>,
    /// The answers that have it.
    pub scope: ColumnScope,
    /// Reads the value with 31 digits, if the method `extended` gives it.
    pub digits: Option<fn(&ExtendedRow<'_>) -> Option<DoubleDouble>>,
}

const fn column(name: &'static str, unit: &'static str, about: &'static str, read: Read<ImpactRow>) -> ImpactColumn {
    ImpactColumn { row: RowColumn::new(name, unit, about, read), scope: ColumnScope::Everywhere, digits: None }
}

impl ImpactColumn {
    const fn scope(self, scope: ColumnScope) -> Self {
        Self { scope, ..self }
    }

    const fn digits(self, digits: fn(&ExtendedRow<'_>) -> Option<DoubleDouble>) -> Self {
        Self { digits: Some(digits), ..self }
    }

    const fn among(self, words: &'static str) -> Self {
        Self { row: self.row.among(words), ..self }
    }

    /// Description in the contract of trajectories.
    fn word(&self) -> ColumnWord {
        let word = self.row.word();
        let (kind, may_be_missing) = word.kind;
        match self.scope {
            ColumnScope::Dated => {
                let about = "Wall time since 1970 (UTC), ms.";
                ColumnWord { about, kind: (kind, false), ..word.only("with `epoch_ms`") }
            }
            _ if self.digits.is_some() => ColumnWord { kind: (ColumnKind::Digits, may_be_missing), ..word },
            _ => word,
        }
    }

    /// Description in the contract of live runs.
    fn live_word(&self) -> ColumnWord {
        let word = self.row.word();
        if self.scope != ColumnScope::Dated {
            return word;
        }
        let about =
            "Wall time of the impact since 1970 (UTC), ms. It is of the clock of the run, with pauses and speeds.";
        ColumnWord { about, kind: (word.kind.0, false), ..word }
    }
}

/// Name of the column of dates.
pub const DATES: &str = "time_ms";

/// All columns, in their order.
#[rustfmt::skip]
pub static COLUMNS: [ImpactColumn; 22] = [
    column("n", "", "Number of the impact, counted from 1.", Read::Count(|row| row.contact.n)),
    column(DATES, "", "Wall time, in milliseconds since 1970 (UTC). Only with `epoch_ms`.", Read::SparseCount(|row| row.time_ms)).scope(ColumnScope::Dated),
    column("t", "s", "Time since the release, in seconds.", Read::Number(|row| row.contact.t)).digits(|row| Some(row.contact.t)),
    column("x", "m", "Horizontal position of the centre of gravity, in metres.", Read::Number(|row| row.contact.x)).digits(|row| Some(row.contact.x)),
    column("theta", "rad", "Angle, in radians. For a point mass, the angle of its velocity from straight down.", Read::Number(|row| row.contact.state.theta))
        .digits(|row| Some(row.contact.state.theta)),
    column("x_dot", "m/s", "Horizontal velocity, in metres per second.", Read::Number(|row| row.contact.state.x_dot))
        .digits(|row| Some(row.contact.state.x_dot)),
    column("y_dot", "m/s", "Vertical velocity, in metres per second.", Read::Number(|row| row.contact.state.y_dot)).digits(|row| Some(row.contact.state.y_dot)),
    column("theta_dot", "rad/s", "Angular velocity, in radians per second. Null for a point mass.", Read::Sparse(|row| row.angle(row.contact.state.theta_dot)))
        .digits(|row| row.has_angle.then_some(row.contact.state.theta_dot)),
    column("x_dot_after", "m/s", "Horizontal velocity just after the impact, in metres per second.", Read::Sparse(|row| row.after().map(|after| after.x_dot)))
        .scope(ColumnScope::Live),
    column("y_dot_after", "m/s", "Vertical velocity just after the impact, in metres per second.", Read::Sparse(|row| row.after().map(|after| after.y_dot)))
        .scope(ColumnScope::Live),
    column("theta_dot_after", "rad/s", "Angular velocity just after the impact, in radians per second. Null for a point mass.", Read::Sparse(|row| row.after()?.theta_dot))
        .scope(ColumnScope::Live),
    column("alpha", "rad", "Angle of the table, in radians.", Read::Number(|row| row.contact.alpha)).digits(|row| Some(row.contact.alpha)),
    column("table_velocity_x", "m/s", "Horizontal velocity of the table, in metres per second.", Read::Sparse(ImpactRow::table_velocity_x))
        .digits(|row| row.struck(|strike| strike.table_velocity.0)),
    column("table_velocity_y", "m/s", "Vertical velocity of the table, in metres per second.", Read::Sparse(ImpactRow::table_velocity_y))
        .digits(|row| row.struck(|strike| strike.table_velocity.1)),
    column("impulse_normal", "m/s", "Impulse along the normal of the table per unit mass, in metres per second.", Read::Sparse(ImpactRow::impulse_normal))
        .digits(|row| row.struck(|strike| strike.impulse_normal)),
    column("impulse_tangential", "m/s", "Impulse along the table per unit mass, in metres per second.", Read::Sparse(ImpactRow::impulse_tangential)),
    column("contact_mode", "", "Mode of the contact along the table: it slid one way throughout (`slide`); was at rest or came to rest, and stayed (`stick`); came to rest and slid the other way (`reverse_slide`); or was at rest and friction could not hold it (`slide_through`). Null without an impact.", Read::Word(ImpactRow::contact_mode))
        .among("ContactMode"),
    column("energy", "m²/s²", "Kinetic and potential energy per unit mass just before the impact, in metres squared per second squared.", Read::Number(|row| row.energy))
        .digits(|row| Some(row.orbit.body.energy(&row.contact.state) + row.orbit.body.rod.gravity * row.contact.clearance)),
    column("flight_time", "s", "Time to the next impact, in seconds. Null for the last.", Read::Sparse(|row| row.contact.flight_time))
        .digits(|row| row.contact.flight_time),
    column("contact_velocity", "m/s", "Vertical velocity of the contact point, in metres per second.", Read::Number(|row| row.contact_velocity))
        .digits(|row| Some(row.orbit.body.contact_speed(&row.contact.state))),
    column("clearance", "m", "Height of the contact point at the strike, in metres: 0 unless the table strikes early or late (`noise`).", Read::Number(|row| row.contact.clearance)),
    column("error_estimate", "m/s", "Bound on the largest of |ρδθ|, |δẋ|, |δẏ| and |ρδθ̇|, in metres (per second); for a point mass, of |δẋ| and |δẏ|. Null if no bound is known: with interventions, past a graze, in a fast spin with state feedback or noise, and once rounding has grown to the size of the run.", Read::Sparse(|row| row.error_estimate))
        .scope(ColumnScope::Trajectories),
];

/// The columns of a trajectory. With a known time of release they include its dates.
pub fn of_trajectories(dated: bool) -> impl Iterator<Item = &'static ImpactColumn> {
    COLUMNS.iter().filter(move |column| match column.scope {
        ColumnScope::Everywhere | ColumnScope::Trajectories => true,
        ColumnScope::Dated => dated,
        ColumnScope::Live => false,
    })
}

column_lists! {
    /// The impacts: columns of one length.
    pub Impacts = trajectory_words();
    /// The impacts: columns of one length.
    pub LiveImpactColumns = live_words();
}

/// Descriptions in the contract of the columns of trajectories.
pub fn trajectory_words() -> Vec<ColumnWord> {
    of_trajectories(true).map(ImpactColumn::word).collect()
}

/// Descriptions in the contract of the columns of live impacts.
pub fn live_words() -> Vec<ColumnWord> {
    of_live_runs().map(ImpactColumn::live_word).collect()
}

/// The columns of live impacts.
pub fn of_live_runs() -> impl Iterator<Item = &'static ImpactColumn> {
    COLUMNS.iter().filter(|column| match column.scope {
        ColumnScope::Everywhere | ColumnScope::Dated | ColumnScope::Live => true,
        ColumnScope::Trajectories => false,
    })
}

/// Wall time, unix ms, of a time since the release at `epoch_ms`.
pub fn date(epoch: u64, t: f64) -> u64 {
    (epoch as f64 + 1e3 * t).round() as u64
}

/// The contact: its samples and its end.
#[derive(Debug)]
pub(crate) struct HoldAnswer {
    /// Samples.
    pub(crate) samples: Vec<HoldSample>,
    /// End.
    pub(crate) end: HoldEnd,
}

/// Impacts and the contact after them as one table, for CSV and NDJSON. The columns do not depend on the outcome: a run that did not
/// settle has no rows in contact. With a known time of release the contact has dates too.
pub(crate) fn phases(impacts: &Table, samples: Option<&Table>, epoch: Option<u64>) -> Table {
    let mut contact = samples.cloned().unwrap_or_else(|| table_of(&OF_HOLD, &[]));
    let times = contact.0.iter().find(|column| column.name == "t").and_then(|column| column.cells.numbers());
    if let (Some(epoch), Some(times)) = (epoch, times) {
        let dates = times.into_iter().map(|t| Some(date(epoch, t))).collect();
        contact.0.push(Column { name: DATES, unit: "", cells: Cells::SparseCounts(dates) });
    }
    stacked(&[("impact", impacts), ("hold", &contact)])
}

/// Descriptions in the contract of the columns of [`phases`].
pub(crate) fn phase_words() -> Vec<ColumnWord> {
    stacked_words(&[trajectory_words(), OF_HOLD.iter().map(RowColumn::word).collect()])
}

words! {
    /// The end of a contact after the bounces.
    /// `completed`: the body stays in contact up to the end of `hold`.
    /// `contact_lost`: no table that pushes keeps the contact point at its height.
    /// `slipped`: a contact that has to stick needs more friction than there is.
    /// `toppled`: the angle reached `topple_angle`.
    /// `other_vertex`: another vertex of a polygon came down to the table.
    /// `rests_on_edge`: a polygon came to rest on an edge.
    /// `beyond_limits`: the contact needs more than `table.limits` allow.
    /// `off_table`: the contact point came to an end of the table (`table.length`).
    /// `too_long`: the motion could not be followed to its end, with twice the work by which the hold is priced.
    HoldEndKind = [
        "completed", "contact_lost", "slipped", "toppled", "other_vertex", "rests_on_edge", "beyond_limits", "off_table", "too_long"
    ];
    /// `frictionless`: the contact point slides freely.
    /// `matched`: the table moves along itself with the contact point, as at strikes with `slide: matched`, and its force along itself is at most
    /// μN.
    /// `coulomb`: the table does not move along itself; the contact point slides with the force μN against it until it rests, and sticks while
    /// that needs less.
    HoldContact = ["frictionless", "matched", "coulomb"];
}

/// The end of the contact that follows the bounces of a run. The table tilts about the contact point by the law of the scene.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct HoldEnd {
    /// Name of the ending.
    #[schemars(with = "HoldEndKind")]
    pub kind: &'static str,
    /// Run time of the end, s.
    pub t: f64,
    /// One sentence, with numbers.
    pub detail: String,
    /// Kind of contact.
    #[schemars(with = "HoldContact")]
    pub contact: &'static str,
    /// Bound on the error of the samples by two tolerances of the integrator, m/s. It bounds |δx| (m), |ρδθ| (m), |δẋ| and |ρδθ̇|. Null if the two
    /// solutions do not end alike.
    pub error_bound: Option<f64>,
    /// Times from which the body stays upright and in place.
    pub upright_within: UprightWithin,
}

/// Times from which the body stays upright and in place up to the end of a completed hold. Null if it does not get there.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct UprightWithin {
    /// Time from which |θ| stays within 1 mrad, s.
    pub theta_1mrad: Option<f64>,
    /// Time from which |x| stays within 1 mm, s.
    pub x_1mm: Option<f64>,
}

impl HoldAnswer {
    /// Follows a run that ended at its `last` contact for `duration` s more. `Err` has a reason if it did not settle.
    ///
    /// # Errors
    /// Cancelled work.
    pub(crate) fn compute(
        scene: &Scene,
        (ending, last): (Ending, Option<&Contact>),
        duration: f64,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Result<Self, String>, Refusal> {
        let (Ending::Settled { settle_time, .. }, Some(last)) = (ending, last) else {
            return Ok(Err(format!("hold is absent: the run ended as `{}`, not as `settled`", ending.name())));
        };
        if let Some(why) = lacking(scene, Analysis::LastingContact) {
            return Ok(Err(format!("hold is absent: {why}")));
        }
        let Some(request) = rest_of_run(scene, last, settle_time, duration) else {
            return Ok(Err("hold is absent: the last contact has no strike".to_owned()));
        };
        let held = hold(&request, go_on);
        if held.ending == HoldEnding::Stopped {
            return Err(Refusal::Cancelled);
        }
        let end = HoldEnd::new(&request, &held);
        Ok(Ok(Self { samples: held.samples, end }))
    }
}

impl HoldEnd {
    fn new(request: &HoldRequest, held: &Hold) -> Self {
        let t = held.t_end;
        let (kind, detail) = match held.ending {
            HoldEnding::Completed => ("completed", format!("the body stays in contact up to t = {t} s")),
            HoldEnding::ContactLost => {
                ("contact_lost", format!("at t = {t} s, no pushing table keeps the contact point at its height"))
            }
            HoldEnding::Slipped { needed } => (
                "slipped",
                format!(
                    "at t = {t} s, sticking needs a friction of {needed}; contact.friction is {}",
                    request.body.rough().map_or(0.0, |friction| friction.coefficient)
                ),
            ),
            HoldEnding::Ended(ending) => (ending.name(), ended_as_a_run(t, ending)),
            HoldEnding::RestsOnEdge { vertices: [one, other] } => {
                ("rests_on_edge", format!("at t = {t} s, the body rests on vertices {one} and {other}"))
            }
            HoldEnding::Stopped | HoldEnding::TooLong => (
                "too_long",
                format!(
                    "at t = {t} s, the contact changes too often, or too fast, to be followed up to {LONGEST_HOLD} s"
                ),
            ),
        };
        Self {
            kind,
            t,
            detail,
            contact: match request.body.rough().map(|friction| friction.slide) {
                None => "frictionless",
                Some(Slide::Matched) => "matched",
                Some(Slide::None) => "coulomb",
            },
            error_bound: Some(held.error_bound).filter(|bound| bound.is_finite()),
            upright_within: UprightWithin { theta_1mrad: held.theta_within, x_1mm: held.x_within },
        }
    }
}

/// The reason for which a contact ended as a run does.
fn ended_as_a_run(t: f64, ending: Ending) -> String {
    let at = format!("at t = {t} s");
    match ending {
        Ending::OtherVertex(touch) => format!("{at}, vertex {} of the body came down to the table", touch.vertex),
        Ending::OffTable { place, limit } => {
            format!("{at}, the contact point is at {place} m, beyond the end of the table at {limit} m")
        }
        other => ended(&at, "the contact", other, |numbers| numbers.map(|number| number.to_string())).0,
    }
}

column_lists! {
    /// Strikes of a catch: states just before each, and the table at each. Columns of one length.
    pub Strikes = of_strikes().iter().map(RowColumn::word);
    /// Lasting contact after the last strike, evenly in time, and its last moment. Columns of one length, without rows if there is none. The
    /// centre of gravity is at table_y + l cos θ.
    pub HoldSamples = OF_HOLD.iter().map(RowColumn::word);
}

/// A column of strikes that an impact of a run has too: its description there holds here.
fn shared(name: &'static str, read: Read<CatchStrike>) -> RowColumn<CatchStrike> {
    let (unit, about) =
        COLUMNS.iter().find(|column| column.row.name == name).map_or(("", ""), |it| (it.row.unit, it.row.about));
    RowColumn::new(name, unit, about, read)
}

/// Columns of strikes.
pub fn of_strikes() -> [RowColumn<CatchStrike>; 19] {
    [
        shared("n", Read::Count(|at| at.n)),
        shared("t", Read::Number(|at| at.t)),
        shared("x", Read::Number(|at| at.x)),
        shared("theta", Read::Number(|at| at.state.theta)),
        shared("x_dot", Read::Number(|at| at.state.x_dot)),
        shared("y_dot", Read::Number(|at| at.state.y_dot)),
        shared("theta_dot", Read::Number(|at| at.state.theta_dot)),
        shared("x_dot_after", Read::Number(|at| at.strike.after.x_dot)),
        shared("y_dot_after", Read::Number(|at| at.strike.after.y_dot)),
        shared("theta_dot_after", Read::Number(|at| at.strike.after.theta_dot)),
        shared("alpha", Read::Number(|at| at.strike.alpha)),
        shared("impulse_normal", Read::Number(|at| at.strike.impulse_normal)),
        shared("impulse_tangential", Read::Number(|at| at.strike.impulse_tangential + 0.0)),
        shared("contact_mode", Read::Word(|at| Some(at.strike.mode.name()))).among("ContactMode"),
        shared("flight_time", Read::Sparse(|at| at.flight_time)),
        shared("contact_velocity", Read::Number(|at| at.contact_speed)),
        shared("clearance", Read::Number(|at| at.clearance)),
        RowColumn::new(
            "table_velocity",
            "m/s",
            "Velocity of the table along its normal, in metres per second; upwards is positive.",
            Read::Number(|at| at.strike.table_speed() + 0.0),
        ),
        RowColumn::new(
            "ratio",
            "",
            "Vertical speed of the contact point just after the strike over that just before: 0 if it comes to rest, below 0 if it goes on downwards.",
            Read::Number(|at| at.ratio() + 0.0),
        ),
    ]
}

/// Columns of the hold.
#[rustfmt::skip]
pub static OF_HOLD: [RowColumn<HoldSample>; 11] = [
    RowColumn::new("t", "s", "Time since the release, in seconds.", Read::Number(|sample| sample.t)),
    RowColumn::new("x", "m", "Horizontal position of the centre of gravity, in metres.", Read::Number(|sample| sample.x)),
    RowColumn::new("theta", "rad", "Angle, in radians.", Read::Number(|sample| sample.theta)),
    RowColumn::new("x_dot", "m/s", "Horizontal velocity, in metres per second.", Read::Number(|sample| sample.x_dot)),
    RowColumn::new("theta_dot", "rad/s", "Angular velocity, in radians per second.", Read::Number(|sample| sample.theta_dot)),
    RowColumn::new("alpha", "rad", "Angle of the table, in radians.", Read::Number(|sample| sample.alpha)),
    RowColumn::new("normal_force", "m/s²", "Force of the table along its normal per unit mass, in metres per second squared. Contact lasts while it is above 0.", Read::Number(|sample| sample.normal_force)),
    RowColumn::new("tangential_force", "m/s²", "Force of the table along itself per unit mass, in metres per second squared.", Read::Number(|sample| sample.tangential_force)),
    RowColumn::new("table_x", "m", "Way of the table's surface along x since the contact began, in metres. 0 unless the table moves along itself.", Read::Number(|sample| sample.table_x)),
    RowColumn::new("table_y", "m", "Height of the table's surface at the contact over its height as the contact began, in metres.", Read::Number(|sample| sample.table_y)),
    RowColumn::new("table_y_dot", "m/s", "Vertical velocity of the table's surface at the contact, in metres per second.", Read::Number(|sample| sample.table_y_dot)),
];

/// The words of the contract on the columns of strikes and hold in one table.
pub fn catch_words() -> Vec<ColumnWord> {
    stacked_words(&[of_strikes().iter().map(RowColumn::word).collect(), OF_HOLD.iter().map(RowColumn::word).collect()])
}
