//! Verdicts on bounces in air that drags the body: against the derivative of the map, against runs, and in their limits.

use crate::paper;
use crate::support::random;
use crate::support::turning as turning_scenes;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use equipoise_physics::stability::fixed_point::{FixedPoint, find_fixed_point};
use equipoise_physics::stability::jacobian::{eigenvalues, jacobian_at, modulus};
use equipoise_physics::stability::linear_verdict::{AngleClass, LinearVerdict, linear_verdict};
use equipoise_physics::stability::margins::budget::find_budget;
use equipoise_physics::stability::nonlinear_run::run_nonlinear;
use equipoise_physics::stability::verdict::{HigherOrder, Verdict, assess};
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
    let place = find_fixed_point(scene).unwrap();
    (place, linear_verdict(scene, &place))
}

/// Asserts that a bounce from the fixed point ends there, and that the derivative there has the eigenvalues of the verdict.
fn assert_exact(scene: &Scene) {
    let (place, linear) = judged(scene);
    let mut orbit = Orbit::at(scene.model(), Rules::BARE_MAP, place.state()).moved(place.x);
    let flight = orbit.advance().flight_time.unwrap();
    assert!((orbit.state().y_dot + place.speed).abs() < 1e-12 * place.speed, "{:?} {place:?}", orbit.state());
    assert!((flight - place.flight_time).abs() < 1e-12 * flight);
    let derivative = jacobian_at(&scene.model(), place.x, &place.state(), 1).unwrap();
    let mut own = eigenvalues(&derivative.matrix).unwrap();
    let mut told = linear.eigenvalues.clone();
    if linear.closed_loop.is_some() {
        told.push(linear.energy_eigenvalue.into());
    }
    let order =
        |a: &nalgebra::Complex<f64>, b: &nalgebra::Complex<f64>| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im));
    own.sort_by(order);
    told.sort_by(order);
    assert_eq!(own.len(), told.len(), "{own:?} {told:?}");
    for (own, told) in own.iter().zip(&told) {
        // A nearly double eigenvalue is known to the square root of rounding.
        assert!(modulus(own - told) < 1e-6, "{own} {told} {scene:?}");
    }
}

#[test]
fn the_fixed_point_repeats_and_its_eigenvalues_are_those_of_the_derivative() {
    let mut random = Random::new(51);
    for _ in 0..300 {
        let share = random.between(-0.5, 1.5);
        assert_exact(&random_scene(&mut random, share));
    }
    let plain = random_scene(&mut random, 0.4);
    // A table that strikes harder than its restitution needs gives back what the air takes.
    let harder = {
        let mut draft = with(&paper::scene(1.1, 0.001), &[(Name::Drag, 0.05), (Name::RotationDrag, 0.05)]).draft();
        number(&mut draft, Name::Restitution, 0.9);
        number(&mut draft, Name::AssumedRestitution, 0.85);
        draft.build().unwrap()
    };
    assert_exact(&harder);
    assert!(judged(&harder).1.energy_eigenvalue < 1.0, "the height holds by itself");
    let mut matched = plain.draft();
    number(&mut matched, Name::Friction, 0.4);
    if plain.value(Name::EnergyLaw).is_none() {
        matched.set(Name::Slide, Some(Value::Choice("matched"))).unwrap();
        assert_exact(&matched.build().unwrap());
    }
}

#[test]
fn state_feedback_in_air_has_the_closed_loop_of_the_derivative() {
    let mut random = Random::new(52);
    for _ in 0..60 {
        let scene = random_scene(&mut random, 0.4);
        let mut draft = scene.draft();
        let kappa = scene.number(Name::TiltGain).unwrap();
        draft.set(Name::TiltGain, None).unwrap();
        for (name, gain) in [
            (Name::FeedbackX, random.size(0.01, 0.2)),
            (Name::FeedbackTheta, -kappa),
            (Name::FeedbackXDot, random.size(0.001, 0.05)),
            (Name::FeedbackThetaDot, random.size(0.0001, 0.005)),
            (Name::AngleBias, 0.002),
        ] {
            number(&mut draft, name, gain);
        }
        assert_exact(&draft.build().unwrap());
    }
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
    assert_exact(&scene);
}

#[test]
fn drag_of_rotation_alone_settles_on_a_height_below_that_of_the_release() {
    let ideal = paper::scene(1.1, 0.3);
    let scene = with(&ideal, &[(Name::RotationDrag, 0.5)]);
    let (place, linear) = judged(&scene);
    let (course, _) = contacts(&scene, 3000);
    assert!((course.last().unwrap().state.y_dot + place.speed).abs() < 1e-9);
    assert!(place.speed < find_fixed_point(&ideal).unwrap().speed);
    assert_eq!(linear.class, AngleClass::Attracting);
    let run = run_nonlinear(&scene, 500, || true).unwrap();
    let higher = HigherOrder::of(&scene, &place, &linear);
    assert_eq!(assess(&scene, &place, &linear, &higher, &run, None).verdict, Verdict::StableDrifting);
}

#[test]
fn bounces_that_nothing_feeds_have_no_fixed_point() {
    let ideal = paper::scene(1.1, 0.1);
    let why = |scene: &Scene| find_fixed_point(scene).unwrap_err();
    let braked = with(&ideal, &[(Name::Drag, 0.05), (Name::RotationDrag, 0.05)]);
    assert!(why(&braked).contains("air.drag") && why(&braked).contains("no bounce repeats"));
    // A flight at the speed u takes 2cu²/(3G): the speed falls as 1/n.
    let (course, _) = contacts(&with(&braked, &[(Name::Theta, 0.0)]), 2000);
    let (first, last) = (-course[0].state.y_dot, -course[1999].state.y_dot);
    let expected = 1.0 / (1.0 / first + 2000.0 * 2.0 * 0.05 / (3.0 * 9.81));
    assert!((last / expected - 1.0).abs() < 0.02, "{last} {expected}");
    let rough = with(&braked, &[(Name::Friction, 0.1)]);
    assert!(why(&rough).contains("friction"));
    let biased = with(&braked, &[(Name::AngleBias, 0.001)]);
    assert!(why(&biased).contains("not derived in air"));
    let negative = with(&braked, &[(Name::EnergyGain, -0.01), (Name::TargetHeight, 0.2)]);
    assert!(why(&negative).contains("negative"));
    let low = with(&braked, &[(Name::EnergyGain, 0.1), (Name::TargetHeight, 0.1)]);
    assert!(why(&low).contains("target_height"), "{}", why(&low));
    assert!(turning(&braked, "follows", Some(0.1), 0.0).build().is_err());
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
