//! The fixed point of the return map, as part of answers.

use equipoise_physics::analysis::fixed_point;
use equipoise_physics::map::strike::State;
use serde::Serialize;

/// The upright bounce, as a state just before an impact.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FixedPointAnswer {
    /// Place of the centre of gravity, m, where a constant tilt of the table has moved it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x: Option<f64>,
    theta: f64,
    x_dot: f64,
    pub(crate) y_dot: f64,
    theta_dot: f64,
    pub(crate) flight_time: f64,
    apex_height: f64,
}

impl From<fixed_point::FixedPoint> for FixedPointAnswer {
    fn from(fixed_point: fixed_point::FixedPoint) -> Self {
        let State { theta, x_dot, y_dot, theta_dot } = fixed_point.state();
        let fixed_point::FixedPoint { x, flight_time, apex_height, .. } = fixed_point;
        Self { x: (x != 0.0).then_some(x), theta, x_dot, y_dot, theta_dot, flight_time, apex_height }
    }
}
