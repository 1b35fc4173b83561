//! The time of the next contact in any kind of number: the root that doubles certify as the first, lifted by Newton's iteration.

use crate::bounce::contact_time;
use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::drag;
use crate::bounce::drag::AirDrag;
use crate::bounce::drag::flight::DragFlight;
use crate::bounce::flight::{Flight, Gap};
use crate::bounce::map_number::MapNumber;
use crate::bounce::state::State;

/// Most Newton steps of a lift: one does, except where the rod grazes the table.
const MAX_STEPS: u32 = 64;

/// Share of a root below which what a Newton step leaves out no longer counts.
const NEGLIGIBLE: f64 = 1e-33;

/// Time from the start of a flight to its end, s: same as [`contact_time::first_contact`].
#[inline(always)]
pub(crate) fn first_contact<N: MapNumber>(flight: &Flight<N>) -> Result<N, TooManyPieces> {
    let mut rounded = flight.map(N::to_f64);
    let root = match short_flight(flight, &mut rounded) {
        Some(root) => root,
        None => contact_time::first_contact(&rounded)?,
    };
    Ok(lifted(flight, &rounded, root))
}

/// Same as [`contact_time::first_descent`].
#[inline(always)]
pub(crate) fn first_descent<N: MapNumber>(flight: &Flight<N>) -> Result<Option<N>, TooManyPieces> {
    let rounded = flight.map(N::to_f64);
    Ok(contact_time::first_descent(&rounded)?.map(|root| lifted(flight, &rounded, root)))
}

/// Same as [`first_contact`], through air.
pub(crate) fn first_contact_in_air<N: MapNumber>(flight: &DragFlight<N>) -> Result<N, TooManyPieces> {
    let mut rounded = DragFlight { free: flight.free.map(N::to_f64), drag: flight.drag };
    let root = match short_flight_in_air(flight, &mut rounded) {
        Some(root) => root,
        None => drag::contact_time::first_contact(&rounded)?,
    };
    Ok(lifted_in_air(flight, root))
}

/// Same as [`first_descent`], through air.
pub(crate) fn first_descent_in_air<N: MapNumber>(flight: &DragFlight<N>) -> Result<Option<N>, TooManyPieces> {
    let rounded = DragFlight { free: flight.free.map(N::to_f64), drag: flight.drag };
    Ok(drag::contact_time::first_descent(&rounded)?.map(|root| lifted_in_air(flight, root)))
}

fn lifted_in_air<N: MapNumber>(flight: &DragFlight<N>, root: f64) -> N {
    if !has_more_digits::<N>() {
        return flight.lift_root(root);
    }
    let AirDrag { linear, rotational } = flight.drag;
    let State { y_dot, theta_dot, .. } = flight.free.start.map(N::to_f64);
    let spin = theta_dot.abs();
    let pull = flight.free.gravity.to_f64() + linear * y_dot.abs();
    let bulge = flight.free.contact_distance.to_f64() * spin * (spin + rotational);
    lifted_by(|t| flight.gap(t), pull + bulge, spin + linear.max(4.0 * rotational), root)
}

/// Tells whether a root in doubles lacks digits.
const fn has_more_digits<N: MapNumber>() -> bool {
    N::UNIT < f64::EPSILON
}

/// A root of a flight in doubles, by Newton's iteration on the flight itself.
#[inline(always)]
fn lifted<N: MapNumber>(flight: &Flight<N>, rounded: &Flight, root: f64) -> N {
    if !has_more_digits::<N>() {
        return flight.lift_root(root);
    }
    let spin = flight.start.theta_dot.to_f64().abs();
    lifted_by(|t| flight.gap(t), rounded.gravity + rounded.bulge(), spin, root)
}

/// A root of a gap in doubles, by Newton's iteration on the gap itself, whose second derivative is at most `bend` (m/s²) and whose third is
/// at most `quickness` (1/s) times that.
fn lifted_by<N: MapNumber>(gap_at: impl Fn(N) -> Gap<N>, bend: f64, quickness: f64, root: f64) -> N {
    let mut t = N::from_f64(root);
    let mut last = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        let gap = gap_at(t);
        let step = gap.value / gap.slope;
        let size = step.to_f64().abs();
        // Steps that shrink no more have met rounding, or a graze that doubles see and these digits do not.
        if size.is_nan() || size >= last {
            break;
        }
        // The second derivative too (Chebyshev): its term is so small that doubles hold it. What that leaves out is of third
        // order in the step.
        let bent = 0.5 * step.to_f64() * gap.bend.to_f64() / gap.slope.to_f64();
        let next = t - (step + N::from_f64(step.to_f64() * bent));
        // The trivial root at the start is no contact.
        if next.to_f64() <= 0.0 {
            break;
        }
        t = next;
        let stiffness = bend / gap.slope.to_f64().abs() + quickness;
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
#[inline(always)]
fn short_flight<N: MapNumber>(flight: &Flight<N>, rounded: &mut Flight) -> Option<f64> {
    if !has_more_digits::<N>() || rounded.clearance != 0.0 {
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

/// Same as [`short_flight`], through air.
fn short_flight_in_air<N: MapNumber>(flight: &DragFlight<N>, rounded: &mut DragFlight) -> Option<f64> {
    if !has_more_digits::<N>() || rounded.free.clearance != 0.0 {
        return None;
    }
    let zero = N::from_f64(0.0);
    let (rise, own) = (flight.gap(zero).slope.to_f64(), rounded.gap(0.0));
    if rise <= 0.0 || (own.slope - rise).abs() <= RESOLVED * rise {
        return None;
    }
    let AirDrag { linear, rotational } = rounded.drag;
    let State { y_dot, theta_dot, .. } = rounded.free.start;
    let (spin, bend) = (theta_dot.abs(), -own.bend);
    let root = 2.0 * rise / bend;
    let pull = rounded.free.gravity + linear * y_dot.abs();
    let change =
        linear * pull + rounded.free.contact_distance * spin * (spin + 2.0 * rotational) * (spin + 2.0 * rotational);
    if bend > 0.0 && 10.0 * change * root <= bend {
        return Some(root);
    }
    let turned = rounded.free.contact_distance * theta_dot * rounded.free.sin_cos_theta.0;
    rounded.free.start.y_dot += 4.0 * f64::EPSILON * (y_dot.abs() + turned.abs());
    None
}
