//! The fixed point of the return map, as part of answers.

use equipoise_physics::analysis::fixed_point;
use equipoise_physics::map::strike::State;
use schemars::JsonSchema;
use serde::Serialize;

/// The upright bounce, just before its impact.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "FixedPoint")]
pub(crate) struct FixedPointAnswer {
    /// Place of the centre of gravity to which a constant error of the tilt has moved it, m. Absent at 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x: Option<f64>,
    /// Angle, rad.
    theta: f64,
    /// Horizontal velocity, m/s. It is `drift_speed` where the table holds the total energy, else 0.
    x_dot: f64,
    /// Vertical velocity, m/s.
    pub(crate) y_dot: f64,
    /// Angular velocity, rad/s.
    theta_dot: f64,
    /// Time from impact to impact, s.
    pub(crate) flight_time: f64,
    /// Height of the centre of gravity at the top, m.
    apex_height: f64,
}

impl From<fixed_point::FixedPoint> for FixedPointAnswer {
    fn from(fixed_point: fixed_point::FixedPoint) -> Self {
        let State { theta, x_dot, y_dot, theta_dot } = fixed_point.state();
        let fixed_point::FixedPoint { x, flight_time, apex_height, .. } = fixed_point;
        Self { x: (x != 0.0).then_some(x), theta, x_dot, y_dot, theta_dot, flight_time, apex_height }
    }
}
