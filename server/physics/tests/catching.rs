//! Catching: the reference catches strike by strike, the gain schedule, and properties over random releases.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::catching::aim::{Aim, GainSchedule, contact_gain};
use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Catch, CatchFailure, CatchNote, CatchOutcome};
use equipoise_physics::catching::plan::{PlanProblem, believed_body, plan_catch};
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::catching::throw::{Throw, ThrowFailure, ThrowTarget, throw};
use equipoise_physics::control::lqr::DesignFailure;
use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::contact_time::first_contact_from_rest;
use equipoise_physics::map::flight::{AirDrag, Flight};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::{ContactMode, PlannedTableMotion, Rod, State};
use equipoise_physics::map::table::control_law::Gains;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::{ContactStart, HoldEnding, HoldLaw, HoldRequest, hold};
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use serde_json::Value as Json;

use crate::paper;
use crate::support::features::{Mix, Swing, all_but};
use crate::support::random::Random;
use crate::support::rig;
use crate::support::rig::{with, worded};
use crate::support::scenes::body_in;

const WEIGHTS: ([f64; 4], f64) = ([1.0, 10.0, 0.1, 0.1], 10.0);

/// The body of the paper, released at rest at 0.25 m and 0.1 rad, with these fields besides.
fn scene(fields: &[(Name, f64)]) -> Scene {
    with(rig::scene(&[(Name::Height, 0.25)]).draft(), fields)
}

fn caught(scene: &Scene, settings: CatchSettings) -> Catch {
    catch(scene, &settings, None, &mut || true).unwrap()
}

fn bounce_down(ratio: f64) -> CatchSettings {
    CatchSettings { strategy: Some(Strategy::BounceDown), ratio: Some(ratio), ..CatchSettings::default() }
}

fn reference() -> Json {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/reference/catching.json");
    serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
}

fn array(gains: Gains) -> [f64; 4] {
    [gains.x, gains.theta, gains.x_dot, gains.theta_dot]
}

