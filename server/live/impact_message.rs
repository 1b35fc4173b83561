//! Impacts as a live run tells them: one as an object, many as columns. Their numbers are those of trajectories. The hold of a body has
//! the columns of `/v1/catches`.

use serde::{Serialize, Serializer};

use crate::api::catches::columns::{OF_HOLD, to_table};
use crate::api::shared::table::gather::Gathered;
use crate::api::shared::table::{Column, Table};
use crate::api::trajectories::columns;
use crate::api::trajectories::columns::{After, ImpactRow};
use crate::live::next_strike::{NextStrike, TableVelocity};
use crate::runs::held::HoldPart;

/// An impact, as an object.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactMessage {
    /// The impact.
    pub row: ImpactRow,
    /// The strike after it.
    pub next_strike: Option<NextStrike>,
}

#[derive(Serialize)]
struct Before {
    x: f64,
    theta: f64,
    x_dot: f64,
    y_dot: f64,
    theta_dot: Option<f64>,
}

#[derive(Serialize)]
struct Nested {
    n: u64,
    t: f64,
    before: Before,
    after: Option<After>,
    alpha: f64,
    table_velocity: Option<TableVelocity>,
    flight_time: Option<f64>,
    energy: f64,
    contact_speed: f64,
    impulse_normal: Option<f64>,
    impulse_tangential: Option<f64>,
    contact_mode: Option<&'static str>,
    clearance: f64,
    next_strike: Option<NextStrike>,
}

impl ImpactMessage {
    /// Number of the impact, from 1.
    pub fn n(&self) -> u64 {
        self.row.contact.n
    }

    /// Time to the next one, s of run time.
    pub fn flight_time(&self) -> Option<f64> {
        self.row.contact.flight_time
    }
}

impl Serialize for ImpactMessage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { row, next_strike } = self;
        let (contact, state) = (&row.contact, &row.contact.state);
        Nested {
            n: contact.n,
            t: contact.t,
            before: Before {
                x: contact.x,
                theta: state.theta,
                x_dot: state.x_dot,
                y_dot: state.y_dot,
                theta_dot: row.angle(state.theta_dot),
            },
            after: row.after(),
            alpha: contact.alpha,
            table_velocity: row.table_velocity_x().zip(row.table_velocity_y()).map(|(x, y)| TableVelocity { x, y }),
            flight_time: contact.flight_time,
            energy: row.energy,
            contact_speed: row.contact_speed,
            impulse_normal: row.impulse_normal(),
            impulse_tangential: row.impulse_tangential(),
            contact_mode: row.contact_mode(),
            clearance: contact.clearance,
            next_strike: *next_strike,
        }
        .serialize(serializer)
    }
}

/// Impacts, column by column.
#[derive(Debug)]
pub struct ImpactColumns(pub Vec<ImpactMessage>);

impl ImpactColumns {
    /// The strike after the last impact.
    pub fn next_strike(&self) -> Option<NextStrike> {
        self.0.last()?.next_strike
    }
}

impl Serialize for ImpactColumns {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let column = |column: &'static columns::ImpactColumn| {
            let mut gathered = Gathered::with_capacity(column.read, self.0.len());
            self.0.iter().for_each(|ImpactMessage { row, .. }| gathered.push(row));
            Column { name: column.name, unit: column.unit, cells: gathered.into_cells() }
        };
        Table(columns::of_live_runs().map(column).collect()).serialize(serializer)
    }
}

/// Samples of a hold.
#[derive(Debug, Clone)]
pub struct HoldMessage(pub HoldPart);

impl Serialize for HoldMessage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Columns<T> {
            columns: T,
        }
        Columns { columns: to_table(OF_HOLD.iter().copied(), self.0.samples()) }.serialize(serializer)
    }
}
