//! The state of the body just before a contact, as part of requests: given, or that of a contact of the scene's run.

use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::Scene;

use crate::api::shared::refusal::Refusal;
use crate::http::request::fields::{Absence, Number, number};
use crate::request_fields;

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

request_fields! {
    impl State {
        /// Angle of the body.
        theta: f64 = ANGLE.or(0.0),
        /// Horizontal velocity.
        x_dot: f64 = SPEED.or(0.0),
        /// Vertical velocity.
        y_dot: f64 = SPEED.required(),
        /// Angular velocity.
        theta_dot: f64 = SPIN.or(0.0),
    }
}

/// Components of a state, as wide as the states that a valid scene can reach.
pub(crate) const PLACE: Number = number(-1000.0..=1000.0, "m");
pub(crate) const ANGLE: Number = number(-std::f64::consts::PI..=std::f64::consts::PI, "rad");
pub(crate) const SPEED: Number = number(-1000.0..=1000.0, "m/s");
pub(crate) const SPIN: Number = number(-1000.0..=1000.0, "rad/s");
