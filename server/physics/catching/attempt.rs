//! One attempt at a catch with a given strategy: its strikes, and its lasting contact.
//!
//! The strikes are those of an orbit with a guide. From the touchdown on, the table brakes if it moves, and holds the body upright. A
//! polygon that it cannot hold upright is let down on an edge.

use crate::catching::aim::{cart_pole_gain, contact_gain};
use crate::catching::guidance::Catcher;
use crate::catching::outcome::{Catch, CatchDemand, CatchFailure, CatchNote, CatchOutcome, CatchStrike, Escape, Reach};
use crate::catching::settings::{Approach, CatchSettings, HOLD_SPEED, MOST_STRIKES};
use crate::control::lqr::DesignFailure;
use crate::map::body::{Body, NoContact, PreImpact};
use crate::map::bounce::Guide;
use crate::map::friction::{Friction, Slide};
use crate::map::strike::Rod;
use crate::map::table::actuator_load::LoadTracker;
use crate::map::table::errors::TableErrors;
use crate::run::ending::Ending;
use crate::run::lasting_contact;
use crate::run::lasting_contact::{ContactStart, Hold, HoldEnding, HoldLaw, HoldRequest};
use crate::run::orbit::ComingContact;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::Scene;
use std::f64::consts::FRAC_PI_2;

