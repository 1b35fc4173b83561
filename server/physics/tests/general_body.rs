//! Scenes beyond the plain rod: state feedback, assumed restitution and limits of the table.

use equipoise_physics::analysis::method::{RunMethod, run_by};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::body::{Body, Kick, Release};
use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::map::strike::Rod;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::capability::{CAPABILITIES, Lack, Need};
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::paper;
use crate::support::rig;
use crate::support::rig::{with_numbers, worded};
use crate::support::turning::turning;

fn draft(values: &[(Name, f64)]) -> Draft {
    with_numbers(paper::scene(1.1, 0.3).draft(), values)
}

fn scene(values: &[(Name, f64)]) -> Scene {
    draft(values).build().unwrap()
}

/// The states at the first contacts.
fn states(scene: &Scene, impacts: u64) -> Vec<[f64; 6]> {
    rig::states(scene, impacts).0
}

/// The loop of a plain rod has no other part of a body in it; a single contact asks for every part.
#[test]
fn the_loop_of_the_plain_rod_gives_the_bits_of_single_contacts() {
    for step in 0..200 {
        let share = f64::from(step) / 200.0;
        let mut values = vec![
            (Name::Theta, 0.6 * share - 0.3),
            (Name::ThetaDot, 2.0 - 3.0 * share),
            (Name::XDot, 0.3 * share),
            (Name::TiltGain, 0.8 + 0.5 * share),
        ];
        if step % 2 == 1 {
            let more = [(Name::Restitution, 0.7), (Name::EnergyGain, 0.2 * share), (Name::TargetHeight, 0.25)];
            values.extend(more);
        }
        let scene = scene(&values);
        assert!(scene.running_model().is_plain_rod());
        let (mut single, mut digits) = (scene.orbit().unwrap(), scene.extended_orbit().unwrap());
        run(&mut scene.orbit().unwrap(), 200, |contact| {
            let mut alone = single.advance();
            if contact.ending == Some(Ending::Completed) {
                (alone.ending, alone.flight_time) = (contact.ending, None);
            }
            assert_eq!(format!("{contact:?}"), format!("{alone:?}"), "{values:?}");
            true
        });
        run(&mut scene.extended_orbit().unwrap(), 20, |contact| {
            let alone = digits.advance();
            assert_eq!(format!("{:?}", contact.state), format!("{:?}", alone.state), "{values:?}");
            true
        });
    }
}

#[test]
fn feedback_of_the_angle_alone_is_the_tilt_gain() {
    let mut draft = draft(&[(Name::FeedbackTheta, -1.1)]);
    draft.set(Name::TiltGain, None).unwrap();
    let (by_gain, by_feedback) = (states(&scene(&[]), 50), states(&draft.build().unwrap(), 50));
    for (one, other) in by_gain.iter().zip(&by_feedback) {
        for (one, other) in one.iter().zip(other) {
            assert!((one - other).abs() < 1e-12, "{one} {other}");
        }
    }
}

#[test]
fn a_wrong_belief_shifts_the_height_that_the_energy_feedback_holds() {
    let wanted = 0.25;
    let values = |assumed| {
        vec![
            (Name::Restitution, 0.5),
            (Name::AssumedRestitution, assumed),
            (Name::EnergyGain, 0.165),
            (Name::TargetHeight, wanted),
            (Name::Theta, 0.02),
        ]
    };
    for assumed in [0.5, 0.48, 0.53] {
        let scene = scene(&values(assumed));
        let fixed_point = small_deviations(&scene).unwrap().fixed_point;
        let end = states(&scene, 3000).pop().unwrap();
        // The difference is of second order in the angle, which goes on circling.
        assert!(
            (end[4] + fixed_point.speed).abs() < 1e-3 * fixed_point.speed,
            "ê = {assumed}: {} {}",
            end[4],
            fixed_point.speed
        );
        // Where the strike gain is 2: κ_E(η* − η) = 2(ê − e)/((1 + e)(1 + ê)).
        let above = 2.0 * (0.5 - assumed) / (1.5 * (1.0 + assumed) * scene.number(Name::EnergyGain).unwrap() * 9.81);
        assert!((fixed_point.apex_height - wanted - above).abs() < 1e-12);
    }
}

