//! The state at which the run of a scene settles whose height follows from its whole run.

use crate::map::strike::State;
use crate::scene::Scene;

/// Most contacts of a run in which a scene settles.
const MOST_CONTACTS: u32 = 10_000;

/// Swing of a settled run: θ and τθ̇, rad.
const SETTLED_SWING: f64 = 1e-10;

/// The state just before a contact at which the run of a scene settles whose table turns as it strikes, or whose spin the air takes: both change
/// the energy as long as the angle moves. `None` if the run does not settle.
pub(crate) fn settled_state(scene: &Scene) -> Option<State> {
    let mut orbit = scene.orbit().ok()?;
    for _ in 0..MOST_CONTACTS {
        let State { theta, y_dot, theta_dot, .. } = *orbit.state();
        let turned = 2.0 * y_dot / scene.gravity * theta_dot;
        if theta.abs() <= SETTLED_SWING && turned.abs() <= SETTLED_SWING {
            return Some(*orbit.state());
        }
        orbit.advance().flight_time?;
    }
    None
}
