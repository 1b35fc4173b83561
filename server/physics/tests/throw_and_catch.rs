//! Throws in a row: a thrown body is caught, also after a flip, and throws at each impact juggle as a program of heights does.

use crate::support::rig_runs::{self, with};
use equipoise_physics::catching::catch;
use equipoise_physics::catching::outcome::CatchOutcome;
use equipoise_physics::catching::plan::{PlanProblem, believed_body, plan_catch};
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::catching::throw::{Throw, ThrowTarget, throw};
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::program::HeightProgram;
use equipoise_physics::scene::{Name, Scene, Value};
use std::f64::consts::TAU;

fn scene(settings: &[(Name, Value)]) -> Scene {
    let mut draft = rig_runs::scene(&[(Name::Theta, 0.0), (Name::Height, 0.25)]).draft();
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
    let scene = scene(&[(Name::Restitution, Value::Number(0.8))]);
    let resting = PreImpact::at(1, 0.1, State { theta: 0.05, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 });
    let found = throw(&scene, &resting, &ThrowTarget { height: 0.4, theta: 0.1 }).unwrap();
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
    let scene = scene(&[]);
    let resting = PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 });
    let found = throw(&scene, &resting, &ThrowTarget { height: 1.0, theta: 0.5 * TAU }).unwrap();
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
        let programmed = scene(&[e, (Name::EnergyLaw, Value::Choice("one_strike")), (Name::Program, program)]);
        let plain = scene(&[e]);
        let mut orbit = programmed.orbit().unwrap();
        let mut release = *plain.release();
        for n in 0..12 {
            let contact = orbit.advance();
            let strike = contact.strike.unwrap();
            let (_, state) = plain.parameters::<f64>().fall(&release).unwrap();
            assert!((state.y_dot - contact.state.y_dot).abs() < 1e-12, "{n}");
            let target = ThrowTarget { height: heights[n % heights.len()], theta: 0.0 };
            let found = throw(&plain, &PreImpact::at(1, 0.0, state), &target).unwrap();
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