fn distance(a: Gains, b: Gains) -> f64 {
    array(a).into_iter().zip(array(b)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn bounces_go_down_strike_by_strike_as_in_the_reference() {
    let catch = caught(&scene(&[]), bounce_down(0.5));
    let reference = &reference()["bounce_down"];
    let expected = reference["strikes"].as_array().unwrap();
    assert_eq!(catch.strikes.len(), expected.len());
    let number = |json: &Json| json.as_f64().unwrap();
    for (at, expected) in catch.strikes.iter().zip(expected) {
        for (name, value) in [
            ("n", at.n as f64),
            ("t", at.t),
            ("x", at.x),
            ("th", at.state.theta),
            ("xd", at.state.x_dot),
            ("yd", at.state.y_dot),
            ("thd", at.state.theta_dot),
            ("al", at.strike.alpha),
            ("w", at.strike.table_speed()),
            ("P", at.strike.impulse_normal),
            ("r", at.ratio()),
            ("vc", -at.contact_speed),
        ] {
            let difference = (value - number(&expected[name])).abs();
            assert!(difference < 1e-10, "{name} of strike {}: {value} is off by {difference:e}", at.n);
        }
        assert_eq!(at.flight_time.is_some(), expected["tau"].is_f64(), "{}", at.n);
    }
    assert!((catch.contact_from.unwrap() - number(&reference["t_hold"])).abs() < 1e-11);
    let (after, expected) = (catch.strikes.last().unwrap().strike.after, &reference["state_at_hold"]);
    for (name, value) in [("th", after.theta), ("xd", after.x_dot), ("yd", after.y_dot), ("thd", after.theta_dot)] {
        assert!((value - number(&expected[name])).abs() < 1e-10, "{name}: {value}");
    }
}

#[test]
fn the_gain_in_contact_is_that_of_the_reference() {
    let rod: Rod = scene(&[]).parameters();
    let gains = contact_gain(&Body::plain(rod), rod.gravity, WEIGHTS.0, WEIGHTS.1).unwrap();
    for (gain, expected) in array(gains).into_iter().zip(reference()["bounce_down"]["K_hold"].as_array().unwrap()) {
        assert!((gain - expected.as_f64().unwrap()).abs() < 1e-9, "{gains:?}");
    }
    for (gain, expected) in array(gains).into_iter().zip([0.3162, -2.9078, 0.3647, -0.2463]) {
        assert!((gain - expected).abs() < 5e-5, "{gains:?}");
    }
}

/// K in contact with a table that pushes as strikes of a ratio do on average, (1 + r)G/(2r).
fn limit(body: &Body, ratio: f64) -> Gains {
    contact_gain(body, body.rod.gravity * (1.0 + ratio) / (2.0 * ratio), WEIGHTS.0, WEIGHTS.1).unwrap()
}

#[test]
fn the_gain_schedule_is_continuous_into_the_contact() {
    let rod: Rod = scene(&[]).parameters();
    for regime in [ContactRegime::Frictionless, ContactRegime::VelocityMatched] {
        let body = body_in(&rod, regime);
        for ratio in [0.2, 0.5, 0.9, 1.0] {
            let schedule = GainSchedule { body, ratio, state_weights: WEIGHTS.0, input_weight: WEIGHTS.1 };
            let limit = limit(&body, ratio);
            // The distance shrinks in proportion to the speed.
            for speed in [1e-2, 1e-3, 1e-4] {
                let off = distance(schedule.gain(speed).unwrap(), limit);
                assert!(off < 20.0 * speed, "{regime:?} r = {ratio}, v = {speed}: off by {off}");
            }
            // And nothing jumps on the way.
            let mut speed = 3.0;
            while speed > 1e-3 {
                let (here, near) = (schedule.gain(speed).unwrap(), schedule.gain(speed * 0.99).unwrap());
                assert!(distance(here, near) < 0.1 * speed.min(1.0), "{regime:?} r = {ratio}, v = {speed}");
                speed *= 0.9;
            }
        }
        // Strikes that keep the height push with the weight.
        let all = GainSchedule { body, ratio: 1.0, state_weights: WEIGHTS.0, input_weight: WEIGHTS.1 };
        let at_rest = contact_gain(&body, rod.gravity, WEIGHTS.0, WEIGHTS.1).unwrap();
        assert!(distance(limit(&body, 1.0), at_rest) < 1e-12);
        assert!(distance(all.gain(1e-5).unwrap(), at_rest) < 1e-3);
    }
}

#[test]
fn weights_that_see_nothing_give_no_law() {
    let rod: Rod = scene(&[]).parameters();
    let gains = contact_gain(&Body::plain(rod), rod.gravity, [0.0; 4], 1.0);
    assert!(gains.is_ok() || gains == Err(DesignFailure::Diverging), "{gains:?}");
    // Without a weight on x the law leaves x out.
    let schedule =
        GainSchedule { body: Body::plain(rod), ratio: 0.5, state_weights: [0.0, 10.0, 0.1, 0.1], input_weight: 10.0 };
    assert_eq!(schedule.gain(1.0).unwrap().x, 0.0);
}

/// Every strategy is stopped at each of its questions, also within the plan of one strike.
#[test]
fn a_catch_stops_at_the_first_no() {
    let scene = scene(&[]);
    for strategy in Strategy::ALL.map(Some).into_iter().chain([None]) {
        let settings = CatchSettings { strategy, ..CatchSettings::default() };
        let mut asked = 0;
        catch(&scene, &settings, None, &mut || {
            asked += 1;
            true
        })
        .unwrap();
        if strategy == Some(Strategy::Plan) {
            assert!(asked > 30, "{asked}");
        }
        for last in [1, 2, asked / 2, asked] {
            let mut asked = 0;
            let stopped = catch(&scene, &settings, None, &mut || {
                asked += 1;
                asked < last
            });
            assert_eq!(stopped.unwrap_err(), CatchFailure::Stopped, "{strategy:?} at {last}");
        }
    }
}

// Catches and throws on any rig: in air, with constant errors, delays, noise, ends and turning tables. Their flights are those of the map, and
// contact in air that of its Lagrange equation.

/// The paper's rod from a height, with further fields.
fn rod_from_height(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Scene {
    let rod = rig::scene(&[(Name::Height, 0.3), (Name::X, 0.05), (Name::Restitution, 0.8)]);
    with(worded(rod.draft(), words), numbers)
}

fn caught_by(scene: &Scene, strategy: Option<Strategy>) -> Catch {
    catch(scene, &CatchSettings { strategy, ..CatchSettings::default() }, None, &mut || true).unwrap()
}

/// Each flight of a catch is the one that follows from its strike.
fn flights_follow(scene: &Scene, catch: &Catch) {
    let body = scene.running_model();
    for pair in catch.strikes.windows(2) {
        let (from, to) = (&pair[0], &pair[1]);
        let flight =
            Flight { clearance: from.clearance, drag: body.drag, ..flight_after(&body.rod, &from.strike.after) };
        let end = flight.end(to.t - from.t);
        let (way, _) = flight.travel(to.t - from.t);
        assert!((from.x + way - to.x).abs() < 1e-12);
        for (one, other) in [
            (end.theta, to.state.theta),
            (end.x_dot, to.state.x_dot),
            (end.y_dot, to.state.y_dot),
            (end.theta_dot, to.state.theta_dot),
        ] {
            assert!((one - other).abs() < 1e-11 * (1.0 + other.abs()), "{one} {other}");
        }
        let gap = flight.gap(to.t - from.t).value;
        assert!((gap - to.clearance).abs() < 1e-12, "{gap} {}", to.clearance);
    }
}

fn flight_after(rod: &Rod, after: &State) -> Flight {
    Flight {
        start: *after,
        sin_cos_theta: (after.theta.sin(), after.theta.cos()),
        clearance: 0.0,
        contact_distance: rod.contact_distance,
        gravity: rod.gravity,
        drag: None,
    }
}

#[test]
fn any_rig_catches() {
    let mut random = Random::new(31);
    let features = all_but(&["wrong belief", "limits", "length", "point mass"]);
    let (mut held, mut all) = (0, 0);
    for _ in 0..150 {
        let mix = Mix::draw(&mut random, Swing::Calm, &features);
        let catch = caught_by(&mix.scene, Some(Strategy::BounceDown));
        flights_follow(&mix.scene, &catch);
        all += 1;
        if catch.outcome.is_caught() {
            held += 1;
        } else {
            // Little friction, an offset, or errors at random are more than a table has to bear.
            let hard = mix.has(&["friction", "matched friction", "offset", "timing", "plan", "sensing", "scatter"]);
            assert!(hard, "{:?}: {:?}", mix.features, catch.outcome);
        }
    }
    assert!(held * 10 > all * 7, "{held} of {all}");
}

#[test]
fn a_plan_through_air_comes_to_rest_as_one_without() {
    for drag in [0.05, 0.5, 3.0] {
        let scene = rod_from_height(&[(Name::Drag, drag), (Name::RotationDrag, 0.5 * drag)], &[]);
        let catch = caught_by(&scene, Some(Strategy::Plan));
        assert_eq!(catch.outcome, CatchOutcome::Held);
        assert!(!catch.notes.iter().any(|note| matches!(note, CatchNote::PlanGivenUp(_))), "{:?}", catch.notes);
        // The stop meets an upright body in place.
        let stop = catch.strikes.last().unwrap();
        let State { theta, x_dot, theta_dot, .. } = stop.state;
        for (name, off) in [("x", stop.x), ("theta", theta), ("x_dot", x_dot), ("theta_dot", theta_dot)] {
            assert!(off.abs() < 0.02, "{drag}: {name} is {off}");
        }
        flights_follow(&scene, &catch);
        // A belief that is wrong is learned in spite of what the air takes.
        let wrong = rod_from_height(&[(Name::Drag, drag), (Name::AssumedRestitution, 0.7)], &[]);
        let learned = caught_by(&wrong, Some(Strategy::Plan));
        let shown = learned.notes.iter().find_map(|note| match note {
            CatchNote::LearnedRestitution { shown, .. } => Some(*shown),
            _ => None,
        });
        assert!((shown.unwrap() - 0.8).abs() < 1e-9, "{drag}: {shown:?}");
    }
}

#[test]
fn a_delay_and_a_turning_change_no_strike() {
    let plain = caught_by(&rod_from_height(&[], &[]), Some(Strategy::Plan));
    for other in [
        rod_from_height(&[(Name::Delay, 0.01)], &[]),
        rod_from_height(&[(Name::Delay, 0.01)], &[(Name::Prediction, "flight")]),
        rod_from_height(&[(Name::PivotX, 0.1), (Name::PivotDepth, 0.03)], &[(Name::TiltRate, "follows")]),
    ] {
        assert_eq!(caught_by(&other, Some(Strategy::Plan)).strikes, plain.strikes);
    }
}

#[test]
fn errors_that_the_table_does_not_know_move_the_rest() {
    // In contact −K(x, θ + b, ẋ, θ̇)(1 + ε) + c is 0 at rest: x* = (c/(1 + ε) − K_θ b)/K_x.
    let errors = [(Name::AngleBias, 1e-3), (Name::TiltOffset, 2e-3), (Name::TiltGainError, 0.02)];
    let settings = CatchSettings { hold: 30.0, strategy: Some(Strategy::BounceDown), ..CatchSettings::default() };
    let catch = catch(&rod_from_height(&errors, &[]), &settings, None, &mut || true).unwrap();
    assert_eq!(catch.outcome, CatchOutcome::Held);
    let last = *catch.hold.unwrap().samples.last().unwrap();
    let [x, theta] = [0.316_227_766_016_837_44, -2.907_809_175_545_411_4];
    let expected = (2e-3 / 1.02 - theta * 1e-3) / x;
    assert!((last.x - expected).abs() < 1e-6 && last.theta.abs() < 1e-6, "{last:?} {expected}");
    // Beyond the end of a short table it falls off.
    let upright = [(Name::Theta, 0.0), (Name::X, 0.0), (Name::TableLength, 0.02)];
    let short: Vec<_> = errors.into_iter().chain(upright).collect();
    let off = caught_by(&rod_from_height(&short, &[]), Some(Strategy::BounceDown));
    let CatchOutcome::Ended { ending: Ending::OffTable { place, limit }, .. } = off.outcome else {
        panic!("{:?}", off.outcome)
    };
    assert!(limit == 0.01 && (place.abs() - limit).abs() < 1e-9, "{place}");
}

#[test]
fn a_contact_with_friction_and_errors_is_held() {
    let errors = [(Name::Friction, 0.6), (Name::AngleBias, 1e-3), (Name::TiltOffset, 2e-3), (Name::Drag, 0.2)];
    let catch = caught_by(&rod_from_height(&errors, &[]), Some(Strategy::BounceDown));
    assert_eq!(catch.outcome, CatchOutcome::Held);
    let last = *catch.hold.unwrap().samples.last().unwrap();
    assert!((last.alpha - 2e-3).abs() < 1e-15, "{last:?}");
}

#[test]
fn a_throw_misses_by_the_errors_of_its_table() {
    let coming = PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: -0.5, theta_dot: 0.0 });
    let target = ThrowTarget { height: 0.3, theta: 0.0 };
    let exact = throw(&rod_from_height(&[], &[]), &coming, None, &target).unwrap();
    let off =
        throw(&rod_from_height(&[(Name::TiltOffset, 1e-3), (Name::SpeedError, 0.01)], &[]), &coming, None, &target)
            .unwrap();
    assert!(exact.residual < 1e-12 && off.residual > 1e-4);
    let PlannedTableMotion { alpha, normal_velocity, .. } = off.motion;
    assert!((alpha - 1e-3).abs() < 1e-15 && (normal_velocity / exact.motion.normal_velocity - 1.01).abs() < 1e-12);
    assert!(
        throw(&rod_from_height(&[(Name::TableLength, 0.1)], &[]), &PreImpact { x: 0.06, ..coming }, None, &target)
            .is_err()
    );
}

/// θ of a body on a level table that only its own equation of motion follows, by Runge and Kutta's method.
fn followed(start: (f64, f64), duration: f64, second: impl Fn(f64, f64) -> f64) -> (f64, f64) {
    let steps = 20_000;
    let h = duration / f64::from(steps);
    let (mut theta, mut rate) = start;
    for _ in 0..steps {
        let k1 = (rate, second(theta, rate));
        let k2 = (rate + 0.5 * h * k1.1, second(theta + 0.5 * h * k1.0, rate + 0.5 * h * k1.1));
        let k3 = (rate + 0.5 * h * k2.1, second(theta + 0.5 * h * k2.0, rate + 0.5 * h * k2.1));
        let k4 = (rate + h * k3.1, second(theta + h * k3.0, rate + h * k3.1));
        theta += h / 6.0 * (k1.0 + 2.0 * (k2.0 + k3.0) + k4.0);
        rate += h / 6.0 * (k1.1 + 2.0 * (k2.1 + k3.1) + k4.1);
    }
    (theta, rate)
}

#[test]
fn contact_in_air_is_that_of_lagrange_s_equation() {
    let (rod, c, turn) = (rod_from_height(&[], &[]).parameters::<f64>(), 1.5, 0.7);
    let Rod { contact_distance: l, radius_of_gyration: rho, gravity, .. } = rod;
    let body = Body { drag: AirDrag::new(c, turn), ..Body::plain(rod) };
    let start = ContactStart { theta: 0.1, theta_dot: -0.3, x_dot: 0.2, ..ContactStart::default() };
    let rules = Rules { topple_angle: 1.5, ..Rules::BARE_MAP };
    let request = HoldRequest::new(&body, &rules, HoldLaw::tilt_gain(0.0), start, 0.25);
    // (ρ² + l² sin²θ)θ̈ + l² sin θ cos θ θ̇² = Gl sin θ − (c l² sin²θ + c_θ ρ²)θ̇, ẍ = −cẋ.
    let held = hold(&request, &mut || true);
    assert_eq!(held.ending, HoldEnding::Completed);
    let within = |found: f64, expected: f64, bound: f64| (found - expected).abs() <= bound + 1e-11;
    assert!(held.error_bound < 1e-6);
    let last = held.samples.last().unwrap();
    let (theta, rate) = followed((0.1, -0.3), 0.25, |theta, rate| {
        let (sin, cos) = theta.sin_cos();
        let drag = (c * l * l * sin * sin + turn * rho * rho) * rate;
        (gravity * l * sin - drag - l * l * sin * cos * rate * rate) / (rho * rho + l * l * sin * sin)
    });
    assert!(within(last.theta, theta, held.error_bound) && within(rho * last.theta_dot, rho * rate, held.error_bound));
    assert!((last.x_dot - 0.2 * (-c * 0.25_f64).exp()).abs() < 1e-11, "{last:?}");
    // A contact that sticks turns about its point: (ρ² + l²)θ̈ = Gl sin θ − (c l² + c_θ ρ²)θ̇.
    let start = ContactStart { x_dot: -l * 0.1_f64.cos() * -0.3, ..start };
    let friction = Friction { coefficient: 50.0, law: RestitutionLaw::Poisson, slide: Slide::None };
    let body = Body { friction: Some(friction), ..request.body };
    let sticks = hold(&HoldRequest { body, start, ..request }, &mut || true);
    let last = sticks.samples.last().unwrap();
    let (theta, rate) = followed((0.1, -0.3), 0.25, |theta, rate| {
        (gravity * l * theta.sin() - (c * l * l + turn * rho * rho) * rate) / (rho * rho + l * l)
    });
    assert!(
        within(last.theta, theta, sticks.error_bound) && within(rho * last.theta_dot, rho * rate, sticks.error_bound)
    );
    assert!(sticks.error_bound < 1e-6);
}

#[test]
fn a_run_in_air_that_settles_goes_on_in_contact() {
    let numbers = [(Name::Drag, 0.3), (Name::RotationDrag, 0.2), (Name::Restitution, 0.5)];
    let scene = rod_from_height(&numbers, &[(Name::Strike, "still")]);
    let mut orbit = scene.orbit().unwrap();
    let mut last = None;
    let ending = equipoise_physics::run::orbit::run(&mut orbit, 10_000, |contact| {
        last = Some(*contact);
        true
    });
    let Some(Ending::Settled { settle_time, .. }) = ending else { panic!("{ending:?}") };
    let request =
        equipoise_physics::run::lasting_contact::rest_of_run(&scene, &last.unwrap(), settle_time, 0.5).unwrap();
    assert_eq!(request.body.drag, AirDrag::new(0.3, 0.2));
    let held = hold(&request, &mut || true);
    assert!(held.error_bound < 1e-6 && held.samples.len() > 2, "{:?} {}", held.ending, held.error_bound);
}

// Throws in a row: a thrown body is caught, also after a flip, and throws at each impact juggle as a program of heights does.

fn scene_with(settings: &[(Name, Value)]) -> Scene {
    let mut draft = rig::scene(&[(Name::Theta, 0.0), (Name::Height, 0.25)]).draft();
    for (name, value) in settings {
        draft.set(*name, Some(*value)).unwrap();
    }
    draft.build().unwrap()
}

/// The scene whose run begins just after a throw.
fn thrown(scene: &Scene, found: &Throw) -> Scene {
    let State { theta, x_dot, y_dot, theta_dot } = found.release.state;
    let values = [
        (Name::Height, found.release.height),
        (Name::X, found.release.x),
        (Name::Theta, theta),
        (Name::XDot, x_dot),
        (Name::YDot, y_dot),
        (Name::ThetaDot, theta_dot),
    ];
    with(scene.draft(), &values)
}

#[test]
fn a_thrown_body_is_caught() {
    let scene = scene_with(&[(Name::Restitution, Value::Number(0.8))]);
    let resting = PreImpact::at(1, 0.1, State { theta: 0.05, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 });
    let found = throw(&scene, &resting, None, &ThrowTarget { height: 0.4, theta: 0.1 }).unwrap();
    for strategy in [Strategy::BounceDown, Strategy::Plan, Strategy::Brake] {
        let settings = CatchSettings { strategy: Some(strategy), ..CatchSettings::default() };
        let caught = catch(&thrown(&scene, &found), &settings, None, &mut || true).unwrap();
        assert_eq!(caught.outcome, CatchOutcome::Held, "{strategy:?}");
        // The first contact is where the throw lands.
        let landing = found.landing.unwrap();
        let first = caught.strikes.first().map_or(caught.contact_from.unwrap(), |strike| strike.t);
        assert!((first - landing.t).abs() < 1e-12, "{first} {landing:?}");
    }
}

#[test]
fn a_whole_turn_is_followed_by_a_plan_to_rest() {
    // Half a turn up to the apex and half a turn down: the body lands as it was thrown.
    let scene = scene_with(&[]);
    let resting = PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 });
    let found = throw(&scene, &resting, None, &ThrowTarget { height: 1.0, theta: 0.5 * TAU }).unwrap();
    let landing = found.landing.unwrap();
    assert!((landing.state.theta - TAU).abs() < 1e-9, "{landing:?}");
    // A strike does not tell a whole turn from none.
    let state = State { theta: landing.state.theta - TAU, ..landing.state };
    let coming = PreImpact::at(1, found.strike.after.x_dot * landing.t, state);
    let body = believed_body(scene.parameters(), 0.0);
    let plan = plan_catch(&PlanProblem { body, strikes: 8, ratio: 0.9 }, &coming, None, &mut || true).unwrap();
    assert!(plan.residual < 1e-11, "{}", plan.residual);
    let stop = plan.strikes.last().unwrap();
    assert!(stop.coming.x.abs() < 1e-11 && stop.strike.after.theta_dot.abs() < 1e-11, "{stop:?}");
}

