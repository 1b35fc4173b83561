//! Cost of endings, energy and bookkeeping over a bare loop of lanes, of other models over the rod, of runs on two threads, and of a whole
//! region as PNG over bare loops on all cores: `cargo bench --bench lanes`. All are measured in turns in one run, so that ratios hold on a
//! noisy machine.

mod case_1;

use std::hint::black_box;
use std::thread;
use std::time::Instant;

use axum::Router;
use axum::body;
use axum::http::{Request, StatusCode};
use case_1::{ROD, RULES};
use clap::Parser;
use equipoise::api::App;
use equipoise::config::Config;
use equipoise::router;
use equipoise_physics::map::body::Body;
use equipoise_physics::map::friction::{Friction, RestitutionLaw, Slide};
use equipoise_physics::map::strike::{Rod, State};
use equipoise_physics::map::table::actuator_load::ActuatorLoad;
use equipoise_physics::map::table::control_law::{Gains, Steering};
use equipoise_physics::map::table::noise::{Noise, NoiseModel};
use equipoise_physics::map::table::pivot::TurningTable;
use equipoise_physics::numbers::dispatch::{InstructionSet, Kernel, Vector, dispatch_on};
use equipoise_physics::run::lanes::batch_run::run_batch_on;
use equipoise_physics::run::lanes::model::BatchModel;
use equipoise_physics::run::orbit::{Orbit, run};
use equipoise_physics::run::rules::Rules;
use http_body_util::BodyExt;
use tower::ServiceExt;

const RUNS: usize = 64;
const BOUNCES: u64 = 2000;
const ROUNDS: usize = 25;

fn rod(run: usize) -> Rod {
    Rod { tilt_gain: 1.05 + 0.004 * run as f64, ..ROD }
}

fn state(run: usize, wide: f64) -> State {
    State { theta: wide * (1 + run % 32) as f64, x_dot: 0.0, y_dot: -1.15, theta_dot: 0.0 }
}

/// Kind of bodies that bounce.
#[derive(Clone, Copy, Debug)]
enum Bodies {
    Rods,
    Points,
    /// With state feedback.
    Fed,
    Rough(RestitutionLaw, Slide),
    /// On tables with a further part.
    With(Part),
}

/// A part of a table.
#[derive(Clone, Copy, Debug)]
enum Part {
    ConstantTilt,
    Delay,
    Pivot,
    Limits,
    Ends,
    TimingNoise,
    SensingNoise,
    RestitutionNoise,
    PlannedStrikes,
}

const PARTS: [Part; 9] = [
    Part::ConstantTilt,
    Part::Delay,
    Part::Pivot,
    Part::Limits,
    Part::Ends,
    Part::TimingNoise,
    Part::SensingNoise,
    Part::RestitutionNoise,
    Part::PlannedStrikes,
];

impl Bodies {
    fn orbit(self, run: usize, wide: f64) -> Orbit {
        let (rod, state) = (rod(run), state(run, wide));
        match self {
            Self::Rods => Orbit::at(Body::plain(rod), RULES, state),
            Self::Points => {
                let rod = Rod { tilt_gain: rod.tilt_gain - 1.0, ..rod };
                let rules = Rules { topple_angle: f64::INFINITY, ..RULES };
                Orbit::at(Body::point(rod), rules, Body::point_state(state.theta, state.y_dot))
            }
            Self::Fed => {
                let gains = Gains { x: 0.018, theta: -0.88 - 0.2 * rod.tilt_gain, x_dot: 0.023, theta_dot: -0.031 };
                Orbit::at(Body { steering: Steering::Feedback(gains), ..Body::plain(rod) }, RULES, state)
            }
            Self::Rough(law, slide) => {
                let friction = Some(Friction { coefficient: 0.3, law, slide });
                let rules = Rules { holds_energy: false, ..RULES };
                Orbit::at(Body { friction, ..Body::plain(rod) }, rules, state)
            }
            Self::With(part) => part.orbit(run, rod, state),
        }
    }
}

