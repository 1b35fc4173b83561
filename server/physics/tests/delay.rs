//! A delay between sensing and strike, with and without prediction: against a simulation of its own, exact reductions to state feedback, and
//! closed forms of the height.

use crate::paper;
use crate::support::evidence::judged;
use crate::support::features::{Mix, Swing};
use crate::support::random;
use crate::support::rig_runs;
use equipoise_physics::analysis::gain_range::stable_gains;
use equipoise_physics::analysis::jacobian::jacobian_at;
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::analysis::repeating;
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::return_map::Y_DOT;
use equipoise_physics::analysis::return_map::{ReturnMap, Vector};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::map::strike::{EnergyFeedback, State};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use random::Random;
use rig_runs::{fed_back, gains, states, with};

fn predicting(scene: &Scene) -> Scene {
    let mut draft = scene.draft();
    draft.set(Name::Prediction, Some(Value::Choice("flight"))).unwrap();
    draft.build().unwrap()
}

fn largest_difference(one: &[[f64; 6]], other: &[[f64; 6]]) -> f64 {
    one.iter().flatten().zip(other.iter().flatten()).map(|(a, b)| (a - b).abs() / (1.0 + b.abs())).fold(0.0, f64::max)
}

#[test]
fn errors_of_velocities_grow_over_the_prediction() {
    let noisy = |delay: f64| {
        let values = [(Name::ThetaDotSd, 0.1), (Name::Delay, delay)];
        predicting(&with(paper::scene(1.1, 0.0).draft(), &values))
    };
    // The table of an upright rod stands still, so its first tilt is κτε.
    let tilt = |scene: &Scene| {
        let (_, strike) = scene.orbit().unwrap().foresee();
        strike.alpha
    };
    let one = tilt(&noisy(0.01));
    assert!(one != 0.0 && (tilt(&noisy(0.03)) - 3.0 * one).abs() < 1e-15);
    // A flight is the longest time over which anything can be predicted.
    let fall = noisy(0.01).orbit().unwrap().t();
    assert!((tilt(&noisy(0.9)) - fall / 0.01 * one).abs() < 1e-13);
}

#[test]
fn a_delay_is_a_feedback_of_velocities() {
    let mut random = Random::new(1813);
    for _ in 0..40 {
        let (kappa, delay) = (random.between(0.5, 1.6), random.size(1e-4, 0.02).abs());
        let ideal = paper::scene(kappa, random.size(0.01, 0.1)).draft();
        let late = with(ideal, &[(Name::Delay, delay)]);
        let fed = fed_back(ideal, [0.0, -kappa, 0.0, kappa * delay]);
        assert!(largest_difference(&states(&late, 12).0, &states(&fed, 12).0) < 1e-8, "{kappa} {delay}");
        let [x, theta, x_dot, theta_dot] = gains().map(|gain| gain * random.between(0.8, 1.2));
        let late = with(fed_back(ideal, [x, theta, x_dot, theta_dot]).draft(), &[(Name::Delay, delay)]);
        let fed = fed_back(ideal, [x, theta, x_dot - delay * x, theta_dot - delay * theta]);
        assert!(largest_difference(&states(&late, 40).0, &states(&fed, 40).0) < 1e-8, "{kappa} {delay}");
        let places = [&late, &fed].map(|scene| small_deviations(scene).unwrap().fixed_point);
        assert!((places[0].speed - places[1].speed).abs() < 1e-14);
        let radii = [&late, &fed].map(|scene| small_deviations(scene).unwrap().linear.spectral_radius());
        assert!((radii[0] - radii[1]).abs() < 1e-12, "{radii:?}");
        let [late_range, fed_range] = [&late, &fed].map(|scene| {
            let (map, bounce) = small_deviations(scene).unwrap().on_map(scene).unwrap();
            stable_gains(&map, &bounce).unwrap()
        });
        let apart = (late_range.upper - fed_range.upper).abs();
        assert!(late_range.upper == fed_range.upper || apart < 1e-8, "{late_range:?} {fed_range:?}");
        let (drift, same) = (
            small_deviations(&late).ok().and_then(|small| small.drift),
            small_deviations(&fed).ok().and_then(|small| small.drift),
        );
        assert_eq!((drift, same), (None, None));
    }
}