#[test]
fn without_energy_feedback_a_wrong_belief_lets_the_height_drift_away() {
    let sinks = scene(&[(Name::Restitution, 0.5), (Name::AssumedRestitution, 0.55), (Name::Theta, 0.0)]);
    assert!(small_deviations(&sinks).is_err());
    let mut orbit = sinks.orbit().unwrap();
    let ending = run(&mut orbit, 100_000, |_| true).unwrap();
    assert!(matches!(ending, Ending::Settled { .. }), "{ending:?}");
    let grows = scene(&[(Name::Restitution, 0.5), (Name::AssumedRestitution, 0.45), (Name::Theta, 0.0)]);
    assert!(small_deviations(&grows).is_err());
    let speeds: Vec<f64> = states(&grows, 20).iter().map(|state| -state[4]).collect();
    // Upright: each strike multiplies the speed by γ − 1 with γ = 2(1 + e)/(1 + ê).
    let factor = 2.0 * 1.5 / 1.45 - 1.0;
    assert!(speeds.windows(2).all(|pair| (pair[1] / pair[0] - factor).abs() < 1e-12));
    // Beliefs have no part in a table that stands still.
    let mut still = draft(&[(Name::Restitution, 0.5), (Name::AssumedRestitution, 0.55)]);
    still.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
    assert_eq!(still.build().unwrap_err()[0].path, "table.assumed_restitution");
}

/// Upright, each strike multiplies the speed by γ − 1 + (1 + e)κ_E(E* − E), γ = 2(1 + e)/(1 + ê): below 1 for good where the
/// gain is negative and the bounce too low, or too small for what the table believes wrongly.
#[test]
fn an_energy_gain_that_does_not_make_up_the_loss_lets_the_run_settle() {
    let (e, wanted, g) = (0.5, 0.4, 9.81);
    for (energy_gain, assumed) in [(-0.1, e), (0.02, 1.0)] {
        let scene = scene(&[
            (Name::Restitution, e),
            (Name::AssumedRestitution, assumed),
            (Name::EnergyGain, energy_gain),
            (Name::TargetHeight, wanted),
            (Name::Theta, 0.0),
        ]);
        let mut orbit = scene.orbit().unwrap();
        let (mut t, mut speed) = (orbit.t(), -orbit.state().y_dot);
        while speed > 1e-20 {
            let missing = g * (wanted - 0.4 / 3.0) - 0.5 * speed * speed;
            speed *= 2.0 * (1.0 + e) / (1.0 + assumed) - 1.0 + (1.0 + e) * energy_gain * missing;
            t += 2.0 * speed / g;
        }
        let ending = run(&mut orbit, 100_000, |_| true).unwrap();
        let Ending::Settled { settle_time, .. } = ending else { panic!("κ_E = {energy_gain}: {ending:?}") };
        assert!((settle_time - t).abs() < 1e-12 * t, "κ_E = {energy_gain}: {settle_time} {t}");
        assert!(orbit.contacts() < 1000);
    }
}

/// e = 0 on a flat table that stands still: the contact point is left at ẏ_c = 0 exactly, whatever rounding makes of it, and is at
/// rest there.
#[test]
fn a_strike_that_gives_nothing_back_ends_the_run() {
    for step in 0..400 {
        let share = f64::from(step) / 400.0;
        let values = [
            (Name::Restitution, 0.0),
            (Name::TiltGain, 0.0),
            (Name::Theta, 2.0 * share - 1.0),
            (Name::ThetaDot, if step % 2 == 0 { 0.0 } else { 5.0 - 13.0 * share }),
            (Name::Friction, if step % 4 < 2 { 0.0 } else { 0.3 }),
        ];
        let mut draft = draft(&values);
        draft.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
        let scene = draft.build().unwrap();
        let mut orbit = scene.orbit().unwrap();
        let ending = run(&mut orbit, 20, |_| true).unwrap();
        assert!(
            matches!(ending, Ending::Settled { flight_time: 0.0, .. } | Ending::Toppled { .. }),
            "{values:?}: {ending:?}"
        );
        assert_eq!(orbit.contacts(), 1, "{values:?}: {ending:?}");
        let mut exact = scene.extended_orbit().unwrap();
        let with_more = orbit::run(&mut exact, 20, |contact| contact.n == 1);
        assert_eq!(with_more.map(Ending::name), Some(ending.name()), "{values:?}");
    }
}

