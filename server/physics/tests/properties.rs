//! Properties of every scene, each held over random mixes of features (`support/features.rs`): the motion against a simulation from Newton's
//! and Euler's equations, symmetry, the derivative, runs with 31 digits, fixed points. The ladder of models is in `model_hierarchy.rs`.

use std::collections::{BTreeMap, BTreeSet};

use equipoise_physics::analysis::jacobian::{eigenvalues, jacobian_at, modulus, state_order};
use equipoise_physics::analysis::linear_verdict::AngleClass;
use equipoise_physics::analysis::method::{RunMethod, run_by};
use equipoise_physics::analysis::return_map::ReturnMap;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::body::{Arrival, Body};
use equipoise_physics::map::strike::{ContactMode, State};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::dual::Dual;
use equipoise_physics::numbers::number::Arithmetic;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Name, Scene, Value};
use nalgebra::DMatrix;

use crate::support::features::{Mix, RANDOM, Swing, all_but};
use crate::support::random::Random;
use crate::support::reference::differences;
use crate::support::rig::hold_to_simulation;
use crate::support::turning::{contacts, numbers, with};

/// Number of something for each feature.
#[derive(Default)]
struct Counts(BTreeMap<&'static str, usize>);

impl Counts {
    fn add(&mut self, mix: &Mix, count: usize) {
        for feature in &mix.features {
            *self.0.entry(*feature).or_default() += count;
        }
    }

    fn of(&self, feature: &str) -> usize {
        self.0.get(feature).copied().unwrap_or(0)
    }

    /// Asserts that each of these features has so many.
    fn assert_least(&self, features: &[&str], least: usize) {
        println!("{:?}", self.0);
        for feature in features {
            assert!(self.of(feature) >= least, "{feature:?}: {} of {least}", self.of(feature));
        }
    }
}

/// Features that the simulation of `support/rig.rs` has.
const SIMULATED: [&str; 20] = [
    "angle bias",
    "tilt offset",
    "gain error",
    "speed error",
    "offset",
    "wrong belief",
    "delay",
    "predicted delay",
    "turning in place",
    "drag",
    "wind",
    "rotation drag",
    "vertical energy",
    "feedback",
    "feedback of the angle",
    "incline",
    "sensing",
    "scatter",
    "length",
    "point mass",
];

#[test]
fn bodies_move_as_newton_and_euler_say() {
    let mut random = Random::new(1802);
    let (mut compared, mut short, mut moved) = (Counts::default(), 0, BTreeMap::new());
    for number in 0..6000 {
        let swing = [Swing::Calm, Swing::Wide][number % 2];
        let mix = Mix::draw(&mut random, swing, &SIMULATED);
        let (course, _) = contacts(&mix.scene, 12);
        let found: Vec<_> = course.iter().map(numbers).collect();
        let within = match () {
            () if mix.has(&["drag", "wind", "rotation drag"]) => 1e-8,
            () if mix.has(&["delay", "predicted delay", "turning in place"]) || swing == Swing::Wide => 1e-9,
            () => 1e-10,
        };
        compared.add(&mix, hold_to_simulation(&found, &mix.scene, within));
        let delay = mix.scene.number(Name::Delay).unwrap_or(0.0);
        short += found.windows(2).filter(|pair| pair[1][0] - pair[0][0] < delay).count();
        for feature in mix.features.iter().copied() {
            let Some(ideal) = mix.without(feature) else { continue };
            let apart = course.iter().zip(contacts(&ideal, 12).0).map(|(a, b)| (a.state.y_dot - b.state.y_dot).abs());
            let most = moved.entry(feature).or_insert(0.0_f64);
            *most = apart.fold(*most, f64::max);
        }
    }
    compared.assert_least(&SIMULATED, 1500);
    assert!(short > 100, "{short} flights shorter than the delay");
    // Each of them takes part.
    println!("{moved:?}");
    for (feature, moved) in moved {
        assert!(feature == "length" || moved > 0.5, "{feature:?} moves by {moved} m/s");
    }
}

/// Fields that change their sign in a mirror.
const ODD: [Name; 9] = [
    Name::Theta,
    Name::ThetaDot,
    Name::X,
    Name::XDot,
    Name::AngleBias,
    Name::TiltOffset,
    Name::Offset,
    Name::PivotX,
    Name::Wind,
];

#[test]
fn a_scene_in_a_mirror_has_the_mirrored_run_and_derivative() {
    let mut random = Random::new(5);
    let features = all_but(&RANDOM);
    let (mut runs, mut derivatives) = (Counts::default(), Counts::default());
    for number in 0..6000 {
        let mix = Mix::draw(&mut random, [Swing::Calm, Swing::Wide, Swing::Wild][number % 3], &features);
        let mut draft = mix.scene.draft();
        for name in ODD {
            if let Some(value) = mix.scene.number(name) {
                draft.set(name, Some(Value::Number(-value))).unwrap();
            }
        }
        let mirrored = draft.build().unwrap();
        let ((course, ending), (other, same)) = (contacts(&mix.scene, 20), contacts(&mirrored, 20));
        assert_eq!((ending.name(), course.len()), (same.name(), other.len()), "{:?}", mix.scene);
        for (one, other) in course.iter().zip(&other) {
            let [t, x, theta, x_dot, y_dot, theta_dot] = numbers(one);
            assert_eq!([t, -x, -theta, -x_dot, y_dot, -theta_dot], numbers(other), "{:?}", mix.scene);
        }
        runs.add(&mix, 1);
        let derivative = |scene: &Scene| {
            let orbit = scene.orbit().ok()?;
            jacobian_at(&scene.model(), orbit.x(), orbit.state(), 1).ok()
        };
        let (Some(one), Some(other)) = (derivative(&mix.scene), derivative(&mirrored)) else { continue };
        let even = ["y_dot", "planned_normal_velocity"];
        let sign = |index: usize| if even.contains(&one.order[index]) { 1.0 } else { -1.0 };
        for (row, column) in (0..one.matrix.nrows()).flat_map(|row| (0..one.matrix.ncols()).map(move |it| (row, it))) {
            let expected = sign(row) * sign(column) * one.matrix[(row, column)];
            assert_eq!(expected, other.matrix[(row, column)], "[{row}, {column}] of {:?}", mix.scene);
        }
        assert_eq!(one.contact_mode, other.contact_mode);
        derivatives.add(&mix, 1);
    }
    runs.assert_least(&features, 100);
    derivatives.assert_least(&features, 50);
}

const STEP: f64 = 1e-6;

/// Names of the states of [`in_duals`].
const STATES: [&str; 5] = ["rho_theta", "x_dot", "y_dot", "rho_theta_dot", "x"];

/// State just before the contact after so many bounces with its derivatives by the one just before contact 1 and by the place there: ρθ, ẋ, ẏ,
/// ρθ̇ and x. `None` if the run ends before.
fn in_duals(scene: &Scene, bounces: u64) -> Option<[Dual<5>; 5]> {
    let doubles = scene.orbit().unwrap();
    let body: Body<Dual<5>> = scene.model().map(Dual::from_f64);
    let rho = body.rod.radius_of_gyration;
    let State { theta, x_dot, y_dot, theta_dot } = *doubles.state();
    let along = |value, direction, rate| Dual::along(value, direction, rate);
    let (theta, theta_dot) = (along(theta, 0, 1.0 / rho.value), along(theta_dot, 3, 1.0 / rho.value));
    let mut state = State { theta, x_dot: along(x_dot, 1, 1.0), y_dot: along(y_dot, 2, 1.0), theta_dot };
    if body.is_point {
        state = Body::point_state(state.x_dot, state.y_dot);
    }
    let zero = Dual::from_f64(0.0);
    let mut orbit = Orbit::at(body, Rules::BARE_MAP, state);
    let arrival = Arrival { t: zero, state, clearance: zero, plan: None, way: zero };
    orbit.resume(0, zero, along(doubles.x(), 4, 1.0), &arrival);
    if (0..bounces).any(|_| orbit.advance().ending.is_some()) {
        return None;
    }
    let State { theta, x_dot, y_dot, theta_dot } = *orbit.state();
    Some([rho * theta, x_dot, y_dot, rho * theta_dot, orbit.x()])
}

#[test]
fn derivatives_are_those_of_differences() {
    let mut random = Random::new(8);
    let features = all_but(&RANDOM);
    let (mut compared, mut seen, mut fed_back) = (Counts::default(), BTreeSet::new(), [0; 3]);
    let rough = ["friction", "matched friction", "incline", "vertical energy", "feedback"];
    for number in 0..60_000 {
        let (swing, from) = match number % 6 {
            0..3 => (Swing::Wild, &rough[..]),
            3 => (Swing::Calm, &features[..]),
            4 => (Swing::Wide, &features[..]),
            _ => (Swing::Wild, &features[..]),
        };
        let mix = Mix::draw(&mut random, swing, from);
        let scene = &mix.scene;
        let Ok(orbit) = scene.orbit() else { continue };
        let (model, period) = (scene.model(), 1 + number as u64 / 6 % 3);
        let by_place = mix.has(&["feedback", "turning in place"]);
        let of_body = if model.is_point { 2 } else { 4 };
        if by_place || !mix.has(&["feedback of the angle", "turning, corrected"]) {
            assert_eq!(state_order(&model).len(), of_body + usize::from(by_place), "{scene:?}");
        }
        let Ok(exact) = jacobian_at(&model, orbit.x(), orbit.state(), period) else { continue };
        let size = exact.matrix.amax();
        // With flights shorter than the delay the motion that the table plans is a part of the state.
        assert!(exact.matrix.iter().all(|it| it.is_finite()), "{scene:?}");
        let plans = exact.order.iter().any(|name| name.starts_with("planned"));
        assert!(!plans || mix.has(&["delay"]), "{scene:?}");
        // Near a graze derivatives grow without bound.
        if !exact.one_sided.is_empty() || exact.contact_speed > -0.2 || size > 100.0 {
            continue;
        }
        let map = ReturnMap::new(&model, period);
        let map = if plans { map.planning() } else { map };
        let places: Vec<_> = map.names().iter().map(|name| exact.order.iter().position(|it| it == name)).collect();
        let matrix = DMatrix::from_fn(places.len(), places.len(), |row, column| {
            exact.matrix[(places[row].unwrap(), places[column].unwrap())]
        });
        let differences = |step| differences(&map, orbit.x(), orbit.state(), step);
        let (Some(rough), Some(fine)) = (differences(STEP), differences(0.5 * STEP)) else { continue };
        // Differences mean something only where no neighbour is beyond a kink.
        if (&rough - &fine).amax() > 1e-6 * size {
            continue;
        }
        let off = (&matrix - &fine).amax() / size;
        // The finer step is off by a third of what it gained, or by rounding.
        assert!(off < 2e-6, "{off:e} {matrix} {fine} {scene:?}");
        // Their state has no planned motion.
        if !plans {
            let duals = in_duals(scene, period).unwrap_or_else(|| panic!("{scene:?}"));
            let places: Vec<_> = exact.order.iter().map(|name| STATES.iter().position(|it| it == name)).collect();
            let place = |index: usize| places[index].unwrap();
            let matrix = DMatrix::from_fn(exact.matrix.nrows(), exact.matrix.ncols(), |row, it| {
                duals[place(row)].partials[place(it)]
            });
            assert!((&exact.matrix - &matrix).amax() < 1e-9 * size, "{} {matrix} {scene:?}", exact.matrix);
        }
        compared.add(&mix, 1);
        if mix.has(&["feedback"]) {
            fed_back[[["friction"], ["matched friction"]].iter().position(|it| mix.has(it)).map_or(2, |it| it)] += 1;
        }
        if let (Some(Value::Choice(law)), true) = (scene.value(Name::Law), mix.has(&["friction", "matched friction"])) {
            seen.insert((exact.contact_mode.name(), law, mix.has(&["matched friction"])));
        }
    }
    compared.assert_least(&features, 400);
    println!("{seen:?} {fed_back:?}");
    assert!(fed_back.iter().all(|count| *count > 60), "{fed_back:?}");
    for law in ["poisson", "newton", "stronge"] {
        for (mode, matched) in [
            (ContactMode::Slide, false),
            (ContactMode::Stick, false),
            (ContactMode::ReverseSlide, false),
            (ContactMode::Stick, true),
            (ContactMode::SlideThrough, true),
        ] {
            assert!(seen.contains(&(mode.name(), law, matched)), "{mode:?} {law} {matched}");
        }
    }
}

/// Where each strike gives back what it takes, and nothing else takes energy: ½|v|² + Gl cos θ is the same after a bounce, and
/// det Df = −ẏ_c⁺/ẏ_c⁻ unless the tilt depends on velocities.
#[test]
fn energy_is_kept_and_the_determinant_is_that_of_the_contact_speeds() {
    let mut random = Random::new(18);
    let features = all_but(&RANDOM);
    let mut kept = Counts::default();
    for number in 0..20_000 {
        let mix = Mix::draw(&mut random, [Swing::Wide, Swing::Wild][number % 2], &features);
        let (scene, rod) = (&mix.scene, mix.scene.parameters::<f64>());
        let Some(orbit) = scene.orbit().ok().filter(|_| scene.rules().holds_energy && rod.strike_gain == 2.0) else {
            continue;
        };
        let Ok(bounce) = jacobian_at(&scene.model(), orbit.x(), orbit.state(), 1) else { continue };
        let (before, after) = (rod.energy(orbit.state()), rod.energy(&bounce.end));
        assert!((before - after).abs() <= 1e-13 * before.abs().max(after.abs()).max(1.0), "{before} {after} {scene:?}");
        kept.add(&mix, 1);
        let (rise, fall) = (orbit.foresee().1.contact_rise, bounce.contact_speed);
        if mix.has(&["feedback", "feedback of the angle", "point mass"]) || rise <= 0.05 || fall >= -0.05 {
            continue;
        }
        let (found, size) = (bounce.matrix.determinant(), bounce.matrix.norm().max(1.0));
        assert!((found + rise / fall).abs() <= 1e-12 * size, "{found} {} {scene:?}", -rise / fall);
    }
    let kept_with =
        ["angle bias", "tilt offset", "gain error", "offset", "turning", "turning, corrected", "feedback", "incline"];
    kept.assert_least(&kept_with, 100);
}

/// Scenes whose runs in doubles are compared with 31 digits.
const RUNS: usize = 8000;

/// Bounds of errors are above them and useful, the first contacts are those of 31 digits, and both runs end alike.
#[test]
fn runs_in_doubles_are_within_their_bounds_of_31_digits() {
    let mut random = Random::new(2602);
    let features = all_but(&[]);
    let (mut bounds, mut all, mut ended, mut alike) =
        (Counts::default(), Counts::default(), BTreeMap::<_, usize>::new(), 0);
    for number in 0..RUNS {
        let mix = Mix::draw(&mut random, [Swing::Calm, Swing::Wide][number % 2], &features);
        let scene = &mix.scene;
        let rho = scene.parameters::<f64>().radius_of_gyration;
        let mut exact = Vec::new();
        let ending = run_by(scene, RunMethod::Extended, 40, |impact| {
            exact.push(*impact.extended.unwrap().1);
            true
        });
        let (mut n, mut useful) = (0, 0);
        let same = run_by(scene, RunMethod::Map, 40, |impact| {
            let Some(exact) = exact.get(n) else { return true };
            n += 1;
            let (ours, theirs) = (impact.contact, exact);
            let off = |ours: f64, exact: DoubleDouble| (DoubleDouble::from(ours) - exact).to_f64().abs();
            let State { theta, x_dot, y_dot, theta_dot } = ours.state;
            let mut turned = off(theta, theirs.state.theta).max(off(theta_dot, theirs.state.theta_dot));
            if scene.model().is_point {
                // The bound is of velocities.
                turned = 0.0;
            }
            let moved = off(x_dot, theirs.state.x_dot).max(off(y_dot, theirs.state.y_dot));
            if impact.error_estimate < 1e-3 {
                let error = moved.max(rho * turned);
                assert!(error <= impact.error_estimate, "{n}: {error:e} {:e} {scene:?}", impact.error_estimate);
                useful += 1;
            }
            if n <= 4 {
                let placed = off(ours.x, theirs.x).max(off(ours.clearance, theirs.clearance));
                let most = moved.max(turned).max(placed).max(off(ours.alpha, theirs.alpha));
                let size = 1.0 + x_dot.abs() + y_dot.abs() + theta_dot.abs();
                assert!(most <= 1e-10 * size, "contact {n} is off by {most:e}: {scene:?}");
            }
            true
        });
        let (ending, same) = (ending.unwrap().unwrap().name(), same.unwrap().unwrap().name());
        if useful == exact.len() {
            assert_eq!((ending, n), (same, exact.len()), "{scene:?}");
            *ended.entry(ending).or_default() += 1;
        }
        alike += usize::from(ending == same);
        bounds.add(&mix, useful);
        all.add(&mix, exact.len());
    }
    all.assert_least(&features, 2000);
    println!("{ended:?}, {alike} alike");
    assert!(["completed", "other_vertex", "beyond_limits"].iter().all(|name| ended.get(name) > Some(&10)), "{ended:?}");
    assert!(100 * alike >= 99 * RUNS, "{alike}");
    for feature in features {
        let (useful, all) = (bounds.of(feature), all.of(feature));
        assert!(10 * useful >= 7 * all, "{feature:?}: {useful} of {all}");
    }
}

/// A bounce from the fixed point ends there, and the derivative there has the eigenvalues of the linear verdict.
#[test]
fn fixed_points_repeat_and_their_eigenvalues_are_those_of_the_derivative() {
    let mut random = Random::new(51);
    let features = all_but(&[&RANDOM[..], &["program", "still", "point mass"]].concat());
    let mut found = Counts::default();
    let mut classes = BTreeMap::<_, usize>::new();
    for _ in 0..8000 {
        let mix = Mix::draw(&mut random, Swing::Calm, &features);
        let mut scene = mix.scene;
        // In air the eigenvalues are those of the bounce without drift, whose square they leave out.
        if scene.running_model().drag.is_some() {
            scene = with(&scene, &[(Name::XDot, 0.0), (Name::ThetaDot, 0.0), (Name::Theta, 0.0)]);
        }
        let scene = &scene;
        // Where only the spin is braked, the fixed point told for a table that holds the total energy is that of the release.
        if mix.has(&["total energy", "one strike"]) && scene.running_model().drag.is_some_and(|drag| drag.linear == 0.0)
        {
            continue;
        }
        let Ok(place) = small_deviations(scene).map(|small| small.fixed_point) else { continue };
        let linear = small_deviations(scene).unwrap().linear;
        let Ok(there) = jacobian_at(&scene.model(), place.x, &place.state(), 1) else { continue };
        let State { x_dot, y_dot, .. } = there.end;
        assert!((y_dot + place.speed).abs() < 1e-12 * place.speed, "{:?} {place:?} {scene:?}", there.end);
        // A bounce of the map is solved to 1e-12 in θ too, and a strike takes that to ẋ.
        assert!((x_dot - place.x_dot).abs() < 1e-11 * place.speed, "{:?} {place:?} {scene:?}", there.end);
        assert!((there.flight_time - place.flight_time).abs() < 1e-12 * place.flight_time, "{place:?} {scene:?}");
        let own = eigenvalues(&there.matrix).unwrap();
        for told in &linear.eigenvalues {
            // A nearly double eigenvalue is known to the square root of rounding.
            let nearest = own.iter().map(|own| modulus(own - told)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-6, "{told} of {own:?}: {scene:?}");
        }
        let beyond = own.iter().any(|own| modulus(*own) > 1.0 + 1e-6);
        let turns = linear.class != AngleClass::Hyperbolic;
        assert_eq!(turns && linear.energy_eigenvalue.abs() <= 1.0 + 1e-6, !beyond, "{linear:?} {own:?} {scene:?}");
        *classes.entry(linear.class.name()).or_default() += 1;
        found.add(&mix, 1);
    }
    println!("{classes:?}");
    found.assert_least(&["drag", "rotation drag", "turning", "turning in place", "delay", "feedback", "friction"], 20);
}

/// Numbers that say that there is nothing of a feature.
const NOTHING: [Name; 13] = [
    Name::AngleBias,
    Name::TiltOffset,
    Name::TiltGainError,
    Name::SpeedError,
    Name::Offset,
    Name::Delay,
    Name::Drag,
    Name::RotationDrag,
    Name::XSd,
    Name::XDotSd,
    Name::YDotSd,
    Name::ThetaDotSd,
    Name::RestitutionSd,
];

#[test]
fn a_feature_of_size_0_changes_no_bit() {
    let mut random = Random::new(1804);
    let features = all_but(&[]);
    let mut added = BTreeMap::<_, usize>::new();
    for number in 0..3000 {
        let mix = Mix::draw(&mut random, [Swing::Calm, Swing::Wide][number % 2], &features);
        for name in NOTHING {
            if mix.scene.number(name).is_some_and(|number| number != 0.0) {
                continue;
            }
            let mut draft = mix.scene.draft();
            draft.set(name, Some(Value::Number(0.0))).unwrap();
            let Ok(same) = draft.build() else { continue };
            assert_eq!((mix.scene.running_model(), mix.scene.rules()), (same.running_model(), same.rules()));
            assert_eq!(mix.scene.model_level(), same.model_level(), "{name:?} {:?}", mix.scene);
            let ((one, ending), (other, end)) = (contacts(&mix.scene, 6), contacts(&same, 6));
            assert_eq!(ending, end);
            assert!(
                one.iter().zip(&other).all(|(one, other)| numbers(one) == numbers(other)),
                "{name:?} {:?}",
                mix.scene
            );
            *added.entry(name.row().path).or_default() += 1;
        }
    }
    println!("{added:?}");
    assert!(added.len() == NOTHING.len() && added.values().all(|count| *count > 300), "{added:?}");
}

/// A plan that is carried out in time, and a prediction of what is known, are the strike itself.
#[test]
fn a_prediction_without_noise_changes_no_bit() {
    let mut random = Random::new(1812);
    let features = all_but(&[&RANDOM[..], &["delay"]].concat());
    let mut predicted = Counts::default();
    for _ in 0..3000 {
        let mix = Mix::draw(&mut random, Swing::Calm, &features);
        let Some(ideal) = mix.without("predicted delay").filter(|_| mix.has(&["predicted delay"])) else { continue };
        assert_eq!((mix.scene.running_model(), mix.scene.rules()), (ideal.running_model(), ideal.rules()));
        assert_eq!(contacts(&mix.scene, 30), contacts(&ideal, 30));
        assert_eq!(
            small_deviations(&mix.scene).map(|small| small.fixed_point),
            small_deviations(&ideal).map(|small| small.fixed_point)
        );
        assert_eq!(mix.scene.model_level(), ideal.model_level());
        predicted.add(&mix, 1);
    }
    predicted.assert_least(&["predicted delay"], 50);
}
