//! The ballistic flight of the rod between two contacts, in closed form.
//!
//! Not here: which root of the gap is the next contact ([`crate::bounce::contact_time`]).

use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::strike::Strike;
use crate::numbers::number::{Arithmetic, Number};

/// A flight, from the moment it starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight<N = f64> {
    /// Angle and velocities at its start.
    pub start: State<N>,
    /// sin θ, cos θ at its start.
    pub sin_cos_theta: (N, N),
    /// h₀, height of the contact point above y = 0 at its start, m: 0 after a strike.
    pub clearance: N,
    /// l, m.
    pub contact_distance: N,
    /// G, m/s².
    pub gravity: N,
}

/// The gap between contact point and y = 0 with its derivatives in time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap<N = f64> {
    /// g, m.
    pub value: N,
    /// g', m/s: the vertical velocity of the contact point.
    pub slope: N,
    /// g'', m/s².
    pub bend: N,
}

impl<N: Number> Gap<N> {
    /// Tells whether a contact point that is at y = 0 goes down from there or stays.
    #[inline(always)]
    pub(crate) fn falls(&self) -> bool {
        let slope = self.slope.to_f64();
        slope < 0.0 || (slope == 0.0 && self.bend.to_f64() <= 0.0)
    }
}

impl<N: Copy> Flight<N> {
    /// The same flight in other numbers.
    #[inline(always)]
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> Flight<M> {
        Flight {
            start: self.start.map(&function),
            sin_cos_theta: (function(self.sin_cos_theta.0), function(self.sin_cos_theta.1)),
            clearance: function(self.clearance),
            contact_distance: function(self.contact_distance),
            gravity: function(self.gravity),
        }
    }
}

impl<N: Arithmetic> Flight<N> {
    /// g(t) = h₀ + ẏt − ½Gt² + l cos θ − l cos(θ + θ̇t), eq. (8).
    ///
    /// The two cosines are written as l (sin θ sin u + cos θ (1 − cos u)), u = θ̇t, so that with h₀ = 0 the trivial root
    /// t = 0 is divided out analytically and short flights keep their relative accuracy.
    #[inline(always)]
    pub fn gap(&self, t: N) -> Gap<N> {
        self.gap_turned(t, (self.start.theta_dot * t).sin_versine())
    }

    /// [`Flight::gap`] with sin u and 1 − cos u.
    #[inline(always)]
    pub(crate) fn gap_turned(&self, t: N, (sin, versine): (N, N)) -> Gap<N> {
        let State { y_dot, theta_dot, .. } = self.start;
        let (sin_theta, cos_theta) = self.sin_cos_theta;
        let (reach_x, reach_y) = (self.contact_distance * sin_theta, self.contact_distance * cos_theta);
        let spin = self.contact_distance * theta_dot;
        let (speed_x, speed_y) = (spin * cos_theta, spin * sin_theta);
        let fall = self.gravity * t;
        let turned = speed_x * sin - speed_y * versine;
        Gap {
            value: (self.clearance + t * (y_dot - N::from_f64(0.5) * fall)) + (reach_x * sin + reach_y * versine),
            slope: ((y_dot + speed_y) - fall) + turned,
            bend: (speed_x - (speed_x * versine + speed_y * sin)) * theta_dot - self.gravity,
        }
    }

    /// Angle and velocities after a time `t`.
    #[inline(always)]
    pub fn end(&self, t: N) -> State<N> {
        let State { theta, x_dot, y_dot, theta_dot } = self.start;
        State { theta: theta + theta_dot * t, x_dot, y_dot: y_dot - self.gravity * t, theta_dot }
    }

    /// l θ̇², m/s²: up to G the gap is concave.
    #[inline(always)]
    pub(crate) fn bulge(&self) -> N {
        self.contact_distance * self.start.theta_dot * self.start.theta_dot
    }
}

impl<N: Number> Flight<N> {
    /// A root of the gap found in doubles, carried over to this kind of number by Newton's iteration: in dual numbers that
    /// is the exact derivative of the implicit contact time, ∂τ = −∂g/ẏ_c⁻.
    #[inline(always)]
    pub fn lift_root(&self, root: f64) -> N {
        lifted(root, |t| self.gap(t))
    }
}

/// A root of a gap found in doubles, carried over to this kind of number.
#[inline(always)]
pub(crate) fn lifted<N: Number>(root: f64, gap: impl Fn(N) -> Gap<N>) -> N {
    let mut t = N::from_f64(root);
    for _ in 0..N::NEWTON_STEPS {
        let gap = gap(t);
        t = t - gap.value / gap.slope;
    }
    t
}

impl<N: Arithmetic> Rod<N> {
    /// The flight that follows a strike.
    #[inline(always)]
    pub fn flight(&self, strike: &Strike<N>) -> Flight<N> {
        Flight {
            start: strike.after,
            sin_cos_theta: strike.sin_cos_theta,
            clearance: N::from_f64(0.0),
            contact_distance: self.contact_distance,
            gravity: self.gravity,
        }
    }
}