impl Part {
    fn orbit(self, run: usize, rod: Rod, state: State) -> Orbit {
        // The table holds the energy of an upright release.
        let target_energy = ROD.energy(&State { theta: 0.0, ..state });
        let energetic = Rod { strike_gain_per_energy: 0.1, target_energy, ..rod };
        let lossy = Rules { settles: true, holds_energy: false, ..RULES };
        let noise = Noise { timing_sd: 1e-4, angle_sd: 1e-5, seed: 1, run: run as u64, ..Noise::NONE };
        let noisy = |noise| Orbit::at(Body { noise: Some(noise), ..Body::plain(energetic) }, lossy, state);
        let plain = Body::plain(rod);
        match self {
            Self::ConstantTilt => Orbit::at(Body { constant_tilt: 1e-6, ..plain }, RULES, state),
            // So short that no swing grows into a fall.
            Self::Delay => Orbit::at(Body { lag: 1e-7, ..plain }, RULES, state),
            Self::Pivot => {
                let turning = Some(TurningTable { place: Some(0.0), depth: 0.03, is_corrected: false });
                Orbit::at(Body { turning, ..Body::plain(energetic) }, lossy, state)
            }
            Self::Limits => {
                let limits = Some(ActuatorLoad { tilt: 1.0, tilt_rate: 100.0, speed: 10.0, stroke: 1.0 });
                Orbit::at(plain, Rules { limits, ..RULES }, state)
            }
            Self::Ends => Orbit::at(plain, Rules { half_length: 1e3, ..RULES }, state),
            Self::TimingNoise => noisy(noise),
            Self::SensingNoise => noisy(Noise { x_dot_sd: 1e-4, theta_dot_sd: 1e-4, ..noise }),
            Self::RestitutionNoise => noisy(Noise { restitution_sd: 1e-3, ..noise }),
            Self::PlannedStrikes => noisy(Noise { model: NoiseModel::Plan, ..noise }),
        }
    }
}

/// Time per bounce of runs one after another, ns.
fn alone(bodies: Bodies) -> f64 {
    let mut orbits: Vec<_> = (0..8).map(|number| bodies.orbit(black_box(number), 0.001)).collect();
    let clock = Instant::now();
    for orbit in &mut orbits {
        black_box(run(orbit, BOUNCES, |_| true));
    }
    let bounces: u64 = orbits.iter().map(Orbit::contacts).sum();
    clock.elapsed().as_secs_f64() * 1e9 / bounces as f64
}

