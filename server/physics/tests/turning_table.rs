//! Tables that turn as they strike: against a simulation from Newton's and Euler's equations, an impulse followed step by step, exact
//! identities, and other methods of the same run.

use crate::paper;
use crate::support::methods;
use crate::support::mixes;
use crate::support::random;
use crate::support::rig_runs;
use crate::support::turning as turning_scenes;
use equipoise_physics::bounce::strike::{ContactMode, State, Strike};
use equipoise_physics::run::method::{RunMethod, run_by};
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::model_hierarchy::run_hierarchy;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use equipoise_physics::stability::jacobian::state_order;
use methods::{compare_bounds, compare_derivatives, numbers};
use mixes::{MIXES, Parts, scene as mixed};
use random::Random;
use rig_runs::hold_to_simulation;
use turning_scenes::{contacts, number, turning, with};

/// A random scene with a turning table that is not corrected, of any kind but planning ones.
fn random_scene(random: &mut Random, parts: Parts) -> Scene {
    let scene = mixed(random, parts);
    let place = (!parts.friction || random.between(0.0, 1.0) < 0.5).then(|| random.size(0.001, 0.3));
    turning(&scene, "follows", place, random.size(0.001, 0.1)).build().unwrap()
}

/// Mixes of the parts that a turning table takes.
fn turning_mixes() -> impl Iterator<Item = Parts> {
    let plain = Parts::default();
    MIXES.into_iter().chain([plain]).filter(|parts| parts.noise != Some("plan") && !parts.further && !parts.late)
}

#[test]
fn turning_tables_move_bodies_as_newton_and_euler_say() {
    let mut random = Random::new(25);
    let (mut compared, mut moved) = (0, 0.0_f64);
    for _ in 0..300 {
        let length = random.between(0.05, 0.3);
        let rho = length * random.between(0.3, 1.0);
        let above = length * random.between(0.3, 1.5);
        let kappa = 1.0 + random.between(0.1, 0.9) * rho * rho / (2.0 * above * length);
        let mut draft = Draft::default();
        let feeds_back = random.between(0.0, 1.0) < 0.5;
        for (name, value) in [
            (Name::ContactDistance, length),
            (Name::RadiusOfGyration, rho),
            (Name::Height, length + above),
            (Name::Theta, random.size(0.01, 0.2)),
            (Name::ThetaDot, random.size(0.01, 1.0)),
            (Name::XDot, random.size(0.001, 0.2)),
            (Name::X, random.size(0.001, 0.2)),
            (Name::Restitution, random.between(0.3, 1.0)),
            (Name::AngleBias, random.size(1e-4, 0.01)),
            (Name::TiltGainError, random.size(1e-3, 0.05)),
            (Name::Offset, length * random.size(1e-4, 0.05)),
            (Name::EnergyGain, random.between(0.05, 0.6) / (2.0 * 9.81 * above)),
            (Name::TargetHeight, length + above * random.between(0.8, 1.3)),
        ] {
            number(&mut draft, name, value);
        }
        if feeds_back {
            number(&mut draft, Name::FeedbackX, random.size(0.01, 0.2));
            number(&mut draft, Name::FeedbackTheta, -kappa);
            number(&mut draft, Name::FeedbackXDot, random.size(0.001, 0.05));
            number(&mut draft, Name::FeedbackThetaDot, random.size(0.0001, 0.005));
        } else {
            number(&mut draft, Name::TiltGain, kappa);
        }
        let still = draft.build().unwrap();
        let place = random.size(0.001, 0.3);
        let scene = turning(&still, "follows", Some(place), random.size(0.001, 0.1)).build().unwrap();
        let (course, _) = contacts(&scene, 12);
        let found: Vec<_> = course.iter().map(numbers).collect();
        compared += hold_to_simulation(&found, &scene, 1e-9);
        let (ideal, _) = contacts(&still, 12);
        moved = course.iter().zip(&ideal).map(|(a, b)| (a.state.y_dot - b.state.y_dot).abs()).fold(moved, f64::max);
    }
    assert!(compared > 1500 && moved > 0.5, "{compared} contacts, moved by {moved} m/s");
}

