//! One contact of all lanes and the flight after it.
//!
//! In several short loops: a bounce is one long chain of operations, each waiting for the last, and the CPU overlaps the
//! chains of neighbours only where they fit into its window together.

use super::contact::Surface;
use super::model::Bounced;
use super::number::{Lane, Near};
use super::outline::OutlineLanes;
use super::state::{Moving, Rods, Scratch, WIDTH, mask, unless};
use super::steering::{SteeringLanes, tilt_by_gain};
use crate::bounce::contact_time;
use crate::bounce::contact_time::NewtonStep;
use crate::bounce::flight::Flight;
use crate::bounce::strike::{State, Tilt};
use crate::numbers::number::Number;
use crate::run::rules::LaneContact;

/// Most Newton steps of a common bounce: nearly all take one, few two.
const STEPS: u32 = 3;

/// The bounce of all lanes from `moving` to `next`, but not of those that it sets apart: as [`super::model::LaneModel::bounce`].
#[inline(always)]
pub(super) fn bounce_rods<L: Lane, S: Surface>(
    surface: &S,
    steering: &SteeringLanes,
    outline: Option<&OutlineLanes>,
    rods: &Rods,
    moving: &Moving,
    next: &mut Moving,
    scratch: &mut Scratch,
) -> Bounced {
    let mut tilted_near = true;
    match steering {
        SteeringLanes::TiltGain => {
            for lane in 0..WIDTH {
                let tilt = tilt_by_gain::<L>(rods, moving, lane);
                tilted_near &= tilted(lane, &tilt, rods, moving, next, scratch);
            }
        }
        SteeringLanes::Feedback(feedback) => {
            for lane in 0..WIDTH {
                let tilt = feedback.tilt::<L>(moving, lane, 0.0);
                tilted_near &= tilted(lane, &tilt, rods, moving, next, scratch);
            }
        }
    }
    surface.strike::<L>(rods, moving, next, scratch);
    guess::<L>(rods, moving, next, scratch);
    let mut fallen = fall_to_table::<L>(STEPS, rods, moving, next, scratch, |_| 0.0);
    if let Some(outline) = outline {
        outline.watch(rods, moving, next, scratch);
        fallen.common = false;
    }
    Bounced { near: tilted_near & fallen.near, common: fallen.common || !any_apart(rods, scratch) }
}

/// Times of flight from the guesses, in at most so many steps, and the states at their ends. The contact points start at a height, m, of
/// each lane.
#[inline(always)]
pub(super) fn fall_to_table<L: Lane>(
    steps: u32,
    rods: &Rods,
    moving: &Moving,
    next: &mut Moving,
    scratch: &mut Scratch,
    clearance: impl Fn(usize) -> f64,
) -> Fallen {
    let mut fallen = fall::<L>(rods, moving, next, scratch, true, &clearance);
    for _ in 1..steps {
        if fallen.common || none_falls(scratch) {
            break;
        }
        let near = fallen.near;
        fallen = fall::<L>(rods, moving, next, scratch, false, &clearance);
        fallen.near &= near;
    }
    fallen
}

/// Tells whether all lanes have found their time of flight or are apart.
#[inline(always)]
fn none_falls(scratch: &Scratch) -> bool {
    let mut all = true;
    for lane in 0..WIDTH {
        all &= scratch.found[lane] | scratch.apart[lane] != 0;
    }
    all
}

/// Sets apart the lanes whose flight is not found or may be their last. Tells whether any lane is apart.
#[inline(always)]
pub(super) fn any_apart(rods: &Rods, scratch: &mut Scratch) -> bool {
    let mut any = 0;
    for lane in 0..WIDTH {
        let contact = LaneContact {
            found: scratch.found[lane] != 0,
            flight_time: scratch.t[lane],
            first_flight: rods.first_flight[lane],
            ..LaneContact::GOES_ON
        };
        scratch.apart[lane] |= unless(contact.passes_all());
        any |= scratch.apart[lane];
    }
    any != 0
}

/// Keeps the sines of θ, α and θ − α in a lane. Tells whether its angles were near.
///
/// Called in loops over the lanes. A closure handed to one loop may be compiled for itself, without vectors.
#[inline(always)]
pub(super) fn tilted<L: Lane>(
    lane: usize,
    tilt: &Tilt<L>,
    rods: &Rods,
    moving: &Moving,
    next: &mut Moving,
    scratch: &mut Scratch,
) -> bool {
    scratch.alpha[lane] = tilt.alpha.to_f64();
    scratch.sin_theta[lane] = tilt.sin_theta.to_f64();
    scratch.versine_theta[lane] = tilt.versine_theta.to_f64();
    scratch.sin_alpha[lane] = tilt.sin_alpha.to_f64();
    scratch.cos_alpha[lane] = tilt.cos_alpha.to_f64();
    scratch.sin_beta[lane] = tilt.sin_beta.to_f64();
    next.tilted(lane, tilt.alpha, rods, moving, scratch)
}

