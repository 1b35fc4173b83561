//! A table that turns as it strikes: where its pivot is, and the velocity that its surface has at the contact by that.
//!
//! The pivot stands at a fixed place on a carriage that brings the surface to the height of the contact, or under the contact wherever
//! that is. So tilting changes no contact height, and the contact time is that of a table that does not turn.

use crate::map::friction::{Friction, Slide};
use crate::map::strike::{SurfaceMotion, Tilt};
use crate::numbers::number::{Arithmetic, Number};

/// Tilt rate of the table at a strike, and its effect on the table's speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TiltRate {
    /// The table does not turn.
    None,
    /// It turns as it follows its law, beside its speed.
    Follows,
    /// It turns so, and the law takes it off its speed.
    Corrected,
}

names!(TiltRate: None => "none", Follows => "follows", Corrected => "corrected");

/// A table that turns as it strikes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurningTable<N = f64> {
    /// x_p, horizontal place of the pivot, m; `None` for one under the contact.
    pub place: Option<N>,
    /// p, depth of the pivot below the surface, along the table's normal, m.
    pub depth: N,
    /// True if the law takes the velocity by the turning off its own.
    pub is_corrected: bool,
}

mapped!(TurningTable: depth; optional place; same is_corrected);

impl<N: Arithmetic> TurningTable<N> {
    /// Tells whether the turning changes the table's speed along its normal.
    pub fn strikes(&self) -> bool {
        self.place.is_some() && !self.is_corrected
    }

    /// Velocity of the surface at a contact point at `contact` (m) by the turning of a table that is tilted like this, at its tilt rate
    /// (rad/s).
    ///
    /// The contact is at a·t + p·n from the pivot, so that x_p + a cos α − p sin α is its place, and moves at α̇ (a n − p t).
    #[inline(always)]
    pub(crate) fn surface(&self, rate: N, contact: N, tilt: &Tilt<N>) -> SurfaceMotion<N> {
        let depth = self.depth;
        let normal = match self.place {
            Some(place) if !self.is_corrected => {
                Some(rate * ((contact - place + depth * tilt.sin_alpha) / tilt.cos_alpha))
            }
            Some(_) | None => None,
        };
        SurfaceMotion { normal, tangential: -(rate * depth), is_matched: self.is_corrected }
    }
}

impl<N: Number> TurningTable<N> {
    /// Tells whether the turning drags the contact point along.
    pub fn drags(&self, friction: Option<&Friction<N>>) -> bool {
        !self.depth.is_zero()
            && friction.is_some_and(|friction| {
                let is_matched = friction.slide == Slide::Matched && self.is_corrected;
                !friction.coefficient.is_zero() && !is_matched
            })
    }

    /// Tells whether the turning changes the motion of a body.
    pub fn acts(&self, friction: Option<&Friction<N>>) -> bool {
        self.strikes() || self.drags(friction)
    }
}