#[test]
fn a_strike_beyond_the_limits_ends_the_run() {
    let free = scene(&[]);
    let mut tilts = Vec::new();
    run(&mut free.orbit().unwrap(), 200, |contact| {
        tilts.push(contact.alpha.abs());
        true
    });
    let largest = tilts.iter().copied().fold(0.0, f64::max);
    let ending = |limit: f64| {
        let scene = scene(&[(Name::TiltLimit, limit)]);
        let mut orbit = scene.orbit().unwrap();
        (run(&mut orbit, 200, |_| true).unwrap(), orbit.contacts())
    };
    assert_eq!(ending(largest), (Ending::Completed, 200));
    let limit = 0.9 * largest;
    let (ended, at) = ending(limit);
    assert_eq!(at as usize, 1 + tilts.iter().position(|&tilt| tilt > limit).unwrap());
    let Ending::BeyondLimits(excess) = ended else { panic!("{ended:?}") };
    assert_eq!((excess.quantity, excess.limit, excess.value), ("tilt", limit, tilts[at as usize - 1]));
}

// Kicks and changes of the table within a run: what follows is the run that would start from there.

const CASE_1: Rod = Rod::lossless(0.4 / 3.0, 0.094, 1.1);

const HOLDING: Rules =
    Rules { topple_angle: 1.5, settles: false, holds_energy: true, limits: None, half_length: f64::INFINITY };

fn at_contact_20() -> Orbit {
    let state = equipoise_physics::map::strike::State { theta: 0.05, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 };
    let mut orbit = Orbit::new(Body::plain(CASE_1), HOLDING, &Release { x: 0.0, height: 0.2, state }).unwrap();
    for _ in 1..20 {
        orbit.advance();
    }
    orbit
}

fn assert_same_run(mut orbit: Orbit, mut anew: Orbit) {
    for _ in 0..100 {
        let (contact, expected) = (orbit.advance(), anew.advance());
        assert_eq!((contact.state, contact.flight_time), (expected.state, expected.flight_time));
        assert_eq!(contact.ending, None);
    }
}

#[test]
fn a_kick_adds_to_the_velocities_after_the_strike() {
    let (mut plain, mut kicked) = (at_contact_20(), at_contact_20());
    let kick = Kick { x_dot: 0.01, y_dot: 0.2, theta_dot: -0.3 };
    let (before, after) = (plain.advance(), kicked.advance_kicked(kick));
    let (plain, struck) = (before.strike.unwrap(), after.strike.unwrap());
    assert_eq!(before.state, after.state);
    assert_eq!(struck.after.x_dot, plain.after.x_dot + 0.01);
    assert_eq!(struck.after.theta_dot, plain.after.theta_dot - 0.3);
    let rise = struck.after.y_dot + CASE_1.contact_distance * struck.after.theta_dot * struck.sin_cos_theta.0;
    assert!((struck.contact_rise - rise).abs() < 1e-15);
    assert!(after.flight_time > before.flight_time);
    // The energy that is held from here on is that with the kick.
    assert_same_run(kicked, Orbit::at(Body::plain(CASE_1), HOLDING, *kicked.state()));
}

#[test]
fn no_kick_is_no_kick() {
    let (mut plain, mut kicked) = (at_contact_20(), at_contact_20());
    let (plain, kicked) = (plain.advance(), kicked.advance_kicked(Kick::default()));
    assert_eq!(plain, kicked);
}

