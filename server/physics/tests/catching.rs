//! Catching: the reference catches strike by strike, the gain schedule, and properties over random releases.

use crate::support::rig_runs::{self, with};
use crate::support::upright::body_in;
use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::catching::aim::{GainSchedule, contact_gain};
use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Catch, CatchFailure};
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::control::lqr::DesignFailure;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::strike::Rod;
use equipoise_physics::map::table::control_law::Gains;
use equipoise_physics::scene::{Name, Scene};
use serde_json::Value as Json;
use std::path::Path;

const WEIGHTS: ([f64; 4], f64) = ([1.0, 10.0, 0.1, 0.1], 10.0);

/// The body of the paper, released at rest at 0.25 m and 0.1 rad, with these fields besides.
fn scene(fields: &[(Name, f64)]) -> Scene {
    with(rig_runs::scene(&[(Name::Height, 0.25)]).draft(), fields)
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
