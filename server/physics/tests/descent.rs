//! Times at which a point comes down through y = 0: against dense sampling with bisection, and where the answer is known.

use equipoise_physics::map::contact_time::{first_contact, first_descent, first_descent_before};
use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::trig;
use proptest::prelude::*;

fn flight(theta: f64, theta_dot: f64, y_dot: f64, clearance: f64, contact_distance: f64) -> Flight {
    Flight {
        start: State { theta, x_dot: 0.3, y_dot, theta_dot },
        sin_cos_theta: trig::sin_cos(theta),
        clearance,
        contact_distance,
        gravity: 9.81,
        drag: None,
    }
}

fn found(flight: &Flight) -> Option<f64> {
    first_descent(flight).unwrap()
}

/// The first change from above to not above among many samples, refined by bisection.
fn sampled(flight: &Flight, samples: u32) -> Option<f64> {
    let State { y_dot, .. } = flight.start;
    let room = flight.clearance.abs() + 2.0 * flight.contact_distance;
    let end = (y_dot + (y_dot * y_dot + 2.0 * flight.gravity * room).sqrt()) / flight.gravity * 1.01;
    let above = |t| flight.gap(t).value > 0.0;
    let times = (1..=samples).map(|sample| end * f64::from(sample) / f64::from(samples));
    let start = flight.gap(0.0);
    let mut before = (start.value > 0.0 || (start.value == 0.0 && start.slope > 0.0)).then_some(0.0);
    for t in times {
        match (before, above(t)) {
            (_, true) => before = Some(t),
            (Some(mut low), false) => {
                let mut high = t;
                for _ in 0..200 {
                    let middle = 0.5 * (low + high);
                    *(if above(middle) { &mut low } else { &mut high }) = middle;
                }
                return Some(high);
            }
            (None, false) => {}
        }
    }
    None
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(3000))]

    #[test]
    fn it_is_the_first_that_sampling_finds(
        theta in -3.2..3.2, spin in prop_oneof![-8.0..8.0, -200.0..200.0], y_dot in -4.0..5.0,
        share in prop_oneof![Just(0.0), -1.0..1.0], contact_distance in 0.02..2.0
    ) {
        let flight = flight(theta, spin, y_dot, 0.5 * share * contact_distance, contact_distance);
        let start = flight.gap(0.0);
        if start.value == 0.0 && start.slope.abs() < 1e-3 {
            return Ok(());
        }
        let (found, sampled) = (found(&flight), sampled(&flight, 4000));
        if let Some(sampled) = sampled {
            let found = found.expect("sampling found one");
            prop_assert!(found <= sampled * (1.0 + 1e-9), "found {found}, sampled {sampled}");
        }
        if let Some(found) = found {
            // An earlier one than sampling saw is a root all the same, and comes down.
            let gap = flight.gap(found);
            let scale = flight.gravity + contact_distance * spin * spin;
            prop_assert!(found > 0.0 && gap.value.abs() <= 1e-13 * (1.0 + scale), "{gap:?}");
            prop_assert!(gap.slope <= 1e-6 * scale, "{gap:?}");
            let grazes = gap.slope.abs() < 1e-3 * scale;
            prop_assert!(grazes || sampled.is_some_and(|it| it - found <= 1e-9), "found {found}, sampled {sampled:?}");
        }
    }

    #[test]
    fn from_above_it_is_the_first_contact(
        theta in -1.5..1.5, spin in prop_oneof![-8.0..8.0, -200.0..200.0], y_dot in -4.0..5.0,
        clearance in prop_oneof![Just(0.0), 0.0..0.5]
    ) {
        let flight = flight(theta, spin, y_dot, clearance, 0.13);
        if clearance == 0.0 && flight.gap(0.0).slope <= 0.0 {
            return Ok(());
        }
        prop_assert_eq!(found(&flight), first_contact(&flight).ok());
    }

    #[test]
    fn a_limit_changes_nothing_before_it(
        theta in -3.2..3.2, spin in prop_oneof![-8.0..8.0, -200.0..200.0], y_dot in -4.0..5.0, clearance in -0.2..0.2, limit in 0.0..2.0
    ) {
        let flight = flight(theta, spin, y_dot, clearance, 0.13);
        let (all, before) = (found(&flight), first_descent_before(&flight, limit).unwrap());
        let expected = all.filter(|t| *t <= limit);
        // Pieces cut at the limit converge from elsewhere.
        let same = match (before, expected) {
            (Some(a), Some(b)) => (a - b).abs() <= 1e-10,
            (a, b) => a == b || (all.unwrap_or(limit) - limit).abs() < 1e-10,
        };
        prop_assert!(same, "{before:?} {expected:?}");
    }

    /// Raised until it all but grazes: it comes down as soon as it is above, and not before.
    #[test]
    fn a_point_that_grazes_from_below(theta in -3.2..3.2, spin in -8.0..8.0, y_dot in 0.5..4.0) {
        let low = flight(theta, spin, y_dot, 0.0, 0.13);
        if low.gap(0.0).slope <= 0.1 {
            return Ok(());
        }
        // The top, by bisection of the slope of a concave gap.
        let (mut left, mut right) = (0.0, 2.0);
        for _ in 0..200 {
            let middle = 0.5 * (left + right);
            *(if low.gap(middle).slope > 0.0 { &mut left } else { &mut right }) = middle;
        }
        let top = low.gap(left).value;
        for share in [1e-2, 1e-6, 1e-10, 1e-13] {
            let raised = Flight { clearance: -top * (1.0 - share), ..low };
            let down = found(&raised).expect("it comes above");
            prop_assert!(down > left - 1e-7 && raised.gap(down).value.abs() < 1e-14 * (1.0 + top), "{down} {left}");
            prop_assert_eq!(found(&Flight { clearance: -top * (1.0 + share), ..low }), None);
        }
    }
}

