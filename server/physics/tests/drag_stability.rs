//! Verdicts on bounces in air that drags the body: against the derivative of the map, against runs, and in their limits.

use crate::paper;
use crate::support::random;
use crate::support::turning as turning_scenes;
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::linear_verdict::{AngleClass, LinearVerdict};
use equipoise_physics::analysis::margins::budget::find_budget;
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use random::Random;
use turning_scenes::{contacts, number, turning, with};

/// A random rod in air whose table steers the energy, with a tilt gain at this share of the way from 1 to the critical one without air.
fn random_scene(random: &mut Random, share: f64) -> Scene {
    let length = random.between(0.05, 0.3);
    let rho = length * random.between(0.3, 1.0);
    let above = length * random.between(0.3, 1.5);
    let mut draft = Draft::default();
    for (name, value) in [
        (Name::ContactDistance, length),
        (Name::RadiusOfGyration, rho),
        (Name::Height, length + above),
        (Name::Theta, 0.001),
        (Name::Restitution, random.between(0.3, 1.0)),
        (Name::TiltGain, 1.0 + share * rho * rho / (2.0 * above * length)),
        (Name::TargetHeight, length + above),
        (Name::Drag, random.size(1e-3, 0.5).abs()),
        (Name::RotationDrag, random.size(1e-2, 0.5).abs()),
    ] {
        number(&mut draft, name, value);
    }
    match random.between(0.0, 4.0) as usize {
        0 => draft.set(Name::EnergyLaw, Some(Value::Choice("one_strike"))).unwrap(),
        law => {
            number(&mut draft, Name::EnergyGain, random.between(0.05, 0.6) / (2.0 * 9.81 * above));
            let measure = if law == 1 { "total" } else { "vertical" };
            draft.set(Name::EnergyMeasure, Some(Value::Choice(measure))).unwrap();
        }
    }
    draft.build().unwrap()
}

fn judged(scene: &Scene) -> (FixedPoint, LinearVerdict) {
    let place = small_deviations(scene).unwrap().fixed_point;
    (place, small_deviations(scene).unwrap().linear)
}

#[test]
fn verdicts_agree_with_runs() {
    let mut random = Random::new(53);
    let (mut stable, mut unstable) = (0, 0);
    for _ in 0..240 {
        let share = random.between(-0.3, 1.6);
        let mut draft = random_scene(&mut random, share).draft();
        // A linear verdict is of small deviations: the speed is not that of the fixed point yet, so a swing can grow at first.
        number(&mut draft, Name::Theta, 1e-6);
        let scene = draft.build().unwrap();
        let (_, linear) = judged(&scene);
        let radius = linear.spectral_radius();
        if radius > 0.99 && radius < 1.02 {
            continue;
        }
        let (course, ending) = contacts(&scene, 3000);
        let last = course.iter().rev().take(10).map(|contact| contact.state.theta.abs()).fold(0.0, f64::max);
        match linear.class {
            AngleClass::Attracting => {
                assert!(ending.name() == "completed" && last < 1e-9, "{radius} {last} {ending:?} {scene:?}");
                let height = course.last().unwrap().state.y_dot;
                assert!((height + judged(&scene).0.speed).abs() < 1e-9, "{scene:?}");
                stable += 1;
            }
            AngleClass::Hyperbolic => {
                assert!(ending.name() != "completed" || last > 0.01, "{radius} {last} {scene:?}");
                unstable += 1;
            }
            AngleClass::Elliptic | AngleClass::Parabolic => panic!("{linear:?}"),
        }
    }
    assert!(stable > 20 && unstable > 20, "{stable} {unstable}");
}

#[test]
fn the_critical_gain_is_where_an_eigenvalue_leaves_and_tends_to_that_without_air() {
    let mut random = Random::new(54);
    for _ in 0..60 {
        let scene = random_scene(&mut random, 0.4);
        let (_, linear) = judged(&scene);
        let at = |kappa: f64| judged(&with(&scene, &[(Name::TiltGain, kappa)])).1;
        let critical = linear.critical_tilt_gain;
        let (inside, outside) = (at(1.0 + (critical - 1.0) * (1.0 - 1e-6)), at(1.0 + (critical - 1.0) * (1.0 + 1e-6)));
        assert!(inside.class == AngleClass::Attracting && outside.class == AngleClass::Hyperbolic);
        assert!((at(critical).eigenvalues.iter().map(|value| value.re).fold(0.0, f64::min) + 1.0).abs() < 1e-9);
        assert!(at(1.0 - 1e-6).class == AngleClass::Hyperbolic && at(1.0 + 1e-6).class == AngleClass::Attracting);
        let none = judged(&with(&scene, &[(Name::Drag, 0.0), (Name::RotationDrag, 0.0)])).1;
        let little = judged(&with(&scene, &[(Name::Drag, 1e-9), (Name::RotationDrag, 1e-9)])).1;
        assert!((little.critical_tilt_gain - none.critical_tilt_gain).abs() < 1e-7 * none.critical_tilt_gain);
        assert!((little.energy_eigenvalue - none.energy_eigenvalue).abs() < 1e-7);
    }
}

