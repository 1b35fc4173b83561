//! The largest load of a run on the table's actuators, as part of answers.

use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use serde::Serialize;

/// The largest tilt, rad, tilt rate, rad/s, speed, m/s, and stroke, m, that a run asks of the table.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct LoadAnswer {
    tilt: f64,
    tilt_rate: f64,
    speed: f64,
    stroke: f64,
}

impl From<ActuatorLoad> for LoadAnswer {
    fn from(ActuatorLoad { tilt, tilt_rate, speed, stroke }: ActuatorLoad) -> Self {
        Self { tilt, tilt_rate, speed, stroke }
    }
}
