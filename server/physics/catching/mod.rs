//! Catching a falling body with the table, and throwing it: tables that choose the motion of each strike.
//!
//! A catch is made of strikes that slow the body down (an [`Orbit`](crate::run::orbit::Orbit) guided by [`guidance`]) and of the lasting contact that follows.

pub mod aim;
mod attempt;
mod choice;
pub mod gain_schedule;
pub mod guidance;
mod landing;
mod notes;
pub mod outcome;
pub mod plan;
pub mod settings;
pub mod throw;

use crate::run::contact::ComingContact;
use crate::scene::{BodyShape, Scene};
use attempt::{CatchStart, guided_body};
use choice::choose;
use landing::Landing;
use outcome::{Catch, CatchFailure, CatchOutcome, UprightWithin};
use settings::CatchSettings;

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

/// Outcome of the catch of a scene from its release, without its record, and the time from which the body rests, s: upright within 1 mrad and
/// 1 mm, or on an edge.
///
/// # Errors
/// [`CatchFailure`].
pub fn catch_outcome(
    scene: &Scene,
    settings: &CatchSettings,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<(CatchOutcome, Option<f64>), CatchFailure> {
    if scene.body() == BodyShape::Point {
        return Err(CatchFailure::Point);
    }
    if let Some(name) = scene.beyond_ideal_rig() {
        return Err(CatchFailure::Rig(name));
    }
    let (attempt, _) = choose(scene, settings, CatchStart::Release, false, go_on)?;
    let rest = attempt.landed.as_ref().and_then(|landed| match attempt.outcome {
        CatchOutcome::Held => Some(landed.hold.theta_within?.max(landed.hold.x_within?)),
        CatchOutcome::RestsOnEdge { .. } => Some(landed.hold.t_end),
        CatchOutcome::Ended { .. } | CatchOutcome::Escaped { .. } => None,
    });
    Ok((attempt.outcome, rest))
}

/// Work by which the lasting contact of one attempt at a catch is priced, in steps of an integrator; 0 if there is no catch.
pub fn contact_work(scene: &Scene, settings: &CatchSettings) -> u64 {
    if scene.body() == BodyShape::Point {
        return 0;
    }
    let (body, regime) = guided_body(scene);
    let deceleration = settings.brake.unwrap_or(body.rod.gravity);
    Landing { body: &body, rules: &scene.rules(), regime, settings, deceleration }.work()
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
    if let Some(name) = scene.beyond_ideal_rig() {
        return Err(CatchFailure::Rig(name));
    }
    let (attempt, candidates) = choose(scene, settings, start, true, go_on)?;
    let (contact_from, demand, notes) = (attempt.contact_from(), attempt.demand(), notes::notes(scene, &attempt));
    let (hold, reach) = attempt.landed.map_or((None, None), |landed| (Some(landed.hold), Some(landed.reach)));
    Ok(Catch {
        settings: *settings,
        approach: attempt.approach,
        strikes_reason: attempt.strikes_reason,
        candidates,
        strikes: attempt.descent.strikes,
        contact_from,
        upright_within: hold.as_ref().map_or_else(UprightWithin::default, |hold| UprightWithin {
            theta_1mrad: hold.theta_within,
            x_1mm: hold.x_within,
        }),
        hold,
        demand,
        reach,
        notes,
        outcome: attempt.outcome,
    })
}
