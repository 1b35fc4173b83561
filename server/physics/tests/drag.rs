//! Air that drags the body: flights against small steps of the equations of motion, the energy that it takes, and first contacts.

use equipoise_physics::analysis::evidence::{Evidence, judge};
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::linear_verdict::{AngleClass, LinearVerdict};
use equipoise_physics::analysis::margins::budget::find_budget;
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::map::flight::{AirDrag, Flight};
use equipoise_physics::map::polygon::Outline;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

use crate::paper;
use crate::support::features::{Mix, RANDOM, Swing, all_but};
use crate::support::random::Random;
use crate::support::turning::{contacts, number, numbers, turning, with};

/// Random scenes in air that drags the body, with or without noise.
fn scenes_in_air(seed: u64, noisy: bool) -> impl Iterator<Item = Scene> {
    let mut random = Random::new(seed);
    let features = all_but(if noisy { &[] } else { &RANDOM });
    let drawn = std::iter::repeat_with(move || Mix::draw(&mut random, Swing::Wide, &features));
    drawn.filter(|mix| mix.has(&["drag", "wind", "rotation drag"])).map(|mix| mix.scene)
}

/// The flight after a strike of a scene.
fn flight_after(scene: &Scene, contact: &Contact) -> Flight {
    let strike = contact.strike.unwrap();
    let rod = scene.parameters::<f64>();
    Flight { clearance: contact.clearance, drag: scene.running_model().drag, ..rod.flight(&strike) }
}

