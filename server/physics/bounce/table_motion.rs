//! The motion of a table at a strike, where it is not that of its law alone: planned before the contact, or turning as it strikes.

use crate::bounce::flight::Flight;
use crate::bounce::state::State;
use crate::bounce::tilt::Tilt;
use crate::numbers::number::Arithmetic;

/// A table that moves as it was planned before the contact, whatever it then meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedTableMotion<N = f64> {
    /// α, rad.
    pub alpha: N,
    /// The table's velocity along its normal, m/s.
    pub normal_velocity: N,
    /// The table's velocity along itself, m/s.
    pub tangential_velocity: N,
}

/// Velocity that a turning table has at the contact beside that of its law, m/s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceMotion<N = f64> {
    /// Along its normal; `None` if the law of the table has taken it off, or the pivot is under the contact.
    pub normal: Option<N>,
    /// Along itself.
    pub tangential: N,
    /// True if a table that moves along itself with the contact point takes this velocity into account.
    pub is_matched: bool,
}

/// Motion of the table that a contact meets.
#[derive(Clone, Copy, Debug)]
pub(crate) enum TableMotion<'a, N> {
    /// That of its law.
    ByLaw,
    /// One that was planned.
    Planned(&'a PlannedTableMotion<N>),
    /// That of its law, and of its turning beside it.
    Turning(&'a SurfaceMotion<N>),
}

impl<N: Copy> PlannedTableMotion<N> {
    /// The same motion in other numbers.
    pub(crate) fn map<M>(&self, function: impl Fn(N) -> M) -> PlannedTableMotion<M> {
        PlannedTableMotion {
            alpha: function(self.alpha),
            normal_velocity: function(self.normal_velocity),
            tangential_velocity: function(self.tangential_velocity),
        }
    }
}

impl<N: Arithmetic> PlannedTableMotion<N> {
    /// A flight as seen from the planned table, a plane that moves along its normal. It was set out to strike the state `seen` at the time
    /// `struck` (s), with the contact at y = 0.
    ///
    /// The body flies as over a level table: with β for θ, and gravity's part along the normal.
    #[inline(always)]
    pub(crate) fn relative(&self, flight: &Flight<N>, struck: N, seen: &State<N>) -> Flight<N> {
        let alpha = self.alpha;
        let Tilt { sin_theta, sin_alpha, cos_alpha, .. } = Tilt::new(seen.theta, alpha, seen.theta - alpha);
        let length = flight.contact_distance;
        let State { theta, x_dot, y_dot, theta_dot } = flight.start;
        let (sin, cos) = flight.sin_cos_theta;
        // The contact point at the start of the flight, from the planned one at the planned time.
        let across = length * (sin - sin_theta) - flight.travel(struck).0;
        let above = flight.clearance * cos_alpha - sin_alpha * across + self.normal_velocity * struck;
        Flight {
            start: State {
                theta: theta - alpha,
                x_dot: N::from_f64(0.0),
                y_dot: cos_alpha * y_dot - sin_alpha * x_dot - self.normal_velocity,
                theta_dot,
            },
            sin_cos_theta: (sin * cos_alpha - cos * sin_alpha, cos * cos_alpha + sin * sin_alpha),
            clearance: above,
            contact_distance: length,
            gravity: match flight.drag {
                None => flight.gravity * cos_alpha,
                // The air stands still and moves past the plane.
                Some(drag) => flight.gravity * cos_alpha + drag.linear * self.normal_velocity,
            },
            drag: flight.drag,
        }
    }
}
