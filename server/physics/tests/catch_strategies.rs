//! Catches as a whole: the figures of the reference by strategy, errors of the table, limits, polygons, and random releases.

use crate::support::random;
use crate::support::rig_runs::{self, with_numbers};
use equipoise_physics::catching::outcome::{
    Catch, CatchFailure, CatchNote, CatchOutcome, CatchOutcomeKind, CatchStrike, Escape,
};
use equipoise_physics::catching::plan::StrikesReason;
use equipoise_physics::catching::settings::{Approach, CatchSettings, Strategy};
use equipoise_physics::catching::{catch, catch_outcome};
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::ComingContact;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use random::Random;

const LENGTH: f64 = 0.4 / 3.0;

/// The body of the paper, released at rest at 0.25 m and 0.1 rad, with these fields besides.
fn scene(fields: &[(Name, f64)]) -> Scene {
    draft(fields).build().unwrap()
}

fn draft(fields: &[(Name, f64)]) -> Draft {
    with_numbers(rig_runs::scene(&[(Name::Height, 0.25)]).draft(), fields)
}

fn by(strategy: Strategy) -> CatchSettings {
    CatchSettings { strategy: Some(strategy), ..CatchSettings::default() }
}

fn caught(scene: &Scene, settings: CatchSettings) -> Catch {
    catch(scene, &settings, None, &mut || true).unwrap()
}

/// Asserts that a figure is the printed one, to half a unit of its last digit.
fn printed(value: f64, figure: f64, unit: f64, what: &str) {
    assert!((value - figure).abs() <= 0.5 * unit * (1.0 + 1e-9), "{what} is {value}, not {figure}");
}

#[test]
fn bounces_go_down_within_the_printed_figures() {
    // Strike by strike the fast one is that of the reference.
    let fast = caught(&scene(&[]), by(Strategy::BounceDown));
    printed(fast.hold.as_ref().unwrap().theta_within.unwrap(), 4.0, 0.1, "time to 1 mrad");
    printed(fast.hold.as_ref().unwrap().x_within.unwrap(), 5.4, 0.1, "time to 1 mm");
    // The 63 strikes of the slow one go down to 2 mm/s.
    let slow = CatchSettings { ratio: Some(0.9), hold_speed: 2e-3, ..by(Strategy::BounceDown) };
    let slow = caught(&scene(&[]), slow);
    assert_eq!((slow.outcome, slow.strikes.len()), (CatchOutcome::Held, 63));
    printed(slow.contact_from.unwrap(), 2.94, 1e-2, "time in the air");
    printed(slow.demand.load.tilt, 0.112, 1e-3, "tilt");
    assert!(slow.strikes.iter().all(|at| at.strike.table_speed().abs() < 0.0865));
    assert!(slow.hold.unwrap().samples[0].theta.abs() < 1e-2);
}

#[test]
fn plans_come_to_rest_within_the_printed_figures() {
    for (strikes, ratio, time, speed, last, tilt) in
        [(5, 1.0, 1.705, 0.026, -0.759, 0.157), (8, 0.8, 1.190, 0.148, -0.127, 0.215)]
    {
        let settings = CatchSettings { ratio: Some(ratio), strikes: Some(strikes), ..by(Strategy::Plan) };
        let catch = caught(&scene(&[]), settings);
        assert_eq!((catch.outcome, catch.strikes.len()), (CatchOutcome::Held, strikes as usize + 1));
        printed(catch.contact_from.unwrap(), time, 1e-3, "time in the air");
        printed(catch.demand.load.tilt, tilt, 1e-3, "tilt");
        let (stop, strikes) = catch.strikes.split_last().unwrap();
        printed(stop.strike.table_speed(), last, 1e-3, "table at the stop");
        let most = strikes.iter().map(|at| at.strike.table_speed().abs()).fold(0.0, f64::max);
        printed(most, speed, 1e-3, "table before");
        let State { theta, x_dot, theta_dot, .. } = stop.strike.after;
        for rest in [stop.x, theta, x_dot, theta_dot] {
            assert!(rest.abs() < 1e-9, "{stop:?}");
        }
        assert_eq!(catch.hold.as_ref().unwrap().theta_within, catch.contact_from);
    }
}

