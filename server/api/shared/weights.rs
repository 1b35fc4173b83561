//! The weights of a state feedback, as part of requests and answers.

use equipoise_physics::control::lqr::{DEFAULT_INPUT_WEIGHT, DEFAULT_STATE_WEIGHTS};
use schemars::JsonSchema;
use serde::{Serialize, Serializer};

use crate::http::request::fields::{Absence, NamedNumbers, number};
use crate::request_fields;

request_fields! {
    /// Costs of a deviation and of a tilt. The law minimizes the sum of the weighted squares over all bounces, in SI units.
    #[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
    pub struct Weights {
        /// Weights of the state just before an impact. With weight 0 for x, the position is free: x is left out, and the body comes to rest anywhere.
        /// An array has all four: x, theta, x_dot, theta_dot.
        #[serde(serialize_with = "by_state")]
        #[schemars(with = "ByState")]
        pub state: [f64; 4] = STATE_WEIGHTS,
        /// Weight of the squared tilt of the table.
        pub input: f64 = number(1e-6..=1e6, "").or(DEFAULT_INPUT_WEIGHT),
    }
}

const STATE_WEIGHTS: NamedNumbers<4> = NamedNumbers {
    names: [
        ("x", "Weight of the squared horizontal position."),
        ("theta", "Weight of the squared angle."),
        ("x_dot", "Weight of the squared horizontal velocity."),
        ("theta_dot", "Weight of the squared angular velocity."),
    ],
    range: 0.0..=1e6,
    defaults: DEFAULT_STATE_WEIGHTS,
};

/// A number for each component of the state.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct ByState {
    x: f64,
    theta: f64,
    x_dot: f64,
    theta_dot: f64,
}

fn by_state<S: Serializer>(&[x, theta, x_dot, theta_dot]: &[f64; 4], serializer: S) -> Result<S::Ok, S::Error> {
    ByState { x, theta, x_dot, theta_dot }.serialize(serializer)
}
