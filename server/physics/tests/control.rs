//! State feedback: the linear model against the bounce itself, the Riccati equation against its plain iteration, margins
//! against eigenvalues, and laws that have to hold.

use crate::support::random;
use crate::support::upright::upright_bounce;
use equipoise_physics::analysis::contact_regime::ContactRegime;
use equipoise_physics::analysis::gain_range::StableGains;
use equipoise_physics::analysis::jacobian::jacobian_at;
use equipoise_physics::control::bounce_model::{BounceModel, STABLE, states};
use equipoise_physics::control::lqr::{DesignFailure, RESIDUAL, design_lqr};
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::run::ending::Ending;
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use nalgebra::{Matrix4, RowVector4, Vector4};

use random::Random;

/// The weights under which the physics was checked.
const WEIGHTS: ([f64; 4], f64) = ([1.0, 10.0, 0.1, 0.1], 10.0);

const FEEDBACK: [Name; 4] = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];

/// The paper's rod with this law, contact and further fields.
fn scene(gain: [f64; 4], regime: ContactRegime, law: &'static str, values: &[(Name, f64)]) -> Scene {
    let mut draft = Draft::default();
    let rod =
        [(Name::ContactDistance, 0.4 / 3.0), (Name::RadiusOfGyration, 0.094_280_904_158_206_35), (Name::Height, 0.2)];
    for (name, number) in rod.into_iter().chain(FEEDBACK.into_iter().zip(gain)).chain(values.iter().copied()) {
        draft.set(name, Some(Value::Number(number))).unwrap();
    }
    draft.set(Name::Law, Some(Value::Choice(law))).unwrap();
    let slide = if regime == ContactRegime::VelocityMatched { "matched" } else { "none" };
    draft.set(Name::Slide, Some(Value::Choice(slide))).unwrap();
    draft.build().unwrap()
}

/// The paper's rod with this restitution.
fn rod(restitution: f64) -> Rod {
    scene([0.0; 4], ContactRegime::Frictionless, "poisson", &[(Name::Restitution, restitution)]).parameters()
}

/// V of the paper's cases.
fn speed(rod: &Rod) -> f64 {
    (2.0 * rod.gravity * (0.2 - rod.contact_distance)).sqrt()
}

/// One bounce of a scene from (x, θ, ẋ, θ̇) and ẏ.
fn bounce(scene: &Scene, [x, theta, x_dot, theta_dot]: [f64; 4], y_dot: f64) -> [f64; 4] {
    let model = scene.model();
    let coming = PreImpact::at(1, x, State { theta, x_dot, y_dot, theta_dot });
    let arrival = model.fly(&coming, &model.strike(&coming)).unwrap();
    let end = arrival.state;
    [x + arrival.t * end.x_dot, end.theta, end.x_dot, end.theta_dot]
}

const REGIMES: [ContactRegime; 3] =
    [ContactRegime::Frictionless, ContactRegime::Sticking, ContactRegime::VelocityMatched];

/// With the gain of one state after the other, A − BK gives both A and B.
#[test]
fn the_model_is_the_derivative_of_the_bounce() {
    let gains = [[0.0; 4], [1.0, 0.0, 0.0, 0.0], [0.0, -2.0, 0.0, 0.0], [0.0, 0.0, 0.5, 0.0], [0.3, -1.0, 0.1, -0.1]];
    for regime in REGIMES {
        let friction = if regime == ContactRegime::Frictionless { 0.0 } else { 0.3 };
        for restitution in [1.0, 0.5, 0.0] {
            for (law, gain) in
                ["poisson", "newton", "stronge"].into_iter().flat_map(|law| gains.map(|gain| (law, gain)))
            {
                let values = [(Name::Restitution, restitution), (Name::Friction, friction)];
                let scene = scene(gain, regime, law, &values);
                let rod: Rod = scene.parameters();
                let v = speed(&rod);
                let model = upright_bounce(&rod, v, regime);
                let closed = model.a - model.b * RowVector4::from(gain);
                let step = 1e-6;
                for column in 0..4 {
                    let ends = [step, -step].map(|step| {
                        let mut start = [0.0; 4];
                        start[column] = step;
                        bounce(&scene, start, -v)
                    });
                    for row in 0..4 {
                        let measured = (ends[0][row] - ends[1][row]) / (2.0 * step);
                        let expected = closed[(row, column)];
                        assert!(
                            (measured - expected).abs() < 1e-8 * (1.0 + closed.norm()),
                            "{regime:?} {law} e = {restitution}: [{row}, {column}] is {expected}, not {measured}"
                        );
                    }
                }
            }
        }
    }
}

/// In the order (ρθ, ẋ, ẏ, ρθ̇, x), from that of the linear model.
const PLACES: [usize; 4] = [4, 0, 1, 3];

