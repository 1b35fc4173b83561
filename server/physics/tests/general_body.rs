//! Scenes beyond the plain rod: state feedback, assumed restitution and limits of the table.

use crate::paper;
use crate::support::rig_runs::{self, with_numbers};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

fn draft(values: &[(Name, f64)]) -> Draft {
    with_numbers(paper::scene(1.1, 0.3).draft(), values)
}

fn scene(values: &[(Name, f64)]) -> Scene {
    draft(values).build().unwrap()
}

/// The states at the first contacts.
fn states(scene: &Scene, impacts: u64) -> Vec<[f64; 6]> {
    rig_runs::states(scene, impacts).0
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
