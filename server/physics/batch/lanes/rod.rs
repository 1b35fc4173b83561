//! Bodies with an angle in lanes: a kind of contact and a law of the tilt.

use super::contact::Surface;
use super::model::{Bounced, LaneModel};
use super::number::Lane;
use super::outline::OutlineLanes;
use super::state::{Moving, Rods, Scratch};
use super::steering::SteeringLanes;
use super::step::bounce_rods;
use crate::body::Body;
use crate::bounce::strike::{EnergyFeedback, Rod};
use crate::run::orbit::LaneRunState;

/// Bodies with an angle.
#[derive(Clone, Debug)]
pub(crate) struct RodLanes<S> {
    pub(crate) surface: S,
    pub(crate) steering: SteeringLanes,
    /// Outlines of polygons.
    pub(crate) outline: Option<OutlineLanes>,
}

/// A rod that bounces upright, for ever.
pub(super) const IDLE: Rod = Rod {
    contact_distance: 1.0,
    radius_of_gyration: 1.0,
    gravity: 1.0,
    restitution: 1.0,
    tilt_gain: 1.0,
    strike_gain: 2.0,
    strike_gain_per_energy: 0.0,
    // Its own energy, so that no feedback changes it.
    target_energy: 1.5,
    energy_feedback: EnergyFeedback::Vertical,
};

impl<S: Surface> LaneModel for RodLanes<S> {
    fn idle(&self) -> Body {
        Body::plain(IDLE)
    }

    #[inline(always)]
    fn load(&mut self, lane: usize, body: &Body, lane_state: &LaneRunState) {
        self.surface.load(lane, body);
        self.steering.load(lane, body, lane_state);
        if let Some(outline) = &mut self.outline {
            outline.load(lane, body.outline.as_ref());
        }
    }

    #[inline(always)]
    fn bounce<L: Lane>(&self, rods: &Rods, moving: &Moving, next: &mut Moving, scratch: &mut Scratch) -> Bounced {
        bounce_rods::<L, S>(&self.surface, &self.steering, self.outline.as_ref(), rods, moving, next, scratch)
    }

    #[inline(always)]
    fn arrive(&mut self, next: &Moving, scratch: &Scratch) {
        self.steering.arrive(next, scratch);
    }

    fn arrive_in(&mut self, lane: usize, next: &Moving, scratch: &Scratch) {
        self.steering.arrive_in(lane, next, scratch);
    }

    fn save(&self, lane: usize, lane_state: &mut LaneRunState) {
        self.steering.save(lane, lane_state);
    }
}
