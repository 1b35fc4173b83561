//! The control law of the table: its tilt as a function of what it senses.

use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::tilt::Tilt;
use crate::numbers::number::Number;

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

impl<N: Number> Gains<N> {
    /// α, rad, at a place of the centre of gravity (m) and a state.
    #[inline(always)]
    pub fn tilt(&self, x: N, state: &State<N>) -> N {
        -(self.x * x + self.theta * state.theta + self.x_dot * state.x_dot + self.theta_dot * state.theta_dot)
    }
}

impl Steering {
    /// The table's tilt at a place and a state, in any kind of number.
    pub(crate) fn tilt<N: Number>(&self, rod: &Rod<N>, x: N, state: &State<N>) -> Tilt<N> {
        let Self::Feedback(gains) = self else { return rod.tilt(state.theta) };
        let [x_gain, theta, x_dot, theta_dot] = [gains.x, gains.theta, gains.x_dot, gains.theta_dot].map(N::from_f64);
        let alpha = Gains { x: x_gain, theta, x_dot, theta_dot }.tilt(x, state);
        Tilt::new(state.theta, alpha, state.theta - alpha)
    }
}
