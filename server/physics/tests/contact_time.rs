//! The first contact of random flights through air, against dense samples of the gap, and its derivatives.

use equipoise_physics::map::contact_time::{first_contact, first_descent, first_descent_before};
use equipoise_physics::map::flight::{AirDrag, Flight};
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::dual::{Dual, ThirdOrder};
use equipoise_physics::numbers::number::{Arithmetic, Number};
use equipoise_physics::numbers::trig;
use proptest::prelude::*;

/// Every power of ten as likely.
fn power(from: f64, to: f64) -> BoxedStrategy<f64> {
    (from..to).prop_map(libm::exp10).boxed()
}

/// A size with either sign.
fn either(size: BoxedStrategy<f64>) -> impl Strategy<Value = f64> {
    (size, any::<bool>()).prop_map(|(size, minus)| if minus { -size } else { size })
}

/// Flights and air beyond what scenes may ask for.
fn flights() -> impl Strategy<Value = Flight> {
    let rate = move || prop_oneof![Just(0.0), power(-6.0, 1.5)];
    let clearance = prop_oneof![Just(0.0), either(power(-4.0, 2.0))];
    let speeds = (either(power(-4.0, 2.0)), either(power(-1.0, 3.0)));
    (-3.2..3.2, speeds, clearance, (power(-3.0, 1.0), power(-2.0, 2.0)), (rate(), rate())).prop_map(
        |(theta, (y_dot, theta_dot), clearance, (contact_distance, gravity), (linear, rotational))| Flight {
            start: State { theta, x_dot: 0.3, y_dot, theta_dot },
            sin_cos_theta: trig::sin_cos(theta),
            clearance,
            contact_distance,
            gravity,
            drag: Some(AirDrag { linear, rotational, wind: 0.0 }),
        },
    )
}

/// Size of the terms of a gap, m.
fn size(flight: &Flight, t: f64) -> f64 {
    let Flight { start, clearance, contact_distance, gravity, .. } = *flight;
    let turned = (start.theta_dot * t).abs();
    clearance.abs() + t * (start.y_dot.abs() + gravity * t) + contact_distance * (2.0 + turned)
}

/// Samples of a flight up to its end.
const SAMPLES: u32 = 2000;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    #[test]
    fn nothing_comes_down_before_the_first_descent(flight in flights()) {
        let found = first_descent(&flight);
        prop_assert!(found.is_ok(), "{flight:?}");
        let start = flight.gap(0.0);
        let rises = start.slope > 0.0 || (start.slope == 0.0 && start.bend > 0.0);
        let mut above = start.value > 0.0 || (start.value == 0.0 && rises);
        let end = match found.unwrap() {
            Some(t) => {
                let gap = flight.gap(t);
                // At the zero to the rounding of the time and of the terms.
                let off = 8.0 * f64::EPSILON * (size(&flight, t) + t * gap.slope.abs());
                prop_assert!(gap.value.abs() <= off, "{} of {off} at {t}: {flight:?}", gap.value);
                // It falls there, or grazes.
                let steep = (2.0 * off * (gap.bend.abs() + flight.gravity)).sqrt();
                prop_assert!(gap.slope <= steep, "{} {steep} at {t}: {flight:?}", gap.slope);
                t
            }
            None => {
                let reach = 2.0 * flight.contact_distance + flight.clearance.abs();
                3.0 * (flight.start.y_dot.abs() + (flight.gravity * reach).sqrt()) / flight.gravity
            }
        };
        for sample in 1..SAMPLES {
            let t = end * f64::from(sample) / f64::from(SAMPLES);
            let value = flight.gap(t).value;
            let rounding = 8.0 * f64::EPSILON * size(&flight, t);
            prop_assert!(!(above && value < -rounding), "{value} at {t} of {found:?}: {flight:?}");
            above |= value > rounding;
        }
        // A point that has been above comes down in the end.
        prop_assert!(!above || found.unwrap().is_some(), "{flight:?}");
    }

    #[test]
    fn without_air_it_is_the_contact_of_the_parabola(mut flight in flights()) {
        flight.drag = Some(AirDrag { linear: 0.0, rotational: 0.0, wind: 0.0 });
        let ours = first_descent_before(&flight, f64::INFINITY).unwrap();
        let theirs = first_descent(&Flight { drag: None, ..flight }).unwrap();
        prop_assert_eq!(ours.is_some(), theirs.is_some(), "{:?}", flight);
        if let (Some(ours), Some(theirs)) = (ours, theirs) {
            let gap = flight.gap(theirs);
            let off = 32.0 * f64::EPSILON * (size(&flight, theirs) / gap.slope.abs() + theirs);
            // Grazes are known to the square root of rounding.
            let graze = (64.0 * f64::EPSILON * size(&flight, theirs) / flight.gravity).sqrt();
            let far = (ours - theirs).abs();
            prop_assert!(far <= off || (far <= graze && gap.slope.abs() <= 64.0 * flight.gravity * graze),
                "{ours} {theirs} {off:e} {flight:?}");
        }
    }
}

/// A flight with one variable in its start and one in the drag of its air.
fn varied(linear: f64) -> Flight<ThirdOrder<2>> {
    let number = ThirdOrder::from_f64;
    let theta = ThirdOrder::linear(0.3, [1.0, 0.0]);
    Flight {
        start: State { theta, x_dot: number(0.1), y_dot: number(1.2), theta_dot: number(2.0) },
        sin_cos_theta: theta.sincos(),
        clearance: number(0.0),
        contact_distance: number(0.13),
        gravity: number(9.81),
        drag: AirDrag::new(ThirdOrder::linear(linear, [0.0, 1.0]), number(0.05)),
    }
}

#[test]
fn a_contact_time_has_all_derivatives_that_its_numbers_carry() {
    for linear in [0.0, 0.2] {
        let flight = varied(linear);
        let left = flight.gap(first_contact(&flight).unwrap()).value;
        let terms = [left.to_f64()].into_iter().chain(left.first()).chain(left.value.second()).chain(left.third());
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