#[test]
fn the_derivative_by_duals_is_the_closed_loop() {
    for regime in REGIMES {
        let values =
            [(Name::Friction, if regime == ContactRegime::Frictionless { 0.0 } else { 0.3 }), (Name::Restitution, 0.5)];
        let gain = design_lqr(&upright_bounce(&rod(0.5), speed(&rod(0.5)), regime), WEIGHTS.0, WEIGHTS.1).unwrap().gain;
        let scene = scene(gain, regime, "poisson", &values);
        let rod: Rod = scene.parameters();
        let v = speed(&rod);
        let upright = State { theta: 0.0, x_dot: 0.0, y_dot: -v, theta_dot: 0.0 };
        let exact = jacobian_at(&scene.model(), 0.0, &upright, 1).unwrap().matrix;
        assert_eq!(exact.shape(), (5, 5));
        let model = upright_bounce(&rod, v, regime);
        let closed = model.a - model.b * RowVector4::from(gain);
        let unit = [1.0, rod.radius_of_gyration, 1.0, rod.radius_of_gyration];
        for row in 0..4 {
            for column in 0..4 {
                let expected = closed[(row, column)] * unit[row] / unit[column];
                let found = exact[(PLACES[row], PLACES[column])];
                assert!(
                    (found - expected).abs() < 1e-12 * closed.norm(),
                    "{regime:?} [{row}, {column}]: {found} {expected}"
                );
            }
        }
        assert!((exact[(2, 2)] - 1.0).abs() < 1e-14, "the height stays");
    }
}

#[test]
fn proportional_tilt_on_a_matched_table_turns_at_its_own_critical_gain() {
    let rod = rod(1.0);
    let v = speed(&rod);
    let (l, rho) = (rod.contact_distance, rod.radius_of_gyration);
    let model = upright_bounce(&rod, v, ContactRegime::VelocityMatched);
    let critical = 1.0 + rod.gravity * (rho * rho + l * l) / (v * v * l);
    for (factor, grows) in [(0.999, false), (1.001, true)] {
        let radius = model.closed_loop([0.0, -critical * factor, 0.0, 0.0], false).unwrap().spectral_radius;
        assert_eq!(radius > 1.001, grows, "{radius}");
    }
    // Without it, and with any friction, no proportional gain holds.
    let stuck = upright_bounce(&rod, v, ContactRegime::Sticking);
    for kappa in (-40..=80).map(|tenth| 0.1 * f64::from(tenth)) {
        let radius = stuck.closed_loop([0.0, -kappa, 0.0, 0.0], false).unwrap().spectral_radius;
        assert!(radius > 1.0, "κ = {kappa}: {radius}");
    }
}

/// P by applying the equation to itself, bounce by bounce.
fn iterate(model: &BounceModel, state: [f64; 4], input: f64, bounces: u32) -> RowVector4<f64> {
    let (a, b) = (model.a, model.b);
    let weights = Matrix4::from_diagonal(&Vector4::from(state));
    let (mut cost, mut gain) = (weights, RowVector4::zeros());
    for _ in 0..bounces {
        let pressed = cost * b;
        gain = pressed.transpose() * a / (input + b.dot(&pressed));
        cost = a.transpose() * cost * (a - b * gain) + weights;
        cost = (cost + cost.transpose()) * 0.5;
    }
    gain
}

#[test]
fn doubling_finds_what_plain_iteration_finds() {
    for regime in REGIMES {
        let rod = rod(0.5);
        let model = upright_bounce(&rod, speed(&rod), regime);
        let design = design_lqr(&model, WEIGHTS.0, WEIGHTS.1).unwrap();
        let plain = iterate(&model, WEIGHTS.0, WEIGHTS.1, 3000);
        for (value, expected) in design.gain.into_iter().zip(plain.iter()) {
            assert!((value - expected).abs() < 1e-10 * plain.norm(), "{regime:?}: {value}, not {expected}");
        }
        assert!(design.residual < 1e-13 && design.iterations <= 10, "{design:?}");
    }
}

#[test]
fn without_a_weight_on_x_there_is_no_gain_on_x() {
    let rod = rod(1.0);
    let model = upright_bounce(&rod, speed(&rod), ContactRegime::Frictionless);
    let design = design_lqr(&model, [0.0, 10.0, 0.1, 0.1], 10.0).unwrap();
    assert_eq!(design.gain[0], 0.0);
    // It is what the law with x comes to as x matters less and less.
    let nearly = design_lqr(&model, [1e-9, 10.0, 0.1, 0.1], 10.0).unwrap();
    for (left, right) in design.gain.into_iter().zip(nearly.gain) {
        assert!((left - right).abs() < 1e-3, "{design:?} {nearly:?}");
    }
}

#[test]
fn a_mode_that_no_weight_sees_is_not_called_stable() {
    let rod = rod(1.0);
    let model = upright_bounce(&rod, speed(&rod), ContactRegime::Frictionless);
    for state in [[1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0; 4]] {
        assert!(
            matches!(design_lqr(&model, state, 1.0), Err(DesignFailure::Diverging | DesignFailure::Unseen(_))),
            "{state:?}"
        );
    }
}

