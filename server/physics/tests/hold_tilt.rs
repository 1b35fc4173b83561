//! The tilt of the table as a lasting contact begins and goes on: it moves at a finite rate, which its demand has and its limits bound.

use crate::support::rig_runs::scene;
use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Catch, CatchOutcome};
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::strike::Rod;
use equipoise_physics::map::table::actuator_load::{ActuatorLimits, Pose};
use equipoise_physics::map::table::control_law::Gains;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::{
    ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest, StrikeBefore, hold, rest_of_run,
};
use equipoise_physics::run::orbit::{ComingContact, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Name, Scene, Value};

fn caught(scene: &Scene, strategy: Strategy) -> Catch {
    let settings = CatchSettings { strategy: Some(strategy), ..CatchSettings::default() };
    catch(scene, &settings, None, &mut || true).unwrap()
}

/// Holds the tilts of a motion, from `before` on, to the rate that its load has.
fn assert_finite(hold: &Hold, before: Option<f64>, case: &str) {
    let first = hold.samples.first().unwrap();
    assert!(before.is_none_or(|alpha| (alpha - first.alpha).abs() <= 1e-9), "{case}: {before:?} and {}", first.alpha);
    for pair in hold.samples.windows(2) {
        let rate = (pair[1].alpha - pair[0].alpha).abs() / (pair[1].t - pair[0].t);
        assert!(rate <= hold.load.tilt_rate * (1.0 + 1e-9), "{case}: {rate} rad/s at {} s", pair[0].t);
    }
}

#[test]
fn a_contact_begins_at_the_tilt_of_its_strike() {
    let mut jumps = 0;
    for strategy in Strategy::ALL {
        for (friction, restitution, theta) in [(0.0, 1.0, 0.1), (0.0, 0.6, -0.15), (0.6, 0.7, 0.1), (0.8, 1.0, -0.05)] {
            let scene = scene(&[(Name::Friction, friction), (Name::Restitution, restitution), (Name::Theta, theta)]);
            let caught = caught(&scene, strategy);
            let case = format!("{strategy:?} {friction} {restitution} {theta}: {:?}", caught.outcome);
            assert!(caught.outcome.is_caught(), "{case}");
            let hold = caught.hold.unwrap();
            let last = caught.strikes.last().map(|strike| strike.strike.alpha);
            assert_finite(&hold, last, &case);
            assert!(caught.demand.load.tilt_rate >= hold.load.tilt_rate, "{case}");
            // On the way the table moves by 1 rad in ρ/√(Gl).
            let growth = (9.81 * 0.4 / 3.0_f64).sqrt() / (2.0_f64.sqrt() / 15.0);
            if hold.load.tilt_rate > 0.999 * growth {
                jumps += 1;
            }
        }
    }
    assert!(jumps > 4, "{jumps} contacts begin with a table on its way");
}

#[test]
fn a_limit_of_the_tilt_rate_bounds_the_way_to_the_hold() {
    let free = caught(&scene(&[(Name::Friction, 0.6)]), Strategy::BounceDown);
    let between = free
        .strikes
        .windows(2)
        .map(|pair| (pair[1].strike.alpha - pair[0].strike.alpha).abs() / pair[0].flight_time.unwrap());
    let limit = 1.001 * between.fold(0.0, f64::max);
    let bounded = caught(&scene(&[(Name::Friction, 0.6), (Name::TiltRateLimit, limit)]), Strategy::BounceDown);
    assert_eq!(bounded.outcome, CatchOutcome::Held);
    assert_eq!(bounded.strikes, free.strikes);
    assert!(bounded.demand.load.tilt_rate <= limit, "{} {limit}", bounded.demand.load.tilt_rate);
    // A level table holds by moving along itself: its tilt acts on the needed friction alone.
    let (free, bounded) = (free.hold.unwrap(), bounded.hold.unwrap());
    assert!(bounded.load.tilt_rate <= limit && free.load.tilt_rate > limit);
    for (one, other) in free.samples.iter().zip(&bounded.samples) {
        let apart = (one.theta - other.theta).abs().max((one.x - other.x).abs());
        assert!(apart < 1e-7, "{apart} at {} and {} s", one.t, other.t);
    }
    assert!(free.samples.last().unwrap().alpha == 0.0);
}

