//! General simulation methods against the exact map: agreement, order of convergence, and scenes on which they are wrong.

use equipoise::integrators::{Integrator, Location, SimulatedImpact, Simulation, WorkCount, simulate};
use equipoise_physics::map::body::Body;
use equipoise_physics::map::body::Release;
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::run::orbit::{Contact, Orbit, run};
use equipoise_physics::run::rules::Rules;
use equipoise_physics::scene::{Draft, Name, Value};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

const RULES: Rules = Rules {
    topple_angle: std::f64::consts::FRAC_PI_2,
    settles: false,
    holds_energy: true,
    limits: None,
    half_length: f64::INFINITY,
};

/// A rod of the paper's length and its release at rest in x and y.
#[derive(Clone, Copy, Debug)]
struct Scene {
    rod: Rod,
    rules: Rules,
    release: Release,
}

/// The paper's radius of gyration, and that of its real triangle, m.
const PRINTED: f64 = 0.094_280_904_158_206_35;
const TRIANGLE: f64 = 0.051_37;

fn scene(radius_of_gyration: f64, tilt_gain: f64, theta: f64) -> Scene {
    let rod = Rod::lossless(0.4 / 3.0, radius_of_gyration, tilt_gain);
    let state = State { theta, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 };
    Scene { rod, rules: RULES, release: Release { x: 0.0, height: 0.2, state } }
}

fn case_1() -> Scene {
    scene(PRINTED, 1.1, 0.3)
}

fn spinning(tilt_gain: f64, height: f64, theta: f64, theta_dot: f64) -> Scene {
    let mut scene = scene(PRINTED, tilt_gain, theta);
    scene.release.height = height;
    scene.release.state.theta_dot = theta_dot;
    scene
}

const STEPS: u64 = 20_000_000;

impl Scene {
    fn by(&self, method: Integrator, impacts: u64) -> Simulation {
        simulate(method, (&Body::plain(self.rod), &self.rules, &self.release), impacts, STEPS, &mut || true).unwrap()
    }

    fn exact(&self, impacts: u64) -> (Vec<Contact>, &'static str) {
        let mut contacts = Vec::new();
        let mut orbit = Orbit::new(Body::plain(self.rod), self.rules, &self.release).unwrap();
        let ending = run(&mut orbit, impacts, |contact| {
            contacts.push(*contact);
            true
        });
        (contacts, ending.unwrap().name())
    }

    /// Distance from the map at a contact; infinite if the method found fewer contacts.
    fn error(&self, method: Integrator, n: usize) -> f64 {
        let (exact, _) = self.exact(n as u64);
        self.by(method, n as u64).impacts.get(n - 1).map_or(f64::INFINITY, |impact| distance(&exact[n - 1], impact))
    }
}

fn distance(exact: &Contact, impact: &SimulatedImpact) -> f64 {
    let (ours, theirs) = (exact.state, impact.state);
    [
        exact.t - impact.t,
        exact.x - impact.x,
        ours.theta - theirs.theta,
        ours.x_dot - theirs.x_dot,
        ours.y_dot - theirs.y_dot,
        ours.theta_dot - theirs.theta_dot,
    ]
    .map(f64::abs)
    .into_iter()
    .fold(0.0, f64::max)
}

fn runge_kutta(location: Location) -> impl Fn(f64) -> Integrator {
    move |step| Integrator::RungeKutta { step, location }
}

fn time_stepping(step: f64) -> Integrator {
    Integrator::TimeStepping { step }
}

fn penalty(step: f64) -> Integrator {
    Integrator::Penalty { step }
}

fn sampling(step: f64) -> Integrator {
    Integrator::Sampling { step }
}

fn adaptive(tolerance: f64) -> Integrator {
    Integrator::Adaptive { tolerance }
}

/// Order of the error at a contact: the power of the step, from a step to a tenth of it. The place of a contact within its step is as
/// good as random, so the mean square over several steps is used.
fn order(method: impl Fn(f64) -> Integrator, step: f64, n: usize) -> f64 {
    let mean_square = |step: f64| {
        let steps = (0..16).map(|index| step * (1.0 + 0.04 * f64::from(index)));
        steps.map(|step| case_1().error(method(step), n).powi(2)).sum::<f64>()
    };
    0.5 * (mean_square(step) / mean_square(0.1 * step)).log10()
}