/// Time per bounce of the batch run that regions use, ns.
fn ours(path: InstructionSet, bodies: Bodies, wide: f64) -> f64 {
    let orbits: Vec<_> = (0..RUNS).map(|run| (run, bodies.orbit(black_box(run), wide))).collect();
    let model = BatchModel::of(&orbits[0].1.body, orbits[0].1.rules());
    let (mut orbits, mut bounces) = (orbits.into_iter(), 0);
    let clock = Instant::now();
    run_batch_on(
        path,
        model.expect("a model of lanes"),
        BOUNCES,
        &mut || orbits.next(),
        &mut |_, end| bounces += end.impacts,
        &mut || true,
    );
    assert!(bounces > RUNS as u64 * BOUNCES / 2, "{bodies:?}: {bounces}");
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
    fn call<V: Vector>(self) -> (usize, f64) {
        let (l, per_square, g) = (ROD.contact_distance, ROD.radius_of_gyration.powi(-2), ROD.gravity);
        let (mut bounces, mut sum) = (0, 0.0);
        for chunk in 0..RUNS / LANES {
            let runs: [usize; LANES] = std::array::from_fn(|lane| black_box(chunk * LANES + lane));
            let kappa = runs.map(|run| rod(run).tilt_gain);
            let starts = runs.map(|run| state(run, self.wide));
            let mut theta = starts.map(|start| start.theta);
            let mut x_dot = starts.map(|start| start.x_dot);
            let mut y_dot = starts.map(|start| start.y_dot);
            let mut theta_dot = starts.map(|start| start.theta_dot);
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

/// A map of 256 × 256 runs, all of which survive their 1000 impacts.
const MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1.05&x.to=1.4&x.count=256\
                   &y.field=release.theta&y.from=0&y.to=0.05&y.count=256&bounces=1000&format=png";
const MAP_BOUNCES: f64 = 256.0 * 256.0 * 1000.0;

/// Wall time of [`MAP`] from request to last byte, per bounce, ns. The server keeps no answers.
fn whole_map(runtime: &tokio::runtime::Runtime, server: &Router) -> f64 {
    let request = Request::get(MAP).header("host", "localhost").body(body::Body::empty()).expect("a request");
    let clock = Instant::now();
    let (status, answer) = runtime.block_on(async {
        let answer = server.clone().oneshot(request).await.expect("the router never fails");
        (answer.status(), answer.into_body().collect().await.expect("the whole answer"))
    });
    let elapsed = clock.elapsed();
    assert_eq!((status, &answer.to_bytes()[1..4]), (StatusCode::OK, &b"PNG"[..]));
    elapsed.as_secs_f64() * 1e9 / MAP_BOUNCES
}

/// Wall time per bounce of bare loops on all cores, as many bounces as those of [`MAP`], ns.
fn bare_on_all_cores(path: InstructionSet) -> f64 {
    let cores = thread::available_parallelism().map_or(1, usize::from);
    let loops = (MAP_BOUNCES / (cores as f64 * RUNS as f64 * BOUNCES as f64)).ceil() as usize;
    let clock = Instant::now();
    thread::scope(|scope| {
        for _ in 0..cores {
            scope.spawn(|| (0..loops).map(|_| bare(path, 0.001)).sum::<f64>());
        }
    });
    clock.elapsed().as_secs_f64() * 1e9 / (cores * loops * RUNS * BOUNCES as usize) as f64
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
            let [ours, bare, ratio] = compare(|| ours(path, Bodies::Rods, wide), || bare(path, wide));
            println!("{path:?}, {name}: sweep {ours:.2}, bare loop {bare:.2}, ratio {ratio:.2}");
        }
    }
    for path in InstructionSet::ALL.into_iter().filter(|path| path.is_there()) {
        for (name, bodies) in [("point mass", Bodies::Points), ("state feedback", Bodies::Fed)] {
            let [its, rods, ratio] = compare(|| ours(path, bodies, 0.001), || ours(path, Bodies::Rods, 0.001));
            println!("{path:?}, {name}: {its:.2}, rod {rods:.2}, ratio {ratio:.2}");
        }
    }
    for path in InstructionSet::ALL.into_iter().filter(|path| path.is_there()) {
        for law in [RestitutionLaw::Poisson, RestitutionLaw::Newton, RestitutionLaw::Stronge] {
            // With friction, a table that only tilts balances only the upright rod.
            for (slide, wide) in [(Slide::Matched, 0.001), (Slide::None, 0.0)] {
                let [with, without, ratio] =
                    compare(|| ours(path, Bodies::Rough(law, slide), wide), || ours(path, Bodies::Rods, wide));
                println!("{path:?}, {law:?}, {slide:?}: {with:.2}, without friction {without:.2}, ratio {ratio:.2}");
            }
        }
    }
    for path in InstructionSet::ALL.into_iter().filter(|path| path.is_there()) {
        for part in PARTS {
            let bodies = Bodies::With(part);
            let [_, _, ratio] = compare(|| ours(path, bodies, 0.001), || ours(path, Bodies::Rods, 0.001));
            let [_, _, alone] = compare(|| alone(bodies), || alone(Bodies::Rods));
            println!("{path:?}, {part:?}: {ratio:.2} times the rod; outside lanes {alone:.2} times");
        }
    }
    let best = InstructionSet::ALL.into_iter().find(|path| path.is_there()).unwrap_or(InstructionSet::Portable);
    let sweep = |path, wide| ours(path, Bodies::Rods, wide);
    let two = |work: fn(InstructionSet, f64) -> f64| {
        thread::scope(|scope| {
            let other = scope.spawn(|| work(best, 0.001));
            let here = work(best, 0.001);
            0.25 * (here + other.join().unwrap_or(f64::NAN))
        })
    };
    for (name, work) in [("sweep", sweep as fn(InstructionSet, f64) -> f64), ("bare loop", bare)] {
        let [one, two, ratio] = compare(|| work(best, 0.001), || two(work));
        println!("{name}, two threads side by side: {two:.2} a bounce for {one:.2} on one, {ratio:.2} times as fast");
    }
    let runtime = tokio::runtime::Runtime::new().expect("threads of the server");
    let server = {
        let _inside = runtime.enter();
        router::router(App::new(&Config::parse_from(["equipoise", "--answer-cache", "0"])))
    };
    let [map, bare, ratio] = compare(|| whole_map(&runtime, &server), || bare_on_all_cores(best));
    println!(
        "256 × 256 × 1000 survival as PNG: {map:.2} a bounce, bare loops on all cores {bare:.2}, ratio {ratio:.2}"
    );
}
