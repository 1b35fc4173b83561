//! Point masses in lanes: as rods of no length ([`crate::body::Body::point`]), without what is zero for them.

use super::contact::struck_smooth;
use super::model::{Bounced, LaneModel};
use super::number::{Lane, Near};
use super::rod::IDLE;
use super::state::{Lanes, Moving, Rods, Scratch, WIDTH, mask};
use super::step::any_apart;
use crate::body::Body;
use crate::bounce::contact_time::NewtonStep;
use crate::bounce::flight::Flight;
use crate::bounce::strike::{EnergyFeedback, Rod, State, Tilt};
use crate::run::orbit::LaneRunState;

/// Point masses, with one energy feedback in all lanes.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct PointLanes {
    energy_feedback: EnergyFeedback,
    /// 1/G, s²/m.
    per_gravity: Lanes,
}

impl PointLanes {
    pub(crate) fn new(energy_feedback: EnergyFeedback) -> Self {
        Self { energy_feedback, per_gravity: [1.0; WIDTH] }
    }

    /// The strikes of all lanes, with one energy feedback, which is a constant in it. Returns true where all angles were near.
    #[inline(always)]
    fn strike<L: Lane>(
        energy_feedback: EnergyFeedback,
        rods: &Rods,
        moving: &Moving,
        next: &mut Moving,
        scratch: &mut Scratch,
    ) -> bool {
        let (number, zero) = (L::from_f64, L::from_f64(0.0));
        let mut near = true;
        for lane in 0..WIDTH {
            let rod = Rod {
                contact_distance: zero,
                radius_of_gyration: number(1.0),
                energy_feedback,
                ..rods.rod(lane).lift::<L>()
            };
            let State { theta, x_dot, y_dot, .. } = moving.state(lane).map(number);
            let alpha = rod.tilt_gain * theta;
            near &= next.tilted::<L>(lane, alpha, rods, moving, scratch);
            let (sin_alpha, cos_alpha) = at_least(alpha, TINY).sincos();
            // The others have no effect, since the body has no length.
            let tilt = Tilt { alpha, sin_theta: zero, versine_theta: zero, sin_alpha, cos_alpha, sin_beta: zero };
            let before = State { theta, x_dot: at_least(x_dot, TINY * y_dot.to_f64().abs()), y_dot, theta_dot: zero };
            let mut strike = rod.strike_with(&before, &tilt, number(1.0));
            strike.after.x_dot = x_dot - strike.impulse_normal * unless_tiny(alpha, sin_alpha);
            struck_smooth(lane, &rod, strike, rods, moving, next, scratch);
        }
        near
    }

    /// The flights of all lanes. Returns true where all angles at their ends were near.
    ///
    /// One step of [`crate::bounce::contact_time::first_contact`] suffices, since its start is the contact time but for rounding.
    #[inline(always)]
    fn fly<L: Lane>(&self, rods: &Rods, next: &mut Moving, scratch: &mut Scratch) -> bool {
        let (number, zero) = (L::from_f64, L::from_f64(0.0));
        let mut near = true;
        for lane in 0..WIDTH {
            let (x_dot, y_dot) = (number(next.x_dot[lane]), number(scratch.y_dot[lane]));
            let flight = Flight {
                start: State { theta: zero, x_dot, y_dot, theta_dot: zero },
                sin_cos_theta: (zero, number(1.0)),
                clearance: zero,
                contact_distance: zero,
                gravity: number(rods.gravity[lane]),
                drag: None,
            };
            let start = number(2.0) * y_dot * number(self.per_gravity[lane]);
            let gap = flight.gap_turned(start, (zero, zero));
            let step = NewtonStep::new(&flight, start, &gap);
            let refined = step.left_out.to_f64() <= step.negligible.to_f64();
            let close = gap.value.to_f64() > 0.25 * start.to_f64() * gap.slope.to_f64();
            let end = flight.end(step.refined);
            // Falls, so that the angle of the velocity is that of its two parts without a sign.
            let falls = end.y_dot.to_f64() < 0.0;
            let ratio = (end.x_dot / -end.y_dot).magnitude();
            let size = ratio.to_f64();
            let theta = unless_tiny(ratio, L::from_f64(size.max(TINY)).arctangent());
            let theta = theta.to_f64().copysign(end.x_dot.to_f64());
            near &= size <= Near::RATIO;
            scratch.found[lane] = mask(refined);
            scratch.t[lane] = step.refined.to_f64();
            let common = close & (gap.slope.to_f64() < 0.0) & falls & (size <= L::RATIO);
            scratch.apart[lane] = scratch.apart_before_flight(lane) | mask(!common);
            next.theta[lane] = theta;
            next.y_dot[lane] = end.y_dot.to_f64();
        }
        near
    }
}

/// An angle, rad, far below those that are their own sine, tangent and arctangent in doubles. On a good table the velocity of a point mass
/// comes as near to the vertical as numbers allow. Products of smaller angles would be too small for doubles, which takes time.
const TINY: f64 = 1e-30;

/// The number, or `least` where its size is below that.
#[inline(always)]
fn at_least<L: Lane>(number: L, least: f64) -> L {
    if number.to_f64().abs() > least { number } else { L::from_f64(least) }
}

/// `value`, or the number itself where it is tiny.
#[inline(always)]
fn unless_tiny<L: Lane>(number: L, value: L) -> L {
    if number.to_f64().abs() < TINY { number } else { value }
}

impl LaneModel for PointLanes {
    fn idle(&self) -> Body {
        Body::point(Rod { target_energy: 0.5, ..IDLE })
    }

    fn load(&mut self, lane: usize, body: &Body, _: &LaneRunState) {
        self.per_gravity[lane] = 1.0 / body.rod.gravity;
    }

    #[inline(always)]
    fn bounce<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) -> Bounced {
        macro_rules! by {
            ($($feedback:ident),*) => {
                match self.energy_feedback {
                    $(EnergyFeedback::$feedback => {
                        Self::strike::<L>(EnergyFeedback::$feedback, rods, moving, next, scratch)
                    })*
                }
            };
        }
        let tilted_near = by!(Vertical, Total, OneStrike);
        let flown_near = self.fly::<L>(rods, next, scratch);
        Bounced { near: tilted_near & flown_near, common: !any_apart(rods, scratch) }
    }

    #[inline(always)]
    fn arrive(&mut self, _: &Moving, _: &Scratch) {}

    fn arrive_in(&mut self, _: usize, _: &Moving, _: &Scratch) {}

    fn save(&self, _: usize, _: &mut LaneRunState) {}
}
