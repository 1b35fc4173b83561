//! One contact of all lanes and the flight after it.
//!
//! In several short loops: a bounce is one long chain of operations, each waiting for the last, and the CPU overlaps the
//! chains of neighbours only where they fit into its window together.

use super::number::{Lane, Near};
use super::surface::Surface;
use super::{Lanes, WIDTH};
use crate::bounce::contact_time;
use crate::bounce::contact_time::NewtonStep;
use crate::bounce::flight::Flight;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::bounce::tilt::Tilt;
use crate::run::orbit::LaneRunState;
use crate::run::rules::{Rules, SPEED_LIMIT};
use crate::run::settling::SETTLED_SHARE;

/// What bounces, and how far it may tilt.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Rods {
    contact_distance: Lanes,
    radius_of_gyration: Lanes,
    leverage: Lanes,
    gravity: Lanes,
    restitution: Lanes,
    tilt_gain: Lanes,
    strike_gain: Lanes,
    strike_gain_per_energy: Lanes,
    target_energy: Lanes,
    topple_angle: Lanes,
    /// Of runs that can settle, s: [`BEFORE_FLIGHT`] until it is over; 0 for those that cannot.
    first_flight: Lanes,
}

/// What changes from contact to contact.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(crate) struct Moving {
    theta: Lanes,
    x_dot: Lanes,
    y_dot: Lanes,
    theta_dot: Lanes,
    /// Energy that the run should have, m²/s².
    pub(crate) energy: Lanes,
    /// Largest |θ| at a contact so far, rad.
    pub(crate) max_theta: Lanes,
}

/// What one part of a bounce leaves for the next.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Scratch {
    alpha: Lanes,
    sin_theta: Lanes,
    versine_theta: Lanes,
    sin_alpha: Lanes,
    cos_alpha: Lanes,
    sin_beta: Lanes,
    /// After the strike.
    y_dot: Lanes,
    t: Lanes,
    /// 1 where t is the time of flight.
    found: [u64; WIDTH],
    /// 1 where this was not a common bounce.
    pub(crate) apart: [u64; WIDTH],
}

/// A contact point that rises faster does so by more than rounding ([`Strike::rises`]), at any speed up to the limit, m/s.
pub(super) const SURE_RISE: f64 = 1e-8;

/// Stands for the first flight until it is over, s: so short that no flight is too short beside it, and its share still normal.
const BEFORE_FLIGHT: f64 = 1e-200;

/// Most Newton steps of a common bounce: nearly all take one, few two.
const STEPS: u32 = 3;

/// How a bounce of all lanes went.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounced {
    /// Whether all angles were in the reach of [`Near`].
    pub(crate) near: bool,
    /// Whether it was a common one in all lanes; else see [`Scratch::apart`].
    pub(crate) common: bool,
}

/// The bounce of all lanes from `moving` to `next`, but not of those that it sets apart: their run may end here, an angle may
/// be beyond the reach of `L`, or their contact time is not a common one.
#[inline(always)]
pub(crate) fn bounce<L: Lane, S: Surface>(
    surface: &S,
    rods: &Rods,
    moving: &Moving,
    next: &mut Moving,
    scratch: &mut Scratch,
) -> Bounced {
    let tilted_near = tilt::<L>(rods, moving, next, scratch);
    surface.strike::<L>(rods, moving, next, scratch);
    guess::<L>(rods, moving, next, scratch);
    let mut fallen = fall::<L>(rods, moving, next, scratch, true);
    for _ in 1..STEPS {
        if fallen.all {
            break;
        }
        let near = fallen.near;
        fallen = fall::<L>(rods, moving, next, scratch, false);
        fallen.near &= near;
    }
    let mut any = 0;
    for lane in 0..WIDTH {
        let settled = unless(scratch.t[lane] >= SETTLED_SHARE * rods.first_flight[lane]);
        scratch.apart[lane] |= (1 - scratch.found[lane]) | settled;
        any |= scratch.apart[lane];
    }
    Bounced { near: tilted_near & fallen.near, common: any == 0 }
}

