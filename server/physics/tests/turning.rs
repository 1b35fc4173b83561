//! Tables that turn as they strike: against an impulse followed step by step, and turning that changes no bounce.

use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::analysis::evidence::{SMALL_RUN, judge};
use equipoise_physics::analysis::linear_verdict::AngleClass;
use equipoise_physics::analysis::nonlinear_run::run_nonlinear;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::analysis::verdict::{DecidedBy, Verdict};
use equipoise_physics::control::lqr::design_lqr;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::{Name, Scene, Value};

use crate::paper;
use crate::support::features::{Mix, Swing};
use crate::support::random::Random;
use crate::support::scenes::{balance, judged, swing, upright_bounce};
use crate::support::turning::{contacts, number, numbers, turning, with};

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

// Stability on tables that turn as they strike: closed forms against derivatives of the map and against runs.

#[test]
fn a_pivot_below_a_matched_table_damps_the_angle_and_one_above_drives_it() {
    let mut draft = with(&paper::scene(1.4, 0.03), &[(Name::Friction, 0.5)]).draft();
    draft.set(Name::Slide, Some(Value::Choice("matched"))).unwrap();
    number(&mut draft, Name::EnergyGain, 0.2);
    number(&mut draft, Name::TargetHeight, 0.2);
    let still = draft.build().unwrap();
    let largest = |scene: &Scene| {
        let contacts = contacts(scene, 400).0;
        contacts[contacts.len().saturating_sub(50)..].iter().map(|it| it.state.theta.abs()).fold(0.0, f64::max)
    };
    for (depth, settles) in [(0.05, true), (-0.05, false)] {
        let scene = turning(&still, "follows", None, depth).build().unwrap();
        let linear = small_deviations(&scene).unwrap().linear;
        let swing = largest(&scene);
        assert!(if settles { swing < 1e-4 } else { swing > 0.1 }, "{depth}: {swing}");
        assert_eq!(linear.class, if settles { AngleClass::Attracting } else { AngleClass::Hyperbolic });
        let found = judged(&scene, 1000);
        assert_eq!(found.verdict, if settles { Verdict::StableDrifting } else { Verdict::Unstable }, "{found:?}");
    }
}

#[test]
fn a_swing_takes_energy_from_a_turning_table_at_the_rate_of_second_order() {
    let mut random = Random::new(77);
    for case in 0..40 {
        let (length, rho) = (random.between(0.05, 0.3), random.between(0.03, 0.2));
        let above = length * random.between(0.3, 1.5);
        let width = rho * rho / (2.0 * above * length);
        let kappa = 1.0 + random.between(0.15, 0.6) * width;
        let theta = 1e-4;
        let scene = with(
            &paper::scene(kappa, 0.0),
            &[
                (Name::ContactDistance, length),
                (Name::RadiusOfGyration, rho),
                (Name::Height, length + above),
                (Name::Theta, theta),
                (Name::Restitution, random.between(0.4, 1.0)),
            ],
        );
        let place = if case % 2 == 0 { 0.0 } else { random.size(0.01, 0.2) };
        let scene = turning(&scene, "follows", Some(place), random.between(-0.5, 0.2)).build().unwrap();
        let linear = small_deviations(&scene).unwrap().linear;
        let pump = swing(&scene).unwrap();
        // Released at rest, the body comes to its first contact with θ₀ and without spin.
        let residue = linear.residue.unwrap();
        assert!((pump.amplitude * (1.0 - residue).sqrt() / theta - 1.0).abs() < 1e-3, "{pump:?}");
        // Mean over runs of both ends by a smooth window, which leaves the slow growth alone.
        let rod = scene.parameters::<f64>();
        let energies: Vec<_> = contacts(&scene, 4000).0.iter().map(|contact| rod.energy(&contact.state)).collect();
        let window: Vec<f64> =
            (1..2000).map(|k| (std::f64::consts::PI * f64::from(k) / 2000.0).sin().powi(4)).collect();
        let weight: f64 = window.iter().sum();
        let mean = |from: usize| window.iter().zip(&energies[from..]).map(|(w, e)| w * e).sum::<f64>() / weight;
        let rate = (mean(2000) - mean(0)) / 2000.0;
        let scale = pump.energy.abs() + 2.0 * kappa * theta * theta * residue * length;
        assert!((rate - pump.energy).abs() < 0.03 * scale, "{rate} {pump:?} {scene:?}");
    }
}

#[test]
fn verdicts_on_turning_tables_say_what_the_run_shows() {
    // The ideal rod bounces on; on this table it falls, about when the growth of its height says.
    for (theta, place) in [(0.02, 0.0), (0.05, 0.0), (0.05, 0.1)] {
        let scene = turning(&paper::scene(1.1, theta), "follows", Some(place), 0.05).build().unwrap();
        let run = run_nonlinear(&scene, 20_000, || true).unwrap();
        let linear = small_deviations(&scene).unwrap().linear;
        assert_eq!(linear.class, AngleClass::Elliptic);
        let found = judge(&scene, &run, SMALL_RUN, || true).unwrap();
        assert_eq!((found.verdict, found.decided_by), (Verdict::Unstable, DecidedBy::Lyapunov), "{found:?}");
        assert_ne!(run.ending, Ending::Completed);
        let expected = balance(&scene).bounces_until_critical().unwrap() as f64;
        let ratio = run.impacts as f64 / expected;
        assert!((0.7..1.3).contains(&ratio), "{} {expected}", run.impacts);
    }
    // State feedback takes the swing away, whatever the table does to the height.
    let ideal = paper::scene(1.1, 0.05);
    let model = upright_bounce(
        &ideal.parameters(),
        small_deviations(&ideal).unwrap().fixed_point.speed,
        ContactRegime::Frictionless,
    );
    let gain = design_lqr(&model, [1.0, 10.0, 0.1, 0.1], 10.0).unwrap().gain;
    let mut draft = ideal.draft();
    draft.set(Name::TiltGain, None).unwrap();
    let names = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];
    for (name, gain) in names.into_iter().zip(gain) {
        number(&mut draft, name, gain);
    }
    let scene = turning(&draft.build().unwrap(), "follows", Some(0.1), 0.05).build().unwrap();
    let fixed_point = small_deviations(&scene).unwrap().fixed_point;
    let last = contacts(&scene, 3000).0.last().copied().unwrap();
    assert!((last.state.y_dot + fixed_point.speed).abs() < 1e-9, "{last:?} {fixed_point:?}");
    assert!((fixed_point.speed - small_deviations(&draft.build().unwrap()).unwrap().fixed_point.speed).abs() > 1e-3);
    let found = judged(&scene, 3000);
    assert_eq!(found.verdict, Verdict::StableInPlace, "{found:?}");
    // With energy feedback a swing is decided in third order.
    let fed = with(&paper::scene(1.1, 0.05), &[(Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2)]);
    let fed = turning(&fed, "follows", Some(0.0), 0.0).build().unwrap();
    assert_eq!(small_deviations(&fed).unwrap().linear.class, AngleClass::Elliptic);
}
