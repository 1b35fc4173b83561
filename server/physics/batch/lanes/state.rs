//! The rods in the lanes, the state of their runs, and what the parts of a bounce hand on.

use super::number::{Lane, Near};
use crate::bounce::strike::{EnergyFeedback, Rod, State, Strike, Tilt};
use crate::run::rules::{LaneContact, Rules};

/// Number of rods that bounce side by side: two vectors of eight, or four of four, which the CPU overlaps.
pub(crate) const WIDTH: usize = 16;

/// A number for each of them.
pub(crate) type Lanes = [f64; WIDTH];

/// All numbers of the lanes in one piece.
///
/// A CPU takes a load for one of a store that it has not finished if their addresses differ by a multiple of 4096 bytes, and waits. So the
/// arrays stand together, in an order in which those so far apart are not used one soon after the other: the places of the arrays of
/// [`Rods`] come again from [`Scratch::alpha`] on.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct LaneNumbers {
    pub(crate) rods: Rods,
    /// State of the runs before a bounce.
    pub(crate) moving: Moving,
    /// State after it.
    pub(crate) next: Moving,
    pub(crate) scratch: Scratch,
}

/// Rods in the lanes, and the angles at which they topple.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Rods {
    pub(super) restitution: Lanes,
    pub(super) radius_of_gyration: Lanes,
    pub(super) leverage: Lanes,
    pub(super) strike_gain: Lanes,
    pub(super) strike_gain_per_energy: Lanes,
    pub(super) target_energy: Lanes,
    pub(super) tilt_gain: Lanes,
    pub(super) topple_angle: Lanes,
    pub(super) contact_distance: Lanes,
    pub(super) gravity: Lanes,
    /// First flight of runs that can settle, s: [`BEFORE_FLIGHT`] until it is over; 0 for those that cannot.
    pub(super) first_flight: Lanes,
}

/// State of the runs in the lanes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Moving {
    pub(super) theta: Lanes,
    pub(super) x_dot: Lanes,
    pub(super) y_dot: Lanes,
    pub(super) theta_dot: Lanes,
    /// Energy that the run should have, m²/s².
    pub(crate) energy: Lanes,
    /// Largest |θ| at a contact so far, rad.
    pub(crate) max_theta: Lanes,
}

/// Results that one part of a bounce leaves for the next.
#[derive(Clone, Debug)]
#[repr(C, align(64))]
pub(crate) struct Scratch {
    pub(super) sin_theta: Lanes,
    pub(super) versine_theta: Lanes,
    pub(super) sin_alpha: Lanes,
    pub(super) cos_alpha: Lanes,
    pub(super) sin_beta: Lanes,
    /// After the strike.
    pub(super) y_dot: Lanes,
    /// Not 0 where the tilt, or the strike, was not that of a common bounce.
    pub(super) tilted_apart: [u64; WIDTH],
    pub(super) struck_apart: [u64; WIDTH],
    /// sin u and 1 − cos u of the angle u that a body turns in its flight.
    pub(super) sin_turned: Lanes,
    pub(super) alpha: Lanes,
    pub(super) versine_turned: Lanes,
    /// t before it is changed.
    pub(super) before: Lanes,
    pub(super) t: Lanes,
    /// Not 0 where t is the time of flight.
    pub(super) found: [u64; WIDTH],
    /// Not 0 where this was not a common bounce.
    pub(crate) apart: [u64; WIDTH],
    /// Error of the time at which a table strikes that errs, s.
    pub(super) timing_error: Lanes,
    /// Error of the angle that it senses there, rad.
    pub(super) angle_error: Lanes,
    /// Height of the contact point there, m.
    pub(super) clearance: Lanes,
}

/// All bits where it holds, else none: a comparison of vectors as it is.
#[inline(always)]
pub(super) fn mask(holds: bool) -> u64 {
    u64::from(holds).wrapping_neg()
}

/// 1 unless it holds, which it does not where something is not a number. For an "or" with what stands in a lane, which would become a
/// masked store with [`mask`]: loads wait for those.
#[inline(always)]
pub(super) fn unless(common: bool) -> u64 {
    u64::from(!common)
}

/// Stands for the first flight until it is over, s: so short that no flight is too short beside it, and its share still normal.
const BEFORE_FLIGHT: f64 = 1e-200;

/// Stand-in for the first flight before there is one.
fn before_flight(rules: &Rules) -> f64 {
    if rules.settles { BEFORE_FLIGHT } else { 0.0 }
}