/// The sines of θ, α and θ − α: whether all were near.
#[inline(always)]
fn tilt<L: Lane>(rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) -> bool {
    let mut near = true;
    for lane in 0..WIDTH {
        let tilt = rods.rod(lane).lift::<L>().tilt(L::from_f64(moving.theta[lane]));
        scratch.alpha[lane] = tilt.alpha.to_f64();
        scratch.sin_theta[lane] = tilt.sin_theta.to_f64();
        scratch.versine_theta[lane] = tilt.versine_theta.to_f64();
        scratch.sin_alpha[lane] = tilt.sin_alpha.to_f64();
        scratch.cos_alpha[lane] = tilt.cos_alpha.to_f64();
        scratch.sin_beta[lane] = tilt.sin_beta.to_f64();
        let size = moving.theta[lane].abs();
        next.max_theta[lane] = if size > moving.max_theta[lane] { size } else { moving.max_theta[lane] };
        let largest = size + tilt.alpha.magnitude().to_f64();
        near &= largest <= Near::REACH;
        scratch.apart[lane] = unless((largest <= L::REACH) & (size < rods.topple_angle[lane]));
    }
    near
}

/// Where to start on the time of flight.
#[inline(always)]
fn guess<L: Lane>(rods: &Rods, moving: &Moving, next: &Moving, scratch: &mut Scratch) {
    for lane in 0..WIDTH {
        let flight = flight::<L>(rods, moving, next, scratch, lane);
        scratch.t[lane] = contact_time::guess(&flight).to_f64();
        scratch.apart[lane] |= unless(flight.bulge().to_f64() <= rods.gravity[lane]);
    }
}

struct Fallen {
    near: bool,
    /// Whether all lanes have found their time of flight or are apart.
    all: bool,
}

/// One step towards the time of flight, of the lanes that have not found it, and the state at its end.
#[inline(always)]
fn fall<L: Lane>(rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch, first: bool) -> Fallen {
    let (mut near, mut all) = (true, 1);
    for lane in 0..WIDTH {
        let flight = flight::<L>(rods, moving, next, scratch, lane);
        let t = scratch.t[lane];
        let gap = flight.gap(L::from_f64(t));
        let step = NewtonStep::new(&flight, L::from_f64(t), &gap);
        let turned = (next.theta_dot[lane] * t).abs();
        near &= turned <= Near::REACH;
        let refined = step.left_out.to_f64() <= step.negligible.to_f64();
        let better = if refined { step.refined.to_f64() } else { t + step.newton.to_f64() };
        // As where `contact_time::first_contact` does not start from the guess.
        let close = !first | (gap.value.to_f64() > 0.25 * t * gap.slope.to_f64());
        let apart = scratch.apart[lane] | unless((turned <= L::REACH) & (gap.slope.to_f64() < 0.0) & close);
        if first {
            scratch.t[lane] = better;
            scratch.found[lane] = u64::from(refined);
        } else {
            // In the order of `contact_time::newton`.
            let back = !refined & (step.newton.to_f64() >= 0.0);
            scratch.t[lane] = if (scratch.found[lane] == 1) | back { t } else { better };
            scratch.found[lane] |= u64::from(refined | back);
        }
        scratch.apart[lane] = apart;
        all &= scratch.found[lane] | apart;
        let end = flight.end(L::from_f64(scratch.t[lane]));
        next.theta[lane] = end.theta.to_f64();
        next.y_dot[lane] = end.y_dot.to_f64();
    }
    Fallen { near, all: all == 1 }
}

/// 1 unless it holds, which it does not where something is not a number.
#[inline(always)]
fn unless(common: bool) -> u64 {
    u64::from(!common)
}

