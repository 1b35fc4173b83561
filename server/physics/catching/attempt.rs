//! One attempt at a catch with a given strategy: its strikes and its lasting contact.

use super::descent::{ComingContact, Descent, DescentEnd, Touchdown};
use super::gain_schedule::GainSchedule;
use super::guidance::Catcher;
use super::landing::{Landed, Landing};
use super::outcome::{CatchDemand, CatchFailure, CatchNote, CatchOutcome, Escape, Fall};
use super::plan::StrikesReason;
use super::settings::{Approach, CatchSettings, DEFAULT_RATIO};
use crate::body::bounce::Guide;
use crate::body::{Arrival, Body, NoContact, PreImpact};
use crate::bounce::friction::{Friction, Slide};
use crate::bounce::strike::Rod;
use crate::scene::Scene;
use crate::stability::contact_regime::ContactRegime;

/// Start of a catch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CatchStart {
    /// The release of the scene.
    Release,
    /// A contact under way.
    Contact(ComingContact),
}

/// An attempt.
#[derive(Clone, Debug)]
pub(super) struct Attempt {
    pub(super) approach: Approach,
    /// Reason for the number of strikes of a plan, if it was chosen.
    pub(super) strikes_reason: Option<StrikesReason>,
    pub(super) descent: Descent,
    pub(super) touchdown: Option<Touchdown>,
    pub(super) landed: Option<Landed>,
    /// Facts that the guide noticed.
    pub(super) notes: Vec<CatchNote>,
    pub(super) outcome: CatchOutcome,
}

impl Attempt {
    /// Tries to catch the body of a scene.
    ///
    /// # Errors
    /// [`CatchFailure`].
    pub(super) fn new(
        scene: &Scene,
        settings: &CatchSettings,
        approach: Approach,
        start: CatchStart,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Self, CatchFailure> {
        let rod: Rod = scene.parameters();
        let rules = scene.rules();
        let (body, regime) = guided_body(scene);
        let landing = Landing {
            body: &body,
            rules: &rules,
            regime,
            settings,
            deceleration: settings.brake.unwrap_or(rod.gravity),
        };
        // No law in contact, no catch: known before the first strike.
        landing.law(rod.gravity).map_err(CatchFailure::NoLaw)?;
        let ratio = match approach {
            Approach::BounceDown { ratio } | Approach::Plan { ratio, .. } => ratio,
            Approach::Brake { .. } => DEFAULT_RATIO,
        };
        let CatchSettings { state_weights, input_weight, .. } = *settings;
        let schedule = GainSchedule { rod, regime, ratio, state_weights, input_weight };
        let believed = Rod { restitution: scene.assumed_restitution(), ..rod };
        let friction = body.friction.map_or(0.0, |friction| friction.coefficient);
        let mut catcher = Catcher::new(believed, friction, approach, schedule, rules.limits.as_ref(), go_on);
        if settings.strikes.is_none() {
            catcher = catcher.choosing_strikes();
        }
        let mut descent = Descent::default();
        let end = match first_contact(scene, &body, start, &mut catcher) {
            Ok(first) => descent.go_down(&body, (&rules, settings.hold_speed), &mut catcher, first),
            Err(outcome) => DescentEnd::Ended(outcome),
        };
        let (approach, strikes_reason) = (catcher.approach(), catcher.strikes_reason);
        let notes = catcher.into_notes(believed.restitution);
        let (touchdown, landed, outcome) = match end {
            DescentEnd::Touchdown(touchdown) => {
                let landed = landing.land(&touchdown, go_on).map_err(CatchFailure::NoLaw)?;
                let landed = landed.ok_or(CatchFailure::Stopped)?;
                let outcome = landed.outcome;
                (Some(touchdown), Some(landed), outcome)
            }
            DescentEnd::Ended(outcome) => (None, None, outcome),
            DescentEnd::Stopped => return Err(CatchFailure::Stopped),
        };
        Ok(Self { approach, strikes_reason, descent, touchdown, landed, notes, outcome })
    }

    /// Beginning of the lasting contact, s.
    pub(super) fn contact_from(&self) -> Option<f64> {
        self.touchdown.map(|touchdown| touchdown.at.t)
    }

    /// Demand on the table.
    pub(super) fn demand(&self) -> CatchDemand {
        let demand = CatchDemand { load: self.descent.load, moves: self.descent.moves, ..CatchDemand::default() };
        self.landed.as_ref().map_or(demand, |Landed { hold, .. }| CatchDemand {
            load: demand.load.or(hold.load),
            moves: true,
            travel: hold.travel,
            least_friction: hold.least_friction,
            most_normal_force: hold.samples.iter().map(|sample| sample.normal_force).fold(0.0, f64::max),
        })
    }
}

/// The body on a guided table, and its contact at strikes. A table that catches a body with friction moves along with its contact.
pub(super) fn guided_body(scene: &Scene) -> (Body, ContactRegime) {
    let friction = scene.contact_friction().filter(|friction| friction.coefficient != 0.0);
    let regime = if friction.is_some() { ContactRegime::VelocityMatched } else { ContactRegime::Frictionless };
    let body = Body {
        friction: friction.map(|friction| Friction { slide: Slide::Matched, ..friction }),
        noise: scene.noise,
        outline: scene.outline,
        ..Body::plain(scene.parameters())
    };
    (body, regime)
}

/// The first contact, with the motion of the guided table.
fn first_contact(
    scene: &Scene,
    body: &Body,
    start: CatchStart,
    catcher: &mut Catcher<'_>,
) -> Result<ComingContact, CatchOutcome> {
    match start {
        CatchStart::Release => {
            let release = scene.release();
            match body.fall_to(release, Some(catcher)) {
                Ok(Arrival { t, state, clearance, plan, .. }) => {
                    let x = release.x + state.x_dot * t;
                    Ok(ComingContact { t, coming: PreImpact { n: 1, x, state, clearance, plan }, before: None })
                }
                Err(no_contact) => Err(no_first_contact(no_contact)),
            }
        }
        CatchStart::Contact(from) => {
            let plan = catcher.motion(&from.coming, 0.0);
            Ok(ComingContact { coming: PreImpact { plan, ..from.coming }, ..from })
        }
    }
}

fn no_first_contact(no_contact: NoContact) -> CatchOutcome {
    let escaped = |escape| CatchOutcome::NotCaught { t: 0.0, escape };
    match no_contact {
        NoContact::OtherVertex(touch) => CatchOutcome::Fell { t: touch.t, fall: Fall::OtherVertex(touch) },
        NoContact::Missed | NoContact::Sinking => escaped(Escape::Missed),
        NoContact::TooManyPieces => escaped(Escape::Diverged(f64::INFINITY)),
    }
}
