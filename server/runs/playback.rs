//! Computes a run contact by contact, with its interventions.

use std::f64::consts::PI;
use std::sync::Arc;

use equipoise_physics::body::PreImpact;
use equipoise_physics::bounce::strike::Strike;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Contact, Orbit};
use equipoise_physics::scene::model::Model;
use equipoise_physics::scene::{Name, Scene, Value};
use equipoise_physics::table::actuator_load::{ActuatorLoad, LoadTracker};

use crate::api::scene::has_angle;
use crate::api::shared::outcome::Outcome;
use crate::compute::Price;
use crate::limits;
use crate::runs::run::Run;

/// Position in a run: before the next impact, or at the end. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Playback {
    orbit: Orbit<Model>,
    /// The scene in force.
    scene: Arc<Scene>,
    outcome: Option<Arc<Outcome>>,
    tracker: LoadTracker,
    /// Number of the impact after which the run is completed.
    last: u64,
}

impl Playback {
    /// A run at its release, completed after impact number `last`. A run without any contact has ended.
    pub fn new(run: &Run, last: u64) -> Self {
        let scene = *run.scene();
        let (orbit, outcome) = match scene.orbit() {
            Ok(orbit) => (orbit, None),
            Err(no_contact) => {
                let nowhere = Orbit::at(scene.running_model(), scene.rules(), *scene.start());
                (nowhere, Some(Arc::new(Outcome::new(no_contact.ending(0.0, 0.0), 0, 0.0))))
            }
        };
        Self { orbit, scene: Arc::new(scene), outcome, tracker: LoadTracker::default(), last }
    }

    /// Time of the next impact, s; `None` after the end.
    pub fn next_t(&self) -> Option<f64> {
        self.outcome.is_none().then(|| self.orbit.t())
    }

    /// Number of the next impact; `None` after the end.
    pub fn next_n(&self) -> Option<u64> {
        self.outcome.is_none().then(|| self.orbit.contacts() + 1)
    }

    /// The end of the run, if it has ended.
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_deref()
    }

    /// The next contact before it happens, with its strike by the changes that act there, and the scene then in force. `None` after
    /// the end.
    pub fn foresee(&self, run: &Run) -> Option<(PreImpact, Strike, Arc<Scene>)> {
        let mut next = self.clone();
        if let Some(intervention) = run.at(self.next_n()?).filter(|intervention| !intervention.set.is_empty()) {
            next.replace(intervention.set.iter().copied());
        }
        let (coming, strike) = next.orbit.foresee();
        Some((coming, strike, next.scene))
    }

    /// Largest load on the table so far.
    pub fn load(&self) -> ActuatorLoad {
        self.tracker.most
    }

    /// The model of the scene in force.
    pub fn body(&self) -> &Model {
        &self.orbit.body
    }

    /// The scene in force.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Computes the next impact of a run that has not ended, and its price.
    pub fn advance(&mut self, run: &Run) -> (Contact, Price) {
        let n = self.orbit.contacts() + 1;
        let intervention = run.at(n);
        if let Some(intervention) = intervention.filter(|intervention| !intervention.set.is_empty()) {
            self.replace(intervention.set.iter().copied());
        }
        let kick = intervention.and_then(|intervention| intervention.kick);
        let mut contact = match kick {
            Some(kick) => self.orbit.advance_kicked(kick),
            None => self.orbit.advance(),
        };
        if contact.ending.is_none() && n >= self.last {
            contact.ending = Some(Ending::Completed);
            contact.flight_time = None;
        }
        if let Some(strike) = &contact.strike {
            self.tracker.track(strike, contact.flight_time);
        }
        if let Some(ending) = contact.ending {
            let turning = Some(&contact).filter(|_| has_angle(&self.scene));
            self.outcome = Some(Arc::new(Outcome::new(ending, n, contact.t).turning(turning)));
        }
        (contact, price(&contact))
    }

    /// Puts these fields in force.
    fn replace(&mut self, set: impl Iterator<Item = (Name, Value)>) {
        let mut draft = self.scene.draft();
        for (name, value) in set {
            // A run holds only fields that can be set, so this does not fail.
            let _ = draft.replace(name, value);
        }
        if let Ok(scene) = draft.build() {
            self.orbit.replace(scene.running_model(), scene.rules());
            self.scene = Arc::new(scene);
        }
    }
}

/// One bounce, and one more for each turn of the body in the following flight, up to a limit. The search for the next contact goes
/// turn by turn, but examines only a few turns.
fn price(contact: &Contact) -> Price {
    let spin = contact.strike.map_or(0.0, |strike| strike.after.theta_dot.abs());
    let turns = spin * contact.flight_time.unwrap_or_default() / (2.0 * PI);
    Price::bounces(1 + (turns as u64).min(limits::SPINNING_PRICE))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::run::tests::case;
    use equipoise_physics::body::Kick;

    fn contacts(run: &Run, count: usize) -> Vec<Contact> {
        let mut playback = Playback::new(run, 1_000_000);
        std::iter::from_fn(|| playback.next_n().map(|_| playback.advance(run).0)).take(count).collect()
    }

    #[test]
    fn without_interventions_it_is_the_trajectory() {
        for preset in crate::api::scene::presets::all() {
            let run = case(preset.name);
            let mut orbit = run.scene().orbit().unwrap();
            for contact in contacts(&run, 200) {
                assert_eq!(contact, orbit.advance());
            }
        }
    }

    #[test]
    fn interventions_act_at_their_impact_and_not_before() {
        let (plain, mut run) = (case("case-1"), case("case-1"));
        run.set(5, &[(Name::TiltGain, Value::Number(1.3))]).unwrap();
        run.kick(5, Kick { theta_dot: 0.5, ..Kick::default() }).unwrap();
        let (plain, other) = (contacts(&plain, 10), contacts(&run, 10));
        assert_eq!(plain[..4], other[..4]);
        assert_eq!(plain[4].state, other[4].state);
        let (plain, other) = (plain[4].strike.unwrap(), other[4].strike.unwrap());
        assert!((other.alpha - 1.3 / 1.1 * plain.alpha).abs() < 1e-15);
        assert!((other.after.theta_dot - plain.after.theta_dot).abs() > 0.1);
    }

    #[test]
    fn a_change_that_stops_the_table_lets_the_run_settle() {
        let mut run = case("case-1");
        let still = [(Name::Strike, Value::Choice("still")), (Name::Restitution, Value::Number(0.5))];
        run.set(3, &still).unwrap();
        let all = contacts(&run, 100_000);
        assert!(all.len() < 1000 && all.last().unwrap().ending.is_some());
    }

    #[test]
    fn friction_that_comes_later_lets_the_run_settle() {
        let mut run = case("case-1");
        let rough = [
            (Name::Friction, Value::Number(2.0)),
            (Name::TiltGain, Value::Number(2.5)),
            (Name::Restitution, Value::Number(0.0)),
            (Name::Strike, Value::Choice("still")),
        ];
        run.set(3, &rough).unwrap();
        let last = contacts(&run, 100).pop().unwrap();
        let settled = matches!(last.ending, Some(Ending::Settled { settle_time, .. }) if settle_time == last.t);
        assert!(settled && last.n == 3, "{last:?}");
    }
}
