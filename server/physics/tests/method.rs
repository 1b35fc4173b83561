//! The choice of a method: doubles where they hold, the same every time, and a refusal where no method does.

use crate::paper::scene;
use equipoise_physics::analysis::method::{RunMethod, choose_method};
use equipoise_physics::run::error_estimate::predictable_impacts;

/// The paper's body with κ, θ₀ and an energy that is V = 1.14 m/s upright.
#[test]
fn doubles_are_enough_for_most_runs() {
    for (theta, impacts) in [(1e-4, 20), (1e-4, 5000), (0.3, 1000)] {
        let choice = choose_method(&scene(1.1, theta), impacts, 1e-6, || true).unwrap().unwrap();
        assert_eq!(choice.method, RunMethod::Map, "{choice:?}");
        assert!(choice.error_estimate < 1e-9, "{choice:?}");
        assert_eq!(choice, choose_method(&scene(1.1, theta), impacts, 1e-6, || true).unwrap().unwrap());
    }
}

#[test]
fn more_digits_than_doubles_hold_are_extended() {
    let choice = choose_method(&scene(1.1, 0.3), 1000, 1e-20, || true).unwrap().unwrap();
    assert_eq!(choice.method, RunMethod::Extended, "{choice:?}");
    assert!(choice.error_estimate <= 1e-20, "{choice:?}");
}

/// A chaotic run that goes on: doubles lose it within some hundred impacts, 31 digits after about twice as many.
#[test]
fn beyond_the_horizon_it_is_refused() {
    let chaotic = scene(1.55, 0.02);
    let within = |impacts| choose_method(&chaotic, impacts, 1e-3, || true).unwrap();
    let refusal = within(100_000).unwrap_err();
    assert!(refusal.horizon > 50 && refusal.horizon < 100_000, "{refusal:?}");
    assert!(refusal.detail.contains(&format!("at most {} impacts", refusal.horizon)), "{refusal:?}");
    assert_eq!(within(refusal.horizon).unwrap().method, RunMethod::Extended);
    assert_eq!(within(refusal.horizon + 1), Err(within(refusal.horizon + 1).unwrap_err()));
    let map = predictable_impacts(&chaotic, 100_000, 1e-3, || true).unwrap();
    assert!(map < refusal.horizon, "{map} {}", refusal.horizon);
    assert_eq!(within(map).unwrap().method, RunMethod::Map);
    assert_eq!(within(map + 1).unwrap().method, RunMethod::Extended);
}

#[test]
fn a_choice_can_be_called_off() {
    assert_eq!(choose_method(&scene(1.1, 0.3), 100_000, 1e-6, || false), None);
}
