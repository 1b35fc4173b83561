//! Air that drags the body: flights against small steps of the equations of motion, runs against a simulation from Newton's and Euler's
//! equations, exact identities, and other methods of the same run.

use crate::paper;
use crate::support::methods;
use crate::support::mixes;
use crate::support::random;
use crate::support::rig_runs;
use crate::support::turning as turning_scenes;
use equipoise_physics::bounce::flight::{AirDrag, Flight};
use equipoise_physics::bounce::strike::State;
use equipoise_physics::run::method::{RunMethod, run_by};
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::model_hierarchy::run_hierarchy;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use methods::{compare_bounds, compare_derivatives, numbers};
use mixes::{MIXES, Parts, scene as mixed};
use random::Random;
use rig_runs::hold_to_simulation;
use turning_scenes::{contacts, number, turning, with};

/// A random scene in air that drags it, of any kind but planning and late ones.
fn random_scene(random: &mut Random, parts: Parts) -> Scene {
    let scene = mixed(random, parts);
    let mut draft = scene.draft();
    let which = random.between(0.0, 3.0) as usize;
    if which != 1 {
        number(&mut draft, Name::Drag, random.size(1e-3, 3.0).abs());
    }
    if which != 0 {
        number(&mut draft, Name::RotationDrag, random.size(1e-3, 3.0).abs());
    }
    draft.build().unwrap()
}

/// Mixes of the parts that go with air.
fn mixes_in_air() -> impl Iterator<Item = Parts> {
    let plain = Parts::default();
    MIXES.into_iter().chain([plain]).filter(|parts| parts.noise != Some("plan") && !parts.late)
}

/// The flight after a strike of a scene.
fn flight_after(scene: &Scene, contact: &Contact) -> Flight {
    let strike = contact.strike.unwrap();
    let rod = scene.parameters::<f64>();
    Flight { clearance: contact.clearance, drag: scene.drag(), ..rod.flight(&strike) }
}

/// x, y, θ and their rates by the equations of motion: v̇ = g − cv, θ̈ = −c_θθ̇.
fn rates([_, _, _, x_dot, y_dot, theta_dot]: [f64; 6], gravity: f64, drag: AirDrag) -> [f64; 6] {
    [x_dot, y_dot, theta_dot, -drag.linear * x_dot, -gravity - drag.linear * y_dot, -drag.rotational * theta_dot]
}

/// Steps of fourth order (Runge and Kutta).
fn stepped(mut at: [f64; 6], t: f64, gravity: f64, drag: AirDrag) -> [f64; 6] {
    const STEPS: u32 = 2000;
    let h = t / f64::from(STEPS);
    let moved = |at: [f64; 6], rate: [f64; 6], by: f64| std::array::from_fn(|i| at[i] + by * rate[i]);
    for _ in 0..STEPS {
        let first = rates(at, gravity, drag);
        let second = rates(moved(at, first, 0.5 * h), gravity, drag);
        let third = rates(moved(at, second, 0.5 * h), gravity, drag);
        let fourth = rates(moved(at, third, h), gravity, drag);
        at = std::array::from_fn(|i| at[i] + h / 6.0 * (first[i] + 2.0 * second[i] + 2.0 * third[i] + fourth[i]));
    }
    at
}

#[test]
fn flights_in_closed_form_follow_the_equations_of_motion() {
    let mut random = Random::new(41);
    for _ in 0..300 {
        let start = State {
            theta: random.between(-3.0, 3.0),
            x_dot: random.size(0.01, 5.0),
            y_dot: random.size(0.01, 5.0),
            theta_dot: random.size(0.01, 10.0),
        };
        let gravity = random.size(0.1, 10.0).abs();
        let drag = AirDrag { linear: random.size(1e-6, 10.0).abs(), rotational: random.size(1e-6, 10.0).abs() };
        let length = random.between(0.05, 0.5);
        let sin_cos_theta = start.theta.sin_cos();
        let flight =
            Flight { start, sin_cos_theta, clearance: 0.3, contact_distance: length, gravity, drag: Some(drag) };
        let t = random.size(0.01, 2.0).abs();
        let [x, y, theta, x_dot, y_dot, theta_dot] =
            stepped([0.0, 0.0, start.theta, start.x_dot, start.y_dot, start.theta_dot], t, gravity, drag);
        let (end, (way, rise), gap) = (flight.end(t), flight.travel(t), flight.gap(t));
        let height = 0.3 + length * start.theta.cos() + y - length * theta.cos();
        let slope = y_dot + length * theta_dot * theta.sin();
        let bend = -gravity - drag.linear * y_dot
            + length * (theta_dot * theta_dot * theta.cos() - drag.rotational * theta_dot * theta.sin());
        for (ours, theirs) in [
            (end.theta, theta),
            (end.x_dot, x_dot),
            (end.y_dot, y_dot),
            (end.theta_dot, theta_dot),
            (way, x),
            (rise, y),
            (gap.value, height),
            (gap.slope, slope),
            (gap.bend, bend),
        ] {
            assert!((ours - theirs).abs() < 1e-10 * (1.0 + theirs.abs()), "{ours} {theirs} after {t}: {flight:?}");
        }
    }
}

