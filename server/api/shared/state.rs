//! The state of the body just before a contact, as part of requests.

use equipoise_physics::bounce::state::State;

use crate::http::Reader;

/// Reads a state just before a contact.
pub(crate) fn read_state(reader: &mut Reader<'_, '_>) -> State {
    let values = STATE.map(|(name, limit, unit)| reader.number(name, -limit..=limit, unit));
    reader.require(&["y_dot"]);
    let [theta, x_dot, y_dot, theta_dot] = values.map(|value| value.unwrap_or(0.0));
    State { theta, x_dot, y_dot, theta_dot }
}

/// Components of a state with limits and units. The limits are as wide as the states that a valid scene can reach.
const STATE: [(&str, f64, &str); 4] = [
    ("theta", std::f64::consts::PI, "rad"),
    ("x_dot", 1000.0, "m/s"),
    ("y_dot", 1000.0, "m/s"),
    ("theta_dot", 1000.0, "rad/s"),
];
