//! End of a flight through air: the first time at which the contact point comes down to y = 0, found with a certificate and without
//! sampling.
//!
//! All velocities decay, so a bound on the second derivative of the gap from now on is known in closed form: g″ ≥ −M. The parabola with the
//! gap's value and slope and with −M for its second derivative lies below the gap, so the gap has no zero before that of the parabola.
//! From there the next parabola starts. The steps never pass a zero, and near a simple one they square the error. They end where Newton's
//! iteration provably converges to the zero ahead, and that is the only one (Kantorovich's condition).

use crate::bounce::contact_time::TooManyPieces;
use crate::bounce::drag::AirDrag;
use crate::bounce::drag::decay::Decay;
use crate::bounce::drag::flight::DragFlight;
use crate::bounce::flight::{Flight, Gap};

/// Most steps of one flight. A fast spin needs some tens for each half turn near the table, and the contact point comes down within three half
/// turns there, as on flights without air ([`crate::bounce::contact_time::MAX_PIECES`]).
pub const MAX_STEPS: u32 = 2048;

/// Time from the start of a flight to its end, s.
///
/// The flight must start at or above y = 0; where it starts on it (h₀ = 0) it must leave upwards: t = 0 is not a contact.
///
/// # Errors
/// [`TooManyPieces`] where the work limit is passed.
pub fn first_contact(flight: &DragFlight) -> Result<f64, TooManyPieces> {
    search(flight, true)?.ok_or(TooManyPieces)
}

/// Time at which a point first comes *down* through y = 0, s from the start of its flight; `None` if it never does: same as
/// [`crate::bounce::contact_time::first_descent`].
///
/// # Errors
/// [`TooManyPieces`] where the work limit is passed.
pub fn first_descent(flight: &DragFlight) -> Result<Option<f64>, TooManyPieces> {
    let start = flight.gap(0.0);
    let rises = start.slope > 0.0 || (start.slope == 0.0 && start.bend > 0.0);
    search(flight, start.value > 0.0 || (start.value == 0.0 && rises))
}

/// Bounds that hold from a time on.
struct Bounds {
    /// Most by which the centre of gravity is accelerated downwards, m/s², and upwards.
    falling: f64,
    rising: f64,
    /// Most by which the turning accelerates the contact point, m/s².
    spinning: f64,
    /// Most by which the third derivative of the gap exceeds the second, 1/s.
    quickness: f64,
    /// Height of the centre of gravity above y = 0, m, and its velocity, m/s.
    height: f64,
    y_dot: f64,
}

impl Bounds {
    fn from(flight: &DragFlight, t: f64) -> Self {
        let Flight { start, sin_cos_theta, clearance, contact_distance, gravity } = flight.free;
        let AirDrag { linear, rotational } = flight.drag;
        let place = Decay::new(linear, t);
        let omega = (start.theta_dot * Decay::new(rotational, t).left).abs();
        // ÿ = −(G + cẏ₀)e^(−ct) keeps its sign.
        let pull = (gravity + linear * start.y_dot) * place.left;
        Self {
            falling: pull.max(0.0),
            rising: (-pull).max(0.0),
            // l|ω² cos θ − c_θω sin θ|, and |ω| only decays.
            spinning: contact_distance * omega * (omega * omega + rotational * rotational).sqrt(),
            quickness: omega + linear.max(4.0 * rotational),
            height: (clearance + contact_distance * sin_cos_theta.1) + (start.y_dot * place.way - gravity * place.fall),
            y_dot: start.y_dot * place.left - gravity * place.way,
        }
    }
}

/// Least time after which a height that is not negative and changes at the rate `slope` may be 0, if it is accelerated downwards by `most` at
/// most; infinite if never.
fn time_to_fall(height: f64, slope: f64, most: f64) -> f64 {
    let root = (slope * slope + 2.0 * most * height).sqrt();
    // Neither is a difference.
    if slope > 0.0 {
        (slope + root) / most
    } else if height == 0.0 {
        0.0
    } else {
        2.0 * height / (root - slope)
    }
}

