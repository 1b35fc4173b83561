//! The time of the next contact with 31 digits: the root that doubles certify as the first, lifted by Newton's iteration.

use crate::bounce::contact_time;
use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::flight::Flight;
use crate::bounce::state::State;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::number::Number;

/// Most Newton steps of a lift: one does, except where the rod grazes the table.
const MAX_STEPS: u32 = 64;

/// Share of a root below which what a Newton step leaves out no longer counts.
const NEGLIGIBLE: f64 = 1e-33;

/// The length of a flight: the root certified in doubles, lifted.
pub(super) fn first_contact(flight: &Flight<DoubleDouble>) -> Result<DoubleDouble, TooManyPieces> {
    let mut rounded = in_doubles(flight);
    let root = match short_flight(flight, &mut rounded) {
        Some(root) => root,
        None => contact_time::first_contact(&rounded)?,
    };
    Ok(lifted(flight, &rounded, root))
}

/// Same as [`contact_time::first_descent`].
pub(super) fn first_descent(flight: &Flight<DoubleDouble>) -> Result<Option<DoubleDouble>, TooManyPieces> {
    let rounded = in_doubles(flight);
    Ok(contact_time::first_descent(&rounded)?.map(|root| lifted(flight, &rounded, root)))
}

/// A flight in doubles.
pub(super) fn in_doubles(flight: &Flight<DoubleDouble>) -> Flight {
    Flight {
        start: flight.start.map(DoubleDouble::to_f64),
        sin_cos_theta: (flight.sin_cos_theta.0.to_f64(), flight.sin_cos_theta.1.to_f64()),
        clearance: flight.clearance.to_f64(),
        contact_distance: flight.contact_distance.to_f64(),
        gravity: flight.gravity.to_f64(),
    }
}

/// A root of a flight in doubles, by Newton's iteration on the flight itself.
fn lifted(flight: &Flight<DoubleDouble>, rounded: &Flight, root: f64) -> DoubleDouble {
    let mut t = DoubleDouble::from_f64(root);
    let mut last = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let gap = flight.gap(t);
        let step = gap.value / gap.slope;
        let size = step.to_f64().abs();
        // Steps that shrink no more have met rounding, or a graze that doubles see and these digits do not.
        if size.is_nan() || size >= last {
            break;
        }
        // The second derivative too (Chebyshev): its term is so small that doubles hold it. What that leaves out is of third
        // order in the step.
        let bent = 0.5 * step.to_f64() * gap.bend.to_f64() / gap.slope.to_f64();
        let next = t - (step + DoubleDouble::from(step.to_f64() * bent));
        // The trivial root at the start is no contact.
        if next.to_f64() <= 0.0 {
            break;
        }
        t = next;
        let stiffness =
            (rounded.gravity + rounded.bulge()) / gap.slope.to_f64().abs() + flight.start.theta_dot.to_f64().abs();
        if size * (size * stiffness) * (size * stiffness) <= NEGLIGIBLE * root {
            break;
        }
        last = size;
    }
    t
}

/// Largest share of the rise that doubles may miss where the root is looked for in them.
const RESOLVED: f64 = 0.01;

/// The length of a flight that rises too slowly for doubles, whose sum ẏ + lθ̇ sin θ is rounding: 2ẏ_c/(G − lθ̇² cos θ), where that is
/// so short that the gap is concave all the way, so that it has no other root. Where it is not, the contact point goes on rising, and
/// `rounded` is made to rise.
fn short_flight(flight: &Flight<DoubleDouble>, rounded: &mut Flight) -> Option<f64> {
    if rounded.clearance != 0.0 {
        return None;
    }
    let State { y_dot, theta_dot, .. } = flight.start;
    let rise = (y_dot + flight.contact_distance * theta_dot * flight.sin_cos_theta.0).to_f64();
    let State { y_dot, theta_dot, .. } = rounded.start;
    let turned = rounded.contact_distance * theta_dot * rounded.sin_cos_theta.0;
    let missed = (y_dot + turned - rise).abs();
    if rise <= 0.0 || missed <= RESOLVED * rise {
        return None;
    }
    let bend = rounded.gravity - rounded.bulge() * rounded.sin_cos_theta.1;
    let root = 2.0 * rise / bend;
    if bend > 0.0 && 10.0 * rounded.bulge() * theta_dot.abs() * root <= bend {
        return Some(root);
    }
    rounded.start.y_dot += 4.0 * f64::EPSILON * (y_dot.abs() + turned.abs());
    None
}