#[test]
fn throws_at_each_impact_juggle_as_a_program_does() {
    let heights = [0.2, 0.3, 0.25];
    let program = Value::Numbers(HeightProgram::new(&heights).unwrap());
    for restitution in [0.6, 1.0] {
        let e = (Name::Restitution, Value::Number(restitution));
        let programmed = scene_with(&[e, (Name::EnergyLaw, Value::Choice("one_strike")), (Name::Program, program)]);
        let plain = scene_with(&[e]);
        let mut orbit = programmed.orbit().unwrap();
        let mut release = *plain.release();
        for n in 0..12 {
            let contact = orbit.advance();
            let strike = contact.strike.unwrap();
            let flight = plain.parameters::<f64>().flight_from(&release);
            let state = flight.end(first_contact_from_rest(&flight).unwrap());
            assert!((state.y_dot - contact.state.y_dot).abs() < 1e-12, "{n}");
            let target = ThrowTarget { height: heights[n % heights.len()], theta: 0.0 };
            let found = throw(&plain, &PreImpact::at(1, 0.0, state), None, &target).unwrap();
            let (_, speed) = strike.table_velocity;
            assert!(
                (found.motion.normal_velocity - speed).abs() < 1e-12,
                "{n}: {} {speed}",
                found.motion.normal_velocity
            );
            assert!((found.strike.after.y_dot - strike.after.y_dot).abs() < 1e-12 && found.motion.alpha == 0.0);
            release = found.release;
        }
    }
}

