//! The columns of strikes and of the hold. Those that an impact has too are described with it.

use equipoise_physics::catching::outcome::CatchStrike;
use equipoise_physics::run::lasting_contact::HoldSample;

use crate::api::shared::table::columns::{ColumnWord, RowColumn};
use crate::api::shared::table::gather::Read;
use crate::api::shared::table::stacked::stacked_words;
use crate::api::trajectories::columns::COLUMNS;
use crate::column_lists;

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
pub static OF_HOLD: [RowColumn<HoldSample>; 11] = [
    RowColumn::new("t", "s", "Time since the release, in seconds.", Read::Number(|sample| sample.t)),
    RowColumn::new(
        "x",
        "m",
        "Horizontal position of the centre of gravity, in metres.",
        Read::Number(|sample| sample.x),
    ),
    RowColumn::new("theta", "rad", "Angle, in radians.", Read::Number(|sample| sample.theta)),
    RowColumn::new("x_dot", "m/s", "Horizontal velocity, in metres per second.", Read::Number(|sample| sample.x_dot)),
    RowColumn::new(
        "theta_dot",
        "rad/s",
        "Angular velocity, in radians per second.",
        Read::Number(|sample| sample.theta_dot),
    ),
    RowColumn::new("alpha", "rad", "Angle of the table, in radians.", Read::Number(|sample| sample.alpha)),
    RowColumn::new(
        "normal_force",
        "m/s²",
        "Force of the table along its normal per unit mass, in metres per second squared. Contact lasts while it is above 0.",
        Read::Number(|sample| sample.normal_force),
    ),
    RowColumn::new(
        "tangential_force",
        "m/s²",
        "Force of the table along itself per unit mass, in metres per second squared.",
        Read::Number(|sample| sample.tangential_force),
    ),
    RowColumn::new(
        "table_x",
        "m",
        "Way of the table's surface along x since the contact began, in metres. 0 unless the table moves along itself.",
        Read::Number(|sample| sample.table_x),
    ),
    RowColumn::new(
        "table_y",
        "m",
        "Height of the table's surface at the contact over its height as the contact began, in metres.",
        Read::Number(|sample| sample.table_y),
    ),
    RowColumn::new(
        "table_y_dot",
        "m/s",
        "Vertical velocity of the table's surface at the contact, in metres per second.",
        Read::Number(|sample| sample.table_y_dot),
    ),
];

/// The words of the contract on the columns of strikes and hold in one table.
pub fn words() -> Vec<ColumnWord> {
    stacked_words(&[of_strikes().iter().map(RowColumn::word).collect(), OF_HOLD.iter().map(RowColumn::word).collect()])
}
