//! Lasting contact of a catch: from the touchdown on, the table brakes if it moves, and holds the body upright. A polygon that it cannot hold
//! upright is let down on an edge.

use super::gain_schedule::{cart_pole_gain, contact_gain};
use super::outcome::{CatchOutcome, Escape, Reach};
use super::settings::CatchSettings;
use crate::body::Body;
use crate::body::Touch;
use crate::bounce::rod::Rod;
use crate::contact;
use crate::contact::{ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest};
use crate::control::lqr::DesignFailure;
use crate::run::ending::Ending;
use crate::run::rules::Rules;
use crate::stability::contact_regime::ContactRegime;
use std::f64::consts::FRAC_PI_2;

/// Speed of the contact point, m/s, that is rounding: the table stands.
const AT_REST: f64 = 1e-9;

/// The body and the laws of the table in lasting contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing<'a> {
    pub(super) body: &'a Body,
    pub(super) rules: &'a Rules,
    pub(super) regime: ContactRegime,
    pub(super) settings: &'a CatchSettings,
    /// Deceleration of a table that moves along with the body, m/s².
    pub(super) deceleration: f64,
}

/// End of a landing.
#[derive(Clone, Debug)]
pub(super) struct Landed {
    pub(super) hold: Hold,
    pub(super) reach: Reach,
    pub(super) outcome: CatchOutcome,
}

impl Landing<'_> {
    /// The law of the table while it pushes with `push`, m/s².
    ///
    /// # Errors
    /// [`DesignFailure`].
    pub(super) fn law(&self, push: f64) -> Result<HoldLaw, DesignFailure> {
        let CatchSettings { state_weights, input_weight, .. } = *self.settings;
        let rod = &self.body.rod;
        Ok(match self.regime {
            ContactRegime::Frictionless => {
                HoldLaw::Feedback(contact_gain(rod, push, self.regime, state_weights, input_weight)?)
            }
            ContactRegime::VelocityMatched | ContactRegime::Sticking => {
                HoldLaw::CartPole(cart_pole_gain(rod, push, state_weights, input_weight)?)
            }
        })
    }

    /// The lasting contact from a touchdown on; `None` if the caller stopped it.
    ///
    /// # Errors
    /// [`DesignFailure`].
    pub(super) fn land(
        &self,
        touchdown: &ContactStart,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Landed>, DesignFailure> {
        let gravity = self.body.rod.gravity;
        // A table that rises with the body and brakes harder would lose it.
        let speed = touchdown.table_speed;
        let brake = if speed > 0.0 { self.deceleration.min(0.5 * gravity) } else { self.deceleration };
        let push = if speed > 0.0 { gravity - brake } else { gravity + brake };
        let start = ContactStart { table_speed: if speed.abs() < AT_REST { 0.0 } else { speed }, ..*touchdown };
        let request = |law| self.request(start, law, brake);
        let moves = speed.abs() >= self.settings.hold_speed;
        let brake_law = if moves { Some(self.law(push)?) } else { None };
        let upright = HoldRequest { brake_law, ..request(self.law(gravity)?) };
        let mut hold = contact::hold(&upright, go_on);
        if hold.ending == HoldEnding::Stopped {
            return Ok(None);
        }
        let mut outcome = outcome(&hold, self.rules);
        if !outcome.is_caught() && self.body.outline.is_some() {
            let down = contact::hold(&request(HoldLaw::Level), go_on);
            match down.ending {
                HoldEnding::RestsOnEdge { vertices } => {
                    (hold, outcome) = (down, CatchOutcome::RestsOnEdge { vertices });
                }
                HoldEnding::Stopped => return Ok(None),
                _ => {}
            }
        }
        let push = if moves { push } else { gravity };
        Ok(Some(Landed { hold, reach: self.reach(&start, push), outcome }))
    }

    /// Work by which the lasting contact is priced, whatever the touchdown; 0 if there is no law for it.
    pub(super) fn work(&self) -> u64 {
        let gravity = self.body.rod.gravity;
        let of = |law| self.request(ContactStart::default(), law, self.deceleration);
        let brake_law = self.law(gravity + self.deceleration).ok();
        let Ok(law) = self.law(gravity) else { return 0 };
        let upright = HoldRequest { brake: Some(self.deceleration), brake_law, ..of(law) }.work();
        let down = if self.body.outline.is_some() { of(HoldLaw::Level).work() } else { 0 };
        upright + down
    }

    fn request(&self, start: ContactStart, law: HoldLaw, brake: f64) -> HoldRequest {
        let brake = (start.table_speed != 0.0).then_some(brake);
        HoldRequest { brake, ..HoldRequest::new(self.body, self.rules, law, start, self.settings.hold) }
    }

    fn reach(&self, start: &ContactStart, push: f64) -> Reach {
        let Rod { contact_distance: l, radius_of_gyration: rho, .. } = self.body.rod;
        let (turning, limit) = match (self.regime, self.body.friction) {
            (ContactRegime::Frictionless, _) | (_, None) => {
                // Beyond a quarter turn a table pushes down.
                (rho * rho, self.rules.limits.map_or(FRAC_PI_2, |limits| limits.tilt.min(FRAC_PI_2)))
            }
            (ContactRegime::VelocityMatched | ContactRegime::Sticking, Some(friction)) => {
                (rho * rho + l * l, friction.coefficient)
            }
        };
        let growth = (push * l / turning).sqrt();
        Reach { theta: (start.theta + start.theta_dot / growth).abs(), limit }
    }
}

/// Outcome of a catch by the ending of its lasting contact.
fn outcome(hold: &Hold, rules: &Rules) -> CatchOutcome {
    let t = hold.t_end;
    let theta = hold.samples.last().map_or(0.0, |last| last.theta);
    let escaped = |escape| CatchOutcome::Escaped { t, escape };
    let ended = |ending| CatchOutcome::Ended { t, ending };
    match hold.ending {
        HoldEnding::Completed => CatchOutcome::Held,
        HoldEnding::RestsOnEdge { vertices } => CatchOutcome::RestsOnEdge { vertices },
        HoldEnding::Slipped { needed } => escaped(Escape::Slipped { needed }),
        HoldEnding::BeyondLimits(violation) => ended(Ending::BeyondLimits(violation)),
        HoldEnding::Toppled => ended(Ending::Toppled { theta, limit: rules.topple_angle }),
        HoldEnding::OtherVertex(vertex) => ended(Ending::OtherVertex(Touch { vertex, t: 0.0 })),
        HoldEnding::ContactLost => escaped(Escape::ContactLost),
        HoldEnding::TooLong | HoldEnding::Stopped => escaped(Escape::HoldTooLong),
    }
}