/// The swing loses and gains nothing on the ideal table; by the delay it gains (2Vl/ρ²)κτ a bounce.
#[test]
fn a_delay_feeds_every_swing() {
    let delay = 0.002;
    let scene = with(paper::scene(1.1, 0.001).draft(), &[(Name::Delay, delay)]);
    let place = small_deviations(&scene).unwrap().fixed_point;
    let linear = small_deviations(&scene).unwrap().linear;
    let rod = scene.parameters::<f64>();
    let turn = 2.0 * place.speed * rod.contact_distance / (rod.radius_of_gyration * rod.radius_of_gyration);
    let radius = linear.spectral_radius();
    assert!((radius * radius - (1.0 + turn * 1.1 * delay)).abs() < 1e-12, "{radius}");
    assert!(!linear.says_bounded() && linear.residue.is_none() && linear.critical_tilt_gain == f64::NEG_INFINITY);
    let run = run_nonlinear(&scene, 2000, || true).unwrap();
    assert!(
        matches!(run.ending, Ending::Toppled { .. } | Ending::Separating { .. } | Ending::Sinking { .. }),
        "{run:?}"
    );
    let found = judged(&scene, 2000);
    assert_eq!(found.verdict, Verdict::Unstable, "{found:?}");
    // Measured over the run while it is small.
    let (course, _) = states(&scene, 60);
    let grown: Vec<f64> =
        course.windows(12).map(|some| some.iter().map(|at| at[2].abs()).fold(0.0, f64::max)).collect();
    let rate = (grown[47] / grown[0]).powf(1.0 / 47.0);
    assert!((rate / radius - 1.0).abs() < 2e-3, "{rate} {radius}");
    // And K that has the delay in mind is the ideal one.
    let [x, theta, x_dot, theta_dot] = gains();
    let ideal = paper::scene(1.1, 0.1).draft();
    let minding = fed_back(ideal, [x, theta, x_dot + delay * x, theta_dot + delay * theta]);
    let minding = with(minding.draft(), &[(Name::Delay, delay)]);
    let fed = fed_back(ideal, [x, theta, x_dot, theta_dot]);
    assert!(largest_difference(&states(&minding, 100).0, &states(&fed, 100).0) < 1e-9);
    let radius_of = |scene: &Scene| small_deviations(scene).unwrap().linear.spectral_radius();
    assert!((radius_of(&minding) - radius_of(&fed)).abs() < 1e-12);
}

/// Scenes that steer the energy by what they sensed some time ago, with the law of one strike or a gain.
fn steering(random: &mut Random) -> Scene {
    let length = random.between(0.05, 0.3);
    let above = length * random.between(0.3, 1.5);
    let fall = (2.0 * above / 9.81).sqrt();
    let mut draft = with(
        Draft::default(),
        &[
            (Name::ContactDistance, length),
            (Name::RadiusOfGyration, length * random.between(0.3, 1.0)),
            (Name::Height, length + above * random.between(0.9, 1.2)),
            (Name::TiltGain, 1.2),
            (Name::Restitution, random.between(0.4, 1.0)),
            (Name::Delay, fall * random.between(0.001, 0.15)),
        ],
    )
    .draft();
    if random.between(0.0, 1.0) < 0.5 {
        draft.set(Name::AssumedRestitution, Some(Value::Number(random.between(0.4, 1.0)))).unwrap();
    }
    draft.set(Name::TargetHeight, Some(Value::Number(length + above))).unwrap();
    match random.between(0.0, 3.0) as u32 {
        0 => draft.set(Name::EnergyLaw, Some(Value::Choice("one_strike"))).unwrap(),
        kind => {
            draft.set(Name::EnergyGain, Some(Value::Number(random.between(0.1, 0.6) / (2.0 * 9.81 * above)))).unwrap();
            draft.set(Name::EnergyMeasure, Some(Value::Choice(["total", "vertical"][kind as usize - 1]))).unwrap();
        }
    }
    draft.build().unwrap()
}

/// Change of the speed by an upright bounce, m/s, and the derivative of the speed after it.
///
/// A body that comes down at u is sensed at û = u − Gτ, τ before the contact. With M = (1 − ê)/(1 + ê) and the missing energy ε₀ = G(y* − l) of a body
/// at rest the table rises at (M + κ_E(ε₀ − ½û²))û, so that u′ = eu + (1 + e)(M + κ_E(ε₀ − ½û²))û; with the law of one strike
/// u′ = eu + s(û + √C) − (1 + e)û, s = (1 + e)/(1 + ê), C = 2ε₀.
fn at_rest(scene: &Scene, speed: f64) -> (f64, f64) {
    let rod = scene.parameters::<f64>();
    let (e, assumed) = (rod.restitution, scene.assumed_restitution());
    let seen = speed - rod.gravity * scene.lag();
    let missing = rod.target_energy - rod.gravity * rod.contact_distance;
    let share = (1.0 + e) / (1.0 + assumed);
    if rod.energy_feedback == EnergyFeedback::OneStrike {
        let next = e * speed + share * (seen + (2.0 * missing).sqrt()) - (1.0 + e) * seen;
        return (next - speed, share - 1.0);
    }
    let gain = rod.strike_gain_per_energy;
    let rises = (1.0 + e) * (1.0 - assumed) / (1.0 + assumed);
    let next = e * speed + (rises + gain * (missing - 0.5 * seen * seen)) * seen;
    (next - speed, e + rises + gain * (missing - 1.5 * seen * seen))
}

