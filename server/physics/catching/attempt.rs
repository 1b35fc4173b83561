//! One attempt at a catch with a given strategy: its strikes and its lasting contact.

use super::gain_schedule::GainSchedule;
use super::guidance::{Catcher, Guidance};
use super::landing::{Landed, Landing};
use super::outcome::{CatchDemand, CatchFailure, CatchNote, CatchOutcome, CatchStrike, Escape};
use super::plan::StrikesReason;
use super::settings::{Approach, CatchSettings, DEFAULT_RATIO, MOST_STRIKES};
use crate::body::bounce::Guide;
use crate::body::{Body, NoContact, PreImpact};
use crate::bounce::friction::{Friction, Slide};
use crate::bounce::rod::Rod;
use crate::contact::ContactStart;
use crate::run::contact::ComingContact;
use crate::run::ending::Ending;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::Scene;
use crate::stability::contact_regime::ContactRegime;
use crate::table::actuator_load::LoadTracker;

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
    /// Beginning of the lasting contact.
    pub(super) touchdown: Option<ContactStart>,
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
        catcher.hold_speed = settings.hold_speed;
        if settings.strikes.is_none() {
            catcher = catcher.choosing_strikes();
        }
        let mut descent = Descent::after(start);
        let end = match first_contact(scene, body, start, &mut catcher) {
            Ok(mut orbit) => descent.go_down(&mut orbit, &mut catcher),
            Err(no_contact) => {
                let t = if let NoContact::OtherVertex(touch) = no_contact { touch.t } else { 0.0 };
                DescentEnd::Ended(CatchOutcome::Ended { t, ending: no_contact.ending(0.0, f64::INFINITY) })
            }
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
        self.touchdown.map(|start| start.t)
    }

    /// Demand on the table.
    pub(super) fn demand(&self) -> CatchDemand {
        let demand = CatchDemand { load: self.descent.load.most, moves: self.descent.moves, ..CatchDemand::default() };
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

/// The orbit on the guided table, before its first contact.
fn first_contact(scene: &Scene, body: Body, start: CatchStart, catcher: &mut Catcher<'_>) -> Result<Orbit, NoContact> {
    // The strikes of a catch end in the contact that follows, and take as much energy as they aim to.
    let rules = Rules { settles: false, holds_energy: false, ..scene.rules() };
    match start {
        CatchStart::Release => Orbit::new_guided(body, rules, scene.release(), Some(catcher)),
        CatchStart::Contact(from) => {
            let plan = catcher.motion(&from.coming, 0.0);
            let from = ComingContact { coming: PreImpact { plan, ..from.coming }, ..from };
            Ok(Orbit::under_way(body, rules, &from))
        }
    }
}

/// Strikes of an attempt.
#[derive(Clone, Debug, Default)]
pub(super) struct Descent {
    pub(super) strikes: Vec<CatchStrike>,
    /// Height ratio that the first strike aimed for.
    pub(super) aimed: Option<f64>,
    load: LoadTracker,
    /// True if the table moved from one strike to another.
    moves: bool,
}

/// End of the strikes of an attempt.
enum DescentEnd {
    /// The lasting contact begins.
    Touchdown(ContactStart),
    /// It ends without one.
    Ended(CatchOutcome),
    /// The caller stopped it.
    Stopped,
}

impl Descent {
    /// No strikes yet.
    fn after(start: CatchStart) -> Self {
        let before = match start {
            CatchStart::Release => None,
            CatchStart::Contact(from) => from.before,
        };
        Self { load: LoadTracker::after(before), ..Self::default() }
    }

    /// Strikes from a coming contact on, until the table stays with the body.
    fn go_down(&mut self, orbit: &mut Orbit, catcher: &mut Catcher<'_>) -> DescentEnd {
        let rod = orbit.body.rod;
        for _ in 0..MOST_STRIKES {
            if !(catcher.go_on)() {
                return DescentEnd::Stopped;
            }
            let t = orbit.t();
            if let Some(ending) = orbit.rules().toppled(orbit.state().theta) {
                return DescentEnd::Ended(CatchOutcome::Ended { t, ending });
            }
            match catcher.guidance {
                Guidance::Strike { ratio } => {
                    self.aimed.get_or_insert(ratio);
                }
                Guidance::Touch => {
                    let at = ComingContact { t, coming: orbit.coming(), before: self.load.last() };
                    return DescentEnd::Touchdown(ContactStart::meeting(&rod, &at));
                }
                Guidance::GiveUp(escape) => return DescentEnd::Ended(CatchOutcome::Escaped { t, escape }),
            }
            let (_, strike) = orbit.foresee();
            let contact = orbit.advance_guided(catcher);
            let is_refused = matches!(contact.ending, Some(Ending::BeyondLimits(_) | Ending::Separating { .. }));
            if contact.strike.is_some() || is_refused {
                self.moves |= self.load.last().is_some();
                self.load.track(&strike, contact.flight_time);
            }
            self.strikes.extend(CatchStrike::of(&rod, &contact));
            match contact.ending {
                None if contact.flight_time.is_some() => {}
                // The table stays with a body that does not rise, or not up to y = 0.
                None | Some(Ending::Sinking { .. }) => {
                    return DescentEnd::Touchdown(ContactStart::after(&contact, &strike, t));
                }
                Some(ending) => {
                    let t = if let Ending::OtherVertex(touch) = ending { t + touch.t } else { t };
                    return DescentEnd::Ended(CatchOutcome::Ended { t, ending });
                }
            }
        }
        let escape = Escape::TooManyStrikes(MOST_STRIKES);
        DescentEnd::Ended(CatchOutcome::Escaped { t: orbit.t(), escape })
    }
}
