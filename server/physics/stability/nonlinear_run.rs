//! Summary of the scene's own run, for the verdict.

use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::Ending;
use crate::run::orbit::run;
use crate::scene::Scene;
use crate::table::actuator_load::{ActuatorLoad, LoadTracker};

/// The summary of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NonlinearRun {
    /// End of the run.
    pub ending: Ending,
    /// Number of contacts until the end.
    pub impacts: u64,
    /// Time of the last contact, s.
    pub t: f64,
    /// Largest |θ| at a contact, rad.
    pub max_theta: f64,
    /// Largest load of the run on the table's actuators.
    pub load: ActuatorLoad,
}

/// Runs the scene for up to `impacts` contacts. `go_on` is called at intervals; `None` once it returns `false`.
pub fn run_nonlinear(scene: &Scene, impacts: u64, mut go_on: impl FnMut() -> bool) -> Option<NonlinearRun> {
    let mut orbit = match scene.orbit() {
        Ok(orbit) => orbit,
        Err(no_contact) => {
            let (ending, t) = (no_contact.ending(0.0, 0.0), 0.0);
            let max_theta = scene.start().theta.abs();
            return Some(NonlinearRun { ending, impacts: 0, t, max_theta, load: ActuatorLoad::default() });
        }
    };
    let mut max_theta: f64 = 0.0;
    let mut t = 0.0;
    let mut tracker = LoadTracker::default();
    let ending = run(&mut orbit, impacts, |contact| {
        if let Some(strike) = &contact.strike {
            tracker.track(strike, contact.flight_time);
        }
        max_theta = max_theta.max(contact.state.theta.abs());
        t = contact.t;
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    })?;
    Some(NonlinearRun { ending, impacts: orbit.contacts(), t, max_theta, load: tracker.most })
}
