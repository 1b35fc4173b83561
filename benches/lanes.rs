//! Cost of endings, energy and bookkeeping over a bare loop of lanes, and of a region on two threads: `cargo bench --bench lanes`.
//! All are measured in turns in one run, so that ratios hold on a noisy machine.

mod case_1;

use std::hint::black_box;
use std::thread;
use std::time::Instant;

use case_1::{ROD, RULES};
use equipoise_physics::batch::batch_run::{RunStart, run_batch_on, run_batch_with_friction_on};
use equipoise_physics::bounce::friction::{RestitutionLaw, Slide};
use equipoise_physics::bounce::rod::Rod;
use equipoise_physics::bounce::state::State;
use equipoise_physics::numbers::dispatch::{InstructionSet, Kernel, dispatch_on};
use equipoise_physics::run::rules::Rules;

const RUNS: usize = 64;
const BOUNCES: u64 = 2000;
const ROUNDS: usize = 25;

fn start(run: usize, wide: f64) -> RunStart {
    RunStart {
        rod: Rod { tilt_gain: 1.05 + 0.004 * run as f64, ..ROD },
        rules: RULES,
        state: State { theta: wide * (1 + run % 32) as f64, x_dot: 0.0, y_dot: -1.15, theta_dot: 0.0 },
    }
}

/// Time per bounce of the batch run that regions use, ns.
fn ours(path: InstructionSet, wide: f64) -> f64 {
    let mut runs = (0..RUNS).map(|run| (run, start(black_box(run), wide)));
    let mut bounces = 0;
    let clock = Instant::now();
    run_batch_on(path, BOUNCES, || runs.next(), |_, end| bounces += end.impacts, || true);
    clock.elapsed().as_secs_f64() * 1e9 / bounces as f64
}

/// Time per bounce of the same with friction, ns.
fn rough(path: InstructionSet, contact: (RestitutionLaw, Slide), wide: f64) -> f64 {
    let mut runs = (0..RUNS).map(|run| {
        let start = start(black_box(run), wide);
        (run, RunStart { rules: Rules { holds_energy: false, ..start.rules }, ..start }, 0.3)
    });
    let mut bounces = 0;
    let clock = Instant::now();
    run_batch_with_friction_on(path, contact, BOUNCES, || runs.next(), |_, end| bounces += end.impacts, || true);
    clock.elapsed().as_secs_f64() * 1e9 / bounces as f64
}

/// Time per bounce of the bare loop, ns.
fn bare(path: InstructionSet, wide: f64) -> f64 {
    let clock = Instant::now();
    let (bounces, _) = black_box(dispatch_on(path, Bare { wide }));
    clock.elapsed().as_secs_f64() * 1e9 / bounces as f64
}

/// Lower bound of the work: lossless strikes, a series for the flight with one Newton step, and one check of the angles. It has no
/// endings, no energy, no largest angle, and no certificate that the contact is the first.
struct Bare {
    wide: f64,
}

const LANES: usize = 16;

impl Kernel for Bare {
    type Output = (usize, f64);

    #[inline(always)]
    fn call(self) -> (usize, f64) {
        let (l, per_square, g) = (ROD.contact_distance, ROD.radius_of_gyration.powi(-2), ROD.gravity);
        let (mut bounces, mut sum) = (0, 0.0);
        for chunk in 0..RUNS / LANES {
            let starts: [RunStart; LANES] =
                std::array::from_fn(|lane| start(black_box(chunk * LANES + lane), self.wide));
            let kappa = starts.map(|start| start.rod.tilt_gain);
            let mut theta = starts.map(|start| start.state.theta);
            let mut x_dot = starts.map(|start| start.state.x_dot);
            let mut y_dot = starts.map(|start| start.state.y_dot);
            let mut theta_dot = starts.map(|start| start.state.theta_dot);
            for _ in 0..BOUNCES {
                let mut small = true;
                bounces += LANES;
                for lane in 0..LANES {
                    let alpha = kappa[lane] * theta[lane];
                    let ((sin, cos), (sin_alpha, cos_alpha)) = (sin_cos(theta[lane]), sin_cos(alpha));
                    let arm = l * (sin * cos_alpha - cos * sin_alpha);
                    let turn = arm * per_square;
                    let normal = cos_alpha * y_dot[lane] - sin_alpha * x_dot[lane] + arm * theta_dot[lane];
                    let impulse = -2.0 * normal / (1.0 + arm * turn);
                    x_dot[lane] -= impulse * sin_alpha;
                    let up = y_dot[lane] + impulse * cos_alpha;
                    let spin = theta_dot[lane] + impulse * turn;
                    theta_dot[lane] = spin;
                    let (reach_x, reach_y) = (l * sin, l * cos);
                    let rise = up + reach_x * spin;
                    let bulge = spin * spin;
                    let fall = 1.0 / (g - reach_y * bulge);
                    let rough = 2.0 * rise * fall;
                    let turned = spin * rough;
                    let p = bulge * fall * turned * reach_x * (1.0 / 3.0);
                    let q = bulge * fall * turned * turned * reach_y * (1.0 / 12.0);
                    let t = rough * (1.0 - q - p + 2.0 * p * p);
                    let (sin_turn, cos_turn) = sin_cos(spin * t);
                    let gap = t * (up - 0.5 * g * t) + reach_x * sin_turn + reach_y * (1.0 - cos_turn);
                    let slope = up - g * t + spin * (reach_x * cos_turn + reach_y * sin_turn);
                    let t = t - gap / slope;
                    theta[lane] += spin * t;
                    y_dot[lane] = up - g * t;
                    small &= alpha.abs() + (spin * t).abs() < 0.75;
                }
                if !small {
                    break;
                }
            }
            sum += theta.iter().sum::<f64>();
        }
        (bounces, sum)
    }
}

