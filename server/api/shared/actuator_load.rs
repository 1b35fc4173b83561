//! The largest load of a run on the table's actuators, as part of answers.

use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use schemars::JsonSchema;
use serde::Serialize;

/// Largest motions that the run requires of the table, to compare with what a rig can do.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "Demand")]
pub struct LoadAnswer {
    /// Largest tilt at a strike, rad.
    tilt: f64,
    /// Largest mean tilt rate from one strike to the next, and the largest tilt rate in the contact of a catch, rad/s.
    tilt_rate: f64,
    /// Largest speed of the table at a strike, m/s.
    speed: f64,
    /// Longest vertical stroke of the table between two strikes, from its lowest to its highest point, m. The table is at y = 0 at each strike
    /// and moves as a cubic in time with the velocities of both strikes, which is the path of least mean square acceleration.
    stroke: f64,
}

impl From<ActuatorLoad> for LoadAnswer {
    fn from(ActuatorLoad { tilt, tilt_rate, speed, stroke }: ActuatorLoad) -> Self {
        Self { tilt, tilt_rate, speed, stroke }
    }
}