#[test]
fn a_kick_downwards_can_end_the_run() {
    let contact = at_contact_20().advance_kicked(Kick { y_dot: -5.0, ..Kick::default() });
    assert!(matches!(contact.ending, Some(Ending::Sinking { contact_rise }) if contact_rise < 0.0));
}

#[test]
fn another_table_is_in_force_from_the_coming_contact_on() {
    let mut orbit = at_contact_20();
    let (t, state) = (orbit.t(), *orbit.state());
    let table = Rod { tilt_gain: 1.2, ..CASE_1 };
    orbit.replace(Body::plain(table), HOLDING);
    assert_eq!((orbit.t(), *orbit.state(), orbit.contacts()), (t, state, 19));
    assert_same_run(orbit, Orbit::at(Body::plain(table), HOLDING, state));
}

#[test]
fn a_run_that_begins_to_lose_energy_settles() {
    let mut orbit = at_contact_20();
    let still = Rod { restitution: 0.5, tilt_gain: 0.0, strike_gain: 1.5, ..CASE_1 };
    orbit.replace(
        Body::plain(still),
        Rules { topple_angle: 1.5, settles: true, holds_energy: false, limits: None, half_length: f64::INFINITY },
    );
    let ending = (0..10_000).find_map(|_| orbit.advance().ending);
    assert!(matches!(ending, Some(Ending::Settled { .. } | Ending::Toppled { .. })), "{ending:?}");
}

// Fields that contradict each other: the scene is refused, and the errors name the fields.