/// Runge-Kutta follows a parabola without error. So methods that locate contacts to the last digit agree with the map at any step.
#[test]
fn a_contact_that_is_located_costs_no_accuracy() {
    for (method, allowed) in [
        (runge_kutta(Location::Bisection)(1e-2), 1e-11),
        (runge_kutta(Location::Bisection)(1e-3), 1e-10),
        (sampling(1e-2), 1e-11),
        (sampling(1e-3), 1e-11),
        (adaptive(1e-3), 1e-10),
        (adaptive(1e-12), 1e-10),
    ] {
        let error = case_1().error(method, 100);
        println!("{method:?}: {error:.1e}");
        assert!(error <= allowed, "{method:?}: {error:.1e}");
    }
}

/// The order of a method at contacts is that of its contact search, not that of its time stepping.
#[test]
fn impacts_take_the_order_away() {
    for (name, order, expected) in [
        ("step end", order(runge_kutta(Location::StepEnd), 1e-3, 4), 1.0),
        ("secant", order(runge_kutta(Location::Secant), 1e-3, 4), 2.0),
        ("time stepping", order(time_stepping, 1e-3, 4), 1.0),
        ("penalty", order(penalty, 1e-4, 4), 1.0),
    ] {
        println!("{name}: order {order:.2}");
        assert!((order - expected).abs() < 0.2, "{name}: order {order:.2}");
    }
}

#[test]
fn fine_steps_agree_with_the_map() {
    for (method, allowed) in [
        (runge_kutta(Location::StepEnd)(1e-5), 2e-3),
        (runge_kutta(Location::Secant)(1e-5), 1e-7),
        (time_stepping(1e-5), 2e-3),
        (penalty(1e-5), 1e-1),
    ] {
        let error = case_1().error(method, 10);
        println!("{method:?}: {error:.1e}");
        assert!(error <= allowed, "{method:?}: {error:.1e}");
    }
}

/// The endings agree too, for rods, tables and releases of all kinds without fast spin.
#[test]
fn any_scene_ends_as_the_map_says() {
    let mut random = SplitMix64::seed_from_u64(1);
    let mut number = |low: f64, high: f64| random.random_range(low..high);
    let mut endings = std::collections::BTreeMap::new();
    for _ in 0..1000 {
        let mut scene = spinning(number(-1.0, 3.0), number(0.2, 0.6), number(-1.4, 1.4), number(-4.0, 4.0));
        scene.rod.radius_of_gyration = number(0.04, 0.2);
        scene.rod.restitution = number(0.3, 1.0);
        if number(0.0, 1.0) < 0.3 {
            scene.rod.strike_gain = 1.0 + scene.rod.restitution;
            scene.rules = Rules { settles: true, holds_energy: false, ..RULES };
        }
        scene.release.state.x_dot = number(-1.0, 1.0);
        let (exact, ending) = scene.exact(4);
        // Up to l θ̇² = G the gap is concave, so no contact hides between two samples.
        if exact.iter().any(|contact| contact.state.theta_dot.abs() > 8.5) {
            continue;
        }
        *endings.entry(ending).or_insert(0) += 1;
        for method in [runge_kutta(Location::Bisection)(1e-3), sampling(1e-3), adaptive(1e-9)] {
            let simulation = scene.by(method, 4);
            assert_eq!(simulation.ending.name(), ending, "{scene:?} {method:?}");
            assert_eq!(simulation.impacts.len(), exact.len(), "{scene:?} {method:?}");
            for (exact, impact) in exact.iter().zip(&simulation.impacts) {
                assert!(distance(exact, impact) < 1e-6, "{scene:?} {method:?} {exact:?} {impact:?}");
            }
        }
        // A method that knows contacts only to its step may end otherwise, but begins alike.
        for method in [time_stepping(1e-3), penalty(1e-3), runge_kutta(Location::StepEnd)(1e-3)] {
            assert!(distance(&exact[0], &scene.by(method, 1).impacts[0]) < 2e-2, "{scene:?} {method:?}");
        }
    }
    println!("{endings:?}");
    assert!(["completed", "toppled", "separating", "sinking"].iter().all(|ending| endings[ending] > 5), "{endings:?}");
}

#[test]
fn flights_that_shrink_settle() {
    let mut scene = scene(PRINTED, 0.0, 0.0);
    scene.rod.restitution = 0.5;
    scene.rod.strike_gain = 1.5;
    scene.rules = Rules { settles: true, holds_energy: false, ..RULES };
    let (exact, ending) = scene.exact(100);
    assert_eq!(ending, "settled");
    let settled = scene.by(sampling(1e-2), 100);
    assert_eq!((settled.ending.name(), settled.impacts.len()), (ending, exact.len()));
    // Methods that integrate the height have no digits for flights below a nanometre.
    for method in [runge_kutta(Location::Bisection)(1e-2), adaptive(1e-6)] {
        let agreed = scene.by(method, 20).impacts;
        assert!(distance(&exact[19], &agreed[19]) < 1e-6, "{method:?}");
    }
}

