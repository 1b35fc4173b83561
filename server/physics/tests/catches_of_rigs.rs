//! Catches and throws on any rig: in air, with constant errors, delays, noise, ends and turning tables. Their flights are those of the map, and
//! contact in air that of its Lagrange equation.

use crate::support::features::{Mix, Swing, all_but};
use crate::support::random::Random;
use crate::support::rig_runs::{self, with, worded};
use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::{Catch, CatchNote, CatchOutcome};
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::catching::throw::{ThrowTarget, throw};
use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::flight::{AirDrag, Flight};
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::{PlannedTableMotion, Rod, State};
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::lasting_contact::{ContactStart, HoldEnding, HoldLaw, HoldRequest, hold};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Name, Scene};

/// The paper's rod from a height, with further fields.
fn scene(numbers: &[(Name, f64)], words: &[(Name, &'static str)]) -> Scene {
    let rod = rig_runs::scene(&[(Name::Height, 0.3), (Name::X, 0.05), (Name::Restitution, 0.8)]);
    with(worded(rod.draft(), words), numbers)
}

fn caught(scene: &Scene, strategy: Option<Strategy>) -> Catch {
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
        let catch = caught(&mix.scene, Some(Strategy::BounceDown));
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
        let scene = scene(&[(Name::Drag, drag), (Name::RotationDrag, 0.5 * drag)], &[]);
        let catch = caught(&scene, Some(Strategy::Plan));
        assert_eq!(catch.outcome, CatchOutcome::Held);
        assert!(!catch.notes.iter().any(|note| matches!(note, CatchNote::PlanGivenUp { .. })), "{:?}", catch.notes);
        // The stop meets an upright body in place.
        let stop = catch.strikes.last().unwrap();
        let State { theta, x_dot, theta_dot, .. } = stop.state;
        for (name, off) in [("x", stop.x), ("theta", theta), ("x_dot", x_dot), ("theta_dot", theta_dot)] {
            assert!(off.abs() < 0.02, "{drag}: {name} is {off}");
        }
        flights_follow(&scene, &catch);
        // A belief that is wrong is learned in spite of what the air takes.
        let wrong = self::scene(&[(Name::Drag, drag), (Name::AssumedRestitution, 0.7)], &[]);
        let learned = caught(&wrong, Some(Strategy::Plan));
        let shown = learned.notes.iter().find_map(|note| match note {
            CatchNote::LearnedRestitution { shown, .. } => Some(*shown),
            _ => None,
        });
        assert!((shown.unwrap() - 0.8).abs() < 1e-9, "{drag}: {shown:?}");
    }
}

#[test]
fn a_delay_and_a_turning_change_no_strike() {
    let plain = caught(&scene(&[], &[]), Some(Strategy::Plan));
    for other in [
        scene(&[(Name::Delay, 0.01)], &[]),
        scene(&[(Name::Delay, 0.01)], &[(Name::Prediction, "flight")]),
        scene(&[(Name::PivotX, 0.1), (Name::PivotDepth, 0.03)], &[(Name::TiltRate, "follows")]),
    ] {
        assert_eq!(caught(&other, Some(Strategy::Plan)).strikes, plain.strikes);
    }
}

#[test]
fn errors_that_the_table_does_not_know_move_the_rest() {
    // In contact −K(x, θ + b, ẋ, θ̇)(1 + ε) + c is 0 at rest: x* = (c/(1 + ε) − K_θ b)/K_x.
    let errors = [(Name::AngleBias, 1e-3), (Name::TiltOffset, 2e-3), (Name::TiltGainError, 0.02)];
    let settings = CatchSettings { hold: 30.0, strategy: Some(Strategy::BounceDown), ..CatchSettings::default() };
    let catch = catch(&scene(&errors, &[]), &settings, None, &mut || true).unwrap();
    assert_eq!(catch.outcome, CatchOutcome::Held);
    let last = *catch.hold.unwrap().samples.last().unwrap();
    let [x, theta] = [0.316_227_766_016_837_44, -2.907_809_175_545_411_4];
    let expected = (2e-3 / 1.02 - theta * 1e-3) / x;
    assert!((last.x - expected).abs() < 1e-6 && last.theta.abs() < 1e-6, "{last:?} {expected}");
    // Beyond the end of a short table it falls off.
    let upright = [(Name::Theta, 0.0), (Name::X, 0.0), (Name::TableLength, 0.02)];
    let short: Vec<_> = errors.into_iter().chain(upright).collect();
    let off = self::caught(&scene(&short, &[]), Some(Strategy::BounceDown));
    let CatchOutcome::Ended { ending: Ending::OffTable { place, limit }, .. } = off.outcome else {
        panic!("{:?}", off.outcome)
    };
    assert!(limit == 0.01 && (place.abs() - limit).abs() < 1e-9, "{place}");
}

#[test]
fn a_contact_with_friction_and_errors_is_held() {
    let errors = [(Name::Friction, 0.6), (Name::AngleBias, 1e-3), (Name::TiltOffset, 2e-3), (Name::Drag, 0.2)];
    let catch = caught(&scene(&errors, &[]), Some(Strategy::BounceDown));
    assert_eq!(catch.outcome, CatchOutcome::Held);
    let last = *catch.hold.unwrap().samples.last().unwrap();
    assert!((last.alpha - 2e-3).abs() < 1e-15, "{last:?}");
}

#[test]
fn a_throw_misses_by_the_errors_of_its_table() {
    let coming = PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: -0.5, theta_dot: 0.0 });
    let target = ThrowTarget { height: 0.3, theta: 0.0 };
    let exact = throw(&scene(&[], &[]), &coming, &target).unwrap();
    let off = throw(&scene(&[(Name::TiltOffset, 1e-3), (Name::SpeedError, 0.01)], &[]), &coming, &target).unwrap();
    assert!(exact.residual < 1e-12 && off.residual > 1e-4);
    let PlannedTableMotion { alpha, normal_velocity, .. } = off.motion;
    assert!((alpha - 1e-3).abs() < 1e-15 && (normal_velocity / exact.motion.normal_velocity - 1.01).abs() < 1e-12);
    assert!(throw(&scene(&[(Name::TableLength, 0.1)], &[]), &PreImpact { x: 0.06, ..coming }, &target).is_err());
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
    let (rod, c, turn) = (scene(&[], &[]).parameters::<f64>(), 1.5, 0.7);
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
    let scene = scene(&numbers, &[(Name::Strike, "still")]);
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
