//! The control law of the table: its tilt as a function of what it senses.

use crate::map::flight::AirDrag;
use crate::map::friction::Friction;
use crate::map::strike::{PlannedTableMotion, Rod, State, Tilt};
use crate::numbers::number::Arithmetic;

/// Control law of the tilt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Steering<N = f64> {
    /// α = κθ.
    TiltGain,
    /// α = −K·(x, θ, ẋ, θ̇).
    Feedback(Gains<N>),
}

/// K of a state feedback.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gains<N = f64> {
    /// rad/m.
    pub x: N,
    /// 1.
    pub theta: N,
    /// rad·s/m.
    pub x_dot: N,
    /// s.
    pub theta_dot: N,
}

mapped!(Gains: x, theta, x_dot, theta_dot);

impl<N: Copy> Steering<N> {
    /// The same law in other numbers.
    #[inline(always)]
    pub(crate) fn map<M: Arithmetic>(&self, function: impl Fn(N) -> M) -> Steering<M> {
        match self {
            Self::TiltGain => Steering::TiltGain,
            Self::Feedback(gains) => Steering::Feedback(gains.map(function)),
        }
    }

    /// Goes through the gains with those of another feedback.
    pub(crate) fn zip<M: Copy>(&mut self, other: &Steering<M>, visit: &mut impl FnMut(&mut N, M)) {
        if let (Self::Feedback(gains), Steering::Feedback(other)) = (self, other) {
            gains.zip(other, visit);
        }
    }
}

impl<N: Arithmetic> Gains<N> {
    /// α, rad, at a place of the centre of gravity (m) and a state.
    #[inline(always)]
    pub fn tilt(&self, x: N, state: &State<N>) -> N {
        -(self.x * x + self.theta * state.theta + self.x_dot * state.x_dot + self.theta_dot * state.theta_dot)
    }

    /// α̇, rad/s, in a flight of a body whose angle changes at the rate `turn` (rad/s): the air alone changes ẋ and θ̇ there.
    #[inline(always)]
    fn tilt_rate(&self, state: &State<N>, turn: N, drag: Option<&AirDrag<N>>) -> N {
        let State { x_dot, y_dot, theta_dot, .. } = *state;
        let rate = self.x * x_dot + self.theta * turn;
        let Some(drag) = drag else { return -rate };
        let [along, _, spin] = drag.taken([x_dot, y_dot, theta_dot]);
        -(rate - (self.x_dot * along + self.theta_dot * spin))
    }
}

impl<N: Arithmetic> Steering<N> {
    /// Tilt rate of a table that follows its law in a flight of a body whose angle changes at the rate `turn`, both in rad/s.
    #[inline(always)]
    pub(crate) fn tilt_rate(&self, rod: &Rod<N>, state: &State<N>, turn: N, drag: Option<&AirDrag<N>>) -> N {
        match self {
            Self::TiltGain => rod.tilt_gain * turn,
            Self::Feedback(gains) => gains.tilt_rate(state, turn, drag),
        }
    }

    /// α, the table's tilt at a place and a state, and θ − α, with an error of the sensed angle and a constant tilt beside the law; all in rad.
    #[inline(always)]
    pub(crate) fn angles(&self, rod: &Rod<N>, x: N, state: &State<N>, error: N, constant: N) -> (N, N) {
        let theta = state.theta;
        let sensed = State { theta: theta + error, ..*state };
        let is_constant_zero = constant.is_zero();
        let own = error.is_zero() & is_constant_zero;
        let by_law = match self {
            Self::TiltGain => rod.tilt_gain * N::select(own, theta, sensed.theta),
            Self::Feedback(gains) => gains.tilt(x, &sensed),
        };
        // A sum with 0 would lose the sign of −0.
        let alpha = N::select(is_constant_zero, by_law, by_law + constant);
        let beta = match self {
            // The rod's own, without the rounding of θ − κθ.
            Self::TiltGain => N::select(own, (N::from_f64(1.0) - rod.tilt_gain) * theta, theta - alpha),
            Self::Feedback(_) => theta - alpha,
        };
        (alpha, beta)
    }
}

/// Motion of a table that follows its own law, for a state that it foresees at this tilt.
#[inline(always)]
pub(crate) fn own_motion<N: Arithmetic>(
    rod: &Rod<N>,
    friction: Option<&Friction<N>>,
    seen: &State<N>,
    tilt: &Tilt<N>,
) -> PlannedTableMotion<N> {
    let Tilt { alpha, sin_alpha, cos_alpha, .. } = *tilt;
    let (table_x, table_y) = rod.strike_with(seen, tilt, rod.leverage()).table_velocity;
    let tangential_velocity = match friction {
        Some(friction) => friction.table_speed(rod, seen, tilt),
        None => N::from_f64(0.0),
    };
    PlannedTableMotion { alpha, normal_velocity: cos_alpha * table_y - sin_alpha * table_x, tangential_velocity }
}