#[test]
fn a_table_that_stops_braking_goes_to_its_law_at_a_finite_rate() {
    let gains = |scale: f64| {
        let (x, theta) = (0.3162 * scale, -2.9078 * scale);
        HoldLaw::Tilting(Gains { x, theta, x_dot: 0.3647 * scale, theta_dot: -0.2463 * scale }, 0.0)
    };
    let start =
        ContactStart { t: 0.0, x: 0.02, theta: 0.1, x_dot: 0.0, theta_dot: 0.0, table_speed: -1.0, before: None };
    let rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.3);
    let rules = |limits| Rules { topple_angle: 1.5, limits, ..Rules::BARE_MAP };
    let request = HoldRequest {
        brake_law: Some(gains(0.8)),
        brake: Some(9.81),
        ..HoldRequest::new(&Body::plain(rod), &rules(None), gains(1.0), start, 2.0)
    };
    let free = hold(&request, &mut || true);
    assert_eq!(free.ending, HoldEnding::Completed);
    assert_finite(&free, None, "brake");
    let limits = ActuatorLimits { tilt: 1.0, tilt_rate: 8.0, speed: 10.0, stroke: 10.0 };
    let struck = StrikeBefore { alpha: 0.2, time: 0.0 };
    let from = |before| ContactStart { before: Some(before), ..start };
    let slow = hold(&HoldRequest { rules: rules(Some(limits)), start: from(struck), ..request }, &mut || true);
    assert_eq!(slow.ending, HoldEnding::Completed);
    assert_finite(&slow, Some(0.2), "slow");
    assert_eq!(slow.load.tilt_rate, 8.0);
    // A table that is too slow loses the body, or has to go faster.
    let slower = ActuatorLimits { tilt_rate: 0.1, ..limits };
    let lost = hold(&HoldRequest { rules: rules(Some(slower)), start: from(struck), ..request }, &mut || true);
    assert_ne!(lost.ending, HoldEnding::Completed);
    assert!(lost.load.tilt_rate <= 0.1 || matches!(lost.ending, HoldEnding::BeyondLimits(_)));
    // With a flight before the contact the way takes all of it.
    let flown = HoldRequest { start: from(StrikeBefore { alpha: 0.3, time: 0.05 }), ..request };
    let first = hold(&flown, &mut || true);
    let alpha = first.samples[0].alpha;
    assert_eq!(alpha, free.samples[0].alpha);
    assert!(first.load.tilt_rate >= (0.3 - alpha).abs() / 0.05);
    let fast = rules(Some(ActuatorLimits { tilt_rate: 0.5, ..limits }));
    let HoldEnding::BeyondLimits(violation) = hold(&HoldRequest { rules: fast, ..flown }, &mut || true).ending else {
        panic!("within limits")
    };
    assert_eq!((violation.quantity, violation.value), ("tilt_rate", (alpha - 0.3).abs() / 0.05));
}

#[test]
fn a_catch_begins_at_the_tilt_of_the_strike_before_it() {
    let plain = scene(&[]);
    let mut contacts = Vec::new();
    run(&mut plain.orbit().unwrap(), 4, |contact| {
        contacts.push(*contact);
        true
    });
    let (before, at) = (contacts[2], contacts[3]);
    for strategy in Strategy::ALL {
        let settings = CatchSettings { strategy: Some(strategy), ..CatchSettings::default() };
        let from = ComingContact {
            t: at.t,
            coming: PreImpact::at(at.n, at.x, at.state),
            before: before.strike.map(|strike| Pose::of(&strike)).zip(before.flight_time),
        };
        let of = |scene: &Scene, from: &ComingContact| catch(scene, &settings, Some(from), &mut || true).unwrap();
        let known = of(&plain, &from);
        let first =
            known.strikes.first().map_or_else(|| known.hold.as_ref().unwrap().samples[0].alpha, |it| it.strike.alpha);
        let rate = (first - before.alpha).abs() / before.flight_time.unwrap();
        assert!(known.demand.load.tilt_rate >= rate, "{strategy:?}");
        let limited = of(&scene(&[(Name::TiltRateLimit, 0.99 * rate)]), &from);
        let CatchOutcome::Ended { t, ending: Ending::BeyondLimits(violation) } = limited.outcome else {
            panic!("{strategy:?}: {:?}", limited.outcome)
        };
        assert_eq!((t, violation.quantity, violation.value), (at.t, "tilt_rate", rate), "{strategy:?}");
    }
}

#[test]
fn the_rest_of_a_run_begins_where_its_last_strike_left_the_table() {
    let mut settled = 0;
    for (restitution, gain) in [(0.5, 1.1), (0.6, 1.1), (0.5, 1.05), (0.4, 1.1)] {
        let values = [(Name::Height, 0.25), (Name::Restitution, restitution), (Name::TiltGain, gain)];
        let mut draft = scene(&values).draft();
        draft.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
        let scene = draft.build().unwrap();
        let mut last = None;
        let ending = run(&mut scene.orbit().unwrap(), 10_000, |contact| {
            last = Some(*contact);
            true
        });
        let Some(Ending::Settled { settle_time, .. }) = ending else { continue };
        settled += 1;
        let last = last.unwrap();
        let rest = hold(&rest_of_run(&scene, &last, settle_time, 0.2).unwrap(), &mut || true);
        assert_finite(&rest, (settle_time == last.t).then_some(last.alpha), "rest");
        let rate = (rest.samples[0].alpha - last.alpha).abs();
        assert!(rate <= rest.load.tilt_rate * (settle_time - last.t).max(f64::MIN_POSITIVE) * (1.0 + 1e-15));
    }
    assert!(settled > 0, "no run settles");
}