/// Velocity of the surface at the contact of a strike by its turning, m/s in x and y, from the place of the hinge.
fn surface_velocity(scene: &Scene, contact: &Contact, strike: &Strike) -> [f64; 2] {
    let State { theta, x_dot, theta_dot, .. } = contact.state;
    let value = |name| scene.number(name).unwrap_or(0.0);
    let rate =
        value(Name::TiltGain) * theta_dot - value(Name::FeedbackX) * x_dot - value(Name::FeedbackTheta) * theta_dot;
    let (sin, cos) = strike.alpha.sin_cos();
    let foot = contact.x + scene.parameters::<f64>().contact_distance * theta.sin();
    let depth = value(Name::PivotDepth);
    let Some(place) = scene.number(Name::PivotX) else { return [-rate * depth * cos, -rate * depth * sin] };
    // The hinge is below the contact by so much that the surface passes through the contact.
    let below = (depth - (foot - place) * -sin) / cos;
    [-rate * below, rate * (foot - place)]
}

/// Velocity of the contact point, m/s.
fn contact_velocity(length: f64, state: &State) -> [f64; 2] {
    let (sin, cos) = state.theta.sin_cos();
    [state.x_dot + length * state.theta_dot * cos, state.y_dot + length * state.theta_dot * sin]
}

