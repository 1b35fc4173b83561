//! The weights of a state feedback, as part of requests and answers.

use equipoise_physics::control::bounce_model::STATE;
use equipoise_physics::control::lqr::{DEFAULT_INPUT_WEIGHT, DEFAULT_STATE_WEIGHTS};
use schemars::JsonSchema;
use serde::Serialize;

use crate::http::Reader;

/// Reads `weights`: those of the state, in its order, and that of the tilt.
pub(crate) fn read_weights(reader: &mut Reader<'_, '_>) -> ([f64; 4], f64) {
    let (mut state, mut input) = (DEFAULT_STATE_WEIGHTS, DEFAULT_INPUT_WEIGHT);
    reader.within("weights", |weights| {
        weights.numbers("state", &STATE, &(0.0..=1e6), &mut state);
        input = weights.number("input", 1e-6..=1e6, "").unwrap_or(input);
    });
    (state, input)
}

/// A number for each component of the state.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct ByState {
    pub(crate) x: f64,
    pub(crate) theta: f64,
    pub(crate) x_dot: f64,
    pub(crate) theta_dot: f64,
}

impl From<[f64; 4]> for ByState {
    fn from([x, theta, x_dot, theta_dot]: [f64; 4]) -> Self {
        Self { x, theta, x_dot, theta_dot }
    }
}

/// The weights for which a feedback is optimal.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub(crate) struct Weights {
    state: ByState,
    input: f64,
}

impl Weights {
    pub(crate) fn new(state: [f64; 4], input: f64) -> Self {
        Self { state: state.into(), input }
    }
}
