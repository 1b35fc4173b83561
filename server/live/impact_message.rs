//! Impacts as a live run tells them: one as an object, many as columns, or each as a flat object. Their numbers are those of trajectories. The hold of a body has
//! the columns of `/v1/catches`.

use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::api::catches::columns::OF_HOLD;
use crate::api::shared::table::columns::table_of;
use crate::api::shared::table::gather::Gathered;
use crate::api::shared::table::{Column, Table};
use crate::api::trajectories::columns;
use crate::api::trajectories::columns::ImpactRow;
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

/// Form of the impacts that a client asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ImpactForm {
    /// One impact as an object with the states and the next strike nested in it; several as columns.
    #[default]
    Nested,
    /// Each impact as an object whose members are the columns.
    Flat,
}

impl ImpactForm {
    /// The forms by name, the default first.
    pub const NAMES: [(&'static str, Self); 2] = [("nested", Self::Nested), ("flat", Self::Flat)];
}

#[derive(Serialize)]
struct Before {
    x: f64,
    theta: f64,
    x_dot: f64,
    y_dot: f64,
    theta_dot: Option<f64>,
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
        let state = &row.contact.state;
        let before = Before {
            x: row.contact.x,
            theta: state.theta,
            x_dot: state.x_dot,
            y_dot: state.y_dot,
            theta_dot: row.angle(state.theta_dot),
        };
        let table_velocity = row.table_velocity_x().zip(row.table_velocity_y()).map(|(x, y)| TableVelocity { x, y });
        let mut object = serializer.serialize_map(None)?;
        write_columns(row, &mut object)?;
        object.serialize_entry("before", &before)?;
        object.serialize_entry("after", &row.after())?;
        object.serialize_entry("table_velocity", &table_velocity)?;
        object.serialize_entry("next_strike", next_strike)?;
        object.end()
    }
}

/// An impact as an object of its columns, without nested objects.
#[derive(Debug)]
pub struct FlatImpact<'a>(pub &'a ImpactMessage);

impl Serialize for FlatImpact<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_map(None)?;
        write_columns(&self.0.row, &mut object)?;
        object.end()
    }
}

/// Writes every column of live impacts as a member.
fn write_columns<M: SerializeMap>(row: &ImpactRow, object: &mut M) -> Result<(), M::Error> {
    columns::of_live_runs().try_for_each(|column| column.read.write_member(row, column.name, object))
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
        Columns { columns: table_of(&OF_HOLD, self.0.samples()) }.serialize(serializer)
    }
}
