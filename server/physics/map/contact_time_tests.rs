//! Number of pieces that a flight is cut into.

use super::*;
use proptest::prelude::*;

/// Flights beyond what scenes may ask for, with every power of ten as likely.
fn flights() -> impl Strategy<Value = Flight> {
    let power = |from: f64, to: f64| (from..to).prop_map(libm::exp10);
    let either =
        |size: BoxedStrategy<f64>| (size, any::<bool>()).prop_map(|(size, minus)| if minus { -size } else { size });
    let clearance = prop_oneof![Just(0.0), either(power(-4.0, 2.5).boxed())];
    let speeds = (either(power(-6.0, 4.0).boxed()), either(power(-1.0, 6.0).boxed()));
    (-3.2..3.2, speeds, clearance, power(-3.0, 1.0), power(-6.0, 2.0)).prop_map(
        |(theta, (y_dot, theta_dot), clearance, contact_distance, gravity)| Flight {
            start: State { theta, x_dot: 0.0, y_dot, theta_dot },
            sin_cos_theta: crate::numbers::trig::sin_cos(theta),
            clearance,
            contact_distance,
            gravity,
            drag: None,
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100_000))]

    #[test]
    fn a_flight_has_few_pieces_however_long_it_is_and_however_fast_it_spins(flight in flights()) {
        let start = flight.gap(0.0);
        let above = flight.clearance > 0.0 || (flight.clearance == 0.0 && start.slope > 0.0);
        if flight.bulge() <= flight.gravity {
            return Ok(());
        }
        let mut budget = MAX_PIECES;
        let found = first_descent_spinning(&flight, || (), above, f64::INFINITY, &mut budget);
        prop_assert!(MAX_PIECES - budget <= 10 && found.is_ok(), "{} pieces of {flight:?}", MAX_PIECES - budget);
    }
}