/// x, y, θ and their rates by the equations of motion: v̇ = g − c(v − u), θ̈ = −c_θθ̇.
fn rates([_, _, _, x_dot, y_dot, theta_dot]: [f64; 6], gravity: f64, drag: AirDrag) -> [f64; 6] {
    let along = -drag.linear * (x_dot - drag.wind);
    [x_dot, y_dot, theta_dot, along, -gravity - drag.linear * y_dot, -drag.rotational * theta_dot]
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
        let [linear, rotational] = [(); 2].map(|()| random.size(1e-6, 10.0).abs());
        let drag = AirDrag { linear, rotational, wind: random.size(0.01, 5.0) };
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
fn without_drag_nothing_changes_and_with_little_drag_little() {
    let ideal = paper::scene(1.1, 0.1);
    let none = with(&ideal, &[(Name::Drag, 0.0), (Name::RotationDrag, 0.0)]);
    assert!(none.model().is_plain_rod() && none.running_model().drag.is_none() && none.first_beyond_rod().is_none());
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
    let mut flights = 0;
    for scene in scenes_in_air(43, true).take(200) {
        let rho = scene.parameters::<f64>().radius_of_gyration;
        for contact in contacts(&scene, 10).0 {
            let Some(length) = contact.flight_time else { continue };
            let flight = flight_after(&scene, &contact);
            let AirDrag { linear, rotational, wind } = flight.drag.unwrap();
            let squares = |state: &State| {
                let State { x_dot, y_dot, theta_dot, .. } = *state;
                [x_dot * x_dot + y_dot * y_dot, rho * rho * theta_dot * theta_dot, wind * x_dot]
            };
            let energy = |t: f64| {
                let [place, turn, _] = squares(&flight.end(t));
                0.5 * (place + turn) + flight.gravity * flight.travel(t).1
            };
            // The power of the drag by Simpson's rule.
            const PARTS: u32 = 400;
            let power = |t: f64| {
                let [place, turn, carried] = squares(&flight.end(t));
                linear * (place - carried) + rotational * turn
            };
            let step = length / f64::from(PARTS);
            let taken: f64 = (0..=PARTS)
                .map(|part| {
                    let weight = if part == 0 || part == PARTS { 1.0 } else { f64::from(2 + 2 * (part % 2)) };
                    weight * power(f64::from(part) * step) * step / 3.0
                })
                .sum();
            let (before, after) = (energy(0.0), energy(length));
            let scale = 1.0 + before.abs() + taken.abs();
            assert!((before - after - taken).abs() < 1e-9 * scale, "{} {taken} {scene:?}", before - after);
            assert!(taken > 0.0 || wind != 0.0);
            flights += 1;
        }
    }
    assert!(flights > 500, "{flights}");
}

#[test]
fn contacts_of_runs_are_first_contacts() {
    let mut flights = 0;
    for scene in scenes_in_air(44, false).take(200) {
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
    assert!(flights > 500, "{flights}");
}

/// On a level table without friction, or one that moves along with the contact, all is as seen from a frame that moves with the air: ẋ and x
/// less those of the air are those of still air.
#[test]
fn a_wind_is_a_frame_that_moves_where_nothing_looks_at_the_place_or_its_speed() {
    let mut random = Random::new(46);
    let features = ["rotation drag", "vertical energy", "matched friction", "still", "incline", "delay"];
    let mut compared = 0;
    while compared < 3000 {
        let mix = Mix::draw(&mut random, Swing::Wide, &features);
        let (c, wind) = (random.size(1e-3, 3.0).abs(), random.size(0.01, 3.0));
        let level = with(&mix.scene, &[(Name::TiltGain, 0.0), (Name::Drag, c)]);
        let x_dot = level.start().x_dot;
        let blown = with(&level, &[(Name::Wind, wind), (Name::XDot, x_dot + wind)]);
        let ((still, ending), (moving, end)) = (contacts(&level, 10), contacts(&blown, 10));
        assert_eq!((ending.name(), still.len()), (end.name(), moving.len()), "{level:?}");
        for (still, moving) in still.iter().zip(&moving) {
            let [t, x, theta, x_dot, y_dot, theta_dot] = numbers(still);
            let wanted = [t, x + wind * t, theta, x_dot + wind, y_dot, theta_dot];
            for (found, wanted) in numbers(moving).into_iter().zip(wanted) {
                assert!((found - wanted).abs() < 1e-10 * (1.0 + wanted.abs()), "{found} {wanted}: {level:?}");
            }
            compared += 1;
        }
    }
}

#[test]
fn a_bounce_drifts_with_the_wind_and_leaves_a_table_with_ends() {
    let target = [(Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2), (Name::RotationDrag, 0.05)];
    let in_air = with(&paper::scene(1.1, 0.01), &[(Name::Drag, 0.05)]);
    let in_air = with(&in_air, &target);
    for wind in [-0.3, 0.02] {
        let blown = with(&in_air, &[(Name::Wind, wind)]);
        let judged = |scene: &Scene| {
            let run = run_nonlinear(scene, 100, || true).unwrap();
            judge(scene, &run, 2000, || true).unwrap()
        };
        let judgement = judged(&blown);
        let Evidence::Balances(balance) = &judgement.evidence else { panic!("{judgement:?}") };
        assert_eq!(judgement.verdict, Verdict::StableDrifting);
        assert!((balance.small.fixed_point.x_dot - wind).abs() < 1e-12, "{balance:?}");
        // Speeds and heights are those of still air.
        let Evidence::Balances(still) = judged(&in_air).evidence else { panic!() };
        assert!((balance.small.fixed_point.speed - still.small.fixed_point.speed).abs() < 1e-11, "{still:?}");
        let last = contacts(&blown, 2000).0.last().unwrap().state;
        assert!((last.x_dot - wind).abs() < 1e-6 && last.theta.abs() < 1e-6, "{last:?}");
        let ends = judged(&with(&blown, &[(Name::TableLength, 2.0)]));
        assert!(ends.verdict == Verdict::Unstable, "{ends:?}");
    }
}

#[test]
fn a_wind_needs_the_drag_of_place_and_does_nothing_without_its_effect() {
    let mut draft = paper::scene(1.1, 0.1).draft();
    draft.set(Name::Wind, Some(Value::Number(0.5))).unwrap();
    let errors = draft.build().unwrap_err();
    assert!(errors.len() == 1 && errors[0].path == "air.wind" && errors[0].detail.contains("air.drag"), "{errors:?}");
    let none = with(&paper::scene(1.1, 0.1), &[(Name::Drag, 0.0)]);
    draft.set(Name::Drag, Some(Value::Number(0.0))).unwrap();
    assert_eq!(draft.build().unwrap().running_model(), none.running_model());
    for scene in scenes_in_air(47, true).filter(|scene| scene.number(Name::Wind).is_none()).take(200) {
        let Some(_) = scene.number(Name::Drag) else { continue };
        assert_eq!(contacts(&scene, 10), contacts(&with(&scene, &[(Name::Wind, 0.0)]), 10));
    }
}

/// Heights of the other vertices of a polygon above y = 0, m, a time `t` (s) after the start of a flight.
fn vertex_heights(outline: &Outline, flight: &Flight, t: f64) -> Vec<f64> {
    let (sin, cos) = flight.end(t).theta.sin_cos();
    let centre = flight.gap(t).value + flight.contact_distance * cos;
    let others = outline.vertices().iter().enumerate().filter(|(vertex, _)| *vertex != outline.contact_vertex);
    others.map(|(_, [x, y])| centre + x * sin + y * cos).collect()
}

/// In a flight to a contact no other vertex comes down through y = 0, and one that ends a run is there at the time told.
#[test]
fn vertices_touch_when_the_run_says_so() {
    let mut random = Random::new(45);
    let (mut flights, mut touches) = (0, 0);
    while flights < 500 || touches < 20 {
        let mix = Mix::draw(&mut random, Swing::Wild, &["triangle", "drag", "rotation drag", "delay", "friction"]);
        let Some(outline) = mix.scene.outline().filter(|_| mix.scene.running_model().drag.is_some()) else { continue };
        let depth = 1e-8 * outline.contact_distance;
        let (course, ending) = contacts(&mix.scene, 20);
        for contact in &course {
            let Some(length) = contact.flight_time else { continue };
            let flight = flight_after(&mix.scene, contact);
            let heights = (0..=400).map(|part| vertex_heights(outline, &flight, length * f64::from(part) / 400.0));
            let heights: Vec<_> = heights.collect();
            for pair in heights.windows(2) {
                assert!(
                    pair[0].iter().zip(&pair[1]).all(|(one, next)| *one < depth || *next > -depth),
                    "{:?}",
                    mix.scene
                );
            }
            flights += 1;
        }
        let (Ending::OtherVertex(touch), Some(last)) = (ending, course.last()) else { continue };
        let Some(strike) = last.strike.filter(|_| touch.t > 0.0) else { continue };
        let flight = Flight { drag: mix.scene.running_model().drag, ..mix.scene.parameters::<f64>().flight(&strike) };
        let nearest = vertex_heights(outline, &flight, touch.t).into_iter().fold(f64::INFINITY, f64::min);
        assert!(nearest.abs() < depth && flight.gap(touch.t).value > -depth, "{nearest} {touch:?} {:?}", mix.scene);
        touches += 1;
    }
}

// Verdicts on bounces in air that drags the body: against the derivative of the map, against runs, and in their limits.

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
    assert_eq!(crate::support::scenes::judged(&scene, 500).verdict, Verdict::StableDrifting);
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
