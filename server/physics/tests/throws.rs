//! Throws: the apex of the exact strike and flight against the target, with friction and without, and the reasons of throws that fail.

use crate::paper;
use crate::support::random;
use equipoise_physics::catching::throw::{Throw, ThrowFailure, ThrowTarget, throw};
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use random::Random;
use std::f64::consts::{PI, TAU};

const L: f64 = 0.4 / 3.0;
const RHO: f64 = 0.094_280_904_158_206_35;
const G: f64 = 9.81;

fn scene(settings: &[(Name, Value)]) -> Scene {
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

/// Apex of a throw by the flight's closed form alone, from the state after its strike.
fn apex(x: f64, after: &State) -> [f64; 3] {
    let t = after.y_dot / G;
    let y = L * after.theta.cos() + after.y_dot * t - 0.5 * G * t * t;
    [x + after.x_dot * t, y, after.theta + after.theta_dot * t]
}

#[test]
fn half_a_turn_has_its_printed_tilt_and_table_speed() {
    let v = (2.0 * G * (0.2 - L)).sqrt();
    let coming = PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: -v, theta_dot: 0.0 });
    let thrown = throw(&scene(&[]), &coming, &ThrowTarget { height: 0.4, theta: PI }).unwrap();
    assert!((thrown.motion.alpha - -0.256).abs() < 5e-4, "{thrown:?}");
    assert!((thrown.motion.normal_velocity - 0.894).abs() < 5e-4, "{thrown:?}");
}

#[test]
fn frictionless_throws_reach_their_apex_to_rounding() {
    let mut random = Random::new(3);
    let mut thrown = 0;
    for _ in 0..5000 {
        let restitution = random.between(0.0, 1.0);
        let scene = scene(&[(Name::Restitution, Value::Number(restitution))]);
        let coming = contact(&mut random);
        let turns = (random.between(-2.5, 2.5)).round();
        let target =
            ThrowTarget { height: L + random.between(0.05, 1.0), theta: PI * turns + random.between(-0.5, 0.5) };
        let Ok(found) = throw(&scene, &coming, &target) else { continue };
        thrown += 1;
        let [x, y, theta] = apex(coming.x, &found.strike.after);
        assert!((y - target.height).abs() < 1e-12 && (theta - target.theta).abs() < 1e-12, "{y} {theta} {target:?}");
        assert!(found.residual < 1e-12 && found.iterations == 0, "{found:?}");
        assert!((found.apex.x - x).abs() < 1e-12 && (found.apex.y - y).abs() < 1e-12);
        // The strike is that of a contact with restitution e: v_n⁺ − w = −e(v_n − w).
        let Throw { strike, motion, .. } = found;
        let normal = |state: &State| {
            let arm = L * (state.theta - motion.alpha).sin() * state.theta_dot;
            motion.alpha.cos() * state.y_dot - motion.alpha.sin() * state.x_dot + arm - motion.normal_velocity
        };
        assert!((normal(&strike.after) + restitution * normal(&coming.state)).abs() < 1e-12);
        // A run from the release lands where the throw does.
        let landing = found.landing.unwrap();
        let after = equipoise_physics::map::strike::Rod::lossless(L, RHO, 1.1);
        let (t, state) = after.fall(&found.release).unwrap();
        assert!((t - landing.t).abs() < 1e-13 * (1.0 + t) && (state.theta - landing.state.theta).abs() < 1e-12);
        assert!(t > found.apex.t);
    }
    assert!(thrown > 4000, "{thrown}");
}

#[test]
fn throws_with_friction_reach_their_apex_or_say_why() {
    let mut random = Random::new(4);
    let (mut thrown, mut short) = (0, 0);
    for _ in 0..2000 {
        let law = ["poisson", "newton", "stronge"][random.between(0.0, 3.0) as usize % 3];
        let slide = ["none", "matched"][random.between(0.0, 2.0) as usize % 2];
        let settings = [
            (Name::Restitution, Value::Number(random.between(0.2, 1.0))),
            (Name::Friction, Value::Number(random.between(0.01, 1.0))),
            (Name::Law, Value::Choice(law)),
            (Name::Slide, Value::Choice(slide)),
        ];
        let scene = scene(&settings);
        let coming = contact(&mut random);
        let target = ThrowTarget { height: L + random.between(0.05, 1.0), theta: random.between(-1.5, 1.5) };
        let mirrored = PreImpact::at(1, -coming.x, mirror(&coming.state));
        let opposite = throw(&scene, &mirrored, &ThrowTarget { theta: -target.theta, ..target });
        match throw(&scene, &coming, &target) {
            Ok(found) => {
                thrown += 1;
                let [_, y, theta] = apex(coming.x, &found.strike.after);
                assert!((y - target.height).abs() < 1e-11 && (theta - target.theta).abs() < 1e-10, "{found:?}");
                assert!(found.residual < 1e-10 && found.iterations > 0, "{found:?}");
                let limit = scene.number(Name::Friction).unwrap() * found.strike.impulse_normal;
                assert!(found.strike.impulse_tangential.abs() <= limit * (1.0 + 1e-12), "{found:?}");
                // Of two tilts of one size, on either side, a body and its mirror image may take the same.
                let other = opposite.unwrap();
                assert!((other.motion.alpha.abs() - found.motion.alpha.abs()).abs() < 1e-8, "{other:?} {found:?}");
            }
            Err(ThrowFailure::AngleOutOfReach { reach, .. }) => {
                short += 1;
                if let Some((least, most)) = reach {
                    assert!(target.theta < least + 0.2 || target.theta > most - 0.2, "{target:?} {least} {most}");
                }
            }
            Err(_) => {}
        }
    }
    assert!(thrown > 1000, "{thrown} {short}");
}

fn mirror(state: &State) -> State {
    State { theta: -state.theta, x_dot: -state.x_dot, theta_dot: -state.theta_dot, ..*state }
}

#[test]
fn whole_turns_need_more_tilt_than_half_turns() {
    let scene = scene(&[]);
    let tilt = |theta: f64| throw(&scene, &upright(), &ThrowTarget { height: 1.0, theta }).unwrap().motion.alpha;
    assert!(tilt(0.0) == 0.0 && tilt(PI) < 0.0 && tilt(TAU) < tilt(PI) && tilt(-PI) == -tilt(PI));
}

#[test]
fn a_table_with_a_wrong_belief_misses_and_says_by_how_much() {
    let scene = scene(&[(Name::Restitution, Value::Number(0.8)), (Name::AssumedRestitution, Value::Number(1.0))]);
    let found = throw(&scene, &upright(), &ThrowTarget { height: 0.4, theta: 0.0 }).unwrap();
    // From rest the impulse is (1 + e)w in place of (1 + ê)w.
    let reached = L + (0.4 - L) * 0.81;
    assert!((found.apex.y - reached).abs() < 1e-12 && (found.residual - (0.4 - reached)).abs() < 1e-12, "{found:?}");
}

#[test]
fn throws_that_cannot_be_say_why() {
    let target = ThrowTarget { height: 0.4, theta: 0.0 };
    let of = |settings: &[(Name, Value)], coming: &PreImpact, target: ThrowTarget| {
        throw(&scene(settings), coming, &target).unwrap_err()
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
    assert!(throw(&scene, &upright(), &ThrowTarget { height: 0.4, theta: 0.2 }).is_ok());
    let flip = throw(&scene, &upright(), &ThrowTarget { height: 0.15, theta: 3.0 * PI });
    assert!(matches!(flip, Err(ThrowFailure::OtherVertex(_))), "{flip:?}");
}