/// [`time_to_fall`] of a height that is not positive, upwards.
fn time_to_rise(height: f64, slope: f64, most: f64) -> f64 {
    time_to_fall(-height, -slope, most)
}

/// The first time at which a point comes down through y = 0 that starts `above` it or below.
fn search(flight: &DragFlight, mut above: bool) -> Result<Option<f64>, TooManyPieces> {
    let length = flight.free.contact_distance;
    let mut t = 0.0;
    for _ in 0..MAX_STEPS {
        let gap = flight.gap(t);
        let bounds = Bounds::from(flight, t);
        let step = if above {
            let most = bounds.falling + bounds.spinning;
            if gap.slope < 0.0 && is_certain(&gap, most + bounds.rising) {
                return Ok(Some(converged(flight, t, gap)));
            }
            // Only rounding brings it to 0 or below.
            if t > 0.0 && gap.value <= 0.0 && gap.slope <= 0.0 {
                return Ok(Some(t));
            }
            let own = time_to_fall(gap.value.max(0.0), gap.slope, most);
            // While the centre of gravity is higher than l, the point cannot reach the table.
            let spare = bounds.height - length;
            let clear = if spare > 0.0 { time_to_fall(spare, bounds.y_dot, bounds.falling) } else { 0.0 };
            own.max(clear)
        } else {
            if gap.slope > 0.0 && gap.value >= 0.0 {
                above = true;
                continue;
            }
            let own = time_to_rise(gap.value.min(0.0), gap.slope, bounds.rising + bounds.spinning);
            // While the centre of gravity is lower than −l, the point is below the table; one that falls there never rises again.
            let lack = bounds.height + length;
            let buried = if lack >= 0.0 {
                0.0
            } else if bounds.y_dot <= 0.0 {
                return Ok(None);
            } else {
                time_to_rise(lack, bounds.y_dot, bounds.rising)
            };
            let step = own.max(buried);
            if gap.slope > 0.0 && step <= 2.0 * f64::EPSILON * t {
                above = true;
                continue;
            }
            step
        };
        if !step.is_finite() {
            return if above { Err(TooManyPieces) } else { Ok(None) };
        }
        let stands = step <= 2.0 * f64::EPSILON * t;
        if stands && above && t > 0.0 {
            return Ok(Some(t));
        }
        // A step in which the point moves by less than rounding.
        let rounding = (2.0 * f64::EPSILON * length / (bounds.falling + bounds.rising + bounds.spinning)).sqrt();
        t += if stands { rounding } else { step };
    }
    Err(TooManyPieces)
}

/// Kantorovich's condition: a gap that falls has a zero within twice a Newton step, and no other up to there, if its second derivative is at
/// most `most` in size.
fn is_certain(gap: &Gap, most: f64) -> bool {
    2.0 * most * gap.value.abs() <= gap.slope * gap.slope
}

/// Most Newton steps: from where it is certain that there is one zero each squares the error; at a double zero each halves it.
const MAX_NEWTON_STEPS: u32 = 64;

/// The zero near `t`, where the gap is `gap` and does not rise, by Newton's iteration.
fn converged(flight: &DragFlight, mut t: f64, mut gap: Gap) -> f64 {
    let mut last = f64::INFINITY;
    for _ in 0..MAX_NEWTON_STEPS {
        if gap.slope >= 0.0 {
            return t;
        }
        let newton = -gap.value / gap.slope;
        let size = newton.abs();
        if size >= last || newton <= -t {
            return t;
        }
        let bounds = Bounds::from(flight, t);
        let bent = size * (bounds.falling + bounds.rising + bounds.spinning) / gap.slope.abs();
        // The second derivative too; that leaves out terms of third order.
        let left_out = size * bent * (bent + size * bounds.quickness);
        if left_out <= 0.25 * f64::EPSILON * t {
            return t + newton * (1.0 - 0.5 * (gap.bend / gap.slope) * newton);
        }
        t += newton;
        last = size;
        gap = flight.gap(t);
    }
    t
}

#[cfg(test)]
#[path = "contact_time_tests.rs"]
mod tests;
