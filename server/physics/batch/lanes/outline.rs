//! Outlines of polygons in lanes: a test of all vertices at once that sets a lane apart where another one may touch the table.

use super::state::{Lanes, Moving, Rods, Scratch, WIDTH, unless};
use crate::body::polygon::{ClearAngles, Outline};

/// Farthest way of a flight, in sizes of the body, of which rounding is surely less than the depth at which a vertex is flush
/// ([`crate::body::polygon::FLUSH`]).
const FARTHEST_WAY: f64 = 1e4;

/// Numbers of the outlines that a common bounce needs.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct OutlineLanes {
    least_angle: Lanes,
    greatest_angle: Lanes,
    reach: Lanes,
    size: Lanes,
}

impl OutlineLanes {
    /// Outlines whose other vertices never touch.
    pub(crate) fn new() -> Self {
        Self {
            least_angle: [f64::NEG_INFINITY; WIDTH],
            greatest_angle: [f64::INFINITY; WIDTH],
            reach: [0.0; WIDTH],
            size: [f64::INFINITY; WIDTH],
        }
    }

    /// Puts the outline of a body into a lane.
    pub(super) fn load(&mut self, lane: usize, outline: Option<&Outline>) {
        let clear = outline.map_or(ClearAngles::ALL, Outline::clear_angles);
        (self.least_angle[lane], self.greatest_angle[lane]) = (clear.least, clear.greatest);
        self.reach[lane] = outline.map_or(0.0, Outline::reach);
        self.size[lane] = outline.map_or(f64::INFINITY, Outline::size);
    }

    /// Sets lanes apart in which another vertex may be below the table at the contact, or may come down in the flight before it ends at
    /// [`Scratch::t`] at y = 0, as [`Outline::below_table`] and [`Outline::first_touch`] find out.
    #[inline(always)]
    pub(super) fn watch(&self, rods: &Rods, moving: &Moving, next: &Moving, scratch: &mut Scratch) {
        for lane in 0..WIDTH {
            let clear = ClearAngles { least: self.least_angle[lane], greatest: self.greatest_angle[lane] };
            let beta = moving.theta[lane] - scratch.alpha[lane];
            let theta_dot = next.theta_dot[lane];
            let way = scratch.y_dot[lane].abs() * scratch.t[lane];
            let is_clear = clear.contain(beta)
                & clear.contain(next.theta[lane])
                & (self.reach[lane] * theta_dot * theta_dot <= rods.gravity[lane])
                & (way <= FARTHEST_WAY * self.size[lane]);
            scratch.apart[lane] |= unless(is_clear);
        }
    }
}
