//! Runs with interventions against plain runs, and runs that go on in contact.

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
    let settings =
        |ratio| CatchSettings { strategy: Some(Strategy::BounceDown), ratio: Some(ratio), ..CatchSettings::default() };
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
    assert!(std::iter::repeat_with(|| playback.advance(&held, &mut stopped)).take(1_000_000).any(|step| step.is_err()));
}
