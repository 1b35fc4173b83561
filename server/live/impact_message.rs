//! Impacts as a live run tells them: one as an object of its columns, many as columns. Their numbers are those of trajectories. The hold of a
//! body has the columns of `/v1/catches`.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::api::catches::columns::{HoldSamples, OF_HOLD};
use crate::api::shared::table::columns::{row_schema, table_of};
use crate::api::shared::table::gather::Gathered;
use crate::api::shared::table::{Column, Table};
use crate::api::trajectories::columns;
use crate::api::trajectories::columns::ImpactRow;
use crate::live::next_strike::NextStrike;
use crate::runs::held::HoldPart;

/// An impact: an object of its columns, and the strike after it.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactMessage {
    /// The impact.
    pub row: ImpactRow,
    /// The strike after it.
    pub next_strike: Option<NextStrike>,
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
        let mut object = serializer.serialize_map(None)?;
        for column in columns::of_live_runs() {
            column.row.read.write_member(&self.row, column.row.name, &mut object)?;
        }
        object.end()
    }
}

impl JsonSchema for ImpactMessage {
    fn schema_name() -> Cow<'static, str> {
        "ImpactMessage".into()
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