#[test]
fn the_height_settles_where_the_cubic_says() {
    let mut random = Random::new(1814);
    let (mut settled, mut without) = (0, 0);
    for _ in 0..200 {
        let scene = steering(&mut random);
        let Ok(small) = small_deviations(&scene) else {
            without += 1;
            continue;
        };
        if small.fixed_point.x_dot != 0.0 || small.fixed_point.flight_time < scene.lag() {
            continue;
        }
        let speed = small.fixed_point.speed;
        let (off, eigenvalue) = at_rest(&scene, speed);
        assert!(off.abs() < 1e-9, "{off} {scene:?}");
        let model = scene.model();
        let start = State { theta: 0.0, x_dot: 0.0, y_dot: -speed, theta_dot: 0.0 };
        let linearized = jacobian_at(&model, 0.0, &start, 1).unwrap();
        assert!((linearized.end.y_dot + speed).abs() < 1e-12 * speed, "{scene:?}");
        assert!((linearized.matrix[(2, 2)] - eigenvalue).abs() < 1e-9, "{} {eigenvalue}", linearized.matrix[(2, 2)]);
        if eigenvalue.abs() < 0.95 {
            let (course, ending) = states(&scene, 600);
            assert_eq!(ending, Ending::Completed, "{scene:?}");
            let [.., y_dot, _] = course[599];
            assert!((y_dot + speed).abs() < 1e-9, "{y_dot} {speed} {scene:?}");
            settled += 1;
        }
    }
    assert!(settled > 100 && without < 60, "{settled} {without}");
}

#[test]
fn a_delay_may_be_longer_than_the_flights_or_let_the_height_sink() {
    let ideal = paper::scene(1.1, 0.1).draft();
    let place = small_deviations(&with(ideal, &[])).unwrap().fixed_point;
    // A delay of more than a flight: the motion that is planned before the last strike is part of the state.
    let long = with(ideal, &[(Name::Delay, 1.01 * place.flight_time), (Name::Theta, 0.0)]);
    assert_eq!(small_deviations(&long).unwrap().linear.eigenvalues.len(), 7);
    // A table that makes up the loss by an earlier speed makes up too little.
    let lossy = with(ideal, &[(Name::Delay, 0.01), (Name::Restitution, 0.7)]);
    let why = small_deviations(&lossy).unwrap_err();
    assert!(matches!(why, NoRepeatingBounce::Moves { change, .. } if change[Y_DOT] > 0.0), "{why}");
    let upright = with(lossy.draft(), &[(Name::Theta, 0.0)]);
    let (course, _) = states(&upright, 10);
    for pair in course.windows(2) {
        // u loses (1 − e)Gτ a bounce.
        assert!((pair[1][4] - pair[0][4] - 0.3 * 9.81 * 0.01).abs() < 1e-12);
    }
    assert!(matches!(states(&upright, 5000).1, Ending::Settled { .. } | Ending::Sinking { .. }));
}

/// The derivative of a table whose delay is longer than its flights: against differences of the map with 31 digits, and against the run.
#[test]
fn a_delay_longer_than_a_flight_adds_the_planned_motion_to_the_state() {
    let mut random = Random::new(5);
    let mut found = 0;
    while found < 40 {
        let mix = Mix::draw(
            &mut random,
            Swing::Calm,
            &["delay", "rotation drag", "matched friction", "feedback", "vertical energy"],
        );
        let scene = &mix.scene;
        let model = scene.model();
        let Ok(orbit) = scene.orbit() else { continue };
        let Ok(exact) = jacobian_at(&model, orbit.x(), orbit.state(), 2) else { continue };
        if exact.order.len() < 7 || exact.matrix.amax() > 100.0 {
            continue;
        }
        found += 1;
        let map = ReturnMap::new(&model, 2).planning();
        assert_eq!(exact.order, map.names());
        let at = map.planned(&map.vector(orbit.state(), orbit.x()));
        // The map goes where the run goes.
        let mut run = Orbit::at(model, Rules::BARE_MAP, *orbit.state()).moved(orbit.x());
        (0..2).for_each(|_| assert!(run.advance().ending.is_none()));
        let image = map.image(&at).unwrap();
        assert!((image[0] / model.rod.radius_of_gyration - run.state().theta).abs() < 1e-12, "{:?}", mix.features);
        for (column, &component) in map.components().iter().enumerate() {
            let end = |step: f64| {
                let mut start: Vector<DoubleDouble> = at.map(DoubleDouble::from);
                start[component] = start[component] + DoubleDouble::from(step);
                map.image(&start).unwrap()
            };
            let (ahead, behind) = (end(1e-10), end(-1e-10));
            for (row, &other) in map.components().iter().enumerate() {
                let slope = (ahead[other] - behind[other]).to_f64() / 2e-10;
                assert!((exact.matrix[(row, column)] - slope).abs() < 1e-8, "{:?} {row} {column}", mix.features);
            }
        }
    }
}

#[test]
fn a_repeating_bounce_is_found_for_a_delay_longer_than_the_flight() {
    let ideal = paper::scene(1.1, 0.0).draft();
    let scene = with(ideal, &[(Name::Delay, 0.4)]);
    let (map, bounce) = repeating::of_scene(&scene).unwrap();
    assert_eq!(map.components().len(), 7);
    let found = jacobian_at(&scene.model(), 0.0, &map.state(&bounce.at), 1).unwrap();
    assert!((found.matrix - &bounce.matrix).amax() < 1e-12);
}
