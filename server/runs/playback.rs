//! Computes a run contact by contact, with its interventions.

use std::sync::Arc;

use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::catching::throw;
use equipoise_physics::catching::throw::{Throw, ThrowFailure, ThrowFromContact, ThrowTarget};
use equipoise_physics::map::body::{Body, Kick, PreImpact};
use equipoise_physics::map::strike::{Rod, Strike};
use equipoise_physics::map::table::actuator_load::{ActuatorLoad, LoadTracker, Pose};
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::HoldSample;
use equipoise_physics::run::orbit::{ComingContact, Contact, Orbit};
use equipoise_physics::scene::{Name, Scene, Value};

use crate::api::computed::catches::request::whole_catch_price;
use crate::api::computed::trajectories::columns::{HoldAnswer, HoldEnd};
use crate::api::scene::has_angle;
use crate::api::shared::outcome::Outcome;
use crate::compute::{Cancelled, Price};
use crate::runs::caught::{CaughtRun, HeldRun, HoldPart, held_body};
use crate::runs::run::{Run, THROW_PRICE, hold_price, impact_price};

/// Rounding of a time in a URL, s.
const SAME_TIME: f64 = 1e-9;

/// Position in a run: before the next impact, or at the end. Cheap to clone.
#[derive(Debug, Clone)]
pub struct Playback {
    orbit: Orbit,
    /// The scene in force.
    scene: Arc<Scene>,
    outcome: Option<Arc<Outcome>>,
    tracker: LoadTracker,
    /// Number of the impact after which the run is completed.
    last: u64,
    /// The catch under way.
    caught: Option<CaughtRun>,
    /// The contact after the last bounce, if the run goes on in it.
    rest: Option<RestOfRun>,
    /// The catch that comes next, if it was foreseen.
    foreseen: Option<ForeseenCatch>,
}

/// The contact that follows the bounces of a run.
#[derive(Debug, Clone)]
struct RestOfRun {
    /// The outcome of the bounces, which is the outcome of the run.
    outcome: Arc<Outcome>,
    held: HeldRun,
    end: Arc<HoldEnd>,
}

/// A catch, and everything that it follows from.
#[derive(Debug, Clone)]
struct ForeseenCatch {
    scene: Arc<Scene>,
    settings: CatchSettings,
    from: ComingContact,
    /// `None` if there is no law for it.
    caught: Option<CaughtRun>,
}

/// Next thing that happens in a run.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "a step is taken apart at once, and most are impacts")]
pub enum Step {
    /// An impact.
    Impact(Contact),
    /// The body is held for some time.
    Hold(HoldPart),
    /// The run ended without an impact.
    End,
}

impl Playback {
    /// A run at its release, completed after impact number `last`. A run without any contact has ended.
    pub fn new(run: &Run, last: u64) -> Self {
        let scene = run.scene().clone();
        let (orbit, outcome) = match scene.orbit() {
            Ok(orbit) => (orbit, None),
            Err(no_contact) => {
                let nowhere = Orbit::at(scene.running_model(), scene.rules(), *scene.start());
                (nowhere, Some(Arc::new(Outcome::new(no_contact.ending(0.0, 0.0), 0, 0.0))))
            }
        };
        Self { orbit, scene, outcome, tracker: LoadTracker::default(), last, caught: None, rest: None, foreseen: None }
    }

    /// Time of the next step, s; `None` after the end.
    pub fn next_t(&self) -> Option<f64> {
        self.outcome.is_none().then(|| self.held().map_or_else(|| self.orbit.t(), |(_, t)| t))
    }

    /// Number of the next impact; `None` after the end. While the body is held there may be no other.
    pub fn next_n(&self) -> Option<u64> {
        self.outcome.is_none().then(|| self.orbit.contacts() + 1)
    }

    /// Time, s, up to which a hold is known to the client. `None` if the body is not held.
    pub fn held_until(&self) -> Option<f64> {
        self.held().map(|(_, t)| t)
    }

    /// The hold under way, and the time up to which it was told.
    fn held(&self) -> Option<(&HeldRun, f64)> {
        let rest = self.rest.as_ref().map(|rest| &rest.held);
        let held = rest.or_else(|| self.caught.as_ref()?.held())?;
        Some((held, held.sample()?.t))
    }

