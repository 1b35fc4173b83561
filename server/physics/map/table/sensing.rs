//! The state of a body as the table senses it, and the motion to which its laws lead there: with random errors, and some time before the strike.
//!
//! Not here: the errors themselves ([`crate::map::table::noise`]), and the error of an angle alone, which turns the table and changes nothing else.

use crate::map::friction::Friction;
use crate::map::strike::{PlannedTableMotion, Rod, State, Tilt};
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

/// The laws of a table, and how it senses a contact.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SensingTable<'a, N> {
    pub(crate) steering: &'a Steering<N>,
    /// Tilt beside the law, rad.
    pub(crate) constant_tilt: N,
    pub(crate) friction: Option<&'a Friction<N>>,
    pub(crate) errors: &'a ContactErrors<N>,
    /// Time from sensing to the strike over which the table does not carry the state on, s; `None` for none.
    pub(crate) lag: Option<N>,
}

/// A contact as a table senses it.
#[derive(Clone, Copy, Debug)]
struct SensedContact<N> {
    x: N,
    state: State<N>,
    /// Error of the angle in the law of the tilt, rad.
    angle_error: N,
}

impl<N: Arithmetic> SensingTable<'_, N> {
    /// A contact at a place (m) and a state; `None` if the table senses place and velocities as they are. `flown` is the time of the flight
    /// so far (s), if it may be shorter than the time from sensing to the strike: the table then takes the state at its beginning.
    #[inline(always)]
    fn sensed(&self, gravity: N, x: N, state: &State<N>, flown: Option<N>) -> Option<SensedContact<N>> {
        let ContactErrors { angle, sensing, horizon, .. } = *self.errors;
        if sensing.is_none() && self.lag.is_none() {
            return None;
        }
        let within = |time: N| match flown {
            Some(flown) => N::select(flown.is_less(time), flown, time),
            None => time,
        };
        let mut sensed = SensedContact { x, state: *state, angle_error: angle };
        if let Some(lag) = self.lag {
            let back = within(lag);
            sensed.x = x - back * state.x_dot;
            sensed.state.theta = state.theta - back * state.theta_dot;
            sensed.state.y_dot = state.y_dot + gravity * back;
        }
        if let Some(SensingErrors { x: aside, x_dot, y_dot, theta_dot }) = sensing {
            sensed.x = sensed.x + aside;
            sensed.state.x_dot = state.x_dot + x_dot;
            sensed.state.y_dot = sensed.state.y_dot + y_dot;
            sensed.state.theta_dot = state.theta_dot + theta_dot;
            let is_at_once = horizon.is_zero();
            if !is_at_once.all() {
                let ahead = within(horizon);
                sensed.x = N::select(is_at_once, sensed.x, sensed.x + ahead * x_dot);
                sensed.angle_error = N::select(is_at_once, angle, angle + ahead * theta_dot);
            }
        }
        Some(sensed)
    }

    #[inline(always)]
    fn law(&self, rod: &Rod<N>, sensed: &SensedContact<N>) -> Tilt<N> {
        let SensedContact { x, state, angle_error } = *sensed;
        let read = State { theta: state.theta + angle_error, ..state };
        let (alpha, _) = self.steering.angles(rod, x, &read, N::from_f64(0.0), self.constant_tilt);
        Tilt::new(state.theta, alpha, state.theta - alpha)
    }

    /// The motion of the table for a contact of a rod at a place (m) and a state, by the place and the velocities that it senses; `None` if
    /// it senses them as they are. `flown` is the time of the flight before it, s, if that may be shorter than the time from sensing to the
    /// strike.
    #[inline(always)]
    pub(crate) fn motion(
        &self,
        rod: &Rod<N>,
        x: N,
        state: &State<N>,
        flown: Option<N>,
    ) -> Option<PlannedTableMotion<N>> {
        let sensed = self.sensed(rod.gravity, x, state, flown)?;
        Some(own_motion(rod, self.friction, &sensed.state, &self.law(rod, &sensed)))
    }
}

impl Steering {
    /// The state feedback by which a table tilts that takes the state `lag` s before the strike for that at the strike: the flight goes on
    /// with ẋ and θ̇, so −K·(x − τẋ, θ − τθ̇, ẋ, θ̇) has the gains K_ẋ − τK_x and K_θ̇ − τK_θ.
    pub(crate) fn lagging(&self, tilt_gain: f64, lag: f64) -> Gains {
        match *self {
            Self::TiltGain => Gains { x: 0.0, theta: -tilt_gain, x_dot: 0.0, theta_dot: lag * tilt_gain },
            Self::Feedback(Gains { x, theta, x_dot, theta_dot }) => {
                Gains { x, theta, x_dot: x_dot - lag * x, theta_dot: theta_dot - lag * theta }
            }
        }
    }
}
