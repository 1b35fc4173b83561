//! Impacts as a live run tells them: one as an object, many as columns, or each as a flat object. Their numbers are those of trajectories. The hold of a body has
//! the columns of `/v1/catches`.

use std::borrow::Cow;

use equipoise_physics::map::strike::State;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::api::catches::columns::{HoldSamples, OF_HOLD};
use crate::api::shared::table::columns::{row_schema, table_of};
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

/// An impact as it is sent: its columns, and again, as objects, the states just before and after it and the velocity of the table.
#[derive(Serialize, JsonSchema)]
#[schemars(inline)]
pub(super) struct NestedImpact<'a> {
    #[serde(flatten)]
    columns: FlatImpact<'a>,
    before: Before,
    after: Option<After>,
    table_velocity: Option<TableVelocity>,
    next_strike: Option<NextStrike>,
}

/// State just before an impact.
#[derive(Serialize, JsonSchema)]
#[schemars(inline)]
struct Before {
    /// Horizontal position of the centre of gravity, m.
    x: f64,
    /// Angle, rad.
    theta: f64,
    /// Horizontal velocity, m/s.
    x_dot: f64,
    /// Vertical velocity, m/s.
    y_dot: f64,
    /// Angular velocity, rad/s. Null for a point mass.
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
        let row = &self.row;
        let State { theta, x_dot, y_dot, theta_dot, .. } = row.contact.state;
        let nested = NestedImpact {
            columns: FlatImpact(self),
            before: Before { x: row.contact.x, theta, x_dot, y_dot, theta_dot: row.angle(theta_dot) },
            after: row.after(),
            table_velocity: row.table_velocity_x().zip(row.table_velocity_y()).map(|(x, y)| TableVelocity { x, y }),
            next_strike: self.next_strike,
        };
        nested.serialize(serializer)
    }
}

/// An impact as an object of its columns, without nested objects.
#[derive(Debug)]
pub struct FlatImpact<'a>(pub &'a ImpactMessage);

impl Serialize for FlatImpact<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_map(None)?;
        for column in columns::of_live_runs() {
            column.row.read.write_member(&self.0.row, column.row.name, &mut object)?;
        }
        object.end()
    }
}

impl JsonSchema for FlatImpact<'_> {
    fn schema_name() -> Cow<'static, str> {
        "FlatImpact".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let mut schema = Schema::try_from(row_schema("", &columns::live_words())).unwrap_or_default();
        // Members of a message are added.
        schema.remove("additionalProperties");
        schema
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
            let mut gathered = Gathered::with_capacity(column.row.read, self.0.len());
            self.0.iter().for_each(|ImpactMessage { row, .. }| gathered.push(row));
            Column { name: column.row.name, unit: column.row.unit, cells: gathered.into_cells() }
        };
        Table(columns::of_live_runs().map(column).collect()).serialize(serializer)
    }
}

/// Samples of a hold.
#[derive(Debug, Clone)]
pub struct HoldMessage(pub HoldPart);

impl Serialize for HoldMessage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        HoldColumns { columns: table_of(&OF_HOLD, self.0.samples()) }.serialize(serializer)
    }
}

/// Samples of a hold as they are sent.
#[derive(Serialize, JsonSchema)]
#[schemars(inline)]
pub(super) struct HoldColumns {
    #[schemars(with = "HoldSamples")]
    columns: Table,
}