// Throws: the apex of the exact strike and flight against the target, with friction and without, and the reasons of throws that fail.

const L: f64 = 0.4 / 3.0;
const G: f64 = 9.81;

fn paper_with(settings: &[(Name, Value)]) -> Scene {
    let mut draft = paper::scene(1.1, 0.0).draft();
    for (name, value) in settings {
        draft.set(*name, Some(*value)).unwrap();
    }
    draft.build().unwrap()
}

fn upright() -> PreImpact {
    PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 })
}

/// A state in contact, at rest on the table or coming down.
fn contact(random: &mut Random) -> PreImpact {
    let moving = f64::from(u8::from(random.between(0.0, 1.0) < 0.7));
    let state = State {
        theta: random.between(-0.5, 0.5),
        x_dot: moving * random.between(-0.5, 0.5),
        y_dot: -moving * random.between(0.0, 3.0),
        theta_dot: moving * random.between(-3.0, 3.0),
    };
    PreImpact::at(1, random.between(-1.0, 1.0), state)
}

#[test]
fn half_a_turn_has_its_printed_tilt_and_table_speed() {
    let v = (2.0 * G * (0.2 - L)).sqrt();
    let coming = PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: -v, theta_dot: 0.0 });
    let thrown = throw(&paper_with(&[]), &coming, None, &ThrowTarget { height: 0.4, theta: PI }).unwrap();
    assert!((thrown.motion.alpha - -0.256).abs() < 5e-4, "{thrown:?}");
    assert!((thrown.motion.normal_velocity - 0.894).abs() < 5e-4, "{thrown:?}");
}

