//! Constant errors of a rig and the ends of its table: against a simulation of its own, exact reductions, and closed forms of the drift.

use crate::paper;
use crate::support::rig_runs;
use equipoise_physics::analysis::jacobian::{eigenvalues, jacobian_at};
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::{ARC, X_DOT, Y_DOT};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::{Name, Scene};
use rig_runs::{gains, scene, states, with, with_numbers};

fn difference(one: &[[f64; 6]], other: &[[f64; 6]]) -> f64 {
    assert_eq!(one.len(), other.len());
    one.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The scene with feedback instead of its tilt gain, and more numbers.
fn fed_back(gains: [f64; 4], values: &[(Name, f64)]) -> Scene {
    rig_runs::fed_back(with_numbers(paper::scene(1.1, 0.1).draft(), values), gains)
}

#[test]
fn an_offset_is_a_longer_rod_whose_angle_is_sensed_wrong() {
    let (along, across) = (0.12_f64, 0.005_f64);
    let offset = scene(&[(Name::ContactDistance, along), (Name::Offset, across)]);
    let (length, lean) = (along.hypot(across), across.atan2(along));
    let longer = scene(&[(Name::ContactDistance, length), (Name::AngleBias, lean)]);
    assert!((offset.constant_tilt() - 1.1 * lean).abs() < 1e-16);
    let ((one, end), (other, same)) = (states(&offset, 40), states(&longer, 40));
    assert!(difference(&one, &other) < 1e-10, "{}", difference(&one, &other));
    assert_eq!(end.name(), same.name());
}

#[test]
fn an_error_of_the_gain_is_another_gain() {
    let (wrong, right) = (scene(&[(Name::TiltGainError, 0.25)]), scene(&[(Name::TiltGain, 1.1 * 1.25)]));
    assert_eq!(states(&wrong, 200), states(&right, 200));
    assert!(wrong.model().is_plain_rod(), "no constant tilt, so it stays the plain rod");
    assert_eq!(
        small_deviations(&wrong).map(|small| small.fixed_point),
        small_deviations(&right).map(|small| small.fixed_point)
    );
}

#[test]
fn an_error_of_the_speed_is_another_belief_and_another_energy_gain() {
    let (e, assumed, error, gain) = (0.5, 0.6, 0.2, 0.1);
    let energy = [(Name::Restitution, e), (Name::TargetHeight, 0.25)];
    let told = [(Name::AssumedRestitution, assumed), (Name::EnergyGain, gain), (Name::SpeedError, error)];
    let wrong = scene(&[&energy[..], &told].concat());
    let made_up = (1.0 + error) * (1.0 - assumed) / (1.0 + assumed);
    let effective = (1.0 - made_up) / (1.0 + made_up);
    let told = [(Name::AssumedRestitution, effective), (Name::EnergyGain, gain * (1.0 + error))];
    let right = scene(&[&energy[..], &told].concat());
    assert!(difference(&states(&wrong, 60).0, &states(&right, 60).0) < 1e-10);
    let (one, other) = (small_deviations(&wrong).unwrap().fixed_point, small_deviations(&right).unwrap().fixed_point);
    assert!((one.apex_height - other.apex_height).abs() < 1e-14);
    // Without energy feedback the height runs away.
    let fast = scene(&[(Name::Restitution, e), (Name::SpeedError, error)]);
    let why = small_deviations(&fast).unwrap_err();
    assert!(matches!(why, NoRepeatingBounce::Moves { change, .. } if change[Y_DOT] < 0.0), "{why}");
    // Where nothing is lost the table stands still, and its speed has no error.
    assert_eq!(states(&scene(&[(Name::SpeedError, error)]), 100), states(&scene(&[]), 100));
}

#[test]
fn a_bias_and_an_offset_that_cancel_leave_the_ideal_rig() {
    // All of these are exact in binary.
    let (kappa, bias) = (1.25, 1.0 / 256.0);
    let ideal = scene(&[(Name::TiltGain, kappa)]);
    let rig = scene(&[(Name::TiltGain, kappa), (Name::AngleBias, bias), (Name::TiltOffset, -kappa * bias)]);
    assert_eq!(rig.constant_tilt(), 0.0);
    assert_eq!(states(&rig, 300), states(&ideal, 300));
}

#[test]
fn a_bias_drives_the_body_aside_at_the_acceleration_of_its_lean() {
    let bias = 1e-4;
    let rig = scene(&[(Name::AngleBias, bias)]);
    let why = small_deviations(&rig).unwrap_err();
    let NoRepeatingBounce::Moves { at, change, flight_time } = why else { panic!("{why}") };
    let (theta, acceleration) = (at[ARC] / rig.model().rod.radius_of_gyration, change[X_DOT] / flight_time);
    assert!((theta + 1.1 * bias / 0.1).abs() < 1e-12, "θ* = −c/(κ − 1): {theta}");
    let closed = -rig.gravity() * theta.tan();
    assert!(
        (acceleration / closed - 1.0).abs() < 1e-5,
        "ẋ changes by −2V tan α in a flight of 2V/G: {acceleration} {closed}"
    );
    // Released at its lean, the body keeps it, and its drift grows with time.
    let (course, _) = states(&scene(&[(Name::AngleBias, bias), (Name::Theta, theta)]), 60);
    for [t, _, lean, x_dot, ..] in &course[1..] {
        assert!((lean - theta).abs() < 0.05 * theta.abs(), "{lean} {theta}");
        assert!((x_dot - acceleration * (t - course[0][0])).abs() < 0.01 * acceleration * t, "{x_dot} at {t} s");
    }
}

#[test]
fn feedback_of_the_place_takes_a_constant_tilt_back_farther_on() {
    let gain = gains();
    let (bias, offset) = (0.002, -0.0005);
    let tilt = offset - gain[1] * bias;
    let rig = fed_back(gain, &[(Name::AngleBias, bias), (Name::TiltOffset, offset)]);
    let place = small_deviations(&rig).unwrap().fixed_point;
    assert!((place.x - tilt / gain[0]).abs() < 1e-12, "x* = c/K_x: {}", place.x);
    let (course, ending) = states(&rig, 2000);
    let [_, x, theta, x_dot, _, theta_dot] = course[1999];
    assert_eq!(ending, Ending::Completed);
    assert!((x - place.x).abs() < 1e-9 && [theta, x_dot, theta_dot].iter().all(|it| it.abs() < 1e-9), "{x}");
    // The map is the ideal one, moved: its derivative is the same there.
    let ideal = fed_back(gain, &[]);
    let state = place.state();
    let moved = jacobian_at(&rig.model(), place.x, &state, 1).unwrap();
    let still = jacobian_at(&ideal.model(), 0.0, &state, 1).unwrap();
    assert!((moved.matrix.clone() - still.matrix).abs().max() < 1e-12);
    assert!(eigenvalues(&moved.matrix).unwrap().iter().all(|value| value.norm() < 1.0 + 1e-12));
    // On a table that ends before, there is no such bounce.
    let half_length = 0.95 * place.x.abs();
    let why = small_deviations(&with(rig.draft(), &[(Name::TableLength, 2.0 * half_length)])).unwrap_err();
    assert!(matches!(why, NoRepeatingBounce::BeyondTable { x, .. } if (x - place.x).abs() < 1e-12), "{why}");
}

#[test]
fn feedback_of_the_velocity_alone_drifts_at_the_speed_that_levels_the_table() {
    let gain = gains();
    // The same gains without x; the drift of x is left.
    let rig = fed_back([0.0, gain[1], gain[2], gain[3]], &[(Name::TiltOffset, 1e-3)]);
    let small = small_deviations(&rig).unwrap();
    let (place, speed) = (small.fixed_point, 1e-3 / gain[2]);
    assert!(small.drifts && small.drift.is_none(), "nothing but the table keeps it");
    assert!((place.x_dot - speed).abs() < 1e-12, "ẋ* = c/K_ẋ: {place:?}");
    let (course, ending) = states(&rig, 3000);
    let [.., x_dot, _, _] = course[2999];
    assert!(ending == Ending::Completed && (x_dot - speed).abs() < 1e-6 * speed.abs(), "{x_dot} {speed}");
}

#[test]
fn a_run_ends_at_the_first_contact_beyond_the_table() {
    let endless = scene(&[(Name::AngleBias, 0.002)]);
    let length = endless.number(Name::ContactDistance).unwrap();
    let (course, _) = states(&endless, 60);
    let place = |[_, x, theta, ..]: &[f64; 6]| x + length * theta.sin();
    for half in [0.005, 0.02, 0.1, 0.2] {
        let (short, ending) = states(&with(endless.draft(), &[(Name::TableLength, 2.0 * half)]), 60);
        let first = course.iter().position(|contact| place(contact).abs() > half).unwrap();
        assert_eq!(short, course[..=first]);
        let Ending::OffTable { place: found, limit } = ending else { panic!("{ending:?}") };
        assert_eq!(limit, half);
        assert!((found - place(&course[first])).abs() < 1e-15);
    }
    // A body that has fallen over has done so wherever it is; the table's other limits come after its ends.
    let ended = |values: &[(Name, f64)]| states(&scene(values), 10).1.name();
    let off = [(Name::X, 1.0), (Name::TableLength, 0.5), (Name::TiltLimit, 0.0)];
    assert_eq!(ended(&off), "off_table");
    assert_eq!(ended(&[&off[..], &[(Name::ToppleAngle, 0.05)]].concat()), "toppled");
}