#[inline(always)]
fn flight<L: Lane>(rods: &Rods, moving: &Moving, next: &Moving, scratch: &Scratch, lane: usize) -> Flight<L> {
    let number = L::from_f64;
    Flight {
        start: State {
            theta: number(moving.theta[lane]),
            x_dot: number(next.x_dot[lane]),
            y_dot: number(scratch.y_dot[lane]),
            theta_dot: number(next.theta_dot[lane]),
        },
        sin_cos_theta: (number(scratch.sin_theta[lane]), number(1.0 - scratch.versine_theta[lane])),
        clearance: number(0.0),
        contact_distance: number(rods.contact_distance[lane]),
        gravity: number(rods.gravity[lane]),
    }
}

/// What stands for the first flight before there is one.
fn before_flight(rules: &Rules) -> f64 {
    if rules.settles { BEFORE_FLIGHT } else { 0.0 }
}

impl Rods {
    /// All the same.
    pub(crate) fn all(rod: &Rod, rules: &Rules) -> Self {
        let Rod { contact_distance, radius_of_gyration, gravity, restitution, tilt_gain, .. } = *rod;
        Self {
            contact_distance: [contact_distance; WIDTH],
            radius_of_gyration: [radius_of_gyration; WIDTH],
            leverage: [rod.leverage(); WIDTH],
            gravity: [gravity; WIDTH],
            restitution: [restitution; WIDTH],
            tilt_gain: [tilt_gain; WIDTH],
            strike_gain: [rod.strike_gain; WIDTH],
            strike_gain_per_energy: [rod.strike_gain_per_energy; WIDTH],
            target_energy: [rod.target_energy; WIDTH],
            topple_angle: [rules.topple_angle; WIDTH],
            first_flight: [before_flight(rules); WIDTH],
        }
    }

    /// Puts another into a lane.
    pub(crate) fn set(&mut self, lane: usize, rod: &Rod, rules: &Rules) {
        self.contact_distance[lane] = rod.contact_distance;
        self.radius_of_gyration[lane] = rod.radius_of_gyration;
        self.leverage[lane] = rod.leverage();
        self.gravity[lane] = rod.gravity;
        self.restitution[lane] = rod.restitution;
        self.tilt_gain[lane] = rod.tilt_gain;
        self.strike_gain[lane] = rod.strike_gain;
        self.strike_gain_per_energy[lane] = rod.strike_gain_per_energy;
        self.target_energy[lane] = rod.target_energy;
        self.topple_angle[lane] = rules.topple_angle;
        self.first_flight[lane] = before_flight(rules);
    }

    /// A run has made its first flight, of so many seconds; 0 where it cannot settle.
    pub(crate) fn begin(&mut self, lane: usize, first_flight: f64) {
        self.first_flight[lane] = first_flight;
    }

    /// The one in a lane.
    #[inline(always)]
    pub(crate) fn rod(&self, lane: usize) -> Rod {
        Rod {
            contact_distance: self.contact_distance[lane],
            radius_of_gyration: self.radius_of_gyration[lane],
            gravity: self.gravity[lane],
            restitution: self.restitution[lane],
            tilt_gain: self.tilt_gain[lane],
            strike_gain: self.strike_gain[lane],
            strike_gain_per_energy: self.strike_gain_per_energy[lane],
            target_energy: self.target_energy[lane],
        }
    }

    /// 1/ρ² of the one in a lane, 1/m².
    #[inline(always)]
    pub(super) fn leverage(&self, lane: usize) -> f64 {
        self.leverage[lane]
    }

    /// l²/ρ² of the one in a lane.
    #[inline(always)]
    pub(super) fn lever_squared(&self, lane: usize) -> f64 {
        self.contact_distance[lane] * self.contact_distance[lane] * self.leverage[lane]
    }

    /// Whether the run in a lane can settle.
    #[inline(always)]
    pub(super) fn settles(&self, lane: usize) -> bool {
        self.first_flight[lane] != 0.0
    }

    /// When the run in a lane ends.
    pub(super) fn rules(&self, lane: usize) -> Rules {
        Rules { topple_angle: self.topple_angle[lane], settles: self.settles(lane), holds_energy: false, limits: None }
    }