#[test]
fn any_rig_throws_to_the_apex_or_says_why() {
    let mut random = Random::new(3);
    let errors = ["angle bias", "tilt offset", "gain error", "speed error", "offset", "wrong belief"];
    let features = all_but(&[&errors[..], &["point mass", "limits", "length"]].concat());
    let (mut thrown, mut short) = (0, 0);
    for _ in 0..3000 {
        let mix = Mix::draw(&mut random, Swing::Calm, &features);
        let (scene, coming) = (&mix.scene, contact(&mut random));
        let body = Body { noise: None, outline: None, ..scene.running_model() };
        let Rod { contact_distance: l, gravity, restitution, .. } = body.rod;
        let is_rough = mix.has(&["friction", "matched friction"]);
        let turns = if is_rough { 8.0 } else { 1.0 } * random.between(-2.5, 2.5).round();
        let target =
            ThrowTarget { height: l + random.between(0.05, 1.0), theta: PI * turns + random.between(-1.5, 1.5) };
        let found = match throw(scene, &coming, None, &target) {
            Ok(found) => found,
            Err(ThrowFailure::AngleOutOfReach { reach, .. }) => {
                short += 1;
                assert!(is_rough, "{:?}", mix.features);
                let is_beyond = |(least, most): (f64, f64)| target.theta < least + 0.2 || target.theta > most - 0.2;
                assert!(reach.is_none_or(is_beyond), "{target:?} {reach:?}");
                continue;
            }
            Err(_) => continue,
        };
        thrown += 1;
        let Throw { strike, motion, apex, release, .. } = found;
        assert!(found.residual < 1e-9 && is_rough == (found.iterations > 0), "{:?} {found:?}", mix.features);
        // The flight that starts there is at the target as it stops rising; without air by its closed form alone.
        let flight = body.flight(release.state, coming.clearance);
        let (top, rise) = (flight.end(apex.t), flight.travel(apex.t).1);
        assert!(top.y_dot.abs() < 1e-9 && (top.theta - target.theta).abs() < 1e-8, "{:?} {top:?}", mix.features);
        assert!((release.height + rise - target.height).abs() < 1e-9, "{:?} {rise}", mix.features);
        if body.drag.is_none() {
            let (t, after) = (strike.after.y_dot / gravity, strike.after);
            let y = l * after.theta.cos() + 0.5 * after.y_dot * t;
            assert!(
                (y - target.height).abs() < 1e-9 && (after.theta + after.theta_dot * t - target.theta).abs() < 1e-8
            );
        }
        // The strike is that of a contact: v_n⁺ − w = −e(v_n − w), or within the cone of friction.
        if is_rough {
            let most = scene.number(Name::Friction).unwrap() * strike.impulse_normal;
            assert!(strike.impulse_tangential.abs() <= most * (1.0 + 1e-12), "{found:?}");
        } else {
            let normal = |state: &State| {
                let arm = l * (state.theta - motion.alpha).sin() * state.theta_dot;
                motion.alpha.cos() * state.y_dot - motion.alpha.sin() * state.x_dot + arm - motion.normal_velocity
            };
            assert!((normal(&strike.after) + restitution * normal(&coming.state)).abs() < 1e-11, "{:?}", mix.features);
        }
        // A run from the release lands where the throw does.
        if let Ok(landing) = found.landing {
            let orbit = Orbit::new(body, Rules::BARE_MAP, &release).unwrap();
            let (t, theta) = (orbit.t(), orbit.state().theta);
            assert!((t - landing.t).abs() < 1e-9 && (theta - landing.state.theta).abs() < 1e-8, "{:?}", mix.features);
        }
        // Of two tilts of one size, on either side, a body and its mirror image may take the same.
        let mirrored = PreImpact::at(1, -coming.x, mirror(&coming.state));
        let opposite = throw(scene, &mirrored, None, &ThrowTarget { theta: -target.theta, ..target }).unwrap();
        let apart = opposite.motion.alpha.abs() - motion.alpha.abs();
        assert!(apart.abs() < 1e-8, "{:?} {opposite:?} {found:?}", mix.features);
    }
    assert!(thrown > 2000 && short > 0, "{thrown} {short}");
}