#[test]
fn margins_are_where_eigenvalues_cross_the_circle() {
    let mut random = Random::new(11);
    for regime in REGIMES {
        for _ in 0..50 {
            let rod = rod(random.between(0.0, 1.0));
            let model = upright_bounce(&rod, speed(&rod) * random.between(0.5, 2.0), regime);
            let state = [1.0, 1.0, 1.0, 1.0].map(|_| random.size(0.01, 100.0).abs());
            let gain = design_lqr(&model, state, random.size(0.1, 100.0).abs()).unwrap().gain;
            let margin = model.stable_factors(gain, states(true)).unwrap();
            let radius = |factor: f64| model.closed_loop(gain.map(|k| k * factor), true).unwrap().spectral_radius;
            let StableGains { lower, upper } = margin;
            assert!((0.0..1.0).contains(&lower) && upper > 1.0, "{margin:?}");
            for end in [lower, upper] {
                assert!((radius(end) - 1.0).abs() < 1e-4, "{regime:?} {margin:?}: {}", radius(end));
            }
            assert!(radius(lower * 0.99) > 1.0 && radius(upper * 1.01) > 1.0, "{margin:?}");
            for step in 1..100 {
                let factor = lower + (upper - lower) * 0.01 * f64::from(step);
                assert!(radius(factor) < 1.0, "{regime:?} {margin:?}: {factor}");
            }
        }
    }
}

#[test]
fn whatever_the_rod_and_the_weights_a_law_is_good_or_there_is_none() {
    let mut random = Random::new(3);
    let mut found = 0;
    for _ in 0..20_000 {
        let mut rod = rod(1.0);
        rod.contact_distance = random.size(1e-3, 10.0).abs();
        rod.radius_of_gyration = random.size(1e-3, 10.0).abs();
        rod.gravity = random.size(1e-3, 100.0).abs();
        let regime = REGIMES[(random.between(0.0, 3.0) as usize).min(2)];
        let model = upright_bounce(&rod, random.size(1e-3, 100.0).abs(), regime);
        let weight = |random: &mut Random| {
            if random.between(0.0, 1.0) < 0.1 { 0.0 } else { random.size(1e-9, 1e9).abs() }
        };
        let state = [1, 2, 3, 4].map(|_| weight(&mut random));
        if let Ok(design) = design_lqr(&model, state, random.size(1e-9, 1e9).abs()) {
            found += 1;
            assert!(design.gain.iter().all(|gain| gain.is_finite()) && design.residual <= RESIDUAL);
            let closed = model.closed_loop(design.gain, state[0] != 0.0).unwrap();
            assert!(closed.spectral_radius <= STABLE);
            let StableGains { lower, upper } = model.stable_factors(design.gain, states(state[0] != 0.0)).unwrap();
            assert!(lower < 1.0 && upper > 1.0);
        }
    }
    assert!(found > 13_000, "{found}");
}

/// Runs a scene; the number of the contact from which on |θ| and |x| stay below `small`, if they do.
fn settle(scene: &Scene, small: f64, contacts: u64) -> Option<u64> {
    let mut last = 0;
    let ending = run(&mut scene.orbit().unwrap(), contacts, |contact| {
        if contact.state.theta.abs() >= small || contact.x.abs() >= small {
            last = contact.n;
        }
        true
    });
    (ending == Some(Ending::Completed) && last < contacts).then_some(last + 1)
}

#[test]
fn it_comes_to_rest_in_place() {
    let rod = rod(1.0);
    let model = upright_bounce(&rod, speed(&rod), ContactRegime::Frictionless);
    let gain = design_lqr(&model, WEIGHTS.0, WEIGHTS.1).unwrap().gain;
    let scene = scene(gain, ContactRegime::Frictionless, "poisson", &[(Name::Theta, 0.3), (Name::X, 0.2)]);
    let contacts = settle(&scene, 1e-9, 20_000).unwrap();
    assert!(contacts <= 100, "{contacts}");
}

#[test]
fn a_law_for_the_sticking_contact_holds_with_friction() {
    let values = [(Name::Theta, 0.05), (Name::Friction, 0.2), (Name::Restitution, 0.5)];
    for law in ["poisson", "newton", "stronge"] {
        let rod = rod(0.5);
        let gain_for = |regime| {
            let model = upright_bounce(&rod, speed(&rod), regime);
            design_lqr(&model, WEIGHTS.0, WEIGHTS.1).unwrap().gain
        };
        let contacts =
            settle(&scene(gain_for(ContactRegime::Sticking), ContactRegime::Sticking, law, &values), 1e-9, 20_000)
                .unwrap();
        assert!(contacts <= 250, "{law}: {contacts}");
        // The law for a contact without friction does not hold here.
        assert_eq!(
            settle(&scene(gain_for(ContactRegime::Frictionless), ContactRegime::Sticking, law, &values), 1e-9, 2000),
            None
        );
    }
}