#[test]
fn a_table_that_brakes_needs_the_printed_stroke() {
    let catch = caught(&scene(&[]), by(Strategy::Brake));
    assert_eq!((catch.outcome, catch.strikes.len()), (CatchOutcome::Held, 0));
    printed(catch.contact_from.unwrap(), 0.155, 1e-3, "time in the air");
    printed(catch.demand.load.speed, 1.517, 1e-3, "table speed");
    printed(catch.demand.load.stroke, 0.117, 1e-3, "stroke");
    printed(catch.demand.load.tilt, 0.298, 1e-3, "tilt");
    assert!(catch.hold.unwrap().most_theta <= 0.1);
    // Stroke (h − l cos θ)G/a.
    let gentle = caught(&scene(&[]), CatchSettings { brake: Some(4.0), ..by(Strategy::Brake) });
    let expected = (0.25 - LENGTH * 0.1_f64.cos()) * 9.81 / 4.0;
    assert!((gentle.demand.load.stroke - expected).abs() < 1e-6, "{}", gentle.demand.load.stroke);
}

#[test]
fn a_catch_of_a_run_under_way_is_that_of_its_rest() {
    let scene = scene(&[(Name::Friction, 0.4), (Name::Restitution, 0.7)]);
    let whole = caught(&scene, by(Strategy::BounceDown));
    for from in [0, 3] {
        let CatchStrike { n, t, x, state, .. } = whole.strikes[from];
        let coming = ComingContact { t, coming: PreImpact::at(n, x, state), before: None };
        let rest = catch(&scene, &by(Strategy::BounceDown), Some(&coming), &mut || true).unwrap();
        assert_eq!(rest.strikes, whole.strikes[from..]);
        assert_eq!(rest.hold, whole.hold);
    }
}

#[test]
fn the_choice_is_the_first_that_the_limits_allow() {
    let free = caught(&scene(&[]), CatchSettings::default());
    assert_eq!(free.approach, Approach::BounceDown { ratio: 0.5 });
    assert_eq!(free.candidates.len(), 5);
    // A slow table has to be slow, or to follow a plan.
    let slow = caught(&scene(&[(Name::SpeedLimit, 0.15)]), CatchSettings::default());
    assert_eq!(slow.approach, Approach::BounceDown { ratio: 0.9 });
    assert!(
        matches!(slow.candidates[0].outcome, CatchOutcome::Ended { ending: Ending::BeyondLimits(violation), .. } if violation.quantity == "speed")
    );
    // One that cannot tilt much catches nothing, and says what each strategy would need.
    let stiff = caught(&scene(&[(Name::TiltLimit, 0.02)]), CatchSettings::default());
    assert!(!stiff.outcome.is_caught());
    for candidate in &stiff.candidates {
        assert_eq!(candidate.outcome.kind(), CatchOutcomeKind::BeyondLimits, "{candidate:?}");
        assert!(candidate.demand.load.tilt > 0.02, "{candidate:?}");
    }
    assert_eq!(stiff.candidates.iter().filter(|candidate| candidate.taken).count(), 1);
}

#[test]
fn a_wrong_belief_is_caught_at_the_ratio_that_it_gives() {
    for (actual, assumed, ratio) in [(0.6, 0.8, 0.5), (0.9, 0.7, 0.5), (0.3, 0.5, 0.2), (0.3, 0.6, 0.1)] {
        let scene = scene(&[(Name::Restitution, actual), (Name::AssumedRestitution, assumed)]);
        let catch = caught(&scene, CatchSettings { ratio: Some(ratio), ..by(Strategy::BounceDown) });
        let expected = actual + (1.0 + actual) * (ratio - assumed) / (1.0 + assumed);
        // At the height ratio itself where the normal one is the same: upright.
        let first = &catch.strikes[0];
        let normal = |velocity: &State| {
            let beta = velocity.theta - first.strike.alpha;
            first.strike.alpha.cos() * velocity.y_dot - first.strike.alpha.sin() * velocity.x_dot
                + LENGTH * beta.sin() * velocity.theta_dot
        };
        let aimed = -normal(&first.state) + first.strike.table_speed();
        let reached = normal(&first.strike.after) - first.strike.table_speed();
        assert!((reached - actual * aimed).abs() < 1e-12, "{reached} {aimed}");
        assert!((first.ratio() - expected).abs() < 0.05, "{} {expected}", first.ratio());
        assert_eq!(catch.outcome, CatchOutcome::Held, "{actual} {assumed} {ratio}");
        assert!(catch.notes.iter().any(|note| matches!(note, CatchNote::WrongBelief { .. })), "{:?}", catch.notes);
        let rode = catch.notes.iter().any(|note| matches!(note, CatchNote::RodeAlong { .. }));
        assert_eq!(rode, catch.strikes.last().unwrap().ratio() < 0.0);
    }
}

