//! Time of one catch, plan and throw on one core: `cargo bench --bench catching`.

use std::hint::black_box;

use divan::{Bencher, main as bench_all};
use equipoise_physics::catching::catch;
use equipoise_physics::catching::plan::{PlanProblem, believed_body, plan_catch};
use equipoise_physics::catching::settings::{CatchSettings, Strategy};
use equipoise_physics::catching::throw::{ThrowTarget, throw};
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::scene::{Draft, Name, Scene, Value};

fn main() {
    bench_all();
}

/// Case 1 released at rest from 0.25 m at 0.1 rad.
fn scene(friction: f64) -> Scene {
    let mut draft = Draft::default();
    for (name, number) in [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0),
        (Name::TiltGain, 1.1),
        (Name::Height, 0.25),
        (Name::Theta, 0.1),
        (Name::Friction, friction),
    ] {
        draft.set(name, Some(Value::Number(number))).expect("a value in its range");
    }
    draft.build().expect("a scene")
}

/// A whole catch: strikes and 6 s of hold. A plan is made again at each strike.
#[divan::bench(args = ["bounce_down", "plan", "brake"])]
fn one_catch(bencher: Bencher, strategy: &str) {
    let scene = scene(0.0);
    let strategy = Strategy::ALL.into_iter().find(|known| known.name() == strategy);
    let settings = CatchSettings { strategy, ..CatchSettings::default() };
    bencher.bench(|| catch(black_box(&scene), &settings, None, &mut || true));
}

/// One plan, from a body that bounces upright to the tilts of least squares.
#[divan::bench(args = [(5, 1.0), (8, 0.8), (16, 0.7)])]
fn one_plan(bencher: Bencher, (strikes, ratio): (u32, f64)) {
    let rod: Rod = scene(0.0).parameters();
    let state = State { theta: 0.1, x_dot: 0.0, y_dot: -1.517, theta_dot: 0.0 };
    let problem = PlanProblem { body: believed_body(rod, 0.0), strikes, ratio };
    bencher.bench(|| plan_catch(black_box(&problem), &PreImpact::at(1, 0.0, state), None, &mut || true));
}

/// One throw to half a metre, in closed form and with friction by a search.
#[divan::bench(args = [0.0, 0.3])]
fn one_throw(bencher: Bencher, friction: f64) {
    let scene = scene(friction);
    let coming = PreImpact::at(1, 0.0, State { theta: 0.1, x_dot: 0.0, y_dot: -1.5, theta_dot: 0.0 });
    bencher.bench(|| throw(black_box(&scene), &coming, None, &ThrowTarget { height: 0.5, theta: 0.5 }));
}