/// A spring and damper reproduce the restitution, as far as gravity allows.
#[test]
fn a_compliant_contact_gives_back_its_restitution() {
    for restitution in [0.1, 0.3, 0.5, 0.8, 0.95, 1.0] {
        let mut scene = scene(PRINTED, 0.0, 0.0);
        (scene.rod.restitution, scene.rod.strike_gain) = (restitution, 1.0 + restitution);
        let impacts = scene.by(penalty(1e-5), 2).impacts;
        let back = -impacts[1].state.y_dot / impacts[0].state.y_dot;
        println!("asked {restitution}, given {:.5}", -back);
        assert!((-back - restitution).abs() < 4e-3, "{restitution}: {back}");
    }
}

/// A fast spinning rod touches the table and is clear of it again between two samples.
#[test]
fn what_comes_and_goes_between_two_looks_is_missed() {
    let scene = spinning(1.1, 0.34, -0.41, -29.9);
    let first = scene.exact(1).0[0].t;
    assert!((first - 0.214_247).abs() < 1e-6, "{first}");
    for (method, sees) in [
        (sampling(1.0 / 60.0), false),
        (sampling(1e-2), false),
        (sampling(1e-3), true),
        (runge_kutta(Location::Bisection)(1e-2), false),
        (runge_kutta(Location::Bisection)(1e-3), true),
    ] {
        let t = scene.by(method, 1).impacts[0].t;
        assert_eq!((t - first).abs() < 1e-6, sees, "{method:?}: {t}");
        assert!(sees || (t - 0.309_420).abs() < 1e-6, "{method:?}: {t}");
    }
    // No tolerance helps: it bounds the error of the parabola, not of the gap.
    let scene = spinning(1.05, 0.33, 0.07, -29.9);
    let first = scene.exact(1).0[0].t;
    for tolerance in [1e-3, 1e-6, 1e-12] {
        let t = scene.by(adaptive(tolerance), 1).impacts[0].t;
        assert!(t - first > 0.1, "{tolerance:e}: {t}, and not {first}");
    }
}

/// Just beyond a hard boundary every run falls. A contact on a chord is a little early and so slower, which acts like a wider margin:
/// it keeps all runs balanced for thousands of contacts at these steps.
#[test]
fn a_step_invents_stability() {
    for theta in [0.0097, 0.01, 0.0103] {
        let scene = scene(TRIANGLE, 1.149, theta);
        let (contacts, ending) = scene.exact(2000);
        assert!(ending != "completed" && contacts.len() < 150, "{theta}: {ending} at {}", contacts.len());
        for step in [0.025, 0.03, 1.0 / 30.0] {
            let simulation = scene.by(runge_kutta(Location::Secant)(step), 2000);
            assert_eq!(simulation.ending.name(), "completed", "{theta} {step}");
            let speed = simulation.impacts.iter().map(|impact| -impact.state.y_dot).sum::<f64>() / 2000.0;
            println!("{theta} {step}: strikes at {speed:.4} m/s, first at {:.4} m/s", -contacts[0].state.y_dot);
            assert!(speed < 0.99 * -contacts[0].state.y_dot, "{theta} {step}: {speed}");
        }
        assert_ne!(scene.by(runge_kutta(Location::Bisection)(1.0 / 30.0), 2000).ending.name(), "completed");
    }
}

/// The paper's own case balances, but falls with common methods at common steps.
#[test]
fn a_step_destroys_stability() {
    assert_eq!(case_1().exact(5000).1, "completed");
    for method in [
        time_stepping(1.0 / 60.0),
        time_stepping(1e-2),
        runge_kutta(Location::StepEnd)(1.0 / 60.0),
        runge_kutta(Location::StepEnd)(1e-2),
        penalty(1e-2),
        penalty(1e-3),
        penalty(1e-4),
    ] {
        let simulation = case_1().by(method, 400);
        println!("{method:?}: {} at {}", simulation.ending.name(), simulation.impacts.len());
        assert_ne!(simulation.ending.name(), "completed", "{method:?}");
    }
    // Nearer to the boundary a tenth of the step is not enough either.
    let scene = scene(PRINTED, 1.49, 0.1);
    assert_eq!(scene.exact(400).1, "completed");
    for method in [time_stepping(1e-3), runge_kutta(Location::StepEnd)(1e-3)] {
        assert_ne!(scene.by(method, 400).ending.name(), "completed", "{method:?}");
    }
}

