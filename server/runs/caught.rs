//! Catches and holds within a run: the strikes one after another, and then the time in which the body is in lasting contact with the table, told
//! part by part.

use std::mem::take;
use std::ops::Range;
use std::sync::Arc;

use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Catch, CatchFailure, CatchStrike};
use equipoise_physics::catching::settings::CatchSettings;
use equipoise_physics::map::body::{Arrival, PreImpact};
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::map::table::actuator_load::Pose;
use equipoise_physics::numbers::trig;
use equipoise_physics::run::lasting_contact::HoldSample;
use equipoise_physics::run::orbit::{ComingContact, Contact};
use equipoise_physics::scene::Scene;

use crate::compute::Cancelled;

/// A catch, and how much of it is over.
#[derive(Debug, Clone)]
pub struct CaughtRun {
    catch: Arc<Catch>,
    /// Number of strikes that are over.
    struck: usize,
    /// The hold that follows the last strike, if the body comes to one. The catch is without its samples.
    held: Option<HeldRun>,
}

impl CaughtRun {
    /// A catch that begins with a coming contact. `None` if there is no law that could catch it.
    ///
    /// # Errors
    /// `go_on` said `false`.
    pub fn begin(
        scene: &Scene,
        settings: &CatchSettings,
        from: &ComingContact,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Self>, Cancelled> {
        // The scene's own table had a plan for this contact, which no longer holds.
        let from = ComingContact { coming: PreImpact { plan: None, ..from.coming }, ..*from };
        let mut catch = match catch(scene, settings, Some(&from), go_on) {
            Ok(catch) => catch,
            Err(CatchFailure::Stopped) => return Err(Cancelled),
            Err(CatchFailure::Point | CatchFailure::NoLaw(_)) => return Ok(None),
        };
        let held = catch.hold.as_mut().map(|hold| HeldRun::new(take(&mut hold.samples)));
        Ok(Some(Self { catch: Arc::new(catch), struck: 0, held }))
    }

    /// The catch.
    pub fn catch(&self) -> &Catch {
        &self.catch
    }

    /// The next strike; `None` if all are over.
    pub fn next_strike(&self) -> Option<&CatchStrike> {
        self.catch.strikes.get(self.struck)
    }

    /// The hold once all strikes are over, if the body comes to one.
    pub fn held(&self) -> Option<&HeldRun> {
        self.held.as_ref().filter(|_| self.next_strike().is_none())
    }

    /// The hold, to go on in it.
    pub fn held_mut(&mut self) -> Option<&mut HeldRun> {
        self.held.as_mut()
    }

    /// The next strike as a contact of the run, and the flight to the one after it.
    pub fn strike(&mut self) -> Option<(Contact, Option<Arrival>)> {
        let strike = self.next_strike()?;
        let contact = contact(strike);
        self.struck += 1;
        let arrival = self.next_strike().zip(contact.flight_time).map(|(next, t)| Arrival {
            t,
            state: next.state,
            clearance: next.clearance,
            plan: None,
            way: next.x - contact.x,
        });
        Some((contact, arrival))
    }
}

/// A strike of a catch as a contact of a run.
fn contact(at: &CatchStrike) -> Contact {
    let CatchStrike { n, t, x, state, clearance, strike, flight_time, .. } = *at;
    Contact { n, t, x, state, clearance, alpha: strike.alpha, strike: Some(strike), flight_time, ending: None }
}

/// Samples in one part of a hold: 0.1 s of a hold of 6 s. A throw acts at the end of a part that was sent.
const PART: usize = 10;

/// A hold, and how much of it is over.
#[derive(Debug, Clone)]
pub struct HeldRun {
    samples: Arc<[HoldSample]>,
    /// Index of the last sample that was sent.
    held: usize,
}

/// Samples of a hold that follow one another. They stay valid without the run.
#[derive(Debug, Clone)]
pub struct HoldPart {
    samples: Arc<[HoldSample]>,
    range: Range<usize>,
}

impl HoldPart {
    /// The samples; the first one is also the last one of the part before.
    pub fn samples(&self) -> &[HoldSample] {
        self.samples.get(self.range.clone()).unwrap_or_default()
    }

    /// Time from the first sample to the last, s.
    pub fn length(&self) -> f64 {
        let samples = self.samples();
        samples.first().zip(samples.last()).map_or(0.0, |(first, last)| last.t - first.t)
    }

    /// This part and the one that follows it, if it does.
    pub fn joined(self, next: &Self) -> Result<Self, Self> {
        let follows = Arc::ptr_eq(&self.samples, &next.samples) && self.range.end == next.range.start + 1;
        if follows { Ok(Self { range: self.range.start..next.range.end, ..self }) } else { Err(self) }
    }
}

impl HeldRun {
    /// A hold at its beginning.
    pub fn new(samples: Vec<HoldSample>) -> Self {
        Self { samples: samples.into(), held: 0 }
    }

    /// All samples.
    pub fn samples(&self) -> &[HoldSample] {
        &self.samples
    }

    /// Last sample so far.
    pub fn sample(&self) -> Option<&HoldSample> {
        self.samples.get(self.held)
    }