/// Taylor series, exact to rounding for |x| < π/4.
#[inline(always)]
fn sin_cos(x: f64) -> (f64, f64) {
    let z = x * x;
    let w = z * z;
    let sin = (1.0 - z * (1.0 / 6.0))
        + w * ((1.0 / 120.0 - z * (1.0 / 5040.0))
            + w * ((1.0 / 362_880.0 - z * (1.0 / 39_916_800.0)) + w * (1.0 / 6_227_020_800.0)));
    let cos = (1.0 - z * 0.5)
        + w * ((1.0 / 24.0 - z * (1.0 / 720.0))
            + w * ((1.0 / 40_320.0 - z * (1.0 / 3_628_800.0))
                + w * (1.0 / 479_001_600.0 - z * (1.0 / 87_178_291_200.0))));
    (x * sin, cos)
}

/// Measures both in turns. Returns their medians and the median of their ratios.
fn compare(first: impl Fn() -> f64, second: impl Fn() -> f64) -> [f64; 3] {
    let pairs: Vec<(f64, f64)> = (0..ROUNDS).map(|_| (first(), second())).collect();
    let median = |value: fn(&(f64, f64)) -> f64| {
        let mut values: Vec<f64> = pairs.iter().map(value).collect();
        values.sort_by(f64::total_cmp);
        values[ROUNDS / 2]
    };
    [median(|pair| pair.0), median(|pair| pair.1), median(|pair| pair.0 / pair.1)]
}

fn main() {
    println!("{RUNS} runs of {BOUNCES} bounces, ns a bounce, medians of {ROUNDS} rounds");
    for path in InstructionSet::ALL.into_iter().filter(|path| path.is_there()) {
        for (name, wide) in [("|θ| ≤ 0.03", 0.001), ("|θ| ≤ 0.13", 0.004)] {
            let [ours, bare, ratio] = compare(|| ours(path, wide), || bare(path, wide));
            println!("{path:?}, {name}: sweep {ours:.2}, bare loop {bare:.2}, ratio {ratio:.2}");
        }
    }
    for path in InstructionSet::ALL.into_iter().filter(|path| path.is_there()) {
        for law in [RestitutionLaw::Poisson, RestitutionLaw::Newton, RestitutionLaw::Stronge] {
            // With friction, a table that only tilts balances only the upright rod.
            for (slide, wide) in [(Slide::Matched, 0.001), (Slide::None, 0.0)] {
                let [with, without, ratio] = compare(|| rough(path, (law, slide), wide), || ours(path, wide));
                println!("{path:?}, {law:?}, {slide:?}: {with:.2}, without friction {without:.2}, ratio {ratio:.2}");
            }
        }
    }
    let best = InstructionSet::ALL.into_iter().find(|path| path.is_there()).unwrap_or(InstructionSet::Portable);
    let two = |work: fn(InstructionSet, f64) -> f64| {
        thread::scope(|scope| {
            let other = scope.spawn(|| work(best, 0.001));
            let here = work(best, 0.001);
            0.25 * (here + other.join().unwrap_or(f64::NAN))
        })
    };
    for (name, work) in [("sweep", ours as fn(InstructionSet, f64) -> f64), ("bare loop", bare)] {
        let [one, two, ratio] = compare(|| work(best, 0.001), || two(work));
        println!("{name}, two threads side by side: {two:.2} a bounce for {one:.2} on one, {ratio:.2} times as fast");
    }
}