#[test]
fn work_is_counted_alike_everywhere() {
    let work = |method| case_1().by(method, 100).work;
    for (method, steps, accelerations, gaps) in [
        (runge_kutta(Location::StepEnd)(1e-2), 1811, 7244, 1911),
        (runge_kutta(Location::Bisection)(1e-2), 1889, 29504, 7376),
        (time_stepping(1e-2), 1857, 0, 1857),
        (sampling(1e-2), 1889, 0, 7284),
        (adaptive(1e-6), 250, 2050, 5908),
    ] {
        assert_eq!(work(method), WorkCount { steps, accelerations, gaps }, "{method:?}");
    }
}

/// No setting and no scene makes a method run for ever or panic.
#[test]
fn every_run_ends() {
    let everything = [0.0, -1.0, 1e-300, 1e300, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e-9, 0.5];
    let mut resting = scene(PRINTED, 0.0, 0.0);
    (resting.rod.restitution, resting.rod.strike_gain) = (0.0, 1.0);
    for scene in [case_1(), spinning(-100.0, 100.0, -1.5, 1e5), resting] {
        for setting in everything {
            let methods = [
                runge_kutta(Location::StepEnd)(setting),
                runge_kutta(Location::Secant)(setting),
                runge_kutta(Location::Bisection)(setting),
                adaptive(setting),
                time_stepping(setting),
                penalty(setting),
                sampling(setting),
            ];
            for method in methods {
                let limit = 10_000;
                let input = (&Body::plain(scene.rod), &scene.rules, &scene.release);
                let simulation = simulate(method, input, 20_000, limit, &mut || true).unwrap();
                assert!(simulation.work.steps <= limit, "{method:?}");
                let mut asked = 0;
                let stopped = simulate(method, input, 20_000, u64::MAX, &mut || {
                    asked += 1;
                    asked < 4
                });
                assert!(stopped.is_none() || asked < 4, "{method:?}");
            }
        }
    }
}

/// Scenes whose strikes are not those of the plain rod: with state feedback, friction, and a program of heights.
#[test]
fn methods_strike_as_the_map_does() {
    let number = |value| Some(Value::Number(value));
    let plain = [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, PRINTED),
        (Name::Height, 0.2),
        (Name::Theta, 0.1),
        (Name::Restitution, 0.8),
    ];
    let feedback = [
        (Name::FeedbackX, 0.05),
        (Name::FeedbackTheta, -1.2),
        (Name::FeedbackXDot, 0.06),
        (Name::FeedbackThetaDot, -0.02),
    ];
    for (with_feedback, friction, law, slide) in [
        (true, 0.0, "poisson", "none"),
        (false, 0.05, "newton", "none"),
        (false, 0.3, "stronge", "matched"),
        (true, 0.2, "poisson", "none"),
        (true, 0.1, "stronge", "matched"),
    ] {
        let mut draft = Draft::default();
        for (name, value) in plain.into_iter().chain(with_feedback.then_some(feedback).into_iter().flatten()) {
            draft.set(name, number(value)).unwrap();
        }
        if !with_feedback {
            draft.set(Name::TiltGain, number(1.1)).unwrap();
        }
        draft.set(Name::Friction, number(friction)).unwrap();
        draft.set(Name::Law, Some(Value::Choice(law))).unwrap();
        draft.set(Name::Slide, Some(Value::Choice(slide))).unwrap();
        let scene = draft.build().unwrap();
        let mut exact = Vec::new();
        run(&mut scene.orbit().unwrap(), 3, |contact| {
            exact.push(*contact);
            true
        });
        let (body, rules) = (scene.model(), scene.rules());
        let error = |method: Integrator| {
            let simulation = simulate(method, (&body, &rules, scene.release()), 3, STEPS, &mut || true).unwrap();
            simulation.impacts.last().map_or(f64::INFINITY, |impact| distance(&exact[2], impact))
        };
        let case = format!("feedback {with_feedback}, friction {friction}, {law}, {slide}");
        for method in [runge_kutta(Location::Bisection)(1e-3), adaptive(1e-9), sampling(1e-3)] {
            assert!(error(method) < 1e-11, "{case}: {method:?} is off by {:e}", error(method));
        }
        // The place of a contact within its step is as good as random.
        let converges = |method: fn(f64) -> Integrator| {
            let sum = |step: f64| (0..8).map(|n| error(method(step * (1.0 + 0.07 * f64::from(n))))).sum::<f64>();
            let (coarse, fine) = (sum(1e-4), sum(1e-5));
            assert!(fine < 0.25 * coarse, "{case}: off by {coarse:e}, then {fine:e}, in eight runs");
        };
        converges(time_stepping);
        if friction == 0.0 {
            converges(penalty);
        }
    }
}
