//! Angle and velocities of a body at a contact.

/// Angle and velocities of the rod just before a contact; the horizontal place is carried beside it, since nothing
/// depends on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<N = f64> {
    /// Angle from upright, counter-clockwise, rad.
    pub theta: N,
    /// Horizontal velocity of the centre of gravity, m/s.
    pub x_dot: N,
    /// Vertical velocity of the centre of gravity, m/s.
    pub y_dot: N,
    /// Angular velocity, rad/s.
    pub theta_dot: N,
}

impl<N: Copy> State<N> {
    /// The same state in other numbers.
    #[inline(always)]
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> State<M> {
        State {
            theta: function(self.theta),
            x_dot: function(self.x_dot),
            y_dot: function(self.y_dot),
            theta_dot: function(self.theta_dot),
        }
    }
}
