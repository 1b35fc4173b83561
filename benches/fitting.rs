//! Time of one fit on one core: `cargo bench --bench fitting`.

use std::hint::black_box;

use divan::{Bencher, main as bench_all};
use equipoise_physics::fitting::{FitRequest, Measured, fit};
use equipoise_physics::run::orbit::run;
use equipoise_physics::scene::{Draft, Name, Scene, Value};
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

/// Places of θ, x and t among the columns, and the noise of a lab: 2 mrad, 1 mm, 1 ms.
const MEASURED: [(usize, f64); 3] = [(0, 2e-3), (4, 1e-3), (5, 1e-3)];

fn main() {
    bench_all();
}

/// Case 1 released at rest from 0.2 m at 0.2 rad.
fn scene() -> Scene {
    let mut draft = Draft::default();
    for (name, number) in [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, 2.0_f64.sqrt() / 15.0),
        (Name::TiltGain, 1.1),
        (Name::Height, 0.2),
        (Name::Theta, 0.2),
    ] {
        draft.set(name, Some(Value::Number(number))).expect("a value in its range");
    }
    draft.build().expect("a scene")
}

/// The run of a scene with noise.
fn measured(scene: &Scene, impacts: u64) -> Measured {
    let mut random = SplitMix64::seed_from_u64(18);
    let mut measured = Measured::default();
    run(&mut scene.orbit().expect("it meets the table"), impacts, |contact| {
        let values = [contact.state.theta, 0.0, 0.0, 0.0, contact.x, contact.t];
        for (column, sd) in MEASURED {
            let normal: f64 = (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0;
            measured.columns[column].push(Some(values[column] + sd * normal));
        }
        true
    });
    measured
}

/// A fit of the first so many of κ, ρ and gravity, from values that are 5 % off.
#[divan::bench(args = [(20, 1), (100, 1), (100, 3), (1000, 3)])]
fn one_fit(bencher: Bencher, (impacts, unknowns): (u64, usize)) {
    let scene = scene();
    let unknown = [Name::TiltGain, Name::RadiusOfGyration, Name::Gravity][..unknowns].to_vec();
    let mut draft = scene.draft();
    for &name in &unknown {
        let value = scene.number(name).expect("a number");
        draft.set(name, Some(Value::Number(1.05 * value))).expect("a value in its range");
    }
    let first = draft.build().expect("a scene");
    let request = FitRequest { scene: first, measured: measured(&scene, impacts), unknown, sd: [None; 6] };
    bencher.bench(|| fit(black_box(&request), &mut |_| {}, &mut || true));
}
