//! Number of pieces that a flight is cut into, and contact times with derivatives.

use super::*;
use crate::map::flight::AirDrag;
use crate::numbers::dual::Dual;
use crate::numbers::taylor::Taylor;
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

/// A flight with one variable in its start and one in the drag of its air.
fn varied(linear: f64) -> Flight<Taylor> {
    let number = Taylor::from_f64;
    let theta = Taylor::linear(0.3, 1.0, 0.0);
    Flight {
        start: State { theta, x_dot: number(0.1), y_dot: number(1.2), theta_dot: number(2.0) },
        sin_cos_theta: theta.sincos(),
        clearance: number(0.0),
        contact_distance: number(0.13),
        gravity: number(9.81),
        drag: AirDrag::new(Taylor::linear(linear, 0.0, 1.0), number(0.05)),
    }
}

#[test]
fn a_contact_time_has_all_derivatives_that_its_numbers_carry() {
    for linear in [0.0, 0.2] {
        let flight = varied(linear);
        let left = flight.gap(first_contact(&flight).unwrap()).value;
        let terms = [left.to_f64()].into_iter().chain(left.first()).chain(left.second()).chain(left.third());
        assert!(terms.into_iter().all(|term| term.abs() < 1e-14), "{left:?}");
    }
}

#[test]
fn a_drag_of_zero_has_a_derivative() {
    let time = |linear: f64, rate: f64| {
        let drag = AirDrag::new(Dual::along(linear, 0, rate), Dual::<1>::from_f64(0.0));
        let rounded = varied(0.0).map(Number::to_f64).map(Dual::from_f64);
        first_contact(&Flight { drag, ..rounded }).unwrap()
    };
    let (still, air) = (time(0.0, 1.0), time(1e-6, 0.0));
    assert!((air.value - still.value - 1e-6 * still.partials[0]).abs() < 1e-13, "{still:?} {air:?}");
    assert!(still.partials[0] < -1e-3);
}
