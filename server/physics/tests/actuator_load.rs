//! Load on the table: strokes and tilt rates between strikes, and the limit that is named.

use equipoise_physics::map::table::actuator_load::{ActuatorLimits, ActuatorLoad, Pose};

/// Stroke between strikes at these vertical velocities, m/s, after this time, s.
fn stroke((v0, v1): (f64, f64), time: f64) -> f64 {
    let pose = |speed| Pose { alpha: 0.0, velocity: (0.0, speed) };
    pose(v1).load(Some((pose(v0), time))).stroke
}

#[test]
fn a_stroke_is_that_of_the_cubic() {
    for (v0, v1) in [(0.3, 0.3), (0.3, -0.3), (0.4, 0.1), (-0.2, 0.5), (0.0, 0.2), (0.2, 0.0), (-0.1, -0.1), (0.0, 0.0)]
    {
        let time = 0.4;
        let places = (0..=20_000).map(|step| {
            let s = f64::from(step) / 20_000.0;
            time * s * (1.0 - s) * (v0 * (1.0 - s) - v1 * s)
        });
        let (low, high) = places.fold((0.0_f64, 0.0_f64), |(low, high), y| (low.min(y), high.max(y)));
        assert!((stroke((v0, v1), time) - (high - low)).abs() < 1e-9, "{v0} {v1}");
    }
}

#[test]
fn a_table_that_strikes_alike_each_time_swings_to_both_sides() {
    // v₀ = v₁ = v: the extremes are at s = ½ ± 1/√12, v·time/(6√3) to either side.
    let expected = 0.5 * 0.2 / (3.0 * 3.0_f64.sqrt());
    assert!((stroke((0.2, 0.2), 0.5) - expected).abs() < 1e-15);
}

#[test]
fn no_flight_is_too_short_for_a_tilt_rate() {
    let pose = |alpha| Pose { alpha, velocity: (0.0, 0.1) };
    assert_eq!(pose(0.3).load(Some((pose(0.1), 1e-20))).tilt_rate, (0.3 - 0.1) / 1e-20);
    for time in [f64::from_bits(1), 0.0] {
        assert_eq!(pose(0.3).load(Some((pose(0.1), time))).tilt_rate, f64::MAX);
    }
}

#[test]
fn the_first_limit_passed_is_named() {
    let limits = ActuatorLimits { tilt: 0.3, tilt_rate: f64::INFINITY, speed: 1.0, stroke: 0.1 };
    let load = ActuatorLoad { tilt: 0.2, tilt_rate: 50.0, speed: 1.5, stroke: 0.2 };
    let excess = limits.exceeded(&load).unwrap();
    assert_eq!((excess.quantity, excess.value, excess.limit, excess.unit), ("speed", 1.5, 1.0, "m/s"));
    assert_eq!(limits.exceeded(&ActuatorLoad { speed: 1.0, ..load }).unwrap().quantity, "stroke");
    assert_eq!(limits.exceeded(&ActuatorLoad::default()), None);
}