#[test]
fn bodies_in_air_move_as_newton_and_euler_say() {
    let mut random = Random::new(42);
    let (mut compared, mut moved) = (0, 0.0_f64);
    for _ in 0..300 {
        let length = random.between(0.05, 0.3);
        let rho = length * random.between(0.3, 1.0);
        let above = length * random.between(0.3, 1.5);
        let kappa = 1.0 + random.between(0.1, 0.9) * rho * rho / (2.0 * above * length);
        let mut draft = Draft::default();
        for (name, value) in [
            (Name::ContactDistance, length),
            (Name::RadiusOfGyration, rho),
            (Name::Height, length + above),
            (Name::Theta, random.size(0.01, 0.2)),
            (Name::ThetaDot, random.size(0.01, 1.0)),
            (Name::XDot, random.size(0.001, 0.2)),
            (Name::X, random.size(0.001, 0.2)),
            (Name::Restitution, random.between(0.3, 1.0)),
            (Name::Incline, random.between(0.2, 1.5)),
            (Name::AngleBias, random.size(1e-4, 0.01)),
            (Name::TiltGain, kappa),
            (Name::EnergyGain, random.between(0.05, 0.6) / (2.0 * 9.81 * above)),
            (Name::TargetHeight, length + above * random.between(0.8, 1.3)),
            (Name::Drag, random.size(1e-3, 5.0).abs()),
            (Name::RotationDrag, random.size(1e-3, 5.0).abs()),
        ] {
            number(&mut draft, name, value);
        }
        let scene = draft.build().unwrap();
        let (course, _) = contacts(&scene, 12);
        let found: Vec<_> = course.iter().map(numbers).collect();
        compared += hold_to_simulation(&found, &scene, 1e-8);
        let (ideal, _) = contacts(&with(&scene, &[(Name::Drag, 0.0), (Name::RotationDrag, 0.0)]), 12);
        moved = course.iter().zip(&ideal).map(|(a, b)| (a.state.y_dot - b.state.y_dot).abs()).fold(moved, f64::max);
    }
    assert!(compared > 1500 && moved > 0.5, "{compared} contacts, moved by {moved} m/s");
}

#[test]
fn without_drag_nothing_changes_and_with_little_drag_little() {
    let ideal = paper::scene(1.1, 0.1);
    let none = with(&ideal, &[(Name::Drag, 0.0), (Name::RotationDrag, 0.0)]);
    assert!(none.model().is_plain_rod() && none.drag().is_none() && none.beyond(&[]).is_none());
    let (still, ending) = contacts(&ideal, 300);
    let (same, other) = contacts(&none, 300);
    assert_eq!(ending.name(), other.name());
    assert!(still.iter().zip(&same).all(|(one, other)| numbers(one) == numbers(other)));
    // The difference is that of the drag and no other: it shrinks with it.
    let mut last = f64::INFINITY;
    for rate in [1e-4, 1e-7, 1e-10, 1e-300] {
        let (course, _) = contacts(&with(&ideal, &[(Name::Drag, rate), (Name::RotationDrag, rate)]), 20);
        assert_eq!(course.len(), 20);
        let pairs = still.iter().zip(&course).flat_map(|(one, other)| numbers(one).into_iter().zip(numbers(other)));
        let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 1000.0 * rate + 1e-12 && most < last, "{rate}: {most}");
        last = most;
    }
}

#[test]
fn the_air_takes_the_energy_that_the_body_loses() {
    let mut random = Random::new(43);
    let mut flights = 0;
    for parts in mixes_in_air() {
        for _ in 0..20 {
            let scene = random_scene(&mut random, parts);
            let rho = scene.parameters::<f64>().radius_of_gyration;
            for contact in contacts(&scene, 10).0 {
                let Some(length) = contact.flight_time else { continue };
                let flight = flight_after(&scene, &contact);
                let AirDrag { linear, rotational } = flight.drag.unwrap();
                let squares = |state: &State| {
                    let State { x_dot, y_dot, theta_dot, .. } = *state;
                    (x_dot * x_dot + y_dot * y_dot, rho * rho * theta_dot * theta_dot)
                };
                let energy = |t: f64| {
                    let (place, turn) = squares(&flight.end(t));
                    0.5 * (place + turn) + flight.gravity * flight.travel(t).1
                };
                // The power of the drag by Simpson's rule.
                const PARTS: u32 = 400;
                let power = |t: f64| {
                    let (place, turn) = squares(&flight.end(t));
                    linear * place + rotational * turn
                };
                let step = length / f64::from(PARTS);
                let taken: f64 = (0..=PARTS)
                    .map(|part| {
                        let weight = if part == 0 || part == PARTS { 1.0 } else { f64::from(2 + 2 * (part % 2)) };
                        weight * power(f64::from(part) * step) * step / 3.0
                    })
                    .sum();
                let (before, after) = (energy(0.0), energy(length));
                let scale = 1.0 + before.abs() + taken;
                assert!((before - after - taken).abs() < 1e-9 * scale, "{} {taken} {scene:?}", before - after);
                assert!(taken > 0.0);
                flights += 1;
            }
        }
    }
    assert!(flights > 500, "{flights}");
}

