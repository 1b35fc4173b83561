//! The contact time is a root, no root comes before it, and finding it is bounded work. The checks use 31 digits, a march that
//! cannot step over a root, and symmetries that hold to the last bit.

use equipoise_physics::map::contact_time::{
    MAX_PIECES, TooManyPieces, evaluations, first_contact, first_descent, first_descent_before,
};
use equipoise_physics::map::flight::Flight;
use equipoise_physics::map::strike::State;
use equipoise_physics::numbers::double_double::DoubleDouble;
use equipoise_physics::numbers::trig;
use std::f64::consts::TAU;

use super::numbers::Numbers;

/// Steps of the march, and of the plain scan beside it.
const MARCH: usize = 4000;
const SCAN: usize = 400;

/// Most evaluations of the gap on one piece of a flight: those for a double root, whose error halves at each step, and the ends.
const LOOKS_A_PIECE: f64 = 130.0;

/// Allowed error of a gap, in roundings.
const ROUNDINGS: f64 = 16.0;

/// A flight whose contact point starts above, at or below y = 0.
pub(crate) fn check(data: &[u8]) {
    let numbers = Numbers::read(data);
    let theta = numbers.within("theta", -100.0..=100.0, 0.3);
    let flight = Flight {
        start: State {
            theta,
            x_dot: 0.0,
            y_dot: numbers.within("y_dot", -1e3..=1e3, 1.0),
            theta_dot: numbers.within("theta_dot", -1e4..=1e4, 0.0),
        },
        sin_cos_theta: trig::sin_cos(theta),
        clearance: numbers.within("clearance", -20.0..=100.0, 0.0),
        contact_distance: numbers.within("contact_distance", 1e-3..=10.0, 0.2),
        gravity: numbers.within("gravity", 1e-3..=100.0, 9.81),
        drag: None,
    };
    let start = flight.gap(0.0);
    let rises = start.slope > 0.0 || (start.slope == 0.0 && start.bend > 0.0);
    let above = flight.clearance > 0.0 || (flight.clearance == 0.0 && rises);
    if above {
        let found = first_contact(&flight);
        let looks = evaluations(&flight) as f64;
        let most = (pieces(&flight) + 3.0).min(f64::from(MAX_PIECES)) * LOOKS_A_PIECE;
        assert!(looks <= most, "{looks} looks at the gap of {flight:?}");
        let t = bounded(&flight, found);
        hold(&flight, t, true);
        for (name, other, of_time) in images(&flight) {
            assert_eq!(first_contact(&other).map(|t| t * of_time), Ok(t), "{name} of {flight:?}");
        }
    }
    let descent = bounded(&flight, first_descent(&flight));
    match descent {
        Some(t) => hold(&flight, t, above),
        None => {
            assert!(!above, "{flight:?} never comes down");
            let end = latest(&flight);
            let up = times(end).find(|&t| flight.gap(t).value > rounding(&flight, t));
            assert_eq!(up, None, "{flight:?} is above then, and never comes down");
        }
    }
    for share in [0.3, 0.999_999, 1.000_001, 2.0] {
        let limit = share * descent.unwrap_or(latest(&flight)).max(0.0);
        match bounded(&flight, first_descent_before(&flight, limit)) {
            Some(t) => {
                assert!(descent.is_some() && t <= limit, "{t} is beyond {limit} in {flight:?}");
                hold(&flight, t, above);
            }
            None => {
                // Near a graze, one evaluation may see the contact point below y = 0 and the other not.
                let is_down = limit > 0.0 && flight.gap(limit).value < -rounding(&flight, limit);
                assert!(descent.is_none() || share < 1.0 || !is_down, "{limit} is after {descent:?} in {flight:?}")
            }
        }
    }
}

/// The contact time. These flights turn so little that their angles have digits, so none may pass the work limit.
fn bounded<T>(flight: &Flight, found: Result<T, TooManyPieces>) -> T {
    found.unwrap_or_else(|error| panic!("{error:?} for {flight:?}"))
}

/// Largest number of convex and concave pieces before the contact point must be down.
fn pieces(flight: &Flight) -> f64 {
    2.0 * (flight.start.theta_dot.abs() * latest(flight) / TAU + 2.0)
}

/// Time at which the centre of gravity is so low that the contact point must be down, s.
fn latest(flight: &Flight) -> f64 {
    let Flight { clearance, contact_distance, gravity, sin_cos_theta: (sin, cos), .. } = *flight;
    let rise = if cos < 0.0 { sin * sin / (1.0 - cos) } else { 1.0 + cos };
    let room = (clearance + contact_distance * rise).max(0.0);
    let y_dot = flight.start.y_dot;
    let root = (y_dot * y_dot + 2.0 * gravity * room).sqrt();
    if y_dot < 0.0 { 2.0 * room / (root - y_dot) } else { (y_dot + root) / gravity }
}