    /// The samples of the contact after the last bounce, and its end, if the run goes on in contact.
    pub fn rest(&self) -> Option<(&[HoldSample], &HoldEnd)> {
        self.rest.as_ref().map(|rest| (rest.held.samples(), &*rest.end))
    }

    /// The end of the run, if it has ended.
    pub fn outcome(&self) -> Option<&Outcome> {
        self.outcome.as_deref()
    }

    /// The next contact before it happens, with its strike by the changes that act there, and the scene then in force. `None` after
    /// the end.
    ///
    /// `None` too while the body is held. A catch that begins with the contact is kept, so that it is computed once.
    ///
    /// # Errors
    /// `go_on` said `false`.
    pub fn foresee(
        &mut self,
        run: &Run,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<(PreImpact, Strike, Arc<Scene>)>, Cancelled> {
        let Some(n) = self.next_n().filter(|_| self.held().is_none()) else { return Ok(None) };
        let mut next = self.clone();
        if next.intervene(run, n, go_on)? {
            self.foreseen.clone_from(&next.foreseen);
        }
        if let Some(order) = run.at(n).and_then(|intervention| intervention.throw)
            && let Ok(thrown) = next.throw(&order.apex)
        {
            return Ok(Some((next.coming(), thrown.strike, next.scene)));
        }
        let Some(caught) = &next.caught else {
            let (coming, strike) = next.orbit.foresee();
            return Ok(Some((coming, strike, next.scene)));
        };
        Ok(caught.next_strike().map(|caught| (next.coming(), caught.strike, next.scene.clone())))
    }

    /// Largest load on the table so far.
    pub fn load(&self) -> ActuatorLoad {
        self.tracker.most
    }

    /// The model of the scene in force.
    pub fn body(&self) -> &Body {
        &self.orbit.body
    }

    /// The scene in force.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Computes the next impact of a run, and its price; `None` if there is none before the run ends.
    ///
    /// # Errors
    /// As for [`Playback::advance`].
    pub fn next_impact(
        &mut self,
        run: &Run,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<(Contact, Price)>, Cancelled> {
        while self.outcome.is_none() {
            if let (Step::Impact(contact), price) = self.advance(run, go_on)? {
                return Ok(Some((contact, price)));
            }
        }
        Ok(None)
    }

    /// Computes the next step of a run that has not ended, and its price.
    ///
    /// # Errors
    /// `go_on`, which catches and contacts ask now and then, said `false`. The position is then no more of use.
    pub fn advance(&mut self, run: &Run, go_on: &mut dyn FnMut() -> bool) -> Result<(Step, Price), Cancelled> {
        let step = self.step(run, go_on)?;
        self.foreseen = None;
        Ok(step)
    }

    fn step(&mut self, run: &Run, go_on: &mut dyn FnMut() -> bool) -> Result<(Step, Price), Cancelled> {
        let n = self.orbit.contacts() + 1;
        let intervention = run.at(n);
        if self.held().is_some() {
            return self.hold(run, n, go_on);
        }
        let began = self.intervene(run, n, go_on)?;
        let kick = intervention.and_then(|intervention| intervention.kick);
        let caught_price = self.settings().map_or(0, |settings| {
            let again = kick.is_some() && self.held().is_none();
            (u64::from(began) + u64::from(again)) * whole_catch_price(&self.scene, &settings)
        });
        let caught_price = Price::bounces(caught_price);
        if self.held().is_some() {
            // It met the table without a strike.
            self.count_hold();
            let (step, price) = self.hold(run, n, go_on)?;
            return Ok((step, price.and(caught_price)));
        }
        let order = intervention.and_then(|intervention| intervention.throw);
        let order_price = Price::bounces(order.map_or(0, |_| THROW_PRICE));
        let thrown = order.and_then(|order| self.throw(&order.apex).ok());
        let mut contact = match (thrown, self.caught.is_some(), kick) {
            (Some(thrown), ..) => self.fly_after(&self.coming(), self.orbit.t(), thrown.strike, kick),
            (None, true, kick) => self.strike_of_catch(kick, go_on)?,
            (None, false, Some(kick)) => self.orbit.advance_kicked(kick),
            (None, false, None) => self.orbit.advance(),
        };
        let price = self.note(&mut contact, run.hold(), go_on)?;
        Ok((Step::Impact(contact), price.and(caught_price).and(order_price)))
    }

    /// Counts an impact, and returns its price. If it is the last, the run ends with it, or goes on in contact for `hold` s.
    fn note(&mut self, contact: &mut Contact, hold: f64, go_on: &mut dyn FnMut() -> bool) -> Result<Price, Cancelled> {
        if contact.ending.is_none() && self.outcome.is_none() && contact.n >= self.last {
            contact.ending = Some(Ending::Completed);
            contact.flight_time = None;
        }
        if let Some(strike) = &contact.strike {
            self.tracker.track(strike, contact.flight_time);
        }
        let price = Price::bounces(impact_price(contact));
        let Some(ending) = contact.ending else { return Ok(price) };
        let turning = Some(&*contact).filter(|_| has_angle(&self.scene));
        let outcome = Arc::new(Outcome::new(ending, contact.n, contact.t).turning(turning));
        let rest = if hold > 0.0 {
            let computed = HoldAnswer::compute(&self.scene, (ending, Some(&*contact)), hold, go_on);
            computed.map_err(|_| Cancelled)?.ok()
        } else {
            None
        };
        Ok(match rest {
            Some(HoldAnswer { samples, end }) => {
                self.rest = Some(RestOfRun { outcome, held: HeldRun::new(samples), end: Arc::new(end) });
                price.and(Price::bounces(hold_price(&self.scene, hold)))
            }
            None => {
                self.outcome = Some(outcome);
                price
            }
        })
    }

    /// Puts in force what is set at impact `n`, and begins a catch there. True if a catch was computed.
    fn intervene(&mut self, run: &Run, n: u64, go_on: &mut dyn FnMut() -> bool) -> Result<bool, Cancelled> {
        let Some(intervention) = run.at(n) else { return Ok(false) };
        let is_set = !intervention.set.is_empty();
        if is_set {
            self.replace(intervention.set.iter().copied());
        }
        let settings = intervention.catch.or_else(|| self.settings().filter(|_| is_set));
        settings.map_or(Ok(false), |settings| self.begin_catch(&settings, self.tracker.last(), go_on))
    }

    /// Settings of the catch under way.
    fn settings(&self) -> Option<CatchSettings> {
        self.caught.as_ref().map(|caught| caught.catch().settings)
    }

    /// Begins a catch at the coming contact, after this strike of the table and this flight, s. False if there is no law for it; then the run
    /// goes on.
    fn begin_catch(
        &mut self,
        settings: &CatchSettings,
        before: Option<(Pose, f64)>,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<bool, Cancelled> {
        let from = ComingContact { t: self.orbit.t(), coming: self.coming(), before };
        let (scene, settings) = (self.scene.clone(), *settings);
        let foreseen =
            self.foreseen.take().filter(|one| (&one.scene, one.settings, one.from) == (&scene, settings, from));
        let foreseen = match foreseen {
            Some(foreseen) => foreseen,
            None => {
                let caught = CaughtRun::begin(&scene, &settings, &from, go_on)?;
                ForeseenCatch { scene, settings, from, caught }
            }
        };
        let begins = foreseen.caught.is_some();
        self.caught = foreseen.caught.clone().or(self.caught.take());
        self.foreseen = Some(foreseen);
        Ok(begins)
    }

    /// The coming contact.
    fn coming(&self) -> PreImpact {
        self.orbit.coming()
    }

    fn rod(&self) -> &Rod {
        &self.orbit.body.rod
    }

    /// The next strike of the catch under way, with a kick after it.
    fn strike_of_catch(&mut self, kick: Option<Kick>, go_on: &mut dyn FnMut() -> bool) -> Result<Contact, Cancelled> {
        let (coming, t) = (self.coming(), self.orbit.t());
        let Some((mut contact, arrival)) = self.caught.as_mut().and_then(|caught| caught.strike()) else {
            // A catch without strikes and without a hold: the body falls before the table meets it.
            self.end_hold(coming.n);
            return Ok(Contact { flight_time: None, ..bare_contact(&coming, t) });
        };
        match (kick, contact.strike) {
            (Some(kick), Some(strike)) => {
                let settings = self.settings();
                contact = self.fly_after(&coming, t, strike, Some(kick));
                if let (Some(settings), true) = (settings, contact.ending.is_none()) {
                    self.begin_catch(&settings, Some(Pose::of(&strike)).zip(contact.flight_time), go_on)?;
                }
            }
            _ => match arrival {
                Some(arrival) => self.orbit.resume(contact.n, t, contact.x, &arrival),
                None => {
                    self.orbit.stay(contact.n);
                    if !self.count_hold() {
                        self.end_hold(contact.n);
                    }
                }
            },
        }
        Ok(contact)
    }

    /// Counts the load of the hold of the catch under way. False if it has none.
    fn count_hold(&mut self) -> bool {
        let held = self.caught.as_ref().and_then(|caught| caught.catch().hold.as_ref());
        let load = held.map(|hold| hold.load);
        if let Some(load) = load {
            self.tracker.hold(load);
        }
        load.is_some()
    }

    /// Ends the run with the outcome of its bounces, or of its catch.
    fn end_hold(&mut self, bounces: u64) {
        if let Some(rest) = &self.rest {
            self.outcome = Some(rest.outcome.clone());
        } else if let Some(caught) = &self.caught {
            self.outcome = Some(Arc::new(Outcome::of_catch(
                caught.catch(),
                self.scene.number(Name::Friction).unwrap_or_default(),
                bounces,
            )));
        }
    }

    /// The next part of a hold, or the throw that ends it.
    fn hold(&mut self, run: &Run, n: u64, go_on: &mut dyn FnMut() -> bool) -> Result<(Step, Price), Cancelled> {
        let free = Price::bounces(1);
        let Some((sample, t)) = self.held().and_then(|(held, t)| Some((*held.sample()?, t))) else {
            return Ok((Step::End, free));
        };
        if let Some(intervention) = run.at(n)
            && let Some(order) = intervention.throw
            && order.t.is_none_or(|least| t >= least - SAME_TIME)
        {
            if !intervention.set.is_empty() {
                self.replace(intervention.set.iter().copied());
            }
            if let Ok(ThrowFromContact { thrown, coming, time }) = self.throw_held(n, &sample, &order.apex) {
                let mut contact = self.fly_after(&coming, t + time, thrown.strike, intervention.kick);
                self.tracker.hold(thrown.load);
                let price = self.note(&mut contact, run.hold(), go_on)?;
                return Ok((Step::Impact(contact), price.and(Price::bounces(THROW_PRICE))));
            }
        }
        let held = match &mut self.rest {
            Some(rest) => Some(&mut rest.held),
            None => self.caught.as_mut().and_then(CaughtRun::held_mut),
        };
        Ok(match held.and_then(HeldRun::next_part) {
            Some(part) => (Step::Hold(part), free),
            None => {
                self.end_hold(n - 1);
                (Step::End, free)
            }
        })
    }

    /// The throw of the body from the coming strike.
    fn throw(&self, target: &ThrowTarget) -> Result<Throw, ThrowFailure> {
        throw::throw(&self.scene, &self.coming(), self.tracker.last(), target)
    }

    /// The throw of the body, as strike `n`, from the table that holds it.
    fn throw_held(&self, n: u64, sample: &HoldSample, target: &ThrowTarget) -> Result<ThrowFromContact, ThrowFailure> {
        let (held, pose) = held_body(n, self.rod(), sample);
        throw::throw_from_contact(&self.scene, &held, pose, target)
    }

    /// The throw that a message asks for, from the next impact, or from where the hold is known to.
    ///
    /// # Errors
    /// The reason for which no strike throws the body there.
    pub fn try_throw(&self, target: &ThrowTarget) -> Result<(), ThrowFailure> {
        let held = self.held().and_then(|(held, _)| held.sample());
        match held {
            Some(sample) => self.throw_held(self.orbit.contacts() + 1, sample, target).map(|_| ()),
            None => self.throw(target).map(|_| ()),
        }
    }

    /// Flies on from a strike by other guidance than the law of the scene, which is in force again from then on.
    fn fly_after(&mut self, coming: &PreImpact, t: f64, mut strike: Strike, kick: Option<Kick>) -> Contact {
        (self.caught, self.rest) = (None, None);
        if let Some(kick) = kick {
            kick.disturb(&mut strike, self.orbit.body.rod.contact_distance);
        }
        let mut contact = Contact { strike: Some(strike), alpha: strike.alpha, ..bare_contact(coming, t) };
        match self.orbit.body.fly(coming, &strike) {
            Ok(arrival) => {
                contact.flight_time = Some(arrival.t);
                self.orbit.resume(coming.n, t, coming.x, &arrival);
            }
            Err(no_contact) => {
                self.orbit.stay(coming.n);
                contact.ending = Some(no_contact.ending(strike.contact_rise, strike.after.y_dot.abs()));
            }
        }
        contact
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

/// A contact without a strike.
fn bare_contact(coming: &PreImpact, t: f64) -> Contact {
    let PreImpact { n, x, state, clearance, .. } = *coming;
    Contact { n, t, x, state, clearance, alpha: 0.0, strike: None, flight_time: None, ending: None }
}

#[cfg(test)]
mod tests {
    use equipoise_physics::catching::settings::Strategy;
    use equipoise_physics::map::body::Kick;
    use equipoise_physics::run::lasting_contact::{hold, rest_of_run};

    use super::*;
    use crate::runs::run::ThrowOrder;
    use crate::runs::run::tests::case;

    fn contacts(run: &Run, count: usize) -> Vec<Contact> {
        let mut playback = Playback::new(run, 1_000_000);
        std::iter::from_fn(|| playback.next_impact(run, &mut || true).unwrap())
            .map(|(contact, _)| contact)
            .take(count)
            .collect()
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

    /// A table that stands still, and a contact that loses much.
    fn settling(theta: f64) -> Run {
        let mut draft = case("still-lossy").scene().draft();
        for (name, value) in [(Name::Restitution, 0.1), (Name::Theta, theta), (Name::XDot, 0.0)] {
            draft.set(name, Some(Value::Number(value))).unwrap();
        }
        Run::new(draft.build().unwrap())
    }

    /// All steps of a run up to its end: contacts, and samples of its holds.
    fn play(run: &Run, playback: &mut Playback) -> (Vec<Contact>, Vec<HoldSample>) {
        let (mut contacts, mut samples) = (Vec::new(), Vec::<HoldSample>::new());
        while let Some(due) = playback.next_t() {
            match playback.advance(run, &mut || true).unwrap().0 {
                Step::Impact(contact) => contacts.push(contact),
                Step::Hold(part) => {
                    let follows = samples.last().is_some_and(|last| last.t == due);
                    samples.extend(&part.samples()[usize::from(follows)..]);
                }
                Step::End => {}
            }
        }
        (contacts, samples)
    }

    #[test]
    fn a_run_goes_on_in_contact_where_its_bounces_end() {
        let plain = settling(0.1);
        let mut ends = Playback::new(&plain, 1000);
        let (bounces, none) = play(&plain, &mut ends);
        assert!(none.is_empty() && ends.rest().is_none());
        let run = plain.clone().holding(0.05);
        let mut playback = Playback::new(&run, 1000);
        let (contacts, samples) = play(&run, &mut playback);
        assert_eq!(contacts, bounces);
        let (outcome, without) = (playback.outcome().unwrap(), ends.outcome().unwrap());
        assert_eq!((outcome.kind, &outcome.detail), ("settled", &without.detail));
        let settled = outcome.settle_time.unwrap();
        let request = rest_of_run(run.scene(), contacts.last().unwrap(), settled, 0.05).unwrap();
        let alone = hold(&request, &mut || true);
        assert_eq!((samples[0].t, &samples), (settled, &alone.samples));
        let (known, end) = playback.rest().unwrap();
        assert_eq!((known, end.kind, end.t), (&samples[..], "completed", alone.t_end));
        assert_eq!(playback.load(), ends.load());
        // A run that does not settle has no such contact.
        let other = case("case-3").holding(1.0);
        let mut falls = Playback::new(&other, 1000);
        assert!(play(&other, &mut falls).1.is_empty() && falls.rest().is_none());
        assert_eq!(falls.outcome().unwrap().kind, "sinking");
    }

    #[test]
    fn a_body_in_contact_after_its_bounces_is_thrown_and_settles_again() {
        let mut run = settling(0.001).holding(0.2);
        let (bounces, held) = play(&run, &mut Playback::new(&run, 1000));
        let n = bounces.len() as u64 + 1;
        let order = ThrowOrder { apex: ThrowTarget { height: 0.3, theta: 0.0 }, t: Some(held[20].t) };
        run.throw(n, order).unwrap();
        let mut playback = Playback::new(&run, 1000);
        let (contacts, again) = play(&run, &mut playback);
        assert_eq!((&contacts[..bounces.len()], &again[..=20]), (&bounces[..], &held[..=20]));
        let thrown = &contacts[bounces.len()];
        // The table gives way for some milliseconds, in which it goes to the tilt of the throw and the body falls freely.
        let (time, from) = (thrown.t - held[20].t, &held[20]);
        assert!(time > 0.0 && time < 0.01, "{time}");
        assert_eq!((thrown.n, thrown.state.theta_dot), (n, from.theta_dot));
        assert!((thrown.x - (from.x + from.x_dot * time)).abs() < 1e-15);
        assert!((thrown.state.theta - (from.theta + from.theta_dot * time)).abs() < 1e-15);
        assert!(thrown.flight_time.is_some_and(|t| t > 0.2), "{thrown:?}");
        let outcome = playback.outcome().unwrap();
        assert_eq!((outcome.kind, outcome.bounces), ("settled", contacts.len() as u64));
        let (second, _) = playback.rest().unwrap();
        assert_eq!((second, second[0].t), (&again[21..], outcome.settle_time.unwrap()));
    }

    #[test]
    fn a_catch_that_was_foreseen_is_computed_once() {
        let settings = |ratio| CatchSettings {
            strategy: Some(Strategy::BounceDown),
            ratio: Some(ratio),
            ..CatchSettings::default()
        };
        let mut run = case("case-1");
        run.catch(2, settings(0.6)).unwrap();
        let mut playback = Playback::new(&run, 1000);
        playback.advance(&run, &mut || true).unwrap();
        let address = |caught: Option<&CaughtRun>| std::ptr::from_ref(caught.unwrap().catch());
        let known = |playback: &Playback| address(playback.foreseen.as_ref().and_then(|one| one.caught.as_ref()));
        let foreseen = playback.foresee(&run, &mut || true).unwrap().unwrap().1;
        let first = known(&playback);
        // Asked again, it is the same; with other settings it is another, and so it is once they are as before.
        playback.foresee(&run, &mut || true).unwrap().unwrap();
        assert_eq!(known(&playback), first);
        let mut other = run.clone();
        other.catch(2, settings(0.5)).unwrap();
        assert_ne!(playback.clone().foresee(&other, &mut || true).unwrap().unwrap().1, foreseen);
        let mut changed = playback.clone();
        assert_eq!(
            (
                changed.foresee(&other, &mut || true).unwrap().is_some(),
                changed.foresee(&run, &mut || true).unwrap().unwrap().1
            ),
            (true, foreseen)
        );
        let (Step::Impact(contact), _) = playback.advance(&run, &mut || true).unwrap() else { panic!("no impact") };
        assert_eq!((contact.strike, address(playback.caught.as_ref())), (Some(foreseen), first));
        assert!(playback.foreseen.is_none());
        // A run that foresees nothing has the same strikes.
        assert_eq!(play(&run, &mut Playback::new(&run, 1000)).0[2..], play(&run, &mut playback).0[..]);
    }

    #[test]
    fn catches_and_holds_end_with_the_work() {
        let mut run = case("case-1");
        run.catch(3, CatchSettings { strategy: Some(Strategy::Plan), ..CatchSettings::default() }).unwrap();
        let mut playback = Playback::new(&run, 100);
        let mut stopped = || false;
        for _ in 1..3 {
            assert!(playback.advance(&run, &mut stopped).is_ok(), "an impact asks nobody");
        }
        assert!(playback.clone().foresee(&run, &mut stopped).is_err());
        assert!(playback.advance(&run, &mut stopped).is_err());
        let held = case("still-lossy").holding(60.0);
        let mut playback = Playback::new(&held, 1_000_000);
        assert!(playback.next_impact(&held, &mut || true).is_ok());
        assert!(
            std::iter::repeat_with(|| playback.advance(&held, &mut stopped)).take(1_000_000).any(|step| step.is_err())
        );
    }
}
