//! A run computed impact after impact, with what was done to it, and how one that is under way is caught up with.
//!
//! Not here: when an impact is told.

use std::f64::consts::PI;
use std::sync::Arc;

use equipoise_physics::run::cancellation::CHECK_INTERVAL;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::{Contact, Orbit};
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::model::Model;
use equipoise_physics::table::actuator_load::{ActuatorLoad, LoadTracker};

use crate::api::scene::has_angle;
use crate::api::shared::outcome::Outcome;
use crate::compute::{Cancelled, Limit, OverBudget, Price, TimeSlice};
use crate::http::Problem;
use crate::limits;
use crate::live::server_message::ImpactMessage;
use crate::runs::run::Run;
use crate::runs::run_url::RunRequest;

/// Where a run is: before its coming impact, or at its end. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Playback {
    orbit: Orbit<Model>,
    /// The scene in force.
    scene: Arc<Scene>,
    has_angle: bool,
    outcome: Option<Arc<Outcome>>,
    meter: LoadTracker,
    /// The impact after which it has completed.
    last: u64,
}

impl Playback {
    /// A run at its release; at its end, where there is not even a first contact.
    pub fn new(run: &Run) -> Self {
        Self::up_to(run, limits::LIVE_IMPACTS)
    }

    /// The same, completed after so many impacts.
    pub fn up_to(run: &Run, last: u64) -> Self {
        let scene = *run.scene();
        let (orbit, outcome) = match scene.orbit() {
            Ok(orbit) => (orbit, None),
            Err(none) => {
                let nowhere = Orbit::at(scene.running_model(), scene.rules(), *scene.start());
                (nowhere, Some(Arc::new(Outcome::new(none.ending(0.0, 0.0), 0, 0.0))))
            }
        };
        Self {
            orbit,
            scene: Arc::new(scene),
            has_angle: has_angle(&scene),
            outcome,
            meter: LoadTracker::default(),
            last,
        }
    }

    /// When the coming impact is, s; none after the end.
    pub fn next_t(&self) -> Option<f64> {
        self.outcome.is_none().then(|| self.orbit.t())
    }

    /// The number of the coming impact; none after the end.
    pub fn next_n(&self) -> Option<u64> {
        self.outcome.is_none().then(|| self.orbit.contacts() + 1)
    }

    /// How the run ended, if it did.
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_deref()
    }

    /// The most that the run has asked of the table so far.
    pub fn demand(&self) -> ActuatorLoad {
        self.meter.most
    }

    /// The scene in force.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The coming impact and what it cost, of a run that has not ended.
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
            self.meter.track(strike, contact.flight_time);
        }
        if let Some(ending) = contact.ending {
            self.outcome = Some(Arc::new(Outcome::new(ending, n, contact.t)));
        }
        (contact, price(&contact))
    }

    /// [`Playback::advance`], as it is told.
    pub fn tell(&mut self, run: &Run) -> (ImpactMessage, Price) {
        let (contact, price) = self.advance(run);
        (ImpactMessage::new(&self.orbit.body, self.has_angle, &contact), price)
    }

    fn replace(
        &mut self,
        set: impl Iterator<Item = (equipoise_physics::scene::Name, equipoise_physics::scene::Value)>,
    ) {
        let mut draft = self.scene.draft();
        for (name, value) in set {
            // The run has admitted it; what it did not admit is not in it.
            let _ = draft.set(name, Some(value));
        }
        if let Ok(scene) = draft.build() {
            self.orbit.replace(scene.running_model(), scene.rules());
            self.scene = Arc::new(scene);
        }
    }
}

/// A bounce, and one more for each turn of the flight after it, whose contact is looked for turn by turn: in a few of them, however
/// many there are.
fn price(contact: &Contact) -> Price {
    let spin = contact.strike.map_or(0.0, |strike| strike.after.theta_dot.abs());
    let turns = spin * contact.flight_time.unwrap_or_default() / (2.0 * PI);
    Price::bounces(1 + (turns as u64).min(limits::SPINNING_PRICE))
}

/// Why there is nothing to catch up with.
#[derive(Debug)]
pub enum CatchUpError {
    /// It would cost too much.
    OverBudget(OverBudget),
    /// Nobody waits for it.
    Cancelled,
}