/// Bound of the rounding error of a gap, m: that of its terms and of the angle.
fn rounding(flight: &Flight, t: f64) -> f64 {
    let State { y_dot, theta_dot, .. } = flight.start;
    let fall = y_dot.abs() * t + 0.5 * flight.gravity * t * t;
    let turn = flight.contact_distance * (theta_dot * t).abs();
    ROUNDINGS * f64::EPSILON * (flight.clearance.abs() + fall + turn.min(2.0 * flight.contact_distance) + turn)
}

/// The gap with 31 digits.
fn exact_gap(flight: &Flight, t: f64) -> f64 {
    let number = DoubleDouble::from;
    let State { theta, x_dot, y_dot, theta_dot } = flight.start;
    let exact = Flight {
        start: State { theta: number(theta), x_dot: number(x_dot), y_dot: number(y_dot), theta_dot: number(theta_dot) },
        sin_cos_theta: (number(flight.sin_cos_theta.0), number(flight.sin_cos_theta.1)),
        clearance: number(flight.clearance),
        contact_distance: number(flight.contact_distance),
        gravity: number(flight.gravity),
        drag: None,
    };
    exact.gap(number(t)).value.to_f64()
}

/// Times over a flight: evenly spaced, and at random between.
fn times(end: f64) -> impl Iterator<Item = f64> {
    (1..SCAN).map(move |index| end * (index as f64 / SCAN as f64))
}

/// Panics unless `t` is the first time at which a flight comes down that starts `above` y = 0, or below it.
fn hold(flight: &Flight, t: f64, above: bool) {
    assert!(t.is_finite() && t >= 0.0, "{t} of {flight:?}");
    let end = latest(flight);
    assert!(t <= end * (1.0 + 1e-9) + 1e-150, "{t} is after {end}, when {flight:?} is down");
    let gap = exact_gap(flight, t);
    assert!(gap.abs() <= 2.0 * rounding(flight, t), "the gap of {flight:?} is {gap} m at {t} s");
    // The contact point comes down, except at a double root, which is undecided.
    let curvature = flight.gravity + flight.contact_distance * flight.start.theta_dot.powi(2);
    let slope = flight.gap(t).slope;
    let open = 4.0 * (curvature * rounding(flight, t)).sqrt();
    assert!(slope <= open, "{flight:?} rises by {slope} m/s at {t} s");
    let mut been_above = above;
    for time in times(t) {
        let (gap, rounding) = (flight.gap(time).value, rounding(flight, time));
        assert!(!been_above || gap >= -rounding, "{flight:?} is at {gap} m at {time} s already, before {t}");
        been_above |= gap > rounding;
    }
    if above {
        march(flight, t, curvature);
    }
}

/// Marches from zero in steps that contain no root, as |g''| ≤ `curvature`.
fn march(flight: &Flight, t: f64, curvature: f64) {
    let mut time = 0.0_f64;
    for _ in 0..MARCH {
        let gap = flight.gap(time);
        let (value, rounding) = (gap.value, rounding(flight, time));
        assert!(value >= -rounding, "{flight:?} is at {value} m at {time} s already, before {t}");
        let step: f64 = (gap.slope + (gap.slope * gap.slope + 2.0 * curvature * value.max(0.0)).sqrt()) / curvature;
        // Half of the safe step, so that near roots are inspected too.
        time += (0.5 * step).max(t / MARCH as f64);
        if time >= t {
            return;
        }
    }
}

/// Flights that are equal to the last bit, with the factor of their times: mirrored, in other units of length, in other units of
/// time.
fn images(flight: &Flight) -> [(&'static str, Flight, f64); 3] {
    let State { theta, y_dot, theta_dot, .. } = flight.start;
    let (sin, cos) = flight.sin_cos_theta;
    let start = flight.start;
    [
        (
            "the mirror image",
            Flight {
                start: State { theta: -theta, theta_dot: -theta_dot, ..start },
                sin_cos_theta: (-sin, cos),
                ..*flight
            },
            1.0,
        ),
        (
            "four times the size",
            Flight {
                start: State { y_dot: 4.0 * y_dot, ..start },
                clearance: 4.0 * flight.clearance,
                contact_distance: 4.0 * flight.contact_distance,
                gravity: 4.0 * flight.gravity,
                ..*flight
            },
            1.0,
        ),
        (
            "twice the pace",
            Flight {
                start: State { y_dot: 2.0 * y_dot, theta_dot: 2.0 * theta_dot, ..start },
                gravity: 4.0 * flight.gravity,
                ..*flight
            },
            2.0,
        ),
    ]
}
