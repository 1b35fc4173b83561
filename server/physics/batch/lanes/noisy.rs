//! Bodies with an angle in lanes, on tables that err in time or in the angle that they sense ([`NoiseModel::Strike`]).
//!
//! Contacts are off y = 0 here, by the height that the contact point has at the wrong time.

use super::contact::Surface;
use super::model::{Bounced, LaneModel};
use super::number::{Lane, Near};
use super::rod::RodLanes;
use super::state::{Lanes, Moving, Rods, Scratch, WIDTH, unless};
use super::steering::SteeringLanes;
use super::step::{any_apart, fall_to_table, flight, tilted};
use crate::body::Body;
use crate::body::bounce::LEAST_FLIGHT;
use crate::bounce::contact_time::{guess, guess_from_above, latest_contact};
use crate::bounce::strike::Tilt;
use crate::run::orbit::LaneRunState;
use crate::table::noise::{FurtherNoise, Noise, NoiseModel, NoiseSample};

/// No errors.
const EXACT: Noise =
    Noise { timing_sd: 0.0, angle_sd: 0.0, model: NoiseModel::Strike, seed: 0, run: 0, further: FurtherNoise::NONE };

/// Most Newton steps of a common bounce. From below y = 0 the search begins at the latest contact, which takes about five.
const STEPS: u32 = 10;

/// Bodies on tables that err.
#[derive(Clone, Debug)]
pub(crate) struct NoisyLanes<S> {
    pub(crate) rods: RodLanes<S>,
    pub(crate) errors: ErrorLanes,
}

/// Errors of the tables, and what they do to the coming contacts.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct ErrorLanes {
    timing_sd: Lanes,
    angle_sd: Lanes,
    seed: [u64; WIDTH],
    run: [u64; WIDTH],
    /// Number of the coming contact.
    n: [u64; WIDTH],
    /// Height of the contact point there, m.
    clearance: Lanes,
    /// Error of the angle that the table senses there, rad.
    angle: Lanes,
}

impl<S: Surface> NoisyLanes<S> {
    pub(crate) fn new(rods: RodLanes<S>) -> Self {
        let errors = ErrorLanes {
            timing_sd: [0.0; WIDTH],
            angle_sd: [0.0; WIDTH],
            seed: [0; WIDTH],
            run: [0; WIDTH],
            n: [1; WIDTH],
            clearance: [0.0; WIDTH],
            angle: [0.0; WIDTH],
        };
        Self { rods, errors }
    }
}

impl<S: Surface> LaneModel for NoisyLanes<S> {
    fn idle(&self) -> Body {
        self.rods.idle()
    }

    fn load(&mut self, lane: usize, body: &Body, lane_state: &LaneRunState) {
        self.rods.load(lane, body, lane_state);
        self.errors.load(lane, body.noise, lane_state);
    }

    #[inline(always)]
    fn bounce<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) -> Bounced {
        let errors = &self.errors;
        let mut near = true;
        match &self.rods.steering {
            SteeringLanes::TiltGain => {
                for lane in 0..WIDTH {
                    let tilt = errors.tilt_by_gain::<L>(rods, moving, lane);
                    near &= tilted(lane, &tilt, rods, moving, next, scratch);
                }
            }
            SteeringLanes::Feedback(feedback) => {
                for lane in 0..WIDTH {
                    let tilt = feedback.tilt::<L>(moving, lane, errors.angle[lane]);
                    near &= tilted(lane, &tilt, rods, moving, next, scratch);
                }
            }
        }
        self.rods.surface.strike::<L>(&errors.seen(rods), moving, next, scratch);
        errors.guess(rods, moving, next, scratch);
        near &= fall_to_table::<L>(STEPS, rods, moving, next, scratch, |lane| errors.clearance[lane]).near;
        if let Some(outline) = &self.rods.outline {
            // Where no other vertex comes down before the contact point would, none does before an early strike.
            outline.watch(rods, moving, next, scratch);
        }
        near &= errors.be_late::<L>(rods, moving, next, scratch);
        Bounced { near, common: !any_apart(rods, scratch) }
    }

    #[inline(always)]
    fn arrive(&mut self, next: &Moving, scratch: &Scratch) {
        self.rods.arrive(next, scratch);
        for lane in 0..WIDTH {
            self.errors.arrive(lane, scratch);
        }
    }

    fn arrive_in(&mut self, lane: usize, next: &Moving, scratch: &Scratch) {
        self.rods.arrive_in(lane, next, scratch);
        self.errors.arrive(lane, scratch);
    }

    fn save(&self, lane: usize, lane_state: &mut LaneRunState) {
        self.rods.save(lane, lane_state);
        lane_state.clearance = self.errors.clearance[lane];
    }
}

