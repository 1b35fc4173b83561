//! Error bounds of runs with state feedback and noise, held against the same runs with 31 digits.

use equipoise_physics::bounce::state::State;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::run::method::{RunMethod, run_by};
use equipoise_physics::scene::{Name, Scene};
use mixes::{MIXES, scene};
use random::Random;

#[path = "support/mixes.rs"]
mod mixes;
#[path = "support/random.rs"]
mod random;
#[path = "support/scenes.rs"]
mod scenes;

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
