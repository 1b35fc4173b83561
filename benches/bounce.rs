//! Time of one bounce on one core: `cargo bench --bench bounce`. Each sample is 1000 bounces; read ns per item. Two ratios follow, each
//! measured in turns: the error estimate over the bounce, and a verdict in bounces.

mod case_1;

use std::hint::black_box;
use std::time::Instant;

use divan::counter::ItemsCount;
use divan::{Bencher, main as bench_all};
use equipoise_physics::analysis::evidence::{Evidence, SMALL_RUN, judge};
use equipoise_physics::analysis::jacobian::jacobian;
use equipoise_physics::analysis::method::{RunMethod, run_by};
use equipoise_physics::analysis::nonlinear_run::run_watched;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::body::Release;
use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::map::strike::{EnergyFeedback, Rod, State};
use equipoise_physics::numbers::dispatch::InstructionSet;
use equipoise_physics::run::lanes::batch_run::run_batch_on;
use equipoise_physics::run::lanes::model::BatchModel;
use equipoise_physics::run::orbit;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::scene::{Draft, Name, Scene, Value};

const BOUNCES: u64 = 1000;

const RELEASE: Release =
    Release { x: 0.0, height: 0.2, state: State { theta: 0.3, x_dot: 0.0, y_dot: 0.0, theta_dot: 0.0 } };

/// Number of impacts of a verdict, as `stability` has by default.
const WATCHED_FOR: u64 = 2000;

const ROUNDS: usize = 100;

fn main() {
    bench_all();
    ratios();
}

/// Prints the time with the error estimate over that of the bare bounce, and the time of a verdict over that of a bounce.
fn ratios() {
    let scene = case_1();
    let works: [&dyn Fn(); 3] = [
        &|| {
            let mut orbit =
                Orbit::new(Body::plain(black_box(case_1::ROD)), case_1::RULES, &RELEASE).expect("a contact");
            black_box(run(&mut orbit, BOUNCES, |_| true));
        },
        &|| {
            let run = run_by(black_box(&scene), RunMethod::Map, BOUNCES, |impact| impact.error_estimate < 1.0);
            assert!(run.is_ok_and(|ending| ending.is_some()), "a run that ended early would look fast");
        },
        &|| {
            black_box(verdict(black_box(&scene)));
        },
    ];
    let mut fastest = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        for (fastest, work) in fastest.iter_mut().zip(works) {
            let clock = Instant::now();
            work();
            *fastest = fastest.min(clock.elapsed().as_secs_f64());
        }
    }
    let [bounces, estimated, verdict] = fastest;
    println!("error estimate with its bounce over the bounce: {:.2}", estimated / bounces);
    let in_bounces = verdict / bounces * BOUNCES as f64;
    println!("verdict over {WATCHED_FOR} impacts: {in_bounces:.0} bounces, {:.0} µs", 1e6 * verdict);
}

/// Run, evidence, regularity and verdict, as `stability` answers.
fn verdict(scene: &Scene) -> Option<Verdict> {
    let run = run_watched(scene, WATCHED_FOR, || true)?;
    let judgement = judge(scene, &run.summary, SMALL_RUN, || true)?;
    if let Evidence::Balances(balance) = &judgement.evidence {
        black_box(run.regularity(scene, &balance.small));
    }
    Some(judgement.verdict)
}

/// States only, endings checked, energy held, as `stability` runs.
#[divan::bench]
fn one_orbit(bencher: Bencher) {
    bencher.counter(ItemsCount::new(BOUNCES)).bench(|| {
        let mut orbit = Orbit::new(Body::plain(black_box(case_1::ROD)), case_1::RULES, &RELEASE).ok()?;
        run(&mut orbit, BOUNCES, |_| true)
    });
}

/// The bare map: endings not checked, energy not held.
#[divan::bench]
fn strike_and_flight(bencher: Bencher) {
    bencher.counter(ItemsCount::new(BOUNCES)).bench(|| {
        let rod = black_box(case_1::ROD);
        let mut state = State { theta: 0.3, x_dot: 0.0, y_dot: -1.193_666_513_079_518, theta_dot: 0.0 };
        for _ in 0..BOUNCES {
            let strike = rod.strike(&state);
            let flight = rod.flight(&strike);
            let Ok(t) = equipoise_physics::map::contact_time::first_contact(&flight) else { break };
            state = flight.end(t);
        }
        state
    });
}

/// The paper's case 1 as a scene.
fn case_1() -> Scene {
    let mut draft = Draft::default();
    for (name, number) in [
        (Name::ContactDistance, case_1::ROD.contact_distance),
        (Name::RadiusOfGyration, case_1::ROD.radius_of_gyration),
        (Name::TiltGain, case_1::ROD.tilt_gain),
        (Name::Height, RELEASE.height),
        (Name::Theta, RELEASE.state.theta),
    ] {
        let _ = draft.set(name, Some(Value::Number(number)));
    }
    draft.build().expect("a scene")
}

