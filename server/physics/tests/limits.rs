//! Limits of any number of a scene: against the closed forms where they are exact, and against the motion just inside and just outside.

use crate::support::features::{Mix, Swing};
use crate::support::random::Random;
use crate::support::rig::{fed_back, with, worded};
use crate::support::turning::turning;
use equipoise_physics::analysis::gain_range::StableGains;
use equipoise_physics::analysis::jacobian::modulus;
use equipoise_physics::analysis::limits::{Limit, LimitKind, Limits, NoLimits, Parameter, limits_of};
use equipoise_physics::analysis::losses::search_ends;
use equipoise_physics::analysis::repeating::{SceneMap, find_planned};
use equipoise_physics::analysis::return_map::{ARC, X, Y_DOT};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::control::bounce_model::BounceModel;
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Scene, Value};

const KAPPA: Parameter = Parameter::Field(Name::TiltGain);

fn limits(scene: &Scene, parameter: Parameter) -> Limits {
    limits_of(scene, parameter, &mut || true).unwrap()
}

/// A random rod at a share of the way from κ = 1 to κ_c, with other numbers.
fn rod(random: &mut Random, share: f64, values: &[(Name, f64)]) -> Scene {
    let length = random.between(0.05, 0.4);
    let rho = length * random.between(0.3, 1.3);
    let above = length * random.between(0.2, 2.0);
    let width = rho * rho / (2.0 * above * length);
    let mut all = vec![
        (Name::ContactDistance, length),
        (Name::RadiusOfGyration, rho),
        (Name::Height, length + above),
        (Name::TiltGain, 1.0 + share * width),
        (Name::Theta, 0.02),
        (Name::Incline, random.between(0.3, 1.5)),
        (Name::Restitution, random.between(0.3, 1.0)),
    ];
    all.extend_from_slice(values);
    with(Draft::default(), &all)
}

fn near(limit: Option<&Limit>, value: f64, eigenvalue: f64, scene: &Scene) {
    let limit = limit.unwrap_or_else(|| panic!("no limit at {value}: {scene:?}"));
    assert!((limit.value - value).abs() <= 1e-10 * value.abs().max(1.0), "{limit:?} is not {value}: {scene:?}");
    assert!((limit.value - value).abs() <= 1e3 * limit.accuracy, "{limit:?} is not {value}: {scene:?}");
    assert_eq!(limit.kind, LimitKind::Eigenvalue(eigenvalue.into()));
}

/// The limits of κ are those of the linear verdict.
fn hold_to_verdict(scene: &Scene) {
    let linear = small_deviations(scene).unwrap().linear;
    let found = limits(scene, KAPPA);
    near(found.lower.as_ref(), linear.lower_tilt_gain, 1.0, scene);
    near(found.upper.as_ref(), linear.critical_tilt_gain, -1.0, scene);
}

#[test]
fn limits_of_the_tilt_gain_are_the_closed_forms() {
    let mut random = Random::new(2201);
    for number in 0..6 {
        let share = random.between(0.05, 0.95);
        hold_to_verdict(&rod(&mut random, share, &[]));
        let gain = (Name::EnergyGain, 0.02);
        let drag = (Name::RotationDrag, random.between(0.01, 0.5));
        // The angle of a release gives a drift and a height where the air takes its spin.
        let scene = rod(&mut random, share, &[(Name::Theta, 0.0)]);
        let height = (Name::TargetHeight, scene.release().height);
        hold_to_verdict(&with(scene.draft(), &[gain, height]));
        hold_to_verdict(&with(scene.draft(), &[drag]));
        hold_to_verdict(&with(scene.draft(), &[drag, gain, height, (Name::Drag, random.between(0.01, 0.5))]));
        let matched = with(worded(scene.draft(), &[(Name::Slide, "matched")]), &[(Name::Friction, 0.5)]);
        hold_to_verdict(&matched);
        if number % 2 == 0 {
            let table = turning(&matched, "follows", None, -0.3 * scene.number(Name::ContactDistance).unwrap());
            let table = table.build().unwrap();
            let linear = small_deviations(&table).unwrap().linear;
            if linear.critical_tilt_gain > 1.0 {
                let inside = 1.0 + share * (linear.critical_tilt_gain - 1.0);
                hold_to_verdict(&with(table.draft(), &[(Name::TiltGain, inside)]));
            }
        }
    }
}

#[test]
fn limits_are_found_from_outside_as_well() {
    let mut random = Random::new(2202);
    for share in [-0.3, 1.4] {
        let scene = rod(&mut random, share, &[]);
        let linear = small_deviations(&scene).unwrap().linear;
        let found = limits(&scene, KAPPA);
        assert!(!found.bounded);
        if share < 0.0 {
            near(found.upper.as_ref(), 1.0, 1.0, &scene);
        } else {
            near(found.lower.as_ref(), linear.critical_tilt_gain, -1.0, &scene);
        }
    }
}

