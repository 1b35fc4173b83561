//! Summary of the scene's own run, for the verdict.

use crate::analysis::regularity::{Regularity, WATCHED, WatchedContact, measure_regularity, regularity_of};
use crate::analysis::small_deviations::SmallDeviations;
use crate::map::body::{Body, PreImpact};
use crate::map::table::actuator_load::{ActuatorLoad, LoadTracker};
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::Ending;
use crate::run::orbit::run;
use crate::scene::Scene;

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

/// A run with its first contacts, so that its regularity needs no second one.
#[derive(Clone, Debug)]
pub struct WatchedRun {
    /// The summary.
    pub summary: NonlinearRun,
    asked: u64,
    /// Body of the run and its first contact, if it has one.
    start: Option<(Body, PreImpact)>,
    watched: Vec<WatchedContact>,
}

impl WatchedRun {
    /// [`measure_regularity`] of the scene about its bounce that repeats, by this run if it is that of the scene.
    pub fn regularity(&self, scene: &Scene, small: &SmallDeviations) -> Option<Regularity> {
        let orbit = scene.orbit().ok()?;
        let first = orbit.coming();
        // The flight after the last contact asked for is watched, but no part of the run.
        let is_whole = self.summary.ending != Ending::Completed || self.asked > WATCHED;
        if is_whole && self.start == Some((orbit.body, first)) {
            regularity_of(&orbit.body, &first, &self.watched, small)
        } else {
            measure_regularity(orbit, small, self.asked)
        }
    }
}

/// Runs the scene for up to `impacts` contacts. `go_on` is called at intervals; `None` once it returns `false`.
pub fn run_nonlinear(scene: &Scene, impacts: u64, go_on: impl FnMut() -> bool) -> Option<NonlinearRun> {
    run_watched(scene, impacts, go_on).map(|run| run.summary)
}

/// [`run_nonlinear`] with the first contacts.
pub fn run_watched(scene: &Scene, impacts: u64, mut go_on: impl FnMut() -> bool) -> Option<WatchedRun> {
    let mut orbit = match scene.orbit() {
        Ok(orbit) => orbit,
        Err(no_contact) => {
            let (ending, t) = (no_contact.ending(0.0, 0.0), 0.0);
            let max_theta = scene.start().theta.abs();
            let summary = NonlinearRun { ending, impacts: 0, t, max_theta, load: ActuatorLoad::default() };
            return Some(WatchedRun { summary, asked: impacts, start: None, watched: Vec::new() });
        }
    };
    let mut watched = Vec::with_capacity(impacts.min(WATCHED) as usize);
    let start = Some((orbit.body, orbit.coming()));
    let (mut max_theta, mut t) = (0.0_f64, 0.0);
    let mut tracker = LoadTracker::default();
    let ending = run(&mut orbit, impacts, |contact| {
        if let Some(strike) = &contact.strike {
            tracker.track(strike, contact.flight_time);
        }
        max_theta = max_theta.max(contact.state.theta.abs());
        t = contact.t;
        if contact.n <= WATCHED {
            watched.extend(WatchedContact::of(contact));
        }
        !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
    })?;
    let summary = NonlinearRun { ending, impacts: orbit.contacts(), t, max_theta, load: tracker.most };
    Some(WatchedRun { summary, asked: impacts, start, watched })
}
