//! The terms of the exact map that one bounce of the linear solution leaves out.

/// Sizes of the terms that one bounce leaves out: of θ, u, ẋ beside its law, ẏ and the flight time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct TruncationError {
    pub(super) theta: f64,
    pub(super) u: f64,
    /// θ and u together, in the norm that the rotation keeps.
    pub(super) turned: f64,
    pub(super) drift: f64,
    pub(super) y_dot: f64,
    pub(super) t: f64,
}

impl TruncationError {
    pub(super) fn or(self, other: Self) -> Self {
        Self {
            theta: self.theta.max(other.theta),
            u: self.u.max(other.u),
            turned: self.turned.max(other.turned),
            drift: self.drift.max(other.drift),
            y_dot: self.y_dot.max(other.y_dot),
            t: self.t.max(other.t),
        }
    }
}