fn mirror(state: &State) -> State {
    State { theta: -state.theta, x_dot: -state.x_dot, theta_dot: -state.theta_dot, ..*state }
}

#[test]
fn whole_turns_need_more_tilt_than_half_turns() {
    let scene = paper_with(&[]);
    let tilt = |theta: f64| throw(&scene, &upright(), None, &ThrowTarget { height: 1.0, theta }).unwrap().motion.alpha;
    assert!(tilt(0.0) == 0.0 && tilt(PI) < 0.0 && tilt(TAU) < tilt(PI) && tilt(-PI) == -tilt(PI));
}

#[test]
fn a_table_with_a_wrong_belief_misses_and_says_by_how_much() {
    let scene = paper_with(&[(Name::Restitution, Value::Number(0.8)), (Name::AssumedRestitution, Value::Number(1.0))]);
    let found = throw(&scene, &upright(), None, &ThrowTarget { height: 0.4, theta: 0.0 }).unwrap();
    // From rest the impulse is (1 + e)w in place of (1 + ê)w.
    let reached = L + (0.4 - L) * 0.81;
    assert!((found.apex.y - reached).abs() < 1e-12 && (found.residual - (0.4 - reached)).abs() < 1e-12, "{found:?}");
}

#[test]
fn throws_that_cannot_be_say_why() {
    let target = ThrowTarget { height: 0.4, theta: 0.0 };
    let of = |settings: &[(Name, Value)], coming: &PreImpact, target: ThrowTarget| {
        throw(&paper_with(settings), coming, None, &target).unwrap_err()
    };
    let low = of(&[], &upright(), ThrowTarget { height: 0.1, ..target });
    assert!(matches!(low, ThrowFailure::TooLow { height: 0.1, least } if least == L), "{low:?}");
    let mut rising = upright();
    rising.state.y_dot = 5.0;
    assert!(matches!(of(&[], &rising, target), ThrowFailure::CannotPush { y_dot: 5.0, .. }));
    let mut lying = upright();
    lying.state.theta = 2.0;
    assert_eq!(of(&[], &lying, target), ThrowFailure::Lying { theta: 2.0 });
    let limited = of(&[(Name::SpeedLimit, Value::Number(0.5))], &upright(), target);
    assert!(matches!(limited, ThrowFailure::BeyondLimits(violation) if violation.quantity == "speed"), "{limited:?}");
    // The centre of gravity stays lower than l, so that the contact point cannot pass under it.
    let mut leaning = upright();
    leaning.state.theta = 0.4;
    let turned = ThrowTarget { height: 0.99 * L, theta: 0.4 + TAU };
    assert!(matches!(of(&[], &leaning, turned), ThrowFailure::ContactReturns { t, apex } if t < apex));
    let sinking = ThrowTarget { height: 0.95 * L, theta: -3.0 };
    assert!(matches!(of(&[], &leaning, sinking), ThrowFailure::ContactSinks { contact_rise } if contact_rise < 0.0));
    let rough = of(&[(Name::Friction, Value::Number(0.5))], &upright(), ThrowTarget { height: 0.2, theta: 200.0 });
    // tan α = (ρ²/l)θG/ẏ⁺² of a body at rest: some 80° for almost five turns.
    let fast = ThrowTarget { height: 0.3, theta: 30.0 };
    assert!(matches!(of(&[], &upright(), fast), ThrowFailure::TooSteep { alpha } if alpha < -1.4 && alpha > -1.5));
    let ThrowFailure::AngleOutOfReach { reach: Some((least, most)), .. } = rough else { panic!("{rough:?}") };
    assert!(least < -0.5 && (least + most).abs() < 1e-9 && most < 200.0, "{rough:?}");
    for failure in [low, limited, rough] {
        assert!(failure.to_string().chars().any(|letter| letter.is_ascii_digit()), "{failure}");
    }
}