    /// Where the run in a lane is.
    pub(crate) fn midst(&self, moving: &Moving, lane: usize) -> LaneRunState {
        let first_flight = Some(self.first_flight[lane]).filter(|&flight| flight != BEFORE_FLIGHT).unwrap_or(0.0);
        LaneRunState { state: moving.state(lane), energy: moving.energy[lane], first_flight }
    }
}

impl Moving {
    /// All the same.
    pub(crate) fn all(state: &State, energy: f64) -> Self {
        let State { theta, x_dot, y_dot, theta_dot } = *state;
        Self {
            theta: [theta; WIDTH],
            x_dot: [x_dot; WIDTH],
            y_dot: [y_dot; WIDTH],
            theta_dot: [theta_dot; WIDTH],
            energy: [energy; WIDTH],
            max_theta: [0.0; WIDTH],
        }
    }

    /// The state in a lane.
    #[inline(always)]
    pub(crate) fn state(&self, lane: usize) -> State {
        State {
            theta: self.theta[lane],
            x_dot: self.x_dot[lane],
            y_dot: self.y_dot[lane],
            theta_dot: self.theta_dot[lane],
        }
    }

    /// Puts another into a lane.
    #[inline(always)]
    pub(crate) fn set(&mut self, lane: usize, state: &State, energy: f64) {
        self.theta[lane] = state.theta;
        self.x_dot[lane] = state.x_dot;
        self.y_dot[lane] = state.y_dot;
        self.theta_dot[lane] = state.theta_dot;
        self.energy[lane] = energy;
    }

    /// Puts what a strike gives into a lane, with the energy that the run should have after it; sets it apart where the run may end
    /// there. A contact point that rises faster than `sure_rise`, m/s, does so by more than rounding.
    #[inline(always)]
    pub(super) fn struck<L: Lane>(
        &mut self,
        lane: usize,
        strike: &Strike<L>,
        energy: f64,
        sure_rise: f64,
        scratch: &mut Scratch,
    ) {
        let after = strike.after.map(L::to_f64);
        self.set(lane, &after, energy);
        scratch.y_dot[lane] = after.y_dot;
        scratch.apart[lane] |= unless(
            (strike.push.to_f64() < 0.0)
                & (after.x_dot.abs() <= 0.5 * SPEED_LIMIT)
                & (after.y_dot.abs() <= 0.5 * SPEED_LIMIT)
                & (strike.contact_rise.to_f64() > sure_rise),
        );
    }

    /// Takes a lane from another.
    pub(crate) fn take(&mut self, lane: usize, other: &Self) {
        self.set(lane, &other.state(lane), other.energy[lane]);
        self.max_theta[lane] = other.max_theta[lane];
    }
}

impl Scratch {
    /// The flight of a lane, s, if its bounce was a common one.
    pub(crate) fn flight_time(&self, lane: usize) -> Option<f64> {
        (self.apart[lane] == 0).then_some(self.t[lane])
    }

    /// The tilt in a lane.
    #[inline(always)]
    pub(super) fn tilt<L: Lane>(&self, lane: usize) -> Tilt<L> {
        let number = L::from_f64;
        Tilt {
            alpha: number(self.alpha[lane]),
            sin_theta: number(self.sin_theta[lane]),
            versine_theta: number(self.versine_theta[lane]),
            sin_alpha: number(self.sin_alpha[lane]),
            cos_alpha: number(self.cos_alpha[lane]),
            sin_beta: number(self.sin_beta[lane]),
        }
    }

    /// Nothing in it.
    pub(crate) fn new() -> Self {
        let zero = [0.0; WIDTH];
        Self {
            alpha: zero,
            sin_theta: zero,
            versine_theta: zero,
            sin_alpha: zero,
            cos_alpha: zero,
            sin_beta: zero,
            y_dot: zero,
            t: zero,
            found: [0; WIDTH],
            apart: [0; WIDTH],
        }
    }
}
