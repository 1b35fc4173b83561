//! The basin of release angles against runs one by one.

mod paper;

use equipoise_physics::run::ending::Ending;
use equipoise_physics::stability::basin::{NoBasin, find_basin};
use equipoise_physics::stability::nonlinear_run::run_nonlinear;
use paper::scene;

fn survives(tilt_gain: f64, theta: f64, impacts: u64) -> bool {
    run_nonlinear(&scene(tilt_gain, theta), impacts, || true).unwrap().ending == Ending::Completed
}

#[test]
fn edges_and_holes_are_where_runs_fall() {
    for tilt_gain in [1.1, 1.2, 1.3, 1.375, 1.45] {
        let basin = find_basin(&scene(tilt_gain, 0.01), 1000, || true).unwrap();
        println!("κ = {tilt_gain}: {basin:?}");
        assert!(basin.unbroken <= basin.theta && basin.tolerance < 1e-6);
        for edge in [basin.theta, basin.unbroken] {
            assert!(survives(tilt_gain, edge, 1000), "κ = {tilt_gain}: {edge}");
            // Not all of them need to: at the outer edge angles that fall and survive are mixed at every scale.
            let falls = |step: i32| !survives(tilt_gain, edge + basin.tolerance * f64::from(step) / 20.0, 1000);
            assert!((1..=21).any(falls), "κ = {tilt_gain}: {edge}");
        }
        assert_eq!(basin.holes.is_empty(), basin.unbroken == basin.theta);
        for (from, to) in &basin.holes {
            assert!(basin.unbroken < *from && from <= to && *to < basin.theta);
            assert!(!survives(tilt_gain, *from, 1000) && !survives(tilt_gain, *to, 1000));
        }
    }
    // The dent beyond the order-4 resonance, R = 1/2.
    let width = |tilt_gain| find_basin(&scene(tilt_gain, 0.01), 1000, || true).unwrap().unbroken;
    println!("{}", width(1.266));
    assert!(width(1.266) < 0.2 && width(1.1) > 0.3);
}

#[test]
fn below_one_nothing_survives_and_a_search_can_be_stopped() {
    assert!(find_basin(&scene(0.9, 0.01), 1000, || true).unwrap().theta < 1e-4);
    assert_eq!(find_basin(&scene(1.1, 0.01), 100_000, || false), Err(NoBasin::Stopped));
}
