//! The error estimate is never below the error and seldom far above it, over random scenes of every kind and over the
//! references. Other seeds than these set its safety factor.

use equipoise_physics::analysis::method::{RunMethod, choose_method, run_by};
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::error_estimate::{ErrorEstimate, predictable_impacts};
use equipoise_physics::run::orbit;
use equipoise_physics::scene::{FIELDS, Name, Scene, Value};

use crate::paper::scene;
use crate::support::features::{Mix, Swing};
use crate::support::scenes::{MIXES, Parts, number};
use crate::support::{features, random, reference, scenes};

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
            let scene = scenes::mixed_scene(&mut source, parts);
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
        let mut draft = scenes::mixed_scene(random, Parts::default()).draft();
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

// The chosen method is within the tolerance, and doubles are nearly always chosen where they would do, over the random scenes on
// which the error estimates are held.

/// A run with 31 digits: its states just before each impact, and how it ended.
struct Exact {
    states: Vec<[DoubleDouble; 4]>,
    ending: &'static str,
    rho: f64,
    is_point: bool,
}

fn exact(scene: &Scene, impacts: u64) -> Exact {
    let mut orbit = scene.extended_orbit().unwrap();
    let rho = orbit.body.rod.radius_of_gyration.to_f64();
    let mut states = Vec::new();
    let ending = orbit::run(&mut orbit, impacts, |contact| {
        let state = contact.state;
        states.push([state.theta, state.x_dot, state.y_dot, state.theta_dot]);
        true
    });
    Exact { states, ending: ending.unwrap().name(), rho, is_point: scene.model().rod.contact_distance == 0.0 }
}

/// The largest error of a method's states; `None` if it ends otherwise or does not apply.
fn error(scene: &Scene, method: RunMethod, impacts: u64, exact: &Exact) -> Option<f64> {
    let (mut worst, mut made) = (0.0_f64, 0);
    let ending: Ending = run_by(scene, method, impacts, |impact| {
        let state = impact.contact.state;
        let ours = [state.theta, state.x_dot, state.y_dot, state.theta_dot];
        let turned = if exact.is_point { 0.0 } else { exact.rho };
        let scales = [turned, 1.0, 1.0, if exact.is_point { 0.0 } else { exact.rho }];
        if let Some(reference) = exact.states.get(made) {
            for ((ours, reference), scale) in ours.into_iter().zip(reference).zip(scales) {
                worst = worst.max(scale * (*reference - ours.into()).to_f64().abs());
            }
        }
        made += 1;
        true
    })
    .ok()??;
    (ending.name() == exact.ending && made == exact.states.len()).then_some(worst)
}

/// m/s. Between the last two is the rounding of doubles itself, where a bound of some ten errors is often the wrong side of it.
const TOLERANCES: [f64; 7] = [1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12, 1e-20];

#[test]
fn the_choice_holds_and_is_nearly_always_the_cheaper() {
    let (mut chosen, mut cheapest, mut refused) = ([0; 2], 0, 0);
    for kind in scenes::KINDS {
        let mut source = random::Random::new(31);
        for run in 0..112 {
            let scene = scenes::scene(&mut source, kind);
            let impacts = [20, 100, 400, 2000][run % 4];
            let tolerance = TOLERANCES[run % TOLERANCES.len()];
            let Ok(choice) = choose_method(&scene, impacts, tolerance, || true).unwrap() else {
                refused += 1;
                continue;
            };
            chosen[usize::from(choice.method == RunMethod::Extended)] += 1;
            let exact = exact(&scene, impacts);
            if choice.method != RunMethod::Extended {
                let off = error(&scene, choice.method, impacts, &exact);
                assert!(off.is_some_and(|off| off <= tolerance), "{kind:?} {run}: {choice:?} is off by {off:?}");
            }
            let would_do = error(&scene, RunMethod::Map, impacts, &exact).is_some_and(|off| off <= tolerance);
            cheapest += usize::from(choice.method == RunMethod::Map || !would_do);
        }
    }
    let all: usize = chosen.iter().sum();
    println!("map, extended chosen {chosen:?} times, {refused} refused; {cheapest} of {all} were the cheapest");
    assert!(all > 800 && chosen.iter().all(|times| *times > 10), "{chosen:?}");
    assert!(cheapest * 100 >= all * 95, "{cheapest} of {all}");
}

// The choice of a method: doubles where they hold, the same every time, and a refusal where no method does.

/// The paper's body with κ, θ₀ and an energy that is V = 1.14 m/s upright.
#[test]
fn doubles_are_enough_for_most_runs() {
    for (theta, impacts) in [(1e-4, 20), (1e-4, 5000), (0.3, 1000)] {
        let choice = choose_method(&scene(1.1, theta), impacts, 1e-6, || true).unwrap().unwrap();
        assert_eq!(choice.method, RunMethod::Map, "{choice:?}");
        assert!(choice.error_estimate < 1e-9, "{choice:?}");
        assert_eq!(choice, choose_method(&scene(1.1, theta), impacts, 1e-6, || true).unwrap().unwrap());
    }
}

#[test]
fn more_digits_than_doubles_hold_are_extended() {
    let choice = choose_method(&scene(1.1, 0.3), 1000, 1e-20, || true).unwrap().unwrap();
    assert_eq!(choice.method, RunMethod::Extended, "{choice:?}");
    assert!(choice.error_estimate <= 1e-20, "{choice:?}");
}

/// A chaotic run that goes on: doubles lose it within some hundred impacts, 31 digits after about twice as many.
#[test]
fn beyond_the_horizon_it_is_refused() {
    let chaotic = scene(1.55, 0.02);
    let within = |impacts| choose_method(&chaotic, impacts, 1e-3, || true).unwrap();
    let refusal = within(100_000).unwrap_err();
    assert!(refusal.horizon > 50 && refusal.horizon < 100_000, "{refusal:?}");
    assert!(refusal.detail.contains(&format!("at most {} impacts", refusal.horizon)), "{refusal:?}");
    assert_eq!(within(refusal.horizon).unwrap().method, RunMethod::Extended);
    assert_eq!(within(refusal.horizon + 1), Err(within(refusal.horizon + 1).unwrap_err()));
    let map = predictable_impacts(&chaotic, 100_000, 1e-3, || true).unwrap();
    assert!(map < refusal.horizon, "{map} {}", refusal.horizon);
    assert_eq!(within(map).unwrap().method, RunMethod::Map);
    assert_eq!(within(map + 1).unwrap().method, RunMethod::Extended);
}

#[test]
fn a_choice_can_be_called_off() {
    assert_eq!(choose_method(&scene(1.1, 0.3), 100_000, 1e-6, || false), None);
}
