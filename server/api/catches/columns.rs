//! The columns of strikes and of the hold. Those that an impact has too are described with it.

use equipoise_physics::catching::outcome::CatchStrike;
use equipoise_physics::run::lasting_contact::HoldSample;

use crate::api::shared::table::gather::{Gathered, Read};
use crate::api::shared::table::{Column, Table};
use crate::api::trajectories::columns::COLUMNS;

/// A column of the rows of a catch.
#[derive(Debug, Clone, Copy)]
pub struct CatchColumn<Row> {
    /// Name in JSON.
    pub name: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Meaning, as the contract says it.
    pub about: &'static str,
    /// Reads the value.
    pub read: Read<Row>,
}

const fn own<Row>(name: &'static str, unit: &'static str, about: &'static str, read: Read<Row>) -> CatchColumn<Row> {
    CatchColumn { name, unit, about, read }
}

/// Columns of a strike that an impact of a run has too: its description there holds here.
static SHARED: [(&str, Read<CatchStrike>); 17] = [
    ("n", Read::Count(|at| at.n)),
    ("t", Read::Number(|at| at.t)),
    ("x", Read::Number(|at| at.x)),
    ("theta", Read::Number(|at| at.state.theta)),
    ("x_dot", Read::Number(|at| at.state.x_dot)),
    ("y_dot", Read::Number(|at| at.state.y_dot)),
    ("theta_dot", Read::Number(|at| at.state.theta_dot)),
    ("x_dot_after", Read::Number(|at| at.strike.after.x_dot)),
    ("y_dot_after", Read::Number(|at| at.strike.after.y_dot)),
    ("theta_dot_after", Read::Number(|at| at.strike.after.theta_dot)),
    ("alpha", Read::Number(|at| at.strike.alpha)),
    ("impulse_normal", Read::Number(|at| at.strike.impulse_normal)),
    ("impulse_tangential", Read::Number(|at| at.strike.impulse_tangential + 0.0)),
    ("contact_mode", Read::Word(|at| Some(at.strike.mode.name()))),
    ("flight_time", Read::Sparse(|at| at.flight_time)),
    ("contact_speed", Read::Number(|at| at.contact_speed)),
    ("clearance", Read::Number(|at| at.clearance)),
];

/// Columns of strikes alone.
static OF_STRIKES_ALONE: [CatchColumn<CatchStrike>; 2] = [
    own(
        "table_velocity",
        "m/s",
        "Velocity of the table along its normal, in metres per second; upwards is positive.",
        Read::Number(|at| at.strike.table_speed() + 0.0),
    ),
    own(
        "ratio",
        "",
        "Vertical speed of the contact point just after the strike over that just before: 0 if it comes to rest, below 0 if it goes on downwards.",
        Read::Number(|at| at.ratio() + 0.0),
    ),
];

/// Columns of the hold.
pub static OF_HOLD: [CatchColumn<HoldSample>; 11] = [
    own("t", "s", "Time since the release, in seconds.", Read::Number(|sample| sample.t)),
    own("x", "m", "Horizontal position of the centre of gravity, in metres.", Read::Number(|sample| sample.x)),
    own("theta", "rad", "Angle, in radians.", Read::Number(|sample| sample.theta)),
    own("x_dot", "m/s", "Horizontal velocity, in metres per second.", Read::Number(|sample| sample.x_dot)),
    own("theta_dot", "rad/s", "Angular velocity, in radians per second.", Read::Number(|sample| sample.theta_dot)),
    own("alpha", "rad", "Angle of the table, in radians.", Read::Number(|sample| sample.alpha)),
    own(
        "normal_force",
        "m/s²",
        "Force of the table along its normal per unit mass, in metres per second squared. Contact lasts while it is above 0.",
        Read::Number(|sample| sample.normal_force),
    ),
    own(
        "tangential_force",
        "m/s²",
        "Force of the table along itself per unit mass, in metres per second squared.",
        Read::Number(|sample| sample.tangential_force),
    ),
    own(
        "table_x",
        "m",
        "Way of the table's surface along x since the contact began, in metres. 0 unless the table moves along itself.",
        Read::Number(|sample| sample.table_x),
    ),
    own(
        "table_y",
        "m",
        "Height of the table's surface at the contact over its height as the contact began, in metres.",
        Read::Number(|sample| sample.table_y),
    ),
    own(
        "table_y_dot",
        "m/s",
        "Vertical velocity of the table's surface at the contact, in metres per second.",
        Read::Number(|sample| sample.table_y_dot),
    ),
];

/// Columns of strikes.
pub fn of_strikes() -> impl Iterator<Item = CatchColumn<CatchStrike>> {
    let shared = SHARED.iter().filter_map(|(name, read)| {
        let column = COLUMNS.iter().find(|column| column.name == *name)?;
        Some(own(column.name, column.unit, column.about, *read))
    });
    shared.chain(OF_STRIKES_ALONE.iter().copied())
}

/// A table of rows.
pub fn to_table<Row>(columns: impl Iterator<Item = CatchColumn<Row>>, rows: &[Row]) -> Table {
    let column = |CatchColumn { name, unit, read, .. }: CatchColumn<Row>| {
        let mut values = Gathered::with_capacity(read, rows.len());
        values.extend(rows);
        Column { name, unit, cells: values.into_cells() }
    };
    Table(columns.map(column).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn document() -> Value {
        serde_json::from_slice(include_bytes!(concat!(env!("OUT_DIR"), "/openapi.json"))).unwrap()
    }

    /// Names, meanings and units of a schema of columns, against those of the table.
    fn hold(schema: &str, columns: &[(&str, &str, &str)]) {
        let document = document();
        let schema = &document["components"]["schemas"][schema];
        let names: Vec<&str> = columns.iter().map(|(name, ..)| *name).collect();
        assert_eq!(json!(names), schema["required"]);
        for (name, unit, about) in columns {
            let property = &schema["properties"][name];
            assert_eq!(property["description"], *about, "{name}");
            assert_eq!(property["x-unit"].as_str().unwrap_or_default(), *unit, "{name}");
        }
    }

    #[test]
    fn the_contract_has_the_columns_of_strikes_and_hold() {
        hold("Strikes", &of_strikes().map(|column| (column.name, column.unit, column.about)).collect::<Vec<_>>());
        hold("HoldSamples", &OF_HOLD.iter().map(|column| (column.name, column.unit, column.about)).collect::<Vec<_>>());
    }
}
