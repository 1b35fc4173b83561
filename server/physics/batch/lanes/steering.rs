//! Tilt of the tables in the lanes, by one law in all of them.

use super::number::Lane;
use super::state::{Lanes, Moving, Rods, Scratch, WIDTH};
use crate::batch::model::TiltLaw;
use crate::body::Body;
use crate::bounce::strike::{State, Tilt};
use crate::numbers::compensated_sum::CompensatedSum;
use crate::run::orbit::LaneRunState;
use crate::table::control_law::Gains;

/// A law of the tilt, with the numbers of each lane.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a batch has one")]
pub(crate) enum SteeringLanes {
    /// α = κθ: κ is in [`Rods`].
    TiltGain,
    /// α = −K·(x, θ, ẋ, θ̇).
    Feedback(FeedbackLanes),
}

/// State feedbacks with the places of the bodies, which no other law needs.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct FeedbackLanes {
    x_gain: Lanes,
    theta: Lanes,
    x_dot: Lanes,
    theta_dot: Lanes,
    x: Lanes,
    lost: Lanes,
}

impl SteeringLanes {
    pub(crate) fn new(law: TiltLaw) -> Self {
        const ZERO: Lanes = [0.0; WIDTH];
        match law {
            TiltLaw::TiltGain => Self::TiltGain,
            TiltLaw::Feedback => Self::Feedback(FeedbackLanes {
                x_gain: ZERO,
                theta: ZERO,
                x_dot: ZERO,
                theta_dot: ZERO,
                x: ZERO,
                lost: ZERO,
            }),
        }
    }

    /// Puts a run into a lane.
    pub(super) fn load(&mut self, lane: usize, body: &Body, lane_state: &LaneRunState) {
        if let Self::Feedback(feedback) = self {
            let [x_gain, theta, x_dot, theta_dot] = body.feedback().unwrap_or_default();
            feedback.x_gain[lane] = x_gain;
            feedback.theta[lane] = theta;
            feedback.x_dot[lane] = x_dot;
            feedback.theta_dot[lane] = theta_dot;
            (feedback.x[lane], feedback.lost[lane]) = (lane_state.x.value, lane_state.x.lost);
        }
    }

    /// The places of all lanes at the end of a flight.
    #[inline(always)]
    pub(super) fn arrive(&mut self, next: &Moving, scratch: &Scratch) {
        if let Self::Feedback(feedback) = self {
            for lane in 0..WIDTH {
                feedback.fly(lane, next, scratch);
            }
        }
    }

    /// The place of one lane at the end of a flight.
    pub(super) fn arrive_in(&mut self, lane: usize, next: &Moving, scratch: &Scratch) {
        if let Self::Feedback(feedback) = self {
            feedback.fly(lane, next, scratch);
        }
    }

    /// Writes the place of a lane, if the law needs it.
    pub(super) fn save(&self, lane: usize, lane_state: &mut LaneRunState) {
        if let Self::Feedback(feedback) = self {
            lane_state.x = feedback.place(lane);
        }
    }
}

impl FeedbackLanes {
    #[inline(always)]
    fn place(&self, lane: usize) -> CompensatedSum {
        CompensatedSum { value: self.x[lane], lost: self.lost[lane] }
    }

    #[inline(always)]
    fn fly(&mut self, lane: usize, next: &Moving, scratch: &Scratch) {
        let mut place = self.place(lane);
        place.add(next.x_dot[lane] * scratch.t[lane]);
        (self.x[lane], self.lost[lane]) = (place.value, place.lost);
    }

    /// The tilt in a lane, the angle sensed with an error (rad).
    #[inline(always)]
    pub(super) fn tilt<L: Lane>(&self, moving: &Moving, lane: usize, error: f64) -> Tilt<L> {
        let number = L::from_f64;
        let gains = Gains {
            x: number(self.x_gain[lane]),
            theta: number(self.theta[lane]),
            x_dot: number(self.x_dot[lane]),
            theta_dot: number(self.theta_dot[lane]),
        };
        let state = moving.state(lane).map(number);
        let sensed = State { theta: state.theta + number(error), ..state };
        let alpha = gains.tilt(number(self.x[lane]), &sensed);
        Tilt::new(state.theta, alpha, state.theta - alpha)
    }
}

/// The tilt of a table with a tilt gain in a lane.
#[inline(always)]
pub(super) fn tilt_by_gain<L: Lane>(rods: &Rods, moving: &Moving, lane: usize) -> Tilt<L> {
    rods.rod(lane).lift::<L>().tilt(L::from_f64(moving.theta[lane]))
}