/// A random release with angles and spins up to these, e from 0.3 to 1 and a belief that is off by up to 0.2.
fn random_release(random: &mut Random, (theta, spin): (f64, f64)) -> [(Name, f64); 6] {
    let restitution = random.between(0.3, 1.0);
    [
        (Name::Theta, random.between(-theta, theta)),
        (Name::ThetaDot, random.between(-spin, spin)),
        (Name::XDot, random.between(-0.3, 0.3)),
        (Name::Restitution, restitution),
        (Name::AssumedRestitution, (restitution + random.between(-0.2, 0.2)).clamp(0.0, 1.0)),
        (Name::Height, random.between(0.2, 0.4)),
    ]
}

#[test]
fn most_random_releases_are_caught() {
    let (usual, wide) = ((0.3, 2.0), (0.45, 3.0));
    for (strategy, spread, runs, least) in [
        (Some(Strategy::BounceDown), usual, 150, 0.75),
        (Some(Strategy::Brake), usual, 100, 0.65),
        (Some(Strategy::Plan), usual, 40, 0.85),
        (Some(Strategy::Plan), wide, 60, 0.6),
        (None, usual, 40, 0.9),
    ] {
        let mut random = Random::new(2026);
        let mut held = 0;
        for _ in 0..runs {
            let settings = CatchSettings { strategy, ..CatchSettings::default() };
            let catch = caught(&scene(&random_release(&mut random, spread)), settings);
            if catch.outcome != CatchOutcome::Held {
                continue;
            }
            held += 1;
            let hold = catch.hold.unwrap();
            let end = hold.samples.last().unwrap();
            assert!(end.theta.abs() < 0.1 && hold.samples.iter().all(|sample| sample.normal_force > 0.0));
            assert!(hold.error_bound < 1e-6, "{}", hold.error_bound);
        }
        let share = f64::from(held) / f64::from(runs);
        println!("{strategy:?} to {} rad: {held} of {runs} caught", spread.0);
        assert!(share >= least, "{strategy:?}: {share}");
    }
}

#[test]
fn the_same_catch_has_the_same_bits() {
    let fields = [(Name::TimingSd, 0.003), (Name::Friction, 0.5), (Name::ThetaDot, 0.4)];
    let settings = by(Strategy::BounceDown);
    let (first, again) = (caught(&scene(&fields), settings), caught(&scene(&fields), settings));
    assert_eq!(format!("{first:?}"), format!("{again:?}"));
    let (outcome, _) = catch_outcome(&scene(&fields), &settings, &mut || true).unwrap();
    assert_eq!(outcome, first.outcome);
}

#[test]
fn a_body_that_lies_too_far_over_falls() {
    let toppled = caught(
        &scene(&[(Name::Theta, 1.2), (Name::ThetaDot, 6.0), (Name::ToppleAngle, 1.0)]),
        by(Strategy::BounceDown),
    );
    assert!(
        matches!(toppled.outcome, CatchOutcome::Ended { ending: Ending::Toppled { .. }, .. }),
        "{:?}",
        toppled.outcome
    );
    let far = caught(&scene(&[(Name::Theta, 1.3), (Name::ThetaDot, 1.0)]), by(Strategy::BounceDown));
    assert!(!far.outcome.is_caught(), "{:?}", far.outcome);
    let slow = caught(&scene(&[]), CatchSettings { hold_speed: 0.0, ..by(Strategy::BounceDown) });
    assert!(
        matches!(
            slow.outcome,
            CatchOutcome::Escaped { escape: Escape::TooManyStrikes(_) | Escape::NoLaw(_), .. } | CatchOutcome::Held
        ),
        "{:?}",
        slow.outcome
    );
}

#[test]
fn a_point_mass_and_a_caller_that_stops_get_no_catch() {
    let stopped = catch(&scene(&[]), &CatchSettings::default(), None, &mut || false);
    assert_eq!(stopped, Err(CatchFailure::Stopped));
    let mut point = Draft::default();
    point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    for (name, number) in [(Name::TiltGain, 1.1), (Name::Height, 0.2)] {
        point.set(name, Some(Value::Number(number))).unwrap();
    }
    let refused = catch(&point.build().unwrap(), &CatchSettings::default(), None, &mut || true);
    assert_eq!(refused, Err(CatchFailure::Point));
}