#[test]
fn the_upper_end_of_the_energy_gain_is_its_closed_form() {
    let mut random = Random::new(2203);
    for measure in ["vertical", "total", "vertical"] {
        let scene = rod(&mut random, 0.4, &[]);
        let draft = worded(scene.draft(), &[(Name::EnergyMeasure, measure)]);
        let scene = with(draft, &[(Name::EnergyGain, 0.01), (Name::TargetHeight, scene.release().height)]);
        let linear = small_deviations(&scene).unwrap().linear;
        let found = limits(&scene, Parameter::Field(Name::EnergyGain));
        near(found.upper.as_ref(), linear.upper_energy_gain, -1.0, &scene);
        let lower = found.lower.unwrap();
        assert!(lower.value.abs() < 1e-8 && lower.kind == LimitKind::Eigenvalue(1.0.into()), "{lower:?}");
    }
}

/// With a wrong belief the height moves with the gain, and the ends of the gain with it.
#[test]
fn the_ends_of_the_energy_gain_of_a_table_that_errs_count_the_height_that_moves() {
    let mut random = Random::new(2209);
    let mut checked = 0;
    for (measure, error) in [("vertical", 0.04), ("total", 0.03), ("vertical", -0.03), ("total", -0.02)] {
        for other in [&[][..], &[(Name::SpeedError, 0.01)], &[(Name::RotationDrag, 0.05)]] {
            let scene = rod(&mut random, 0.4, other);
            let aimed = 2.0 * scene.gravity() * (scene.release().height - scene.number(Name::ContactDistance).unwrap());
            let restitution = scene.number(Name::Restitution).unwrap() * 0.9;
            let numbers = [
                (Name::EnergyGain, 0.3 / aimed),
                (Name::TargetHeight, scene.release().height),
                (Name::Restitution, restitution),
                (Name::AssumedRestitution, restitution + error),
            ];
            let scene = with(worded(scene.draft(), &[(Name::EnergyMeasure, measure)]), &numbers);
            let mut small = small_deviations(&scene).unwrap();
            search_ends(&scene, &mut small, &mut || true).unwrap();
            let (linear, found) = (&small.linear, limits(&scene, Parameter::ENERGY_GAIN));
            let upper = found.upper.unwrap().value * scene.speed_factor();
            assert!((upper / linear.upper_energy_gain - 1.0).abs() < 1e-8, "{upper} {linear:?}: {scene:?}");
            // A bounce that comes to rest is found less exactly.
            let lower = found.lower.map_or(0.0, |limit| limit.value.max(0.0)) * scene.speed_factor();
            let off = (lower - linear.lower_energy_gain).abs();
            assert!(off <= 1e-3 * lower.max(1e-3 / aimed), "{lower} {linear:?}: {scene:?}");
            checked += u32::from(linear.lower_energy_gain > 0.0);
        }
    }
    assert!(checked >= 8, "{checked}");
}

/// Ends are those of the table, and limits those of the field, which differ by the error of the gain.
#[test]
fn an_error_of_the_gain_divides_its_limits_once() {
    let mut random = Random::new(2210);
    for error in [-0.2, 0.1] {
        let rod = rod(&mut random, 0.3, &[]);
        let told = rod.number(Name::TiltGain).unwrap() / (1.0 + error);
        let rod = with(rod.draft(), &[(Name::TiltGain, told), (Name::TiltGainError, error)]);
        let heights = rod.release().height;
        let mut draft = worded(rod.draft(), &[(Name::EnergyLaw, "one_strike")]);
        draft.set(Name::Program, HeightProgram::new(&[heights, heights * 1.05]).map(Value::Numbers)).unwrap();
        for scene in [rod, draft.build().unwrap()] {
            let mut small = small_deviations(&scene).unwrap();
            let (losses, _) = search_ends(&scene, &mut small, &mut || true).unwrap();
            let found = limits(&scene, KAPPA);
            let upper = found.upper.unwrap().value;
            let acting = small.linear.critical_tilt_gain;
            assert!((upper * scene.tilt_factor() / acting - 1.0).abs() < 1e-9, "{upper} {acting} {scene:?}");
            for loss in losses.iter().filter(|loss| loss.end == KAPPA) {
                assert!((loss.value / upper - 1.0).abs() < 1e-9, "{loss:?} {upper}");
            }
        }
    }
}