/// Tries to catch the body of a scene by one strategy, from its release or from a contact under way.
pub(super) fn attempt(
    scene: &Scene,
    settings: &CatchSettings,
    approach: Approach,
    from: Option<&ComingContact>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Catch, CatchFailure> {
    let rules = scene.rules();
    let body = guided_body(scene);
    let landing = Landing::new(&body, &rules, scene.leaning_errors(), settings);
    // No law in contact, no catch: known before the first strike.
    landing.law(body.rod.gravity)?;
    let mut catcher = Catcher::new(&body, scene, approach, settings, go_on);
    let mut descent = Descent { load: LoadTracker::after(from.and_then(|from| from.before)), ..Descent::default() };
    let end = match first_contact(scene, body, from, &mut catcher) {
        Ok(mut orbit) => descent.go_down(&mut orbit, &mut catcher),
        Err(no_contact) => {
            let t = if let NoContact::OtherVertex(touch) = no_contact { touch.t } else { 0.0 };
            Err(Some(CatchOutcome::Ended { t, ending: no_contact.ending(0.0, f64::INFINITY) }))
        }
    };
    let (approach, strikes_reason) = (catcher.approach, catcher.strikes_reason);
    let noticed = catcher.into_notes(scene.specified_restitution());
    let (touchdown, hold, reach, outcome) = match end {
        Err(outcome) => (None, None, None, outcome.ok_or(CatchFailure::Stopped)?),
        Ok(touchdown) => {
            let (hold, reach, outcome) = landing.land(&touchdown, go_on)?;
            (Some(touchdown), Some(hold), Some(reach), outcome)
        }
    };
    let Descent { strikes, aimed, load, moves } = descent;
    let struck = CatchDemand { load: load.most, moves, ..CatchDemand::default() };
    let demand = hold.as_ref().map_or(struck, |hold| CatchDemand {
        load: struck.load.or(hold.load),
        moves: true,
        travel: hold.travel,
        least_friction: hold.least_friction,
        most_normal_force: hold.samples.iter().map(|sample| sample.normal_force).fold(0.0, f64::max),
    });
    let mut catch = Catch {
        settings: *settings,
        approach,
        strikes_reason,
        candidates: Vec::new(),
        strikes,
        contact_from: touchdown.map(|start| start.t),
        hold,
        demand,
        reach,
        notes: noticed,
        outcome,
    };
    catch.notes.extend(notes(scene, &catch, aimed, touchdown.as_ref()));
    Ok(catch)
}

/// The body on a guided table. A table that catches a body with friction moves along with its contact. It strikes as it has planned, at a tilt
/// that does not turn, and carries a state that it has sensed before on to the strike.
pub(super) fn guided_body(scene: &Scene) -> Body {
    let Body { rod, noise, drag, outline, .. } = scene.running_model;
    let friction = scene.running_model.rough().map(|friction| Friction { slide: Slide::Matched, ..friction });
    Body { friction, noise, drag, outline, ..Body::plain(rod) }
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

#[derive(Clone, Debug, Default)]
struct Descent {
    strikes: Vec<CatchStrike>,
    /// Height ratio that the first strike aimed for.
    aimed: Option<f64>,
    load: LoadTracker,
    /// True if the table moved from one strike to another.
    moves: bool,
}

impl Descent {
    /// Strikes until the lasting contact begins. Fails with the outcome without one, `None` if the caller stopped them.
    fn go_down(&mut self, orbit: &mut Orbit, catcher: &mut Catcher<'_>) -> Result<ContactStart, Option<CatchOutcome>> {
        let rod = orbit.body.rod;
        for _ in 0..MOST_STRIKES {
            if !(catcher.go_on)() {
                return Err(None);
            }
            let t = orbit.t();
            let without_strike = match catcher.aimed {
                Ok(Some(ratio)) => {
                    self.aimed.get_or_insert(ratio);
                    None
                }
                Ok(None) => {
                    let at = ComingContact { t, coming: orbit.coming(), before: self.load.last() };
                    Some(Ok(ContactStart::meeting(&rod, &at)))
                }
                Err(escape) => Some(Err(Some(CatchOutcome::Escaped { t, escape }))),
            };
            if let Some(end) = without_strike {
                let toppled = orbit.rules().toppled(orbit.state().theta);
                return toppled.map_or(end, |ending| Err(Some(CatchOutcome::Ended { t, ending })));
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
                None | Some(Ending::Sinking { .. }) => return Ok(ContactStart::after(&contact, &strike, t)),
                Some(ending) => {
                    let t = if let Ending::OtherVertex(touch) = ending { t + touch.t } else { t };
                    return Err(Some(CatchOutcome::Ended { t, ending }));
                }
            }
        }
        Err(Some(CatchOutcome::Escaped { t: orbit.t(), escape: Escape::TooManyStrikes(MOST_STRIKES) }))
    }
}

/// Speed of the contact point, m/s, that is rounding: the table stands.
const AT_REST: f64 = 1e-9;

/// The body and the laws of the table in lasting contact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Landing<'a> {
    body: &'a Body,
    rules: &'a Rules,
    errors: TableErrors,
    settings: &'a CatchSettings,
    /// Deceleration of a table that moves along with the body, m/s².
    deceleration: f64,
}

impl<'a> Landing<'a> {
    /// The contact of this body by these settings.
    pub(super) fn new(body: &'a Body, rules: &'a Rules, errors: TableErrors, settings: &'a CatchSettings) -> Self {
        Self { body, rules, errors, settings, deceleration: settings.brake.unwrap_or(body.rod.gravity) }
    }

    /// The law of the table while it pushes with `push`, m/s².
    fn law(&self, push: f64) -> Result<HoldLaw, DesignFailure> {
        let CatchSettings { state_weights, input_weight, .. } = *self.settings;
        let TableErrors { angle_bias: angle, tilt_offset: tilt, .. } = self.errors;
        if self.body.friction.is_none() {
            let gains =
                contact_gain(self.body, push, state_weights, input_weight)?.map(|gain| self.errors.tilting(gain));
            return Ok(HoldLaw::Tilting(gains, tilt - gains.theta * angle));
        }
        let gains = cart_pole_gain(self.body, push, state_weights, input_weight)?;
        Ok(HoldLaw::CartPole { gains, acceleration: -(gains.theta * angle), tilt })
    }

    /// The lasting contact from a touchdown on, with its reach and the outcome.
    fn land(
        &self,
        touchdown: &ContactStart,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<(Hold, Reach, CatchOutcome), CatchFailure> {
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
        let mut hold = lasting_contact::hold(&upright, go_on);
        if hold.ending == HoldEnding::Stopped {
            return Err(CatchFailure::Stopped);
        }
        let mut outcome = outcome(&hold);
        // A table that is not level does not let a body down on an edge.
        if !outcome.is_caught() && self.body.outline.is_some() && self.errors.tilt_offset == 0.0 {
            let down = lasting_contact::hold(&request(HoldLaw::Level), go_on);
            match down.ending {
                HoldEnding::RestsOnEdge { vertices } => {
                    (hold, outcome) = (down, CatchOutcome::RestsOnEdge(vertices));
                }
                HoldEnding::Stopped => return Err(CatchFailure::Stopped),
                _ => {}
            }
        }
        let push = if moves { push } else { gravity };
        Ok((hold, self.reach(&start, push), outcome))
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
        let (turning, limit) = match self.body.friction {
            // Beyond a quarter turn a table pushes down.
            None => (rho * rho, self.rules.limits.map_or(FRAC_PI_2, |limits| limits.tilt.min(FRAC_PI_2))),
            Some(friction) => (rho * rho + l * l, friction.coefficient),
        };
        let growth = (push * l / turning).sqrt();
        Reach { theta: (start.theta + start.theta_dot / growth).abs(), limit }
    }
}

/// Outcome of a catch by the ending of its lasting contact.
fn outcome(hold: &Hold) -> CatchOutcome {
    let t = hold.t_end;
    let escaped = |escape| CatchOutcome::Escaped { t, escape };
    match hold.ending {
        HoldEnding::Completed => CatchOutcome::Held,
        HoldEnding::RestsOnEdge { vertices } => CatchOutcome::RestsOnEdge(vertices),
        HoldEnding::Ended(ending) => CatchOutcome::Ended { t, ending },
        HoldEnding::Slipped { needed } => escaped(Escape::Slipped(needed)),
        HoldEnding::ContactLost => escaped(Escape::ContactLost),
        HoldEnding::TooLong | HoldEnding::Stopped => escaped(Escape::HoldTooLong),
    }
}

/// Angular velocity, rad/s, above which a body counts as turning.
const TURNING: f64 = 1e-3;

/// Angle, rad, up to which a body counts as upright at the end.
const UPRIGHT: f64 = 1e-3;

/// Difference of height ratios that a wrong belief explains, not rounding.
const MISSED_RATIO: f64 = 1e-6;

/// The facts about a catch whose first strike aimed for the ratio `aimed`.
fn notes(scene: &Scene, catch: &Catch, aimed: Option<f64>, touchdown: Option<&ContactStart>) -> Vec<CatchNote> {
    let mut notes = Vec::from_iter(energy_feedback(scene));
    if scene.running_model.friction.is_some_and(|friction| friction.slide == Slide::None) {
        notes.push(CatchNote::MovesAlongItself);
    }
    if scene.specified_restitution() != scene.running_model.rod.restitution
        && let (Some(first), Some(aimed)) = (catch.strikes.first(), aimed)
        && (first.ratio() - aimed).abs() > MISSED_RATIO
    {
        notes.push(CatchNote::WrongBelief { aimed, reached: first.ratio() });
    }
    notes.extend(keeps_height(scene, &catch.approach));
    let Some(ContactStart { table_speed: speed, theta_dot, .. }) = touchdown.copied() else { return notes };
    if speed.abs() >= HOLD_SPEED {
        notes.push(CatchNote::RodeAlong(speed));
    }
    if theta_dot.abs() > TURNING {
        notes.push(CatchNote::StillTurning(theta_dot));
    }
    notes.extend(catch.reach.filter(|reach| reach.theta >= reach.limit).map(CatchNote::OutOfReach));
    if let Some(Hold { ending: HoldEnding::Completed, samples, .. }) = &catch.hold
        && let Some(last) = samples.last()
        && last.theta.abs() > UPRIGHT
    {
        notes.push(CatchNote::NotYetUpright(last.theta));
    }
    notes
}

/// A wrong belief with which the strikes of `bounce_down` do not slow the body down.
fn keeps_height(scene: &Scene, approach: &Approach) -> Option<CatchNote> {
    let Approach::BounceDown(aimed) = *approach else { return None };
    let (actual, assumed) = (scene.running_model.rod.restitution, scene.specified_restitution());
    let reached = actual + (1.0 + actual) * (aimed - assumed) / (1.0 + assumed);
    (reached >= 1.0).then_some(CatchNote::KeepsHeight { aimed, reached })
}

/// The energy feedback of the scene, if it does not catch by itself: near its target Gl each strike takes a share that is
/// proportional to v², so that dv/dt = −½aGv² and v = 2/(aGt) in the long run.
fn energy_feedback(scene: &Scene) -> Option<CatchNote> {
    let rod = scene.running_model.rod;
    let rate = 0.5 * (1.0 + rod.restitution) * scene.energy_gain();
    (rate > 0.0).then(|| CatchNote::EnergyFeedbackNeverSettles(2.0 / (rate * rod.gravity * HOLD_SPEED)))
}