/// Start of the search for the time of flight.
#[inline(always)]
fn guess<L: Lane>(rods: &Rods, moving: &Moving, next: &Moving, scratch: &mut Scratch) {
    for lane in 0..WIDTH {
        let flight = flight::<L>(rods, moving, next, scratch, lane, 0.0);
        scratch.t[lane] = contact_time::guess(&flight).to_f64();
    }
}

/// Result of the flights of all lanes.
pub(super) struct Fallen {
    /// True where all angles were near.
    pub(super) near: bool,
    /// True where all lanes have found their time of flight and none is apart.
    pub(super) common: bool,
}

/// One step towards the time of flight, of the lanes that have not found it, and the state at its end.
#[inline(always)]
fn fall<L: Lane>(
    rods: &Rods,
    moving: &Moving,
    next: &mut Moving,
    scratch: &mut Scratch,
    first: bool,
    clearance: impl Fn(usize) -> f64,
) -> Fallen {
    let (mut near, mut common) = (true, true);
    // A copy: where a lane may keep its time, a store beside the load would be a masked one, which takes tens of cycles with AVX2.
    for lane in 0..WIDTH {
        let t = scratch.t[lane];
        let (sin, versine) = (L::from_f64(next.theta_dot[lane]) * L::from_f64(t)).sin_versine();
        scratch.before[lane] = t;
        scratch.sin_turned[lane] = sin.to_f64();
        scratch.versine_turned[lane] = versine.to_f64();
    }
    for lane in 0..WIDTH {
        let clearance = clearance(lane);
        let flight = flight::<L>(rods, moving, next, scratch, lane, clearance);
        let t = scratch.before[lane];
        let turned = (L::from_f64(scratch.sin_turned[lane]), L::from_f64(scratch.versine_turned[lane]));
        let gap = flight.gap_turned(L::from_f64(t), turned);
        let step = NewtonStep::new(&flight, L::from_f64(t), &gap);
        let turned = (next.theta_dot[lane] * t).abs();
        near &= turned <= Near::REACH;
        let refined = step.left_out.to_f64() <= step.negligible.to_f64();
        let better = if refined { step.refined.to_f64() } else { t + step.newton.to_f64() };
        // As where `contact_time::first_contact` does not start from the guess. From below the search starts right of the last root.
        let close = if clearance < 0.0 {
            (gap.value.to_f64() <= 0.0) & (t > 0.0)
        } else {
            gap.value.to_f64() > 0.25 * t * gap.slope.to_f64()
        };
        let close = !first | close;
        let (t, found) = if first {
            (better, refined)
        } else {
            // In the order of `contact_time::newton`.
            let (found, back) = (scratch.found[lane] != 0, !refined & (step.newton.to_f64() >= 0.0));
            (if found | back { t } else { better }, found | refined | back)
        };
        let contact = LaneContact { flight_time: t, first_flight: rods.first_flight[lane], ..LaneContact::GOES_ON };
        let goes_on = (turned <= L::REACH)
            & (gap.slope.to_f64() < 0.0)
            & close
            & (flight.bulge().to_f64() <= rods.gravity[lane])
            & contact.passes_all();
        let before = if first { scratch.apart_before_flight(lane) } else { scratch.apart[lane] };
        let apart = before | mask(!goes_on);
        common &= found & (apart == 0);
        scratch.t[lane] = t;
        scratch.found[lane] = mask(found);
        scratch.apart[lane] = apart;
        let end = flight.end(L::from_f64(t));
        next.theta[lane] = end.theta.to_f64();
        next.y_dot[lane] = end.y_dot.to_f64();
    }
    Fallen { near, common }
}

/// The flight after the strike in a lane, from a height of the contact point, m.
#[inline(always)]
pub(super) fn flight<N: Number>(
    rods: &Rods,
    moving: &Moving,
    next: &Moving,
    scratch: &Scratch,
    lane: usize,
    clearance: f64,
) -> Flight<N> {
    let number = N::from_f64;
    Flight {
        start: State {
            theta: number(moving.theta[lane]),
            x_dot: number(next.x_dot[lane]),
            y_dot: number(scratch.y_dot[lane]),
            theta_dot: number(next.theta_dot[lane]),
        },
        sin_cos_theta: (number(scratch.sin_theta[lane]), number(1.0 - scratch.versine_theta[lane])),
        clearance: number(clearance),
        contact_distance: number(rods.contact_distance[lane]),
        gravity: number(rods.gravity[lane]),
        drag: None,
    }
}