    /// Next part; `None` at the end.
    pub fn next_part(&mut self) -> Option<HoldPart> {
        let begin = self.held;
        let end = (begin + PART).min(self.samples.len().saturating_sub(1));
        if begin >= end {
            return None;
        }
        self.held = end;
        Some(HoldPart { samples: self.samples.clone(), range: begin..end + 1 })
    }
}

/// A body that is held, before a strike that is to follow, and the table that holds it.
pub fn held_body(n: u64, rod: &Rod, sample: &HoldSample) -> (PreImpact, Pose) {
    let (sin, _) = trig::sin_cos(sample.theta);
    // The contact point is as fast as the table, and as high.
    let y_dot = sample.table_y_dot - rod.contact_distance * sample.theta_dot * sin;
    let state = State { theta: sample.theta, x_dot: sample.x_dot, y_dot, theta_dot: sample.theta_dot };
    let pose = Pose { alpha: sample.alpha, velocity: (0.0, sample.table_y_dot) };
    (PreImpact { n, x: sample.x, state, clearance: sample.table_y, plan: None }, pose)
}

#[cfg(test)]
mod tests {
    use equipoise_physics::catching::settings::Strategy;
    use equipoise_physics::catching::throw::ThrowTarget;
    use equipoise_physics::map::body::Kick;
    use equipoise_physics::map::strike::State;
    use equipoise_physics::map::table::actuator_load::Pose;
    use equipoise_physics::numbers::trig;
    use equipoise_physics::run::lasting_contact::HoldSample;

    use super::*;
    use crate::runs::playback::{Playback, Step};
    use crate::runs::run::tests::case;
    use crate::runs::run::{Run, ThrowOrder};

    /// All steps of a run up to its end: contacts, and samples of holds without those that stand in two parts.
    fn play(run: &Run, bounces: u64) -> (Vec<Contact>, Vec<HoldSample>, Playback) {
        let mut playback = Playback::new(run, bounces);
        let (mut contacts, mut samples) = (Vec::new(), Vec::<HoldSample>::new());
        while playback.outcome().is_none() {
            let due = playback.next_t().unwrap();
            match playback.advance(run, &mut || true).unwrap().0 {
                Step::Impact(contact) => {
                    // A table that holds the body first gives way for a throw.
                    let holds = samples.last().is_some_and(|last| last.t == due);
                    assert!(contact.t.to_bits() == due.to_bits() || (holds && contact.t > due));
                    contacts.push(contact);
                }
                Step::Hold(part) => {
                    assert_eq!(part.samples()[0].t, due);
                    assert!(part.samples().len() <= 11 && part.length() > 0.0);
                    let follows = samples.last().is_some_and(|last| last.t == due);
                    samples.extend(&part.samples()[usize::from(follows)..]);
                }
                Step::End => assert!(playback.outcome().is_some()),
            }
        }
        (contacts, samples, playback)
    }

    fn settings(strategy: Strategy) -> CatchSettings {
        CatchSettings { strategy: Some(strategy), ..CatchSettings::default() }
    }

    #[test]
    fn a_catch_begins_with_its_impact_and_ends_with_the_hold() {
        let mut run = case("case-1");
        let plain = play(&run, 30).0;
        let long = CatchSettings { hold: 20.0, ..settings(Strategy::BounceDown) };
        run.catch(5, long).unwrap();
        let (contacts, samples, playback) = play(&run, 1000);
        assert_eq!(contacts[..4], plain[..4]);
        assert_eq!(contacts[4].state, plain[4].state);
        let at = PreImpact::at(5, plain[4].x, plain[4].state);
        let before = plain[3].strike.map(|strike| Pose::of(&strike)).zip(plain[3].flight_time);
        let from = ComingContact { t: plain[4].t, coming: at, before };
        let alone = CaughtRun::begin(run.scene(), &long, &from, &mut || true).unwrap().unwrap();
        assert_eq!(contacts.len(), 4 + alone.catch().strikes.len());
        for (contact, strike) in contacts[4..].iter().zip(&alone.catch().strikes) {
            assert_eq!((contact.n, contact.t, contact.state), (strike.n, strike.t, strike.state));
            assert_eq!(contact.strike, Some(strike.strike));
        }
        assert_eq!(samples, alone.held.unwrap().samples());
        let outcome = playback.outcome().unwrap();
        assert_eq!((outcome.kind, outcome.bounces), ("held", contacts.len() as u64));
        assert!(outcome.headline().starts_with("Caught after bounce"), "{}", outcome.headline());
        assert!(samples.last().unwrap().theta.abs() < 1e-3);
        assert!(
            playback.load().speed
                >= contacts.iter().map(|it| it.strike.unwrap().table_velocity.1.abs()).fold(0.0, f64::max)
        );
    }