#[test]
fn a_triangle_that_would_touch_with_another_corner_is_not_thrown() {
    let corners = [[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]];
    let mut draft = Draft::default();
    draft.set_vertices(Some(equipoise_physics::map::polygon::Vertices::new(&corners).unwrap()));
    draft.set(Name::TiltGain, Some(Value::Number(1.1))).unwrap();
    draft.set(Name::Height, Some(Value::Number(0.2))).unwrap();
    let scene = draft.build().unwrap();
    assert!(throw(&scene, &upright(), None, &ThrowTarget { height: 0.4, theta: 0.2 }).is_ok());
    let flip = throw(&scene, &upright(), None, &ThrowTarget { height: 0.15, theta: 3.0 * PI });
    assert!(matches!(flip, Err(ThrowFailure::OtherVertex(_))), "{flip:?}");
}

// Strikes of a table that aims: the chosen ratio of heights, by the exact strike of every law of restitution.

#[test]
fn a_strike_reaches_the_ratio_that_was_aimed_for() {
    let mut random = Random::new(1);
    let (mut held, mut slid) = (0, 0);
    for _ in 0..2000 {
        let mut rod = Rod::lossless(random.between(0.05, 0.5), random.between(0.02, 0.5), 0.0);
        rod.restitution = random.between(0.0, 1.0);
        let coefficient = if random.between(0.0, 1.0) < 0.3 { 0.0 } else { random.between(0.0, 1.0) };
        let state = State {
            theta: random.between(-0.6, 0.6),
            x_dot: random.between(-1.0, 1.0),
            y_dot: random.between(-3.0, -1.0),
            theta_dot: random.between(-2.0, 2.0),
        };
        let (alpha, ratio) = (random.between(-0.3, 0.3), random.between(0.0, 1.3));
        let aim = Aim::new(&believed_body(rod, coefficient), &state, alpha);
        let impulse = aim.impulse_for(ratio);
        if impulse <= 0.0 || rod.contact_speed(&state) >= 0.0 {
            continue;
        }
        for law in [RestitutionLaw::Poisson, RestitutionLaw::Newton, RestitutionLaw::Stronge] {
            let friction = (coefficient > 0.0).then_some(Friction { coefficient, law, slide: Slide::Matched });
            let body = Body { friction, ..Body::plain(rod) };
            let strike = body.strike(&PreImpact { plan: Some(aim.motion(impulse)), ..PreImpact::at(1, 0.0, state) });
            let wanted = -ratio * rod.contact_speed(&state);
            assert!((strike.contact_rise - wanted).abs() < 1e-13 * (1.0 + impulse), "{body:?} {strike:?} {wanted}");
            assert!((strike.impulse_normal - impulse).abs() < 1e-13 * (1.0 + impulse), "{strike:?} {impulse}");
            held += i32::from(strike.mode == ContactMode::Stick);
            slid += i32::from(strike.mode == ContactMode::SlideThrough);
        }
    }
    assert!(held > 500 && slid > 500, "{held} {slid}");
}
