//! The state of a body as the table senses it, and the motion to which its laws lead there: with random errors, and some time before the strike.

use crate::map::body::Body;
use crate::map::flight::{AirDrag, Decay};
use crate::map::friction::Slide;
use crate::map::strike::{PlannedTableMotion, Rod, State, SurfaceMotion, Tilt};
use crate::map::table::control_law::{Gains, Steering, own_motion};
use crate::map::table::noise::{ContactErrors, SensingErrors};
use crate::numbers::number::{Arithmetic, Mask};

/// Use that a table makes of a state that it has sensed some time before the strike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prediction {
    /// Takes it for the state at the strike.
    None,
    /// Carries it on along the flight.
    Flight,
}

names!(Prediction: None => "none", Flight => "flight");

/// A contact as a table senses it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SensedContact<N = f64> {
    pub(crate) x: N,
    pub(crate) state: State<N>,
    /// Error of the angle in the law of the tilt, rad.
    pub(crate) angle_error: N,
}

impl<N: Arithmetic> Body<N> {
    /// A contact at a place (m) and a state; `None` if the table senses place and velocities as they are. `flown` is the time of the flight
    /// so far (s), if it may be shorter than the time from sensing to the strike: the table then takes the state at its beginning.
    #[inline(always)]
    pub(crate) fn sensed(
        &self,
        errors: &ContactErrors<N>,
        gravity: N,
        x: N,
        state: &State<N>,
        flown: Option<N>,
    ) -> Option<SensedContact<N>> {
        let ContactErrors { angle, sensing, horizon, .. } = *errors;
        let lag = if self.lag.is_zero().all() { None } else { Some(self.lag) };
        if sensing.is_none() && lag.is_none() {
            return None;
        }
        let mut sensed = SensedContact { x, state: *state, angle_error: angle };
        if let Some(lag) = lag {
            let back = within(flown, lag);
            (sensed.x, sensed.state) = earlier(self.drag.as_ref(), gravity, (x, state), back);
        }
        if let Some(SensingErrors { x: aside, mut x_dot, mut y_dot, mut theta_dot }) = sensing {
            sensed.x = sensed.x + aside;
            let is_at_once = horizon.is_zero();
            if !is_at_once.all() {
                let ahead = within(flown, horizon);
                let (mut place, mut turn) = (ahead * x_dot, ahead * theta_dot);
                if let Some(drag) = &self.drag {
                    // What is carried on decays as the velocities do.
                    let (of_place, of_turn) = drag.decays(ahead);
                    (place, turn) = (of_place.way * x_dot, of_turn.way * theta_dot);
                    (x_dot, y_dot) = (of_place.left * x_dot, of_place.left * y_dot);
                    theta_dot = of_turn.left * theta_dot;
                }
                sensed.x = N::select(is_at_once, sensed.x, sensed.x + place);
                sensed.angle_error = N::select(is_at_once, angle, angle + turn);
            }
            let State { x_dot: along, y_dot: up, theta_dot: spin, .. } = &mut sensed.state;
            (*along, *up, *spin) = (*along + x_dot, *up + y_dot, *spin + theta_dot);
        }
        if self.is_point {
            sensed.state.theta = N::angle_of(sensed.state.x_dot, -sensed.state.y_dot);
        }
        Some(sensed)
    }

    #[inline(always)]
    fn law(&self, rod: &Rod<N>, sensed: &SensedContact<N>) -> Tilt<N> {
        let SensedContact { x, state, angle_error } = *sensed;
        let read = State { theta: state.theta + angle_error, ..state };
        let Body { steering, constant_tilt, .. } = self;
        let (alpha, _) = steering.angles(rod, x, &read, N::from_f64(0.0), *constant_tilt);
        Tilt::new(state.theta, alpha, state.theta - alpha)
    }

    /// The motion of the table for a contact of a rod at a place (m) and a state, by the place and the velocities that it senses; `None` if
    /// it senses them as they are. `flown` is the time of the flight before it, s, if that may be shorter than the time from sensing to the
    /// strike.
    #[inline(always)]
    pub(crate) fn sensed_motion(
        &self,
        errors: &ContactErrors<N>,
        rod: &Rod<N>,
        x: N,
        state: &State<N>,
        flown: Option<N>,
    ) -> Option<PlannedTableMotion<N>> {
        let sensed = self.sensed(errors, rod.gravity, x, state, flown)?;
        let (friction, tilt) = (self.friction.as_ref(), self.law(rod, &sensed));
        let mut motion = own_motion(rod, friction, &sensed.state, &tilt);
        if let Some(turning) = &self.turning {
            // It turns by the velocities that it senses, and strikes where the contact is.
            let contact = x + rod.contact_distance * state.theta.sincos().0;
            let SurfaceMotion { normal, tangential, is_matched } =
                turning.surface(self.tilt_rate(rod, &sensed.state), contact, &tilt);
            if let Some(speed) = normal {
                motion.normal_velocity = motion.normal_velocity + speed;
            }
            if !(is_matched && friction.is_some_and(|friction| friction.slide == Slide::Matched)) {
                motion.tangential_velocity = motion.tangential_velocity + tangential;
            }
        }
        Some(motion)
    }
}

/// A time, or that of the flight so far if that is shorter, s.
// A function, since closures are not compiled for the vectors of lanes.
#[inline(always)]
fn within<N: Arithmetic>(flown: Option<N>, time: N) -> N {
    match flown {
        Some(flown) => N::select(flown.is_less(time), flown, time),
        None => time,
    }
}

/// The place (m) and the state of a flight `back` s before those given.
#[inline(always)]
fn earlier<N: Arithmetic>(drag: Option<&AirDrag<N>>, gravity: N, (x, state): (N, &State<N>), back: N) -> (N, State<N>) {
    let State { theta, x_dot, y_dot, theta_dot } = *state;
    let Some(drag) = drag else {
        let then = State { theta: theta - back * theta_dot, y_dot: y_dot + gravity * back, ..*state };
        return (x - back * x_dot, then);
    };
    let (way, then) = drag.before(&drag.decays(back), gravity, state);
    (x - way, then)
}

impl Steering {
    /// The state feedback by which a table tilts that takes the state `lag` s before the strike for that at the strike: the flight goes on
    /// with ẋ and θ̇, so −K·(x − τẋ, θ − τθ̇, ẋ, θ̇) has the gains K_ẋ − τK_x and K_θ̇ − τK_θ. In air velocities were e^(cτ) times as large, and
    /// ways (e^(cτ) − 1)/c.
    pub(crate) fn lagging(&self, tilt_gain: f64, lag: f64, drag: Option<&AirDrag>) -> Gains {
        let still = Decay::new(0.0, lag);
        let (place, turn) = drag.map_or((still, still), |drag| drag.decays(lag));
        let Gains { x, theta, x_dot, theta_dot } = match *self {
            Self::TiltGain => Gains { x: 0.0, theta: -tilt_gain, x_dot: 0.0, theta_dot: 0.0 },
            Self::Feedback(gains) => gains,
        };
        Gains {
            x,
            theta,
            x_dot: (x_dot - place.way * x) / place.left,
            theta_dot: (theta_dot - turn.way * theta) / turn.left,
        }
    }
}