impl LaneNumbers {
    /// All the same, at the same contact.
    pub(crate) fn all(rod: &Rod, rules: &Rules, state: &State, energy: f64) -> Self {
        let moving = Moving::all(state, energy);
        Self { rods: Rods::all(rod, rules), moving, next: moving, scratch: Scratch::new() }
    }
}

impl Rods {
    /// All the same.
    fn all(rod: &Rod, rules: &Rules) -> Self {
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

    /// Gives the table in a lane another target energy, m²/s².
    pub(crate) fn aim(&mut self, lane: usize, target_energy: f64) {
        self.target_energy[lane] = target_energy;
    }

    /// A run has made its first flight, of so many seconds; 0 where it cannot settle.
    pub(crate) fn begin(&mut self, lane: usize, first_flight: f64) {
        self.first_flight[lane] = first_flight;
    }

    /// The one in a lane, with the energy feedback of most: the kind of contact knows its own.
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
            energy_feedback: EnergyFeedback::Vertical,
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

    /// Tells whether the run in a lane can settle.
    #[inline(always)]
    pub(super) fn settles(&self, lane: usize) -> bool {
        self.first_flight[lane] != 0.0
    }

    /// First flight of the run in a lane, s; 0 until it is over, and for runs that cannot settle.
    pub(crate) fn first_flight(&self, lane: usize) -> f64 {
        Some(self.first_flight[lane]).filter(|&flight| flight != BEFORE_FLIGHT).unwrap_or(0.0)
    }
}

impl Moving {
    /// All the same.
    fn all(state: &State, energy: f64) -> Self {
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

    /// Begins the bounce of a lane, at a table tilted by `alpha`: notes the largest angle, and sets the lane apart where the run may end
    /// there or an angle is beyond the reach of `L`. Tells whether the angles are near.
    #[inline(always)]
    pub(super) fn tilted<L: Lane>(
        &mut self,
        lane: usize,
        alpha: L,
        rods: &Rods,
        moving: &Moving,
        scratch: &mut Scratch,
    ) -> bool {
        let size = moving.theta[lane].abs();
        self.max_theta[lane] = if size > moving.max_theta[lane] { size } else { moving.max_theta[lane] };
        let largest = size + alpha.magnitude().to_f64();
        let contact = LaneContact { size, topple_angle: rods.topple_angle[lane], ..LaneContact::GOES_ON };
        scratch.tilted_apart[lane] = mask(!((largest <= L::REACH) & contact.passes_all()));
        largest <= Near::REACH
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
        // The angle and ẏ of the coming contact follow from the flight.
        self.x_dot[lane] = after.x_dot;
        self.theta_dot[lane] = after.theta_dot;
        self.energy[lane] = energy;
        scratch.y_dot[lane] = after.y_dot;
        let contact = LaneContact {
            push: strike.push.to_f64(),
            x_dot: after.x_dot,
            y_dot: after.y_dot,
            contact_rise: strike.contact_rise.to_f64(),
            sure_rise,
            ..LaneContact::GOES_ON
        };
        scratch.struck_apart[lane] = mask(!contact.passes_all());
    }

    /// Takes all lanes from another, one kind of number after the other: short enough for the compiler to copy without a call.
    #[inline(always)]
    pub(crate) fn take_all(&mut self, other: &Self) {
        self.theta = other.theta;
        self.x_dot = other.x_dot;
        self.y_dot = other.y_dot;
        self.theta_dot = other.theta_dot;
        self.energy = other.energy;
        self.max_theta = other.max_theta;
    }

    /// Takes a lane from another.
    pub(crate) fn take(&mut self, lane: usize, other: &Self) {
        self.set(lane, &other.state(lane), other.energy[lane]);
        self.max_theta[lane] = other.max_theta[lane];
    }
}

impl Scratch {
    /// Not 0 where the bounce of a lane was not a common one up to its flight.
    #[inline(always)]
    pub(super) fn apart_before_flight(&self, lane: usize) -> u64 {
        self.tilted_apart[lane] | self.struck_apart[lane]
    }

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
    fn new() -> Self {
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
            before: zero,
            sin_turned: zero,
            versine_turned: zero,
            timing_error: zero,
            angle_error: zero,
            clearance: zero,
            found: [0; WIDTH],
            tilted_apart: [0; WIDTH],
            struck_apart: [0; WIDTH],
            apart: [0; WIDTH],
        }
    }
}
