//! One attempt at a catch with a given strategy: its strikes, and its lasting contact.
//!
//! The strikes are those of an orbit with a guide. From the touchdown on, the table brakes if it moves, and holds the body upright. A
//! polygon that it cannot hold upright is let down on an edge.

use crate::body::bounce::Guide;
use crate::body::{Body, NoContact, PreImpact, Touch};
use crate::bounce::friction::{Friction, Slide};
use crate::bounce::rod::Rod;
use crate::catching::aim::{GainSchedule, cart_pole_gain, contact_gain};
use crate::catching::guidance::{Catcher, Guidance};
use crate::catching::outcome::{CatchDemand, CatchFailure, CatchNote, CatchOutcome, CatchStrike, Escape, Reach};
use crate::catching::plan::StrikesReason;
use crate::catching::settings::{Approach, CatchSettings, DEFAULT_RATIO, MOST_STRIKES};
use crate::contact;
use crate::contact::{ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest};
use crate::control::lqr::DesignFailure;
use crate::run::contact::ComingContact;
use crate::run::ending::Ending;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::Scene;
use crate::stability::contact_regime::ContactRegime;
use crate::table::actuator_load::LoadTracker;
use std::f64::consts::FRAC_PI_2;

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
    /// Tries to catch the body of a scene, from its release or from a contact under way.
    ///
    /// # Errors
    /// [`CatchFailure`].
    pub(super) fn new(
        scene: &Scene,
        settings: &CatchSettings,
        approach: Approach,
        from: Option<&ComingContact>,
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
        let before = from.and_then(|from| from.before);
        let mut descent = Descent { load: LoadTracker::after(before), ..Descent::default() };
        let end = match first_contact(scene, body, from, &mut catcher) {
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

/// The orbit on the guided table, before its first contact: from the release of the scene, or from a contact under way.
fn first_contact(
    scene: &Scene,
    body: Body,
    from: Option<&ComingContact>,
    catcher: &mut Catcher<'_>,
) -> Result<Orbit, NoContact> {
    // The strikes of a catch end in the contact that follows, and take as much energy as they aim to.
    let rules = Rules { settles: false, holds_energy: false, ..scene.rules() };
    let Some(from) = from else { return Orbit::new_guided(body, rules, scene.release(), Some(catcher)) };
    let plan = catcher.motion(&from.coming, 0.0);
    let from = ComingContact { coming: PreImpact { plan, ..from.coming }, ..*from };
    Ok(Orbit::under_way(body, rules, &from))
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
    /// Strikes from a coming contact on, until the table stays with the body.
    fn go_down(&mut self, orbit: &mut Orbit, catcher: &mut Catcher<'_>) -> DescentEnd {
        let rod = orbit.body.rod;
        for _ in 0..MOST_STRIKES {
            if !(catcher.go_on)() {
                return DescentEnd::Stopped;
            }
            let t = orbit.t();
            let without_strike = match catcher.guidance {
                Guidance::Strike { ratio } => {
                    self.aimed.get_or_insert(ratio);
                    None
                }
                Guidance::Touch => {
                    let at = ComingContact { t, coming: orbit.coming(), before: self.load.last() };
                    Some(DescentEnd::Touchdown(ContactStart::meeting(&rod, &at)))
                }
                Guidance::GiveUp(escape) => Some(DescentEnd::Ended(CatchOutcome::Escaped { t, escape })),
            };
            if let Some(end) = without_strike {
                let toppled = orbit.rules().toppled(orbit.state().theta);
                return toppled.map_or(end, |ending| DescentEnd::Ended(CatchOutcome::Ended { t, ending }));
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