#[test]
fn drag_of_place_alone_leaves_the_angle_circling() {
    let scene = with(&paper::scene(1.1, 0.1), &[(Name::Drag, 0.1), (Name::EnergyGain, 0.1), (Name::TargetHeight, 0.2)]);
    let (place, linear) = judged(&scene);
    assert_eq!(linear.class, AngleClass::Elliptic);
    assert!(linear.residue.is_some_and(|residue| residue > 0.0 && residue < 1.0) && linear.rotation.is_some());
    assert!(place.apex_height < 0.2 && place.apex_height > 0.19, "{place:?}");
    // A table that strikes harder than its restitution needs gives back what the air takes, and the height holds by itself.
    let air = [(Name::Drag, 0.05), (Name::RotationDrag, 0.05)];
    let harder = [(Name::Restitution, 0.9), (Name::AssumedRestitution, 0.85)];
    let harder = with(&paper::scene(1.1, 0.001), &[air, harder].concat());
    assert!(judged(&harder).1.energy_eigenvalue < 1.0);
}

#[test]
fn drag_of_rotation_alone_settles_on_a_height_below_that_of_the_release() {
    let ideal = paper::scene(1.1, 0.3);
    let scene = with(&ideal, &[(Name::RotationDrag, 0.5)]);
    let (place, linear) = judged(&scene);
    let (course, _) = contacts(&scene, 3000);
    assert!((course.last().unwrap().state.y_dot + place.speed).abs() < 1e-9);
    assert!(place.speed < small_deviations(&ideal).unwrap().fixed_point.speed);
    assert_eq!(linear.class, AngleClass::Attracting);
    assert_eq!(crate::support::evidence::judged(&scene, 500).verdict, Verdict::StableDrifting);
}

#[test]
fn bounces_that_nothing_feeds_have_no_fixed_point() {
    let ideal = paper::scene(1.1, 0.1);
    let braked = with(&ideal, &[(Name::Drag, 0.05), (Name::RotationDrag, 0.05)]);
    assert!(small_deviations(&braked).is_err());
    // A flight at the speed u takes 2cu²/(3G): the speed falls as 1/n.
    let (course, _) = contacts(&with(&braked, &[(Name::Theta, 0.0)]), 2000);
    let (first, last) = (-course[0].state.y_dot, -course[1999].state.y_dot);
    let expected = 1.0 / (1.0 / first + 2000.0 * 2.0 * 0.05 / (3.0 * 9.81));
    assert!((last / expected - 1.0).abs() < 0.02, "{last} {expected}");
    let rough = with(&braked, &[(Name::Friction, 0.1)]);
    let biased = with(&braked, &[(Name::AngleBias, 0.001)]);
    let low = with(&braked, &[(Name::EnergyGain, 0.1), (Name::TargetHeight, 0.1)]);
    let turns = turning(&braked, "follows", Some(0.1), 0.0).build().unwrap();
    for scene in [rough, biased, low, turns] {
        assert!(small_deviations(&scene).is_err(), "{scene:?}");
    }
}

#[test]
fn a_scene_that_names_the_air_has_lines_for_it_in_its_budget() {
    let steered = with(&paper::scene(1.1, 0.1), &[(Name::EnergyGain, 0.1), (Name::TargetHeight, 0.2)]);
    let lines = |scene: &Scene| {
        let found = find_budget(scene, 60, || true).unwrap();
        let of_air = found.errors.into_iter().filter(|error| [Name::Drag, Name::RotationDrag].contains(&error.name));
        of_air.collect::<Vec<_>>()
    };
    assert!(lines(&steered).is_empty());
    let named = lines(&with(&steered, &[(Name::Drag, 0.0)]));
    assert_eq!(named.len(), 2);
    for error in &named {
        let above = error.above.as_ref().unwrap();
        assert!(error.below.is_none() && above.value > 0.0, "{error:?}");
        let inside = with(&steered, &[(error.name, 0.99 * above.value)]);
        assert_eq!(run_nonlinear(&inside, 60, || true).unwrap().ending.name(), "completed");
    }
}