impl ErrorLanes {
    fn load(&mut self, lane: usize, noise: Option<Noise>, lane_state: &LaneRunState) {
        let noise = noise.unwrap_or(EXACT);
        self.timing_sd[lane] = noise.timing_sd;
        self.angle_sd[lane] = noise.angle_sd;
        (self.seed[lane], self.run[lane]) = (noise.seed, noise.run);
        self.n[lane] = lane_state.n + 1;
        self.clearance[lane] = lane_state.clearance;
        self.angle[lane] = noise.angle_error(lane_state.n + 1);
    }

    #[inline(always)]
    fn arrive(&mut self, lane: usize, scratch: &Scratch) {
        self.n[lane] += 1;
        self.clearance[lane] = scratch.clearance[lane];
        self.angle[lane] = scratch.angle_error[lane];
    }

    /// The tilt in a lane: the rod's own without an error, as [`crate::body::Body`] has it.
    #[inline(always)]
    fn tilt_by_gain<L: Lane>(&self, rods: &Rods, moving: &Moving, lane: usize) -> Tilt<L> {
        let (theta, error, gain) = (moving.theta[lane], self.angle[lane], rods.tilt_gain[lane]);
        let sensed = if error == 0.0 { theta } else { theta + error };
        let alpha = gain * sensed;
        let beta = if error == 0.0 { (1.0 - gain) * theta } else { theta - alpha };
        Tilt::new(L::from_f64(theta), L::from_f64(alpha), L::from_f64(beta))
    }

    /// The tables as they see contacts that are off y = 0: the energy of a bounce counts from there. No energy is held.
    #[inline(always)]
    fn seen(&self, rods: &Rods) -> Rods {
        let mut seen = Rods { first_flight: [1.0; WIDTH], ..rods.clone() };
        for lane in 0..WIDTH {
            seen.target_energy[lane] = rods.target_energy[lane] - rods.gravity[lane] * self.clearance[lane];
        }
        seen
    }

    /// Start of the search for the time of flight to y = 0.
    #[inline(always)]
    fn guess(&self, rods: &Rods, moving: &Moving, next: &Moving, scratch: &mut Scratch) {
        for lane in 0..WIDTH {
            let clearance = self.clearance[lane];
            let flight = flight::<f64>(rods, moving, next, scratch, lane, clearance);
            let above = if clearance == 0.0 { guess(&flight) } else { guess_from_above(&flight) };
            scratch.t[lane] = if clearance < 0.0 { latest_contact(&flight) } else { above };
        }
    }

    /// Strikes at the wrong time, instead of that at which the contact point is at y = 0. Tells whether all angles were near.
    #[inline(always)]
    fn be_late<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) -> bool {
        for lane in 0..WIDTH {
            let noise = Noise {
                timing_sd: self.timing_sd[lane],
                angle_sd: self.angle_sd[lane],
                seed: self.seed[lane],
                run: self.run[lane],
                ..EXACT
            };
            let NoiseSample { timing, angle } = noise.draw(self.n[lane] + 1);
            (scratch.timing_error[lane], scratch.angle_error[lane]) = (timing, angle);
        }
        let mut near = true;
        // A copy, as in the steps of a flight.
        scratch.before = scratch.t;
        for lane in 0..WIDTH {
            let (t, timing) = (scratch.before[lane], scratch.timing_error[lane]);
            let struck = if timing == 0.0 { t } else { (t + timing).max(LEAST_FLIGHT) };
            let turned = (next.theta_dot[lane] * struck).abs();
            near &= turned <= Near::REACH;
            scratch.apart[lane] |= unless(turned <= L::REACH);
            let flight = flight::<L>(rods, moving, next, scratch, lane, self.clearance[lane]);
            let height = flight.gap(L::from_f64(struck)).value.to_f64();
            scratch.clearance[lane] = if timing == 0.0 { 0.0 } else { height };
            scratch.t[lane] = struck;
            let end = flight.end(L::from_f64(struck));
            (next.theta[lane], next.y_dot[lane]) = (end.theta.to_f64(), end.y_dot.to_f64());
        }
        near
    }
}
