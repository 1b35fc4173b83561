//! Guidance of the table: the motion for each coming contact, by the strategy of the catch.

use super::aim::Aim;
use super::gain_schedule::GainSchedule;
use super::outcome::{CatchNote, Escape};
use super::settings::Approach;
use crate::body::PreImpact;
use crate::body::general::Guide;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::bounce::table_motion::PlannedTableMotion;

/// Decision of the table for a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Guidance {
    /// A strike that aims at this height ratio.
    Strike {
        /// r.
        ratio: f64,
    },
    /// No strike: it meets the body at the speed of the contact point, and stays with it.
    Touch,
    /// It cannot go on.
    GiveUp(Escape),
}

/// Guide of a catch. It decides contact by contact, from what it senses and believes.
#[derive(Clone, Debug)]
pub struct Catcher {
    /// The rod with the restitution that the table believes in.
    believed: Rod,
    /// μ.
    friction: f64,
    approach: Approach,
    schedule: GainSchedule,
    /// The last decision.
    pub(super) guidance: Guidance,
    /// Facts noticed on the way.
    pub(super) notes: Vec<CatchNote>,
}

impl Catcher {
    /// A guide by `approach`, for a contact with friction μ, with a rod of the believed restitution.
    pub(super) fn new(believed: Rod, friction: f64, approach: Approach, schedule: GainSchedule) -> Self {
        Self { believed, friction, approach, schedule, guidance: Guidance::Touch, notes: Vec::new() }
    }

    /// A strike of `ratio` at the tilt of the gain schedule; `error` of the sensed angle in rad.
    fn bounce_down(&mut self, seen: &PreImpact, error: f64) -> Option<PlannedTableMotion> {
        let speed = -self.believed.contact_speed(&seen.state);
        let Ok(gains) = self.schedule.gain(speed) else {
            self.guidance = Guidance::GiveUp(Escape::NoLaw(speed));
            return None;
        };
        let sensed = State { theta: seen.state.theta + error, ..seen.state };
        self.aim(seen, gains.tilt(seen.x, &sensed), self.schedule.ratio)
    }

    /// A strike at tilt `alpha` (rad) with the height ratio `ratio`.
    fn aim(&mut self, seen: &PreImpact, alpha: f64, ratio: f64) -> Option<PlannedTableMotion> {
        let aim = Aim::new(&self.believed, self.friction, &seen.state, alpha);
        let impulse = aim.impulse_for(ratio);
        if impulse.is_nan() || impulse <= 0.0 {
            self.guidance = Guidance::GiveUp(Escape::NoLift(alpha));
            return None;
        }
        self.guidance = Guidance::Strike { ratio };
        Some(aim.motion(impulse))
    }
}

impl Guide for Catcher {
    fn motion(&mut self, seen: &PreImpact, angle_error: f64) -> Option<PlannedTableMotion> {
        if self.believed.contact_speed(&seen.state) >= 0.0 {
            // Struck early or late while it rises: the table follows it.
            self.guidance = Guidance::Touch;
            return None;
        }
        match self.approach {
            Approach::BounceDown { .. } | Approach::Plan { .. } => self.bounce_down(seen, angle_error),
            Approach::Brake { .. } => {
                self.guidance = Guidance::Touch;
                None
            }
        }
    }
}