/// The scene on each level of the model hierarchy, endings checked.
#[divan::bench(args = ["point", "linear", "rod", "rod_with_x", "friction", "noise", "polygon"])]
fn levels(bencher: Bencher, level: &str) {
    let mut draft = case_1().draft();
    let bencher = bencher.counter(ItemsCount::new(BOUNCES));
    match level {
        "linear" => {
            draft.set(Name::Theta, Some(Value::Number(1e-3))).expect("a value in its range");
            let scene = draft.build().expect("a scene");
            return bencher
                .bench(|| run_by(black_box(&scene), RunMethod::Linear, BOUNCES, |impact| impact.error_estimate < 1.0));
        }
        "point" => {
            for name in [Name::ContactDistance, Name::RadiusOfGyration, Name::Theta] {
                let _ = draft.set(name, None);
            }
            for (name, value) in [
                (Name::PointMass, Value::Flag(true)),
                (Name::TiltGain, Value::Number(0.2)),
                (Name::XDot, Value::Number(0.1)),
            ] {
                draft.set(name, Some(value)).expect("a value in its range");
            }
        }
        "polygon" => {
            for name in [Name::ContactDistance, Name::RadiusOfGyration] {
                let _ = draft.set(name, None);
            }
            draft.set_vertices(Vertices::new(&[[0.0, 0.0], [0.05, 0.2], [-0.05, 0.2]]).ok());
        }
        _ => {}
    }
    let mut set = |name, value| draft.set(name, Some(value)).expect("a value in its range");
    match level {
        "rod_with_x" => {
            for (name, gain) in [
                (Name::FeedbackX, 0.1),
                (Name::FeedbackTheta, -1.2),
                (Name::FeedbackXDot, 0.1),
                (Name::FeedbackThetaDot, -0.05),
            ] {
                set(name, Value::Number(gain));
            }
            let _ = draft.set(Name::TiltGain, None);
        }
        "friction" => {
            set(Name::Friction, Value::Number(0.3));
            set(Name::Slide, Value::Choice("matched"));
            set(Name::Theta, Value::Number(0.05));
        }
        "noise" => {
            set(Name::TimingSd, Value::Number(1e-3));
            set(Name::Theta, Value::Number(0.1));
        }
        _ => {}
    }
    let scene = draft.build().expect("a scene");
    bencher.bench(|| {
        let mut orbit = black_box(&scene).orbit().ok()?;
        let ending = run(&mut orbit, BOUNCES, |_| true);
        assert_eq!(orbit.contacts(), BOUNCES, "a run that ended early would look fast");
        ending
    });
}

/// With 31 digits, endings checked, energy held.
#[divan::bench]
fn extended(bencher: Bencher) {
    let scene = case_1();
    bencher.counter(ItemsCount::new(BOUNCES)).bench(|| {
        let mut orbit = black_box(&scene).extended_orbit().ok()?;
        orbit::run(&mut orbit, BOUNCES, |_| true)
    });
}

/// In doubles, with the error estimate.
#[divan::bench]
fn with_error_estimate(bencher: Bencher) {
    let scene = case_1();
    bencher
        .counter(ItemsCount::new(BOUNCES))
        .bench(|| run_by(black_box(&scene), RunMethod::Map, BOUNCES, |impact| impact.error_estimate < 1.0));
}

/// The exact derivative of the map, a product over the bounces.
#[divan::bench]
fn jacobian_product(bencher: Bencher) {
    let state = State { theta: 0.3, x_dot: 0.0, y_dot: -1.193_666_513_079_518, theta_dot: 0.0 };
    bencher
        .counter(ItemsCount::new(BOUNCES))
        .bench(|| jacobian(&Body::plain(black_box(case_1::ROD)), &state, BOUNCES).map(|it| it.flight_time));
}

/// Sine and cosine: ours, then the platform's.
#[divan::bench(args = ["ours", "platform"])]
fn sine_and_cosine(bencher: Bencher, whose: &str) {
    let function: fn(f64) -> (f64, f64) =
        if whose == "ours" { equipoise_physics::numbers::trig::sin_cos } else { f64::sin_cos };
    bencher.counter(ItemsCount::new(BOUNCES)).bench(|| {
        (0..BOUNCES).fold(black_box(0.3), |angle, _| {
            let (sin, cos) = function(angle);
            0.3 + 1e-9 * (sin + cos)
        })
    });
}

/// Eight rods side by side with their survival counts, on one core, as regions run. Items are bounces.
#[divan::bench(args = InstructionSet::ALL)]
fn lanes(bencher: Bencher, path: InstructionSet) {
    const RUNS: u64 = 32;
    let state = |theta| State { theta, x_dot: 0.0, y_dot: -1.15, theta_dot: 0.0 };
    bencher.counter(ItemsCount::new(RUNS * BOUNCES)).bench(|| {
        let mut left = RUNS;
        let mut next = || {
            left = left.checked_sub(1)?;
            let rod = Rod { tilt_gain: black_box(1.1 + 0.01 * left as f64), ..case_1::ROD };
            Some((0, Orbit::at(Body::plain(rod), case_1::RULES, state(0.002 * left as f64))))
        };
        let (model, mut survived) = (BatchModel::rods(EnergyFeedback::Vertical), 0);
        run_batch_on(path, model, BOUNCES, &mut next, &mut |_, end| survived += end.impacts, &mut || true);
        assert_eq!(survived, RUNS * BOUNCES);
    });
}