#[test]
fn contacts_of_runs_are_first_contacts() {
    let mut random = Random::new(44);
    let mut flights = 0;
    for parts in mixes_in_air().filter(|parts| parts.noise.is_none()) {
        for _ in 0..40 {
            let scene = random_scene(&mut random, parts);
            for contact in contacts(&scene, 20).0 {
                let Some(length) = contact.flight_time else { continue };
                let flight = flight_after(&scene, &contact);
                let size = flight.contact_distance + flight.start.y_dot.abs() * length;
                for sample in 1..1000 {
                    let gap = flight.gap(length * f64::from(sample) / 1000.0);
                    assert!(gap.value > -1e-14 * size, "{gap:?} {scene:?}");
                }
                let end = flight.gap(length);
                assert!(end.value.abs() < 1e-13 * size && end.slope < 0.0, "{end:?} {scene:?}");
                flights += 1;
            }
        }
    }
    assert!(flights > 500, "{flights}");
}

#[test]
fn the_derivative_has_the_drag_in_it() {
    let mut random = Random::new(45);
    let mut compared = 0;
    for parts in mixes_in_air().filter(|parts| parts.noise.is_none()) {
        compared += compare_derivatives((0..40).map(|_| random_scene(&mut random, parts)));
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn error_bounds_hold_against_runs_with_31_digits() {
    let mut random = Random::new(46);
    for parts in mixes_in_air() {
        compare_bounds((0..30).map(|_| random_scene(&mut random, parts)));
    }
}

#[test]
fn the_ladder_has_a_level_for_drag() {
    let rough = with(&paper::scene(1.1, 0.1), &[(Name::Friction, 0.05), (Name::AngleBias, 0.001)]);
    let scene = with(&rough, &[(Name::Drag, 0.2), (Name::RotationDrag, 0.1)]);
    let steps = run_hierarchy(&scene, 20, || true).unwrap();
    let levels: Vec<_> = steps.iter().map(|step| step.level).collect();
    use ModelLevel::{Drag, Friction, Linear, RigErrors, Rod};
    assert_eq!(levels, [Linear, Rod, RigErrors, Drag, Friction]);
    assert_eq!(steps[3].requirement.as_ref().unwrap().path, "air.drag");
    assert!(steps[2].scene.unwrap().drag().is_none() && steps[3].scene.unwrap().drag().is_some());
    let change = steps[3].run.as_ref().unwrap().change.unwrap();
    assert!(change.y_dot.value > 1e-3, "{change:?}");
    assert!(scene.rules().settles && !scene.rules().holds_energy);
    assert!(run_by(&scene, RunMethod::Linear, 10, |_| true).is_err());
}

#[test]
fn drag_that_is_not_derived_is_refused_by_its_field() {
    let paths = |draft: Draft| {
        let errors = draft.build().unwrap_err();
        errors.into_iter().map(|error| (error.path, error.detail)).collect::<Vec<_>>()
    };
    let ideal = with(&paper::scene(1.1, 0.1), &[(Name::Drag, 0.2)]);
    let mut late = ideal.draft();
    number(&mut late, Name::Delay, 0.01);
    let mut plans = ideal.draft();
    number(&mut plans, Name::TimingSd, 0.001);
    plans.set(Name::NoiseModel, Some(Value::Choice("plan"))).unwrap();
    let mut point = Draft::default();
    number(&mut point, Name::TiltGain, 0.5);
    number(&mut point, Name::Height, 0.2);
    number(&mut point, Name::Drag, 0.2);
    point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    let turned = turning(&ideal, "follows", Some(0.1), 0.05);
    let refusals = [(late, "table.delay"), (plans, "noise.model"), (point, "point mass"), (turned, "table.tilt_rate")];
    for (draft, word) in refusals {
        let errors = paths(draft);
        assert!(errors.len() == 1 && errors[0].0 == "air.drag" && errors[0].1.contains(word), "{errors:?}");
    }
    let mut turned = ideal.draft();
    number(&mut turned, Name::Drag, 0.0);
    number(&mut turned, Name::RotationDrag, 0.2);
    number(&mut turned, Name::Delay, 0.01);
    assert_eq!(paths(turned)[0].0, "air.rotation_drag");
}