/// The run where the telling begins: before the impact that was asked for or, if none was, the last one so far. It is
/// computed up to the run time `until`, so that the price of everything up to then is known.
///
/// # Errors
/// Where that costs more than `limit`.
pub fn catch_up(request: &RunRequest, until: f64, limit: &Limit, slice: &TimeSlice) -> Result<Playback, CatchUpError> {
    let RunRequest { run, from } = request;
    let mut playback = Playback::new(run);
    let mut begin = None;
    let (mut spent, mut looked) = (Price::bounces(0), 0);
    while let (Some(t), Some(n)) = (playback.next_t(), playback.next_n())
        && t <= until
    {
        if from.is_none_or(|from| n == from) {
            begin = Some(playback.clone());
        }
        if from.is_some_and(|from| n >= from) {
            spent = spent.and(Price::bounces(limits::LIVE_IMPACT_PRICE));
        }
        let (_, price) = playback.advance(run);
        spent = spent.and(price).within(limit).map_err(CatchUpError::OverBudget)?;
        if spent.as_bounces() >= looked {
            looked = spent.as_bounces() + CHECK_INTERVAL;
            slice.check().map_err(|Cancelled| CatchUpError::Cancelled)?;
        }
    }
    Ok(begin.unwrap_or(playback))
}

impl From<CatchUpError> for Problem {
    fn from(error: CatchUpError) -> Self {
        match error {
            CatchUpError::OverBudget(over) => over.into(),
            CatchUpError::Cancelled => Cancelled.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runs::run::tests::case;
    use equipoise_physics::body::Kick;
    use equipoise_physics::scene::{Name, Value};

    const PLENTY: Limit = Limit { name: "work", most: 1_000_000, unit: "bounces" };

    fn contacts(run: &Run, count: usize) -> Vec<Contact> {
        let mut playback = Playback::new(run);
        std::iter::from_fn(|| playback.next_n().map(|_| playback.advance(run).0)).take(count).collect()
    }

    #[test]
    fn without_interventions_it_is_the_trajectory() {
        for preset in crate::api::scene::presets::all() {
            let run = case(&preset.name);
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

    #[test]
    fn catching_up_begins_where_it_was_asked_to() {
        let run = case("case-1");
        let all = contacts(&run, 30);
        let until = all[19].t;
        let begin = |from| {
            catch_up(&RunRequest { run: run.clone(), from }, until, &PLENTY, &TimeSlice::unbounded()).unwrap().next_n()
        };
        assert_eq!(
            [begin(None), begin(Some(7)), begin(Some(20)), begin(Some(21)), begin(Some(25))].map(Option::unwrap),
            [20, 7, 20, 21, 21]
        );
        let early = RunRequest { run: run.clone(), from: None };
        assert_eq!(catch_up(&early, -5.0, &PLENTY, &TimeSlice::unbounded()).unwrap().next_n(), Some(1));
    }

    #[test]
    fn catching_up_has_a_price_and_telling_a_higher_one() {
        let limit = Limit { most: 100, ..PLENTY };
        let ask = |from| RunRequest { run: case("case-1"), from };
        let until = contacts(&case("case-1"), 200)[49].t;
        assert!(catch_up(&ask(None), until, &limit, &TimeSlice::unbounded()).is_ok());
        let over = catch_up(&ask(Some(1)), until, &limit, &TimeSlice::unbounded()).unwrap_err();
        assert!(matches!(over, CatchUpError::OverBudget(_)));
        assert!(catch_up(&ask(None), 1e6, &limit, &TimeSlice::unbounded()).is_err());
    }

    #[test]
    fn a_run_that_has_ended_is_told_from_its_last_impact() {
        let run = case("case-3");
        let playback =
            catch_up(&RunRequest { run: run.clone(), from: None }, 1e6, &PLENTY, &TimeSlice::unbounded()).unwrap();
        assert_eq!(playback.next_n(), Some(49));
        let playback = catch_up(&RunRequest { run, from: Some(60) }, 1e6, &PLENTY, &TimeSlice::unbounded()).unwrap();
        assert_eq!(playback.outcome().unwrap().kind, "sinking");
    }
}
