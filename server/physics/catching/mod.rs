//! Catching a falling body with the table, and throwing it: tables that choose the motion of each strike.
//!
//! A catch is made of strikes that slow the body down ([`attempt`], guided by [`guidance`]) and of the lasting contact that follows.

pub mod aim;
pub mod attempt;
pub mod gain_schedule;
pub mod guidance;
pub mod outcome;
pub mod plan;
pub mod settings;
pub mod throw;

use crate::body::general::GeneralBody;
use crate::body::{Arrival, NoContact, PreImpact};
use crate::bounce::friction::{Friction, Slide};
use crate::bounce::rod::Rod;
use crate::scene::{BodyShape, Scene};
use crate::stability::contact_regime::ContactRegime;
use crate::table::control_law::Steering;
use attempt::{ComingContact, Descent, DescentEnd};
use gain_schedule::{GainSchedule, contact_gain};
use guidance::Catcher;
use outcome::{Catch, CatchDemand, CatchFailure, CatchOutcome, Escape, Fall, UprightWithin};
use settings::{Approach, CatchSettings, DEFAULT_RATIO, Strategy};

/// Start of a catch.
#[derive(Clone, Copy, Debug, PartialEq)]
enum CatchStart {
    /// The release of the scene.
    Release,
    /// A contact under way.
    Contact(ComingContact),
}

/// Catches the body of a scene from its release.
///
/// # Errors
/// [`CatchFailure`].
pub fn catch(scene: &Scene, settings: &CatchSettings, go_on: &mut dyn FnMut() -> bool) -> Result<Catch, CatchFailure> {
    catch_by(scene, settings, CatchStart::Release, go_on)
}

/// Catches the body of a scene from a contact that a run has come to, at its time.
///
/// # Errors
/// [`CatchFailure`].
pub fn catch_from(
    scene: &Scene,
    settings: &CatchSettings,
    from: &ComingContact,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Catch, CatchFailure> {
    catch_by(scene, settings, CatchStart::Contact(*from), go_on)
}

fn catch_by(
    scene: &Scene,
    settings: &CatchSettings,
    start: CatchStart,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Catch, CatchFailure> {
    if scene.body() == BodyShape::Point {
        return Err(CatchFailure::Point);
    }
    let rod: Rod = scene.parameters();
    let strategy = settings.strategy.unwrap_or(Strategy::BounceDown);
    let approach = settings.approach(strategy, rod.gravity);
    let (body, regime) = guided_body(scene);
    contact_gain(&rod, rod.gravity, regime, settings.state_weights, settings.input_weight)
        .map_err(CatchFailure::NoLaw)?;
    let ratio = match approach {
        Approach::BounceDown { ratio } => ratio,
        Approach::Plan { .. } | Approach::Brake { .. } => DEFAULT_RATIO,
    };
    let schedule =
        GainSchedule { rod, regime, ratio, state_weights: settings.state_weights, input_weight: settings.input_weight };
    let believed = Rod { restitution: scene.assumed_restitution(), ..rod };
    let friction = body.friction.map_or(0.0, |friction| friction.coefficient);
    let mut catcher = Catcher::new(believed, friction, approach, schedule);
    let mut descent = Descent::default();
    let end = match first_contact(scene, &body, start, &mut catcher) {
        Ok(first) => descent.go_down(&body, &scene.rules(), &mut catcher, first, go_on),
        Err(outcome) => DescentEnd::Ended(outcome),
    };
    let (contact_from, outcome) = match end {
        DescentEnd::Touchdown(touchdown) => (Some(touchdown.at.t), CatchOutcome::Held),
        DescentEnd::Ended(outcome) => (None, outcome),
        DescentEnd::Stopped => return Err(CatchFailure::Stopped),
    };
    Ok(Catch {
        settings: *settings,
        approach,
        candidates: Vec::new(),
        strikes: descent.strikes,
        contact_from,
        hold: None,
        upright_within: UprightWithin::default(),
        demand: CatchDemand { load: descent.load, ..CatchDemand::default() },
        reach: None,
        notes: catcher.notes,
        outcome,
    })
}

/// The body on a guided table, and its contact at strikes. A table that catches a body with friction moves along with its contact.
fn guided_body(scene: &Scene) -> (GeneralBody, ContactRegime) {
    let friction = scene.contact_friction().filter(|friction| friction.coefficient != 0.0);
    let regime = if friction.is_some() { ContactRegime::VelocityMatched } else { ContactRegime::Frictionless };
    let body = GeneralBody {
        rod: scene.parameters(),
        steering: Steering::TiltGain,
        program: None,
        friction: friction.map(|friction| Friction { slide: Slide::Matched, ..friction }),
        noise: scene.noise,
        outline: scene.outline,
    };
    (body, regime)
}

/// The first contact, with the motion of the guided table.
fn first_contact(
    scene: &Scene,
    body: &GeneralBody,
    start: CatchStart,
    catcher: &mut Catcher,
) -> Result<ComingContact, CatchOutcome> {
    match start {
        CatchStart::Release => {
            let release = scene.release();
            match body.fall_to(release, Some(catcher)) {
                Ok(Arrival { t, state, clearance, plan }) => {
                    let x = release.x + state.x_dot * t;
                    Ok(ComingContact { t, coming: PreImpact { n: 1, x, state, clearance, plan } })
                }
                Err(no_contact) => Err(no_first_contact(no_contact)),
            }
        }
        CatchStart::Contact(ComingContact { t, coming }) => {
            use crate::body::general::Guide;
            let plan = catcher.motion(&coming, 0.0);
            Ok(ComingContact { t, coming: PreImpact { plan, ..coming } })
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
