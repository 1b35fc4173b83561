//! Throws: the apex of the exact strike and flight against the target, with friction and without, and the reasons of throws that fail.

use crate::paper;
use crate::support::features::{Mix, Swing, all_but};
use crate::support::random::Random;
use equipoise_physics::catching::throw::{Throw, ThrowFailure, ThrowTarget, throw};
use equipoise_physics::map::body::{Body, PreImpact};
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::run::orbit::Orbit;
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use std::f64::consts::{PI, TAU};

const L: f64 = 0.4 / 3.0;
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

#[test]
fn half_a_turn_has_its_printed_tilt_and_table_speed() {
    let v = (2.0 * G * (0.2 - L)).sqrt();
    let coming = PreImpact::at(1, 0.0, State { theta: 0.0, x_dot: 0.0, y_dot: -v, theta_dot: 0.0 });
    let thrown = throw(&scene(&[]), &coming, &ThrowTarget { height: 0.4, theta: PI }).unwrap();
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
        let found = match throw(scene, &coming, &target) {
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
        let opposite = throw(scene, &mirrored, &ThrowTarget { theta: -target.theta, ..target }).unwrap();
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