#[test]
fn strikes_reverse_the_velocity_relative_to_the_moving_surface() {
    let mut random = Random::new(7);
    let mut strikes = 0;
    for parts in turning_mixes() {
        for _ in 0..40 {
            let scene = random_scene(&mut random, parts);
            let e = scene.number(Name::Restitution).unwrap();
            let rod = scene.parameters::<f64>();
            let (length, rho) = (rod.contact_distance, rod.radius_of_gyration);
            for contact in contacts(&scene, 20).0 {
                let Some(strike) = contact.strike.filter(|strike| strike.push < 0.0) else { continue };
                let scale = 1.0 + strike.impulse_normal.abs() + strike.impulse_tangential.abs();
                let near = |one: f64, other: f64| (one - other).abs() < 1e-11 * scale;
                let (sin, cos) = strike.alpha.sin_cos();
                let (normal, tangent) = ([-sin, cos], [cos, sin]);
                let dot = |one: [f64; 2], other: [f64; 2]| one[0] * other[0] + one[1] * other[1];
                let table = [strike.table_velocity.0, strike.table_velocity.1];
                let (before, after) =
                    (contact_velocity(length, &contact.state), contact_velocity(length, &strike.after));
                let relative = |velocity: [f64; 2]| [velocity[0] - table[0], velocity[1] - table[1]];
                // All of the table's velocity but what its law gives it is the turning's.
                let turned = surface_velocity(&scene, &contact, &strike);
                assert!(near(strike.approach, dot(relative(before), normal)), "{scene:?}");
                if !scene.steers_energy() {
                    let law = -(1.0 - e) / (1.0 + e) * strike.normal_velocity;
                    assert!(near(dot(table, normal), law + dot(turned, normal)), "{scene:?}");
                }
                match scene.value(Name::Slide) {
                    Some(Value::Choice("matched")) => {
                        assert!(near(dot(relative(before), tangent), -dot(turned, tangent)), "{scene:?}");
                    }
                    _ => assert!(near(dot(table, tangent), dot(turned, tangent)), "{scene:?}"),
                }
                // Momentum, moment of momentum and energy.
                let (normal_impulse, tangential) = (strike.impulse_normal, strike.impulse_tangential);
                let impulse = [0, 1].map(|axis| normal_impulse * normal[axis] + tangential * tangent[axis]);
                let (sin_theta, cos_theta) = contact.state.theta.sin_cos();
                let turn = length * (sin_theta * impulse[1] + cos_theta * impulse[0]) / (rho * rho);
                assert!(near(strike.after.x_dot - contact.state.x_dot, impulse[0]));
                assert!(near(strike.after.y_dot - contact.state.y_dot, impulse[1]));
                assert!(near(rho * (strike.after.theta_dot - contact.state.theta_dot), rho * turn));
                let work = 0.5 * (dot(impulse, before) + dot(impulse, after));
                assert!((strike.energy_gain - work).abs() < 1e-10 * scale * scale, "{} {work}", strike.energy_gain);
                if scene.value(Name::Friction) == Some(Value::Number(0.0)) {
                    assert!(tangential == 0.0 && strike.mode == ContactMode::Frictionless);
                    let bounced = dot(relative(after), normal) + e * dot(relative(before), normal);
                    assert!(bounced.abs() < 1e-11 * scale, "{bounced}");
                }
                strikes += 1;
            }
        }
    }
    assert!(strikes > 1000, "{strikes}");
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
    for _ in 0..150 {
        let scene = random_scene(&mut random, Parts { friction: true, ..Parts::default() });
        let mut draft = scene.draft();
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
        assert!(scene.model().is_plain_rod() && scene.beyond(&[]).is_none());
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

#[test]
fn a_turning_table_seen_in_a_mirror_is_one_with_a_mirrored_pivot() {
    let mut random = Random::new(5);
    for parts in turning_mixes().filter(|parts| parts.noise.is_none()) {
        for _ in 0..20 {
            let scene = random_scene(&mut random, parts);
            let odd = [Name::Theta, Name::ThetaDot, Name::X, Name::XDot, Name::PivotX];
            let mirrored = odd.into_iter().filter_map(|name| Some((name, -scene.number(name)?))).collect::<Vec<_>>();
            let (course, ending) = contacts(&scene, 20);
            let (other, same) = contacts(&with(&scene, &mirrored), 20);
            assert_eq!(ending.name(), same.name());
            for (one, other) in course.iter().zip(&other) {
                let [t, x, theta, x_dot, y_dot, theta_dot] = numbers(one);
                assert_eq!([t, -x, -theta, -x_dot, y_dot, -theta_dot], numbers(other));
            }
        }
    }
}

#[test]
fn the_derivative_has_the_turning_in_it() {
    let mut random = Random::new(8);
    let mut compared = 0;
    for parts in turning_mixes().filter(|parts| parts.noise.is_none()) {
        let scenes = (0..40).map(|_| random_scene(&mut random, parts)).inspect(|scene| {
            let by_place = parts.feedback || scene.number(Name::PivotX).is_some();
            assert_eq!(state_order(&scene.model()).len(), if by_place { 5 } else { 4 });
        });
        compared += compare_derivatives(scenes);
    }
    assert!(compared > 100, "{compared}");
}

#[test]
fn error_bounds_hold_against_runs_with_31_digits() {
    let mut random = Random::new(31);
    for parts in turning_mixes() {
        compare_bounds((0..30).map(|_| random_scene(&mut random, parts)));
    }
}

#[test]
fn the_ladder_has_a_level_for_a_turning_table() {
    let rough = with(&paper::scene(1.1, 0.1), &[(Name::Friction, 0.05), (Name::AngleBias, 0.001)]);
    let scene = turning(&rough, "follows", Some(0.0), 0.02).build().unwrap();
    let steps = run_hierarchy(&scene, 20, || true).unwrap();
    let levels: Vec<_> = steps.iter().map(|step| step.level).collect();
    use ModelLevel::{Friction, Linear, RigErrors, Rod, Turning};
    assert_eq!(levels, [Linear, Rod, RigErrors, Turning, Friction]);
    assert_eq!(steps[3].requirement.as_ref().unwrap().path, "table.tilt_rate");
    assert!(steps[2].scene.unwrap().acting_turn().is_none() && steps[3].scene.unwrap().acting_turn().is_some());
    let change = steps[3].run.as_ref().unwrap().change.unwrap();
    assert!(change.y_dot.value > 1e-3, "{change:?}");
    assert!(scene.rules().settles && !scene.rules().holds_energy);
    assert!(run_by(&scene, RunMethod::Linear, 10, |_| true).is_err());
}

#[test]
fn turning_that_is_not_derived_is_refused_by_both_fields() {
    let refused = |draft: Draft| draft.build().unwrap_err().into_iter().map(|error| (error.path, error.detail));
    let ideal = paper::scene(1.1, 0.1);
    let about = turning(&ideal, "follows", Some(0.0), 0.0);
    for limit in [Name::TiltRateLimit, Name::SpeedLimit, Name::StrokeLimit] {
        let mut draft = about;
        number(&mut draft, limit, 10.0);
        let errors: Vec<_> = refused(draft).collect();
        assert!(
            errors.len() == 1 && errors[0].0 == limit.row().path && errors[0].1.contains("tilt_rate"),
            "{errors:?}"
        );
        // The limit is allowed on a table that turns about the contact.
        draft.set(Name::PivotX, None).unwrap();
        draft.build().unwrap();
    }
    let mut noisy = about;
    number(&mut noisy, Name::TimingSd, 0.001);
    noisy.set(Name::NoiseModel, Some(Value::Choice("plan"))).unwrap();
    let errors: Vec<_> = refused(noisy).collect();
    assert!(errors.len() == 1 && errors[0].0 == "table.tilt_rate" && errors[0].1.contains("noise.model"), "{errors:?}");
    let mut point = Draft::default();
    number(&mut point, Name::TiltGain, 0.5);
    number(&mut point, Name::Height, 0.2);
    point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
    point.set(Name::TiltRate, Some(Value::Choice("follows"))).unwrap();
    assert_eq!(refused(point).map(|(path, _)| path).collect::<Vec<_>>(), ["table.tilt_rate"]);
}
