//! The state of the body just before a contact, as part of requests: given, or that of a contact of the scene's run.

use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::Scene;

use crate::api::shared::refusal::Refusal;
use crate::http::Reader;

/// Runs a scene up to contact `impact`, which a request names at `pointer`, and returns its time, s, and the body just before it.
pub(crate) fn run_to_impact(
    scene: &Scene,
    impact: u64,
    pointer: &'static str,
    mut go_on: impl FnMut() -> bool,
) -> Result<(f64, PreImpact), Refusal> {
    let mut orbit = scene.orbit().map_err(|_| (pointer, "the run has no contact".to_owned()))?;
    let mut last = (0.0, PreImpact::at(0, orbit.x(), *orbit.state()));
    let ending = run(&mut orbit, impact, |contact| {
        let before = PreImpact { clearance: contact.clearance, ..PreImpact::at(contact.n, contact.x, contact.state) };
        last = (contact.t, before);
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    });
    let ending = ending.ok_or(Refusal::Cancelled)?;
    if orbit.contacts() < impact {
        let why = ending.name();
        return Err(Refusal::At(
            pointer,
            format!("impact is {impact}, but the run ends as `{why}` at contact {}", orbit.contacts()),
        ));
    }
    Ok(last)
}

/// Reads a state just before a contact, which comes down.
pub(crate) fn read_state(reader: &mut Reader<'_, '_>) -> State {
    let state = read_any_state(reader);
    reader.require(&["y_dot"]);
    state
}

/// Reads a state on the table, at rest where nothing else is given.
pub(crate) fn read_any_state(reader: &mut Reader<'_, '_>) -> State {
    let values = STATE.map(|(name, limit, unit)| reader.number(name, -limit..=limit, unit));
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
