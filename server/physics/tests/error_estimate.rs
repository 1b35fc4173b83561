//! The error estimate is never below the error and seldom far above it, over random scenes of every kind and over the
//! references. Other seeds than these set its safety factor.

use crate::support::features;
use crate::support::mixes;
use crate::support::random;
use crate::support::reference;
use crate::support::scenes;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::error_estimate::ErrorEstimate;
use equipoise_physics::scene::{FIELDS, Name, Scene, Value};
use features::{Mix, Swing};
use mixes::{MIXES, Parts, number};

/// Beyond it a bound says no more than "lost".
const USEFUL: f64 = 1e-3;

/// A run in doubles beside the same with 31 digits.
#[derive(Default)]
struct Comparison {
    /// Largest error/bound.
    worst: f64,
    /// bound/error of every contact with a useful bound, the error at least one unit in the last place of the state.
    ratios: Vec<f64>,
    /// Contacts of the run with 31 digits.
    contacts: usize,
}

fn compare(scene: &Scene, impacts: u64) -> Comparison {
    let mut orbit = scene.orbit().unwrap();
    let mut exact = scene.extended_orbit().unwrap();
    let mut estimate = ErrorEstimate::of_scene(scene, orbit.t());
    let mut rest = ErrorEstimate::of_extended_run(scene, exact.t().to_f64());
    let rho = exact.body.rod.radius_of_gyration.to_f64();
    let is_point = orbit.body.is_point;
    let mut comparison = Comparison::default();
    let mut is_useful = true;
    for _ in 0..impacts {
        let (contact, reference) = (orbit.advance(), exact.advance());
        comparison.contacts += 1;
        let bound = estimate.bound();
        is_useful &= bound <= USEFUL;
        if is_useful {
            assert!(rest.bound() < 1e-12 * bound.max(1e-12), "31 digits are off by {:e}", rest.bound());
            let (ours, exact) = (contact.state, reference.state);
            let error = |ours: f64, exact: DoubleDouble| (exact - ours.into()).to_f64().abs();
            let turned = if is_point { 0.0 } else { rho * error(ours.theta, exact.theta) };
            let error = turned
                .max(error(ours.x_dot, exact.x_dot))
                .max(error(ours.y_dot, exact.y_dot))
                .max(rho * error(ours.theta_dot, exact.theta_dot));
            let size =
                ours.x_dot.abs().max(ours.y_dot.abs()).max(rho * ours.theta_dot.abs()).max(rho * ours.theta.abs());
            if error > 0.0 {
                comparison.worst = comparison.worst.max(error / bound);
            }
            comparison.ratios.push(bound / error.max(f64::EPSILON * size));
        }
        if contact.flight_time.is_none() || reference.flight_time.is_none() {
            break;
        }
        estimate.pass(&contact);
        rest.pass(&reference);
    }
    comparison
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Runs of each kind, 1,000 and some in all.
const RUNS: usize = 115;

#[test]
fn bounds_hold_over_random_scenes() {
    for kind in scenes::KINDS {
        let mut source = random::Random::new(2026);
        let (mut worst, mut all) = (0.0_f64, Vec::new());
        for _ in 0..RUNS {
            let scene = scenes::scene(&mut source, kind);
            let run = compare(&scene, 300);
            worst = worst.max(run.worst);
            all.extend(run.ratios);
        }
        let typical = median(&mut all);
        println!("{kind:?}: error/bound at most {worst:.2}, bound/error {typical:.1}, {} contacts", all.len());
        assert!(worst <= 1.0, "{kind:?}: an error is {worst} of its bound");
        assert!(typical <= 100.0, "{kind:?}: bounds are {typical} errors");
    }
}

/// A table that turns far for a small angle: the rounding of α itself.
#[test]
fn bounds_hold_over_large_tilt_gains() {
    let mut source = random::Random::new(2029);
    let (mut worst, mut all) = (0.0_f64, Vec::new());
    for _ in 0..20 * RUNS {
        let mut draft = scenes::scene(&mut source, scenes::Kind::Regular).draft();
        draft.set(Name::TiltGain, Some(Value::Number(source.size(5.0, 100.0)))).unwrap();
        draft.set(Name::Theta, Some(Value::Number(source.size(0.1, 0.7)))).unwrap();
        draft.set(Name::XDot, Some(Value::Number(source.size(0.1, 40.0)))).unwrap();
        let run = compare(&draft.build().unwrap(), 20);
        worst = worst.max(run.worst);
        all.extend(run.ratios);
    }
    println!("error/bound at most {worst:.2}, bound/error {:.1}, {} contacts", median(&mut all), all.len());
    assert!(worst <= 1.0 && all.len() > 500, "an error is {worst} of its bound, {} contacts", all.len());
}

#[test]
fn bounds_hold_over_random_scenes_with_friction() {
    use scenes::Kind::{Chaotic, Feedback, Grazing, Regular, Small, Spinning, Still};
    for kind in [Regular, Small, Chaotic, Spinning, Still, Feedback, Grazing] {
        for slide in ["matched", "none"] {
            let mut source = random::Random::new(2028);
            let (mut worst, mut all) = (0.0_f64, Vec::new());
            for run in 0..RUNS {
                let mut draft = scenes::scene(&mut source, kind).draft();
                let law = ["poisson", "newton", "stronge"][run % 3];
                draft.set(Name::Friction, Some(Value::Number(source.size(0.01, 1.0).abs()))).unwrap();
                draft.set(Name::Law, Some(Value::Choice(law))).unwrap();
                draft.set(Name::Slide, Some(Value::Choice(slide))).unwrap();
                let run = compare(&draft.build().unwrap(), 300);
                worst = worst.max(run.worst);
                all.extend(run.ratios);
            }
            let typical = median(&mut all);
            println!(
                "{kind:?}, {slide}: error/bound at most {worst:.2}, bound/error {typical:.1}, {} contacts",
                all.len()
            );
            assert!(worst <= 1.0, "{kind:?}, {slide}: an error is {worst} of its bound");
            assert!(typical <= 100.0, "{kind:?}, {slide}: bounds are {typical} errors");
        }
    }
}

#[test]
fn bounds_hold_over_the_references() {
    for (name, scene, reference) in reference::all() {
        let Comparison { worst, mut ratios, .. } = compare(&scene, reference["impacts"].as_u64().unwrap());
        let typical = median(&mut ratios);
        println!("{name}: error/bound at most {worst:.2}, bound/error {typical:.1}, {} contacts", ratios.len());
        assert!(worst <= 1.0 && typical <= 200.0, "{name}: {worst} {typical}");
    }
}

/// The scene with every number of 24 bits, and the same with lengths and gravity three times as large: rounded independently,
/// exactly the same run.
fn twins(scene: &Scene) -> [Scene; 2] {
    [1.0, 3.0].map(|factor| {
        let mut draft = scene.draft();
        for row in &FIELDS {
            if let Some(number) = scene.number(row.name) {
                let scaled = matches!(row.unit, "m" | "m/s" | "m/s²");
                let number = if row.name == Name::Incline { number } else { f64::from(number as f32) };
                let number = if scaled { number * factor } else { number };
                draft.set(row.name, Some(Value::Number(number))).unwrap();
            }
        }
        draft.build().unwrap()
    })
}

/// Two runs with 31 digits are nowhere farther apart than their bounds together, up to the horizon of chaotic ones.
#[test]
fn bounds_with_31_digits_hold_between_twins() {
    for kind in [scenes::Kind::Regular, scenes::Kind::Chaotic, scenes::Kind::Still] {
        let mut source = random::Random::new(2027);
        let (mut worst, mut ratios, mut lost) = (0.0_f64, Vec::new(), 0);
        // Chaotic ones that stay up: the paper's body beyond its soft boundary.
        let paper = reference::frictionless().into_iter().find(|(name, ..)| name == "case-1").unwrap().1;
        let beyond = |theta| {
            let mut draft = paper.draft();
            draft.set(Name::TiltGain, Some(Value::Number(1.55))).unwrap();
            draft.set(Name::Theta, Some(Value::Number(theta))).unwrap();
            draft.build().unwrap()
        };
        let mut scenes: Vec<Scene> = (0..20).map(|step| beyond(0.001 * f64::from(step + 5))).collect();
        scenes.extend((0..40).map(|_| scenes::scene(&mut source, kind)));
        for scene in scenes {
            let twins = twins(&scene);
            let [mut one, mut other] = twins.map(|scene| scene.extended_orbit().unwrap());
            let mut estimate = ErrorEstimate::of_extended_run(&twins[0], one.t().to_f64());
            let rho = one.body.rod.radius_of_gyration;
            let three = DoubleDouble::from(3.0);
            for _ in 0..1000 {
                let (ours, theirs) = (*one.state(), *other.state());
                let bound = estimate.bound();
                if bound > USEFUL {
                    lost += 1;
                    break;
                }
                let apart = [
                    rho * (ours.theta - theirs.theta),
                    ours.x_dot - theirs.x_dot / three,
                    ours.y_dot - theirs.y_dot / three,
                    rho * (ours.theta_dot - theirs.theta_dot),
                ]
                .map(|apart| apart.to_f64().abs())
                .into_iter()
                .fold(0.0, f64::max);
                worst = worst.max(apart / (2.0 * bound));
                ratios.push(2.0 * bound / apart.max(1e-32));
                let contact = one.advance();
                if contact.flight_time.is_none() || other.advance().flight_time.is_none() {
                    break;
                }
                estimate.pass(&contact);
            }
        }
        let typical = median(&mut ratios);
        println!("{kind:?}: apart/bounds at most {worst:.2}, bounds/apart {typical:.1}, {lost} lost");
        assert!(worst <= 1.0 && typical <= 300.0, "{kind:?}: {worst} {typical}");
        assert!(lost > 0, "no run was followed to its horizon");
    }
}

/// Scenes with two to four features, of all that there are.
const MIXED_SCENES: usize = 1000;

#[test]
fn bounds_hold_over_mixes_of_features() {
    let mut source = random::Random::new(2700);
    let (mut worst, mut contacts, mut runs) = (0.0_f64, 0, 0);
    // Those of point masses apart: their drift dies out, and the error with it.
    let (mut all, mut of_points) = (Vec::new(), Vec::new());
    let from = features::all_but(&[]);
    while runs < MIXED_SCENES {
        let swing = if runs % 2 == 0 { Swing::Calm } else { Swing::Wide };
        let Mix { scene, features, .. } = Mix::draw(&mut source, swing, &from);
        if features.len() < 2 || scene.orbit().is_err() {
            continue;
        }
        runs += 1;
        let run = compare(&scene, 300);
        assert!(run.worst <= 1.0, "{features:?}: an error is {} of its bound, {scene:?}", run.worst);
        worst = worst.max(run.worst);
        contacts += run.contacts;
        if features.contains(&"point mass") { &mut of_points } else { &mut all }.extend(run.ratios);
    }
    let (typical, of_point, bounds) = (median(&mut all), median(&mut of_points), all.len() + of_points.len());
    println!("error/bound at most {worst:.2}, bound/error {typical:.1} and {of_point:.1}, {bounds} of {contacts}");
    // A fifth of the mixes are in air, where each decay counts as four roundings.
    assert!(typical <= 30.0 && of_point <= 100.0, "bounds are {typical} and {of_point} errors");
    assert!(10 * bounds >= 8 * contacts, "{bounds} bounds at {contacts} contacts");
}

#[test]
fn bounds_of_tables_that_err_hold_and_are_not_idle() {
    let mut source = random::Random::new(2611);
    for parts in MIXES.into_iter().filter(|parts| parts.feedback || parts.noise.is_some() || parts.late) {
        let (mut ratios, mut contacts, mut worst) = (Vec::new(), 0, 0.0_f64);
        for _ in 0..100 {
            let scene = mixes::scene(&mut source, parts);
            let run = compare(&scene, 60);
            assert!(run.worst <= 1.0, "an error is {} of its bound, {scene:?}", run.worst);
            worst = worst.max(run.worst);
            contacts += run.contacts;
            ratios.extend(run.ratios);
        }
        let typical = median(&mut ratios);
        println!("{parts:?}: error/bound at most {worst:.2}, bound/error {typical:.1}, {} of {contacts}", ratios.len());
        assert!(10 * ratios.len() >= 8 * contacts && typical <= 100.0, "{parts:?}: {} of {contacts}", ratios.len());
    }
}

/// A random scene with constant errors of its rig: with `gain`, that of the tilt alone, on a table whose gain is then near 1.
fn off(random: &mut random::Random, gain: bool) -> Scene {
    loop {
        let mut draft = mixes::scene(random, Parts::default()).draft();
        let error = random.size(1e-3, 0.2);
        number(&mut draft, Name::TiltGainError, error);
        if gain {
            number(&mut draft, Name::TiltGain, (1.0 + random.size(1e-7, 1e-2)) / (1.0 + error));
        } else {
            number(&mut draft, Name::AngleBias, random.size(1e-6, 1e-3));
            number(&mut draft, Name::TiltOffset, random.size(1e-6, 1e-3));
            number(&mut draft, Name::SpeedError, random.size(1e-4, 0.05));
            number(&mut draft, Name::Offset, 0.1 * random.size(1e-4, 0.02));
        }
        if let Ok(scene) = draft.build() {
            return scene;
        }
    }
}

#[test]
fn parameters_that_an_error_of_the_rig_rounds_are_in_the_bound() {
    let mut source = random::Random::new(2626);
    for gain in [true, false] {
        let (mut ratios, mut worst, mut runs) = (Vec::new(), 0.0_f64, 0);
        while runs < 240 {
            let scene = off(&mut source, gain);
            let run = compare(&scene, 300);
            if gain && run.contacts < 300 {
                continue;
            }
            runs += 1;
            worst = worst.max(run.worst);
            ratios.extend(run.ratios);
        }
        let typical = median(&mut ratios);
        println!("gain {gain}: error/bound at most {worst:.2}, bound/error {typical:.1}, {} bounds", ratios.len());
        assert!(worst <= 1.0, "an error is {worst} of its bound");
        assert!(ratios.len() > 240 * 20 && typical <= 100.0, "{} bounds, {typical}", ratios.len());
    }
}