#[test]
fn limits_of_the_feedback_are_the_critical_factors() {
    let mut random = Random::new(2204);
    for _ in 0..6 {
        let scene = rod(&mut random, 0.4, &[(Name::Theta, 0.0)]);
        let place = small_deviations(&scene).unwrap().fixed_point;
        let bounce = BounceModel::rising(&scene.model(), place.speed, 1.0);
        let gain = design_lqr(&bounce, [1.0, 10.0, 0.1, 0.1], 10.0).unwrap().gain;
        for gain in [gain, [0.0, gain[1], gain[2], gain[3]], [0.0, gain[1], 0.0, gain[3]]] {
            let fed_back = fed_back(scene.draft(), gain);
            let states = bounce.fed_back(gain);
            let StableGains { lower, upper } = bounce.stable_factors(gain, states).unwrap();
            let factors = [lower, upper];
            let found = limits(&fed_back, Parameter::FeedbackFactor);
            assert!(found.lower.is_some() || found.upper.is_some());
            for limit in found.lower.iter().chain(&found.upper) {
                let apart = factors.iter().map(|it| (it - limit.value).abs()).fold(f64::INFINITY, f64::min);
                assert!(apart < 1e-10 * limit.value, "{limit:?} {factors:?} {fed_back:?}");
            }
        }
    }
}

#[test]
fn a_scene_without_the_number_has_no_limits_and_a_search_stops_when_asked() {
    let scene = rod(&mut Random::new(1), 0.5, &[]);
    assert_eq!(limits_of(&scene, Parameter::FeedbackFactor, &mut || true), Err(NoLimits::NoNumber));
    assert_eq!(limits_of(&scene, Parameter::Field(Name::TableLength), &mut || true), Err(NoLimits::NoNumber));
    let mut asked = 0;
    let mut go_on = || {
        asked += 1;
        asked < 5
    };
    assert_eq!(limits_of(&scene, KAPPA, &mut go_on), Err(NoLimits::Stopped));
}

/// Largest deviation of the angle and of the speed from the bounce that repeats, in the second half of a run from a small one over that in the
/// first half, and the same by the largest eigenvalue. The run is as long as that takes to grow a thousandfold, or as `impacts`.
fn growth(scene: &Scene, impacts: Option<u64>) -> Option<(f64, u64)> {
    let SceneMap { map, reference, guess } = SceneMap::of(scene).ok()?;
    let bounce = find_planned(&map, &guess, &reference).ok()?;
    let map = &bounce.map;
    let largest = modulus(*bounce.eigenvalues.first()?);
    let impacts = impacts.unwrap_or((1e3_f64.ln() / largest.ln()).abs() as u64).max(40);
    if impacts > 20_000 {
        return None;
    }
    let mut start = map.state(&bounce.at);
    (start.theta, start.y_dot) = (start.theta + 1e-9, start.y_dot + 1e-9);
    let mut orbit = Orbit::at(map.body, Rules::BARE_MAP, start).moved(bounce.at[X]);
    let mut halves = [0.0_f64; 2];
    let period = map.period;
    for n in 0..impacts {
        for _ in 0..period {
            if orbit.advance().ending.is_some() {
                return None;
            }
        }
        let state = orbit.state();
        let off = (state.theta - bounce.at[ARC] / map.body.rod.radius_of_gyration).abs();
        let half = &mut halves[usize::from(2 * n >= impacts)];
        *half = half.max(off).max((state.y_dot - bounce.at[Y_DOT]).abs());
    }
    Some((halves[1] / halves[0], impacts))
}

const SMOOTH: [&str; 14] = [
    "angle bias",
    "gain error",
    "offset",
    "delay",
    "predicted delay",
    "turning",
    "drag",
    "rotation drag",
    "vertical energy",
    "total energy",
    "one strike",
    "matched friction",
    "feedback",
    "feedback of the angle",
];

#[test]
fn small_deviations_stay_small_inside_a_limit_and_grow_outside() {
    let mut random = Random::new(2205);
    let mut held = [0; 2];
    for number in 0..60 {
        let mix = Mix::draw(&mut random, Swing::Calm, &SMOOTH);
        let scene = with(mix.scene.draft(), &[(Name::Theta, 0.0), (Name::ThetaDot, 0.0)]);
        let gain = if mix.has(&["feedback", "feedback of the angle"]) { Parameter::FeedbackFactor } else { KAPPA };
        let parameter = if number % 2 == 0 { Parameter::Field(Name::Height) } else { gain };
        let found = limits(&scene, parameter);
        for limit in [&found.lower, &found.upper].into_iter().flatten() {
            if !matches!(limit.kind, LimitKind::Eigenvalue(_)) {
                continue;
            }
            let beside = |share: f64| parameter.moved(&scene, found.value + (limit.value - found.value) * share).ok();
            let (inside, outside) = if found.bounded { (0.98, 1.02) } else { (1.02, 0.98) };
            let (Some(inside), Some(outside)) = (beside(inside), beside(outside)) else { continue };
            let Some((grown, impacts)) = growth(&outside, None) else { continue };
            let (kept, _) = growth(&inside, Some(impacts)).unwrap();
            assert!(grown > 15.0 && kept < 3.0, "{:?} {grown} {kept} {limit:?} {scene:?}", mix.features);
            held[usize::from(parameter == gain)] += 1;
        }
    }
    println!("{held:?}");
    assert!(held[0] >= 8 && held[1] >= 20, "{held:?}");
}