#[test]
fn a_point_without_spin_falls_as_a_stone() {
    // −0.1 + 2t − 4.905 t² = 0.
    let stone = flight(0.4, 0.0, 2.0, -0.1, 0.13);
    let down = (2.0 + (4.0_f64 - 4.0 * 4.905 * 0.1).sqrt()) / 9.81;
    assert!((found(&stone).unwrap() - down).abs() < 1e-15);
    assert_eq!(found(&Flight { clearance: -0.3, ..stone }), None, "it rises 0.204 m");
    assert_eq!(found(&flight(0.4, 0.0, -2.0, -0.1, 0.13)), None, "it is below and falls");
    assert_eq!(found(&flight(0.4, 0.0, -2.0, 0.0, 0.13)), None, "it is on it and falls");
    assert_eq!(found(&flight(0.4, 0.0, 0.0, 0.0, 0.13)), None);
    assert!((found(&flight(0.4, 0.0, 2.0, 0.0, 0.13)).unwrap() - 4.0 / 9.81).abs() < 1e-15);
    assert!((found(&flight(0.4, 0.0, 0.0, 0.981, 0.13)).unwrap() - 0.2_f64.sqrt()).abs() < 1e-15);
    assert_eq!(found(&flight(0.4, 0.0, 3.0, -50.0, 0.13)), None, "far below");
}

#[test]
fn a_fast_one_from_below_comes_round_and_down_again() {
    // A point 5 mm below turns 20 times a second about a centre that floats up: it rises within its first half turn.
    let wheel = flight(0.0, 40.0 * std::f64::consts::PI, 0.0, -0.005, 0.1);
    let down = found(&wheel).unwrap();
    assert!((0.02..0.05).contains(&down), "{down}");
    assert!(wheel.gap(down).value.abs() < 1e-13 && wheel.gap(down).slope < -1.0);
    // So deep that it never comes up.
    assert_eq!(found(&Flight { clearance: -0.3, ..wheel }), None);
}

/// A nearly vertical table: gravity along its normal is small, so the body stays below it for hours.
#[test]
fn what_is_below_for_hours_is_not_looked_at_turn_by_turn() {
    // The centre rises from 1.52 m to 0.72 m below in eleven hours. Within 1 m the point comes up and down in one turn.
    let slow = Flight { gravity: 1e-9, ..flight(0.5, 200.0, 4e-5, -2.4, 1.0) };
    let enters = (4e-5 - (1.6e-9_f64 - 2e-9 * (1.4 - 0.5_f64.cos())).sqrt()) / 1e-9;
    let down = found(&slow).expect("it comes up");
    assert!((enters..enters + 3.0).contains(&down), "{down} s, and it is near from {enters} s on");
    assert!(slow.gap(down).value.abs() < 1e-9 && slow.gap(down).slope < 0.0, "{:?}", slow.gap(down));
    // One that rises to 1.02 m below and no further.
    assert_eq!(found(&Flight { clearance: -2.7, ..slow }), None);
}

#[test]
fn an_angle_without_digits_says_so() {
    // It is away for six centuries and turns 3e16 times, of which a double resolves every eighth.
    let endless = Flight { gravity: 1e-6, ..flight(0.5, 1e7, 1e4, 1.1, 1.0) };
    assert!(first_contact(&endless).is_err() && first_descent(&endless).is_err());
}
