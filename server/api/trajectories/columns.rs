//! The columns of impacts, each described once: trajectories and live runs take theirs from this table.

use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::{State, Strike};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::orbit::{Contact, ExtendedContact, ExtendedOrbit};

use crate::api::shared::table::columns::{ColumnWord, RowColumn};
use crate::api::shared::table::gather::{ColumnKind, Read};
use crate::column_lists;

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

    /// What the contract says of it in trajectories.
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

    /// What the contract says of it in live runs.
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
pub static COLUMNS: [ImpactColumn; 22] = [
    column("n", "", "Number of the impact, counted from 1.", Read::Count(|row| row.contact.n)),
    column(
        DATES,
        "",
        "Wall time, in milliseconds since 1970 (UTC). Only with `epoch_ms`.",
        Read::SparseCount(|row| row.time_ms),
    )
    .scope(ColumnScope::Dated),
    column("t", "s", "Time since the release, in seconds.", Read::Number(|row| row.contact.t))
        .digits(|row| Some(row.contact.t)),
    column("x", "m", "Horizontal position of the centre of gravity, in metres.", Read::Number(|row| row.contact.x))
        .digits(|row| Some(row.contact.x)),
    column(
        "theta",
        "rad",
        "Angle, in radians. For a point mass, the angle of its velocity from straight down.",
        Read::Number(|row| row.contact.state.theta),
    )
    .digits(|row| Some(row.contact.state.theta)),
    column("x_dot", "m/s", "Horizontal velocity, in metres per second.", Read::Number(|row| row.contact.state.x_dot))
        .digits(|row| Some(row.contact.state.x_dot)),
    column("y_dot", "m/s", "Vertical velocity, in metres per second.", Read::Number(|row| row.contact.state.y_dot))
        .digits(|row| Some(row.contact.state.y_dot)),
    column(
        "theta_dot",
        "rad/s",
        "Angular velocity, in radians per second. Null for a point mass.",
        Read::Sparse(|row| row.angle(row.contact.state.theta_dot)),
    )
    .digits(|row| row.has_angle.then_some(row.contact.state.theta_dot)),
    column(
        "x_dot_after",
        "m/s",
        "Horizontal velocity just after the impact, in metres per second.",
        Read::Sparse(|row| row.after().map(|after| after.x_dot)),
    )
    .scope(ColumnScope::Live),
    column(
        "y_dot_after",
        "m/s",
        "Vertical velocity just after the impact, in metres per second.",
        Read::Sparse(|row| row.after().map(|after| after.y_dot)),
    )
    .scope(ColumnScope::Live),
    column(
        "theta_dot_after",
        "rad/s",
        "Angular velocity just after the impact, in radians per second. Null for a point mass.",
        Read::Sparse(|row| row.after()?.theta_dot),
    )
    .scope(ColumnScope::Live),
    column("alpha", "rad", "Angle of the table, in radians.", Read::Number(|row| row.contact.alpha))
        .digits(|row| Some(row.contact.alpha)),
    column(
        "table_velocity_x",
        "m/s",
        "Horizontal velocity of the table, in metres per second.",
        Read::Sparse(ImpactRow::table_velocity_x),
    )
    .digits(|row| row.struck(|strike| strike.table_velocity.0)),
    column(
        "table_velocity_y",
        "m/s",
        "Vertical velocity of the table, in metres per second.",
        Read::Sparse(ImpactRow::table_velocity_y),
    )
    .digits(|row| row.struck(|strike| strike.table_velocity.1)),
    column(
        "impulse_normal",
        "m/s",
        "Impulse along the normal of the table per unit mass, in metres per second.",
        Read::Sparse(ImpactRow::impulse_normal),
    )
    .digits(|row| row.struck(|strike| strike.impulse_normal)),
    column(
        "impulse_tangential",
        "m/s",
        "Impulse along the table per unit mass, in metres per second.",
        Read::Sparse(ImpactRow::impulse_tangential),
    ),
    column(
        "contact_mode",
        "",
        "Mode of the contact along the table: it slid one way throughout (`slide`); was at rest or came to \
             rest, and stayed (`stick`); came to rest and slid the other way (`reverse_slide`); or was at rest \
             and friction could not hold it (`slide_through`). Null without an impact.",
        Read::Word(ImpactRow::contact_mode),
    )
    .among("ContactMode"),
    column(
        "energy",
        "m²/s²",
        "Kinetic and potential energy per unit mass just before the impact, in metres squared per second squared.",
        Read::Number(|row| row.energy),
    )
    .digits(|row| Some(row.orbit.body.energy(&row.contact.state) + row.orbit.body.rod.gravity * row.contact.clearance)),
    column(
        "flight_time",
        "s",
        "Time to the next impact, in seconds. Null for the last.",
        Read::Sparse(|row| row.contact.flight_time),
    )
    .digits(|row| row.contact.flight_time),
    column(
        "contact_velocity",
        "m/s",
        "Vertical velocity of the contact point, in metres per second.",
        Read::Number(|row| row.contact_velocity),
    )
    .digits(|row| Some(row.orbit.body.contact_speed(&row.contact.state))),
    column(
        "clearance",
        "m",
        "Height of the contact point at the strike, in metres: 0 unless the table strikes early or late (`noise`).",
        Read::Number(|row| row.contact.clearance),
    ),
    column(
        "error_estimate",
        "m/s",
        "Bound on the largest of |ρδθ|, |δẋ|, |δẏ| and |ρδθ̇|, in metres (per second); for a point mass, of \
             |δẋ| and |δẏ|. Null if no bound is known: with interventions, past a graze, in a fast spin with state \
             feedback or noise, and once rounding has grown to the size of the run.",
        Read::Sparse(|row| row.error_estimate),
    )
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

/// What the contract says of the columns of trajectories.
pub fn trajectory_words() -> Vec<ColumnWord> {
    of_trajectories(true).map(ImpactColumn::word).collect()
}

/// What the contract says of the columns of live impacts.
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
