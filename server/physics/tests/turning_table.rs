//! Tables that turn as they strike: against an impulse followed step by step, and turning that changes no bounce.

use crate::paper;
use crate::support::features::{Mix, Swing};
use crate::support::random::Random;
use crate::support::turning as turning_scenes;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Value};
use turning_scenes::{contacts, number, numbers, turning, with};

/// Velocity of the contact point, m/s.
fn contact_velocity(length: f64, state: &State) -> [f64; 2] {
    let (sin, cos) = state.theta.sin_cos();
    [state.x_dot + length * state.theta_dot * cos, state.y_dot + length * state.theta_dot * sin]
}

/// Routh's impulse with Poisson's law, followed in small steps of the normal impulse.
fn stepped(friction: f64, e: f64, [a, b, c]: [f64; 3], [mut along, mut across]: [f64; 2]) -> [f64; 2] {
    const STEPS: f64 = 40_000.0;
    let step = -across / b / STEPS;
    let (mut normal, mut tangential) = (0.0, 0.0);
    let mut end = f64::INFINITY;
    while normal < end {
        // The impulse along the table that would bring the contact to rest, as far as friction reaches.
        let most = friction * step;
        let pull = (-(along + c * step) / a).clamp(-most, most);
        along += a * pull + c * step;
        across += c * pull + b * step;
        normal += step;
        tangential += pull;
        if across >= 0.0 && end == f64::INFINITY {
            end = (1.0 + e) * normal;
        }
        assert!(normal < 100.0 * STEPS * step, "it ends");
    }
    [normal, tangential]
}

#[test]
fn friction_acts_on_the_velocity_relative_to_the_turning_surface() {
    let mut random = Random::new(11);
    let mut modes = Vec::new();
    let features = ["friction", "matched friction", "turning", "turning in place", "feedback", "vertical energy"];
    for _ in 0..1000 {
        let mix = Mix::draw(&mut random, Swing::Wide, &features);
        if !mix.has(&features[..2]) || !mix.has(&features[2..4]) {
            continue;
        }
        let mut draft = mix.scene.draft();
        draft.set(Name::Law, Some(Value::Choice("poisson"))).unwrap();
        number(&mut draft, Name::Friction, random.between(0.01, 0.3));
        number(&mut draft, Name::ThetaDot, random.size(0.1, 10.0));
        number(&mut draft, Name::XDot, random.size(0.1, 1.0));
        let scene = draft.build().unwrap();
        let rod = scene.parameters::<f64>();
        let (lever, mu) = (rod.contact_distance / rod.radius_of_gyration, scene.number(Name::Friction).unwrap());
        for contact in contacts(&scene, 4).0 {
            let Some(strike) = contact.strike.filter(|strike| strike.push < 0.0) else { continue };
            let (sin, cos) = strike.alpha.sin_cos();
            let velocity = contact_velocity(rod.contact_distance, &contact.state);
            let (x, y) = (velocity[0] - strike.table_velocity.0, velocity[1] - strike.table_velocity.1);
            let (sin_beta, cos_beta) = (contact.state.theta - strike.alpha).sin_cos();
            let (across, along) = (lever * sin_beta, lever * cos_beta);
            let mobility = [1.0 + along * along, 1.0 + across * across, across * along];
            let [normal, tangential] = stepped(mu, rod.restitution, mobility, [cos * x + sin * y, cos * y - sin * x]);
            let off = (normal - strike.impulse_normal).abs().max((tangential - strike.impulse_tangential).abs());
            assert!(off < 1e-3 * strike.impulse_normal, "{off} of {}: {strike:?}\n{scene:?}", strike.impulse_normal);
            if !modes.contains(&strike.mode) {
                modes.push(strike.mode);
            }
        }
    }
    assert!(modes.len() >= 3, "{modes:?}");
}

#[test]
fn turning_that_moves_the_surface_along_itself_changes_no_bounce_without_friction() {
    let ideal = paper::scene(1.1, 0.1);
    let (still, _) = contacts(&ideal, 300);
    for (word, place) in [("follows", None), ("corrected", None), ("corrected", Some(0.2))] {
        let scene = turning(&ideal, word, place, 0.05).build().unwrap();
        assert!(scene.acting_turn().is_none());
        assert!(scene.model().is_plain_rod() && scene.first_beyond_rod().is_none());
        let (course, _) = contacts(&scene, 300);
        assert_eq!(still.len(), course.len());
        for (one, other) in still.iter().zip(&course) {
            assert_eq!(numbers(one), numbers(other));
            // The surface moves along itself.
            let (strike, table) = (one.strike.unwrap(), other.strike.unwrap().table_velocity);
            let (sin, cos) = strike.alpha.sin_cos();
            let speed = -1.1 * one.state.theta_dot * 0.05;
            let (x, y) = (table.0 - strike.table_velocity.0, table.1 - strike.table_velocity.1);
            assert!((x - speed * cos).abs() < 1e-14 && (y - speed * sin).abs() < 1e-14);
        }
    }
    // A matched table that is corrected for it moves with the contact point in any case.
    let mut rough = with(&ideal, &[(Name::Friction, 0.3)]).draft();
    rough.set(Name::Slide, Some(Value::Choice("matched"))).unwrap();
    let rough = rough.build().unwrap();
    let known = turning(&rough, "corrected", Some(0.1), 0.05).build().unwrap();
    assert!(known.acting_turn().is_none());
    let pairs = contacts(&rough, 100).0.into_iter().zip(contacts(&known, 100).0);
    assert!(pairs.clone().count() == 100 && pairs.into_iter().all(|(one, other)| numbers(&one) == numbers(&other)));
    // A pivot in the surface, under the contact, and a table that does not turn, are nothing at all.
    for (word, depth) in [("follows", 0.0), ("none", 0.1)] {
        let scene = turning(&ideal, word, None, depth).build().unwrap();
        assert!(scene.model_level() == ModelLevel::Rod && scene.requirements().is_empty());
        assert_eq!(scene.running_model(), ideal.running_model());
    }
}