    #[test]
    fn a_strike_of_a_catch_is_the_strike_of_the_body() {
        // The centre of percussion keeps its velocity along the rod's normal; the energies are those of the velocities.
        let mut run = case("case-1");
        run.catch(2, settings(Strategy::BounceDown)).unwrap();
        let rod = Playback::new(&run, 1).body().rod;
        for contact in &play(&run, 1000).0[1..] {
            let strike = contact.strike.unwrap();
            let (sin, cos) = strike.sin_cos_theta;
            let lever = rod.radius_of_gyration * rod.radius_of_gyration / rod.contact_distance;
            let along = |state: &State| state.x_dot * cos + state.y_dot * sin - lever * state.theta_dot;
            assert!((along(&contact.state) - along(&strike.after)).abs() < 1e-14);
            let restitution = -rod.restitution * strike.approach;
            let (sin_alpha, cos_alpha) = trig::sin_cos(strike.alpha);
            let (sin_beta, _) = trig::sin_cos(contact.state.theta - strike.alpha);
            let after = cos_alpha * strike.after.y_dot - sin_alpha * strike.after.x_dot
                + rod.contact_distance * sin_beta * strike.after.theta_dot;
            let table = cos_alpha * strike.table_velocity.1 - sin_alpha * strike.table_velocity.0;
            assert!((after - table - restitution).abs() < 1e-13, "{contact:?}");
        }
    }

    #[test]
    fn a_body_that_is_held_can_be_thrown_and_bounces_on() {
        for strategy in [Strategy::BounceDown, Strategy::Brake] {
            let mut run = case("case-1");
            run.catch(3, settings(strategy)).unwrap();
            let (caught, held, _) = play(&run, 1000);
            // A little after the time at which the client knows 20 samples.
            let order = ThrowOrder { apex: ThrowTarget { height: 0.3, theta: 0.05 }, t: Some(held[20].t) };
            run.throw(caught.len() as u64 + 1, order).unwrap();
            let (contacts, again, playback) = play(&run, caught.len() as u64 + 20);
            assert_eq!(contacts[..caught.len()], caught[..]);
            assert_eq!(again[..], held[..=20]);
            let thrown = &contacts[caught.len()];
            // The table goes to the tilt of the throw as fast as its demand says, while the body falls freely.
            let (rod, time) = (playback.body().rod, thrown.t - held[20].t);
            let rate = (thrown.alpha - held[20].alpha).abs() / time;
            assert!(rate <= playback.load().tilt_rate * (1.0 + 1e-9), "{rate}");
            let alone = play(&run, caught.len() as u64 + 1).2.load();
            assert!(alone.tilt_rate >= rate * (1.0 - 1e-9) && time < 0.02, "{time}");
            let fallen = |from: f64, rate: f64| from + rate * time;
            assert!((thrown.x - fallen(held[20].x, held[20].x_dot)).abs() < 1e-15);
            assert!((thrown.state.theta - fallen(held[20].theta, held[20].theta_dot)).abs() < 1e-15);
            assert_eq!(thrown.state.theta_dot, held[20].theta_dot);
            let after = thrown.strike.unwrap().after;
            let rise = after.y_dot / rod.gravity;
            let from = rod.contact_distance * after.theta.cos() + thrown.clearance;
            assert!((from + 0.5 * after.y_dot * rise - 0.3).abs() < 1e-12, "{strategy:?}");
            assert!((after.theta + after.theta_dot * rise - 0.05).abs() < 1e-12);
            assert_eq!(contacts.len(), caught.len() + 20);
            assert_eq!(playback.outcome().unwrap().kind, "completed");
        }
    }

    #[test]
    fn a_throw_takes_the_place_of_a_strike() {
        let mut run = case("case-1");
        run.throw(4, ThrowOrder { apex: ThrowTarget { height: 0.35, theta: 0.0 }, t: None }).unwrap();
        let contacts = play(&run, 12).0;
        let after = contacts[3].strike.unwrap().after;
        assert!((after.theta + after.theta_dot * after.y_dot / 9.81).abs() < 1e-12);
        assert_eq!(contacts.len(), 12);
    }

    #[test]
    fn a_kick_during_a_catch_is_caught_too() {
        let mut run = case("case-1");
        run.catch(3, settings(Strategy::BounceDown)).unwrap();
        let kick = Kick { theta_dot: 0.4, ..Kick::default() };
        run.kick(5, kick).unwrap();
        let (contacts, samples, playback) = play(&run, 1000);
        assert_eq!(playback.outcome().unwrap().kind, "held");
        let mut plain = case("case-1");
        plain.catch(3, settings(Strategy::BounceDown)).unwrap();
        let calm = play(&plain, 1000).0;
        assert_eq!(contacts[..4], calm[..4]);
        assert!(
            (contacts[4].strike.unwrap().after.theta_dot - calm[4].strike.unwrap().after.theta_dot - 0.4).abs() < 1e-15
        );
        assert!(samples.last().unwrap().theta.abs() < 1e-3);
    }

    #[test]
    fn what_cannot_be_thrown_bounces_on() {
        let mut run = case("case-1");
        let plain = play(&run, 20).0;
        run.throw(4, ThrowOrder { apex: ThrowTarget { height: 0.01, theta: 0.0 }, t: None }).unwrap();
        assert_eq!(play(&run, 20).0, plain);
        assert!(Playback::new(&run, 20).try_throw(&ThrowTarget { height: 0.01, theta: 0.0 }).is_err());
    }
}
