//! Error bounds of runs with state feedback and noise, held against the same runs with 31 digits.

use crate::support::mixes;
use crate::support::random;
use equipoise_physics::bounce::strike::State;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::method::{RunMethod, run_by};
use equipoise_physics::scene::{Name, Scene};
use mixes::{MIXES, Parts, number, scene};
use random::Random;

/// Bounds and states of a run in doubles, up to the first impact without a bound.
fn bounded(scene: &Scene, impacts: u64) -> Vec<(f64, State)> {
    let mut run = Vec::new();
    run_by(scene, RunMethod::Map, impacts, |impact| {
        run.push((impact.error_estimate, impact.contact.state));
        impact.error_estimate < 1e-3
    })
    .unwrap();
    run.retain(|(bound, _)| *bound < 1e-3);
    run
}

/// States of the same run with 31 digits, and their bounds.
fn exact(scene: &Scene, impacts: u64) -> Vec<(f64, State<DoubleDouble>)> {
    let mut run = Vec::new();
    run_by(scene, RunMethod::Extended, impacts, |impact| {
        run.push((impact.error_estimate, impact.extended.unwrap().1.state));
        true
    })
    .unwrap();
    run
}

fn error(scene: &Scene, ours: &State, exact: &State<DoubleDouble>) -> f64 {
    let rho = scene.as_rod().unwrap().number(Name::RadiusOfGyration).unwrap();
    let off = |ours: f64, exact: DoubleDouble| (DoubleDouble::from(ours) - exact).to_f64().abs();
    f64::max(rho * off(ours.theta, exact.theta), rho * off(ours.theta_dot, exact.theta_dot))
        .max(off(ours.x_dot, exact.x_dot))
        .max(off(ours.y_dot, exact.y_dot))
}

#[test]
fn no_bound_is_below_the_error_and_none_is_idle() {
    let mut random = Random::new(2611);
    for parts in MIXES.into_iter().filter(|parts| parts.feedback || parts.noise.is_some() || parts.late) {
        let (mut ratios, mut contacts, mut worst) = (Vec::new(), 0, 0.0_f64);
        for _ in 0..100 {
            let scene = scene(&mut random, parts);
            let exact = exact(&scene, 60);
            contacts += exact.len();
            for (n, ((bound, ours), (rest, exact))) in bounded(&scene, 60).iter().zip(&exact).enumerate() {
                assert!(*rest < 1e-12 * bound.max(1e-12), "contact {}: 31 digits are off by {rest:e}", n + 1);
                let error = error(&scene, ours, exact);
                worst = worst.max(error / bound);
                assert!(error <= *bound, "contact {}: error {error:e}, bound {bound:e}, {scene:?}", n + 1);
                ratios.push(bound / error.max(2e-16));
            }
        }
        ratios.sort_by(f64::total_cmp);
        let median = ratios[ratios.len() / 2];
        println!(
            "{parts:?}: {} bounds at {contacts} contacts, median {median:.1}, worst share {worst:.3}",
            ratios.len()
        );
        assert!(
            10 * ratios.len() >= 8 * contacts && median <= 200.0,
            "{parts:?}: {} of {contacts}, {median}",
            ratios.len()
        );
    }
}

/// A random scene with constant errors of its rig: with `gain`, that of the tilt alone, on a table whose gain is then near 1.
fn off(random: &mut Random, gain: bool) -> Scene {
    loop {
        let mut draft = scene(random, Parts::default()).draft();
        let error = random.size(1e-3, 0.2);
        number(&mut draft, Name::TiltGainError, error);
        if gain {
            number(&mut draft, Name::TiltGain, (1.0 + random.size(1e-7, 1e-2)) / (1.0 + error));
        } else {
            number(&mut draft, Name::AngleBias, random.size(1e-6, 1e-3));
            number(&mut draft, Name::TiltOffset, random.size(1e-6, 1e-3));
            number(&mut draft, Name::SpeedError, random.size(1e-4, 0.05));
            number(&mut draft, Name::Offset, 0.1 * random.size(1e-4, 0.02));
        }
        if let Ok(scene) = draft.build() {
            return scene;
        }
    }
}

#[test]
fn parameters_that_an_error_of_the_rig_rounds_are_in_the_bound() {
    let mut random = Random::new(2626);
    for gain in [true, false] {
        let (mut ratios, mut beyond, mut worst, mut runs) = (Vec::new(), 0, 0.0_f64, 0);
        while runs < 240 {
            let scene = off(&mut random, gain);
            let exact = exact(&scene, 300);
            if gain && exact.len() < 300 {
                continue;
            }
            runs += 1;
            let run = bounded(&scene, 300).into_iter().zip(exact);
            let shares: Vec<f64> =
                run.map(|((bound, ours), (_, exact))| error(&scene, &ours, &exact) / bound).collect();
            ratios.extend(shares.iter().map(|share| 1.0 / share.max(1e-6)));
            let largest = shares.into_iter().fold(0.0, f64::max);
            beyond += u32::from(largest > 1.0);
            worst = worst.max(largest);
        }
        ratios.sort_by(f64::total_cmp);
        let median = ratios[ratios.len() / 2];
        println!(
            "gain {gain}: {beyond} of {runs} runs beyond, worst {worst:.3}, {} bounds, median {median:.1}",
            ratios.len()
        );
        assert_eq!(beyond, 0, "the worst error is {worst} of its bound");
        assert!(ratios.len() > 240 * 20 && median < 200.0, "{} bounds, median {median}", ratios.len());
    }
}