fn draft_of(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Draft {
    worded(with_numbers(paper::scene(1.1, 0.1).draft(), numbers), words)
}

fn point(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Draft {
    let mut draft = with_numbers(Draft::default(), &[&[(Name::TiltGain, 0.5), (Name::Height, 0.2)], numbers].concat());
    draft.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    worded(draft, words)
}

#[test]
fn contradictions_are_refused_by_their_fields() {
    let planned = (Name::NoiseModel, "plan");
    let timing = (Name::TimingSd, 0.001);
    let about = turning(&paper::scene(1.1, 0.1), "follows", Some(0.0), 0.0);
    // Path of the error, and a word of its reason.
    let cases: [(Draft, &[(&str, &str)]); 8] = [
        (worded(with_numbers(about, &[timing]), &[planned]), &[("table.tilt_rate", "noise.model")]),
        (draft_of(&[(Name::SpeedError, 0.1)], &[(Name::Strike, "still")]), &[("table.errors.speed", "")]),
        (point(&[(Name::Offset, 0.1)], &[]), &[("body.offset", "point mass")]),
        (point(&[(Name::RotationDrag, 0.2)], &[]), &[("air.rotation_drag", "point mass")]),
        (point(&[(Name::ThetaDotSd, 0.1)], &[]), &[("noise.theta_dot_sd", "point mass")]),
        (
            point(&[(Name::FeedbackThetaDot, 0.1)], &[]),
            &[("table.tilt_gain", ""), ("table.feedback.theta_dot", "point mass")],
        ),
        (
            draft_of(&[(Name::EnergyGain, 0.1)], &[(Name::Strike, "still")]),
            &[("table.energy_gain", ""), ("table.target_height", "")],
        ),
        (
            draft_of(&[(Name::Restitution, 0.5), (Name::AssumedRestitution, 0.55)], &[(Name::Strike, "still")]),
            &[("table.assumed_restitution", "")],
        ),
    ];
    for (draft, expected) in cases {
        let errors = draft.build().err().unwrap_or_default();
        assert_eq!(errors.len(), expected.len(), "{errors:?}");
        for (error, (path, word)) in errors.iter().zip(expected) {
            assert!(error.path == *path && error.detail.contains(word), "{errors:?}");
        }
    }
}

#[test]
fn methods_that_do_not_know_a_rig_say_so() {
    let refused = |draft: Draft| run_by(&draft.build().unwrap(), RunMethod::Linear, 10, |_| true).unwrap_err();
    assert!(refused(draft_of(&[(Name::AngleBias, 0.002)], &[])).contains("table.errors.angle_bias"));
    assert!(refused(draft_of(&[(Name::TableLength, 0.5)], &[])).contains("table.length"));
    let beyond = |numbers: &[(Name, f64)]| draft_of(numbers, &[]).build().unwrap().first_beyond_rod();
    assert_eq!(beyond(&[(Name::AngleBias, 0.002)]), Some("table.errors.angle_bias"));
    assert!(beyond(&[(Name::TiltGainError, 0.1), (Name::SpeedError, 0.1)]).is_none(), "gains alone");
}

/// A scene for each need that it does not meet, with the field that says so. Nothing else of the table is missed.
#[test]
fn every_need_is_missed_by_a_scene_that_has_too_much() {
    let polygon = || {
        let mut polygon = draft_of(&[], &[]);
        for name in [Name::ContactDistance, Name::RadiusOfGyration] {
            polygon.set(name, None).unwrap();
        }
        polygon.set_vertices(Some(Vertices::new(&[[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]]).unwrap()));
        polygon
    };
    let total = [(Name::EnergyMeasure, "total")];
    let follows = [(Name::TiltRate, "follows")];
    let target = [(Name::EnergyGain, 0.2), (Name::TargetHeight, 0.25)];
    let missed: [(Need, Draft, &str); 12] = [
        (Need::Angle, point(&[], &[]), "body.point"),
        (Need::PlainRod, draft_of(&[(Name::Delay, 0.002)], &[]), "table.delay"),
        (Need::NoEndings, draft_of(&[(Name::TableLength, 1.0)], &[]), "table.length"),
        (Need::NoEndings, draft_of(&[(Name::SpeedLimit, 1.0)], &[]), "table.limits.speed"),
        (Need::NoEndings, polygon(), "body.vertices"),
        (Need::VerticalEnergy, draft_of(&target, &total), "table.energy_measure"),
        (Need::VerticalEnergy, draft_of(&target[1..], &[(Name::EnergyLaw, "one_strike")]), "table.energy_law"),
        (Need::PresentState, draft_of(&[(Name::Delay, 0.002)], &[]), "table.delay"),
        (Need::NoDragging, draft_of(&[(Name::Friction, 0.3), (Name::PivotDepth, 0.03)], &follows), "table.pivot.depth"),
        (Need::NoTurning, draft_of(&[(Name::PivotX, 0.02)], &follows), "table.tilt_rate"),
        (Need::NoAir, draft_of(&[(Name::RotationDrag, 0.1)], &[]), "air.rotation_drag"),
        (Need::NoFriction, draft_of(&[(Name::Friction, 0.3)], &[]), "contact.friction"),
    ];
    let plain = draft_of(&[], &[]).build().unwrap();
    let mut met = Vec::new();
    for (need, draft, path) in missed {
        let scene = draft.build().unwrap();
        for (analysis, needs) in CAPABILITIES.into_iter().filter(|(_, needs)| needs.contains(&need)) {
            assert_eq!(analysis.lack(&plain), None);
            let Lack { need: first, .. } = analysis.lack(&scene).unwrap();
            // An earlier need may be missed by the same scene.
            let place = |need| needs.iter().position(|other| *other == need).unwrap();
            assert!(place(first) <= place(need), "{analysis:?} {first:?} {need:?}");
        }
        let lacks = CAPABILITIES.into_iter().filter_map(|(analysis, _)| analysis.lack(&scene));
        assert!(lacks.into_iter().any(|lack| lack == Lack { need, path }), "{need:?}");
        met.push(need);
    }
    // That of a bounce that repeats is told by the map.
    met.push(Need::RepeatingBounce);
    for need in CAPABILITIES.into_iter().flat_map(|(_, needs)| needs) {
        assert!(met.contains(need), "{need:?}");
    }
}
