//! The fixed point of the return map, as part of answers.

use equipoise_physics::stability::fixed_point;
use serde::Serialize;

/// The upright bounce in place, as a state just before an impact.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FixedPointAnswer {
    theta: f64,
    x_dot: f64,
    pub(crate) y_dot: f64,
    theta_dot: f64,
    pub(crate) flight_time: f64,
    apex_height: f64,
}

impl From<fixed_point::FixedPoint> for FixedPointAnswer {
    fn from(fixed_point::FixedPoint { speed, flight_time, apex_height }: fixed_point::FixedPoint) -> Self {
        Self { theta: 0.0, x_dot: 0.0, y_dot: -speed, theta_dot: 0.0, flight_time, apex_height }
    }
}