#[test]
fn a_plan_chooses_its_number_of_strikes_by_the_tilt_it_needs() {
    // Case 1's release: the fewest strikes with tilts within 0.25 rad.
    let chosen = caught(&scene(&[]), by(Strategy::Plan));
    let Approach::Plan { strikes, ratio } = chosen.approach else { panic!("{:?}", chosen.approach) };
    assert_eq!((chosen.outcome, chosen.strikes_reason), (CatchOutcome::Held, Some(StrikesReason::FewestWithin(0.25))));
    assert_eq!(chosen.strikes.len(), strikes as usize + 1);
    assert!(chosen.demand.load.tilt <= 0.25, "{:?}", chosen.demand);
    let named = |strikes| CatchSettings { strikes: Some(strikes), ratio: Some(ratio), ..by(Strategy::Plan) };
    let same = caught(&scene(&[]), named(strikes));
    assert_eq!((&same.strikes, same.strikes_reason), (&chosen.strikes, None));
    if strikes > 4 {
        let fewer = caught(&scene(&[]), named(strikes - 1));
        assert!(fewer.outcome != CatchOutcome::Held || fewer.demand.load.tilt > 0.25, "{:?}", fewer.demand);
    }
    // A table that tilts less needs more strikes.
    let stiff = caught(&scene(&[(Name::TiltLimit, 0.18)]), by(Strategy::Plan));
    assert!(matches!(stiff.approach, Approach::Plan { strikes: more, .. } if more >= strikes), "{:?}", stiff.approach);
    // One for which no number of strikes is enough tells the tilt that is missing.
    let rigid = caught(&scene(&[(Name::TiltLimit, 0.02)]), by(Strategy::Plan));
    assert!(
        matches!(rigid.outcome, CatchOutcome::Ended { ending: Ending::BeyondLimits(violation), .. } if violation.quantity == "tilt")
    );
}

#[test]
fn a_plan_learns_the_restitution_from_its_first_strike() {
    for friction in [0.0, 0.7] {
        for (actual, assumed) in [(0.6, 0.8), (0.9, 0.7), (0.4, 0.25)] {
            let fields = [(Name::Restitution, actual), (Name::AssumedRestitution, assumed), (Name::Friction, friction)];
            let catch = caught(&scene(&fields), by(Strategy::Plan));
            assert_eq!(catch.outcome, CatchOutcome::Held, "{fields:?}");
            let shown = catch.notes.iter().find_map(|note| match note {
                CatchNote::LearnedRestitution { assumed: before, shown } => Some((*before, *shown)),
                _ => None,
            });
            let (before, shown) = shown.unwrap();
            assert!(before == assumed && (shown - actual).abs() < 1e-9, "{shown} {actual}");
            // The first strike misses its ratio; the next ones reach it, and the stop ends in one strike.
            let ratios: Vec<f64> = catch.strikes.iter().map(CatchStrike::ratio).collect();
            let (stop, strikes) = ratios.split_last().unwrap();
            assert!((strikes[0] - 0.8).abs() > 0.05, "{ratios:?}");
            assert!(strikes[1..].iter().all(|ratio| (ratio - 0.8).abs() < 1e-6), "{ratios:?}");
            assert!(stop.abs() < 1e-6, "{ratios:?}");
        }
    }
    let right = caught(&scene(&[(Name::Restitution, 0.7)]), by(Strategy::Plan));
    assert!(!right.notes.iter().any(|note| matches!(note, CatchNote::LearnedRestitution { .. })), "{:?}", right.notes);
}

#[test]
fn a_belief_that_keeps_the_height_is_told_of() {
    // (1 + 0.98)(1 + 0.9)/(1 + 0.5) − 1 = 1.508.
    let fields = [(Name::Restitution, 0.9), (Name::AssumedRestitution, 0.5)];
    let catch = caught(&scene(&fields), CatchSettings { ratio: Some(0.98), ..by(Strategy::BounceDown) });
    assert!(!catch.outcome.is_caught(), "{:?}", catch.outcome);
    let told = catch
        .notes
        .iter()
        .any(|note| matches!(note, CatchNote::KeepsHeight { aimed: 0.98, reached } if (reached - 1.508).abs() < 1e-12));
    assert!(told, "{:?}", catch.notes);
    let low = caught(&scene(&fields), CatchSettings { ratio: Some(0.3), ..by(Strategy::BounceDown) });
    assert!(!low.notes.iter().any(|note| matches!(note, CatchNote::KeepsHeight { .. })), "{:?}", low.notes);
}

#[test]
fn a_stroke_is_known_once_the_table_has_moved() {
    let stopped = caught(&scene(&[(Name::SpeedLimit, 0.15)]), by(Strategy::BounceDown));
    assert!(!stopped.outcome.is_caught() && !stopped.demand.moves, "{:?}", stopped.demand);
    let held = caught(&scene(&[]), by(Strategy::BounceDown));
    assert!(held.demand.moves && held.demand.load.stroke > 0.0, "{:?}", held.demand);
}
