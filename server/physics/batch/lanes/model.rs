//! A model as lanes see it: how all of them bounce.

use super::number::Lane;
use super::state::{Moving, Rods, Scratch};
use crate::body::Body;
use crate::run::orbit::LaneRunState;

/// Result of a bounce of all lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounced {
    /// True where all angles were in the reach of [`Near`].
    pub(crate) near: bool,
    /// True where it was a common one in all lanes; else see [`Scratch::apart`].
    pub(crate) common: bool,
}

/// A model whose bounces lanes can make, with the numbers of each lane that [`Rods`] and [`Moving`] have not.
pub(crate) trait LaneModel {
    /// The body of a lane that idles: it bounces upright, for ever, and nobody looks.
    fn idle(&self) -> Body;

    /// Puts a run into a lane.
    fn load(&mut self, lane: usize, body: &Body, lane_state: &LaneRunState);

    /// The bounce of all lanes from `moving` to `next`, but not of those that it sets apart ([`Scratch::apart`]): their run may end here,
    /// an angle may be beyond the reach of `L`, or their contact time is not a common one.
    fn bounce<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) -> Bounced;

    /// Goes on to the end of a bounce: of all lanes, or of one.
    fn arrive(&mut self, next: &Moving, scratch: &Scratch);

    /// [`LaneModel::arrive`] of one lane.
    fn arrive_in(&mut self, lane: usize, next: &Moving, scratch: &Scratch);

    /// Writes what it keeps of the run in a lane.
    fn save(&self, lane: usize, lane_state: &mut LaneRunState);
}
