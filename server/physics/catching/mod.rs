//! Catching a falling body with the table, and throwing it: tables that choose the motion of each strike.
//!
//! A catch is made of strikes that slow the body down (an [`Orbit`](crate::run::orbit::Orbit) guided by [`guidance`]) and of the lasting
//! contact that follows.

pub mod aim;
mod attempt;
pub mod guidance;
pub mod outcome;
pub mod plan;
pub mod settings;
pub mod throw;

use crate::bounce::friction::Slide;
use crate::bounce::rod::Rod;
use crate::catching::attempt::{Attempt, Landing, guided_body};
use crate::catching::outcome::{Candidate, Catch, CatchFailure, CatchNote, CatchOutcome, UprightWithin};
use crate::catching::settings::{Approach, CatchSettings, HOLD_SPEED, Strategy};
use crate::contact::{ContactStart, HoldEnding};
use crate::run::contact::ComingContact;
use crate::scene::{BodyShape, Scene};

/// Catches the body of a scene from its release.
///
/// # Errors
/// [`CatchFailure`].
pub fn catch(scene: &Scene, settings: &CatchSettings, go_on: &mut dyn FnMut() -> bool) -> Result<Catch, CatchFailure> {
    catch_by(scene, settings, None, go_on)
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
    catch_by(scene, settings, Some(from), go_on)
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
    let (attempt, _) = choose(scene, settings, None, false, go_on)?;
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
    from: Option<&ComingContact>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Catch, CatchFailure> {
    let (attempt, candidates) = choose(scene, settings, from, true, go_on)?;
    let (contact_from, demand, notes) = (attempt.contact_from(), attempt.demand(), notes(scene, &attempt));
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

/// Height ratio of a slow `bounce_down`, which asks for less tilt and speed.
const SLOW_RATIO: f64 = 0.9;

/// Height ratio of a slow plan: its strikes keep the height.
const SLOW_PLAN_RATIO: f64 = 1.0;

/// The strategies to compare, in their order.
fn approaches(settings: &CatchSettings, gravity: f64) -> Vec<Approach> {
    let mut approaches = vec![settings.approach(Strategy::BounceDown, gravity)];
    if settings.ratio.is_none() {
        approaches.push(Approach::BounceDown { ratio: SLOW_RATIO });
    }
    approaches.push(settings.approach(Strategy::Plan, gravity));
    if settings.ratio.is_none() {
        let slow = CatchSettings { ratio: Some(SLOW_PLAN_RATIO), ..*settings };
        approaches.push(slow.approach(Strategy::Plan, gravity));
    }
    approaches.push(settings.approach(Strategy::Brake, gravity));
    approaches
}

/// The attempt with the strategy that was asked for, or the first that catches; the first of all if none does. With `compare`, all
/// are tried and returned; without it, none after the first that catches.
///
/// # Errors
/// [`CatchFailure`].
fn choose(
    scene: &Scene,
    settings: &CatchSettings,
    from: Option<&ComingContact>,
    compare: bool,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<(Attempt, Vec<Candidate>), CatchFailure> {
    if scene.body() == BodyShape::Point {
        return Err(CatchFailure::Point);
    }
    if let Some(name) = scene.beyond_ideal_rig() {
        return Err(CatchFailure::Rig(name));
    }
    if let Some(strategy) = settings.strategy {
        let approach = settings.approach(strategy, scene.gravity());
        return Ok((Attempt::new(scene, settings, approach, from, go_on)?, Vec::new()));
    }
    let (mut candidates, mut taken): (Vec<Candidate>, Option<(usize, Attempt)>) = (Vec::new(), None);
    for approach in approaches(settings, scene.gravity()) {
        let attempt = Attempt::new(scene, settings, approach, from, go_on)?;
        let (approach, demand) = (attempt.approach, attempt.demand());
        let (contact_from, outcome) = (attempt.contact_from(), attempt.outcome);
        let is_better = match &taken {
            None => true,
            Some((_, best)) => outcome.is_caught() && !best.outcome.is_caught(),
        };
        if is_better {
            taken = Some((candidates.len(), attempt));
        }
        candidates.push(Candidate { approach, demand, contact_from, outcome, taken: false });
        if !compare && outcome.is_caught() {
            break;
        }
    }
    // There is always a first.
    let (index, attempt) = taken.ok_or(CatchFailure::Stopped)?;
    if let Some(candidate) = candidates.get_mut(index) {
        candidate.taken = true;
    }
    Ok((attempt, candidates))
}

/// Angular velocity, rad/s, above which a body counts as turning.
const TURNING: f64 = 1e-3;

/// Angle, rad, up to which a body counts as upright at the end.
const UPRIGHT: f64 = 1e-3;

/// Difference of height ratios that a wrong belief explains, not rounding.
const MISSED_RATIO: f64 = 1e-6;

/// The facts about an attempt.
fn notes(scene: &Scene, attempt: &Attempt) -> Vec<CatchNote> {
    let mut notes = attempt.notes.clone();
    notes.extend(energy_feedback(scene));
    if scene.friction > 0.0 && scene.slide == Slide::None {
        notes.push(CatchNote::MovesAlongItself);
    }
    if scene.assumed_restitution() != scene.restitution
        && let (Some(first), Some(aimed)) = (attempt.descent.strikes.first(), attempt.descent.aimed)
        && (first.ratio() - aimed).abs() > MISSED_RATIO
    {
        notes.push(CatchNote::WrongBelief { aimed, reached: first.ratio() });
    }
    notes.extend(keeps_height(scene, attempt));
    if let (Some(touchdown), Some(landed)) = (&attempt.touchdown, &attempt.landed) {
        let ContactStart { table_speed: speed, theta_dot, .. } = *touchdown;
        if speed.abs() >= HOLD_SPEED {
            notes.push(CatchNote::RodeAlong { speed });
        }
        if theta_dot.abs() > TURNING {
            notes.push(CatchNote::StillTurning { theta_dot });
        }
        if landed.reach.theta >= landed.reach.limit {
            notes.push(CatchNote::OutOfReach(landed.reach));
        }
        if landed.hold.ending == HoldEnding::Completed
            && let Some(last) = landed.hold.samples.last()
            && last.theta.abs() > UPRIGHT
        {
            notes.push(CatchNote::NotYetUpright { theta: last.theta });
        }
    }
    notes
}

/// A wrong belief with which the strikes of `bounce_down` do not slow the body down.
fn keeps_height(scene: &Scene, attempt: &Attempt) -> Option<CatchNote> {
    let Approach::BounceDown { ratio: aimed } = attempt.approach else { return None };
    let (actual, assumed) = (scene.restitution, scene.assumed_restitution());
    let reached = actual + (1.0 + actual) * (aimed - assumed) / (1.0 + assumed);
    (reached >= 1.0).then_some(CatchNote::KeepsHeight { aimed, reached })
}

/// The energy feedback of the scene, if it does not catch by itself: near its target Gl each strike takes a share that is
/// proportional to v², so that dv/dt = −½aGv² and v = 2/(aGt) in the long run.
fn energy_feedback(scene: &Scene) -> Option<CatchNote> {
    let rod: Rod = scene.parameters();
    let rate = 0.5 * (1.0 + rod.restitution) * scene.energy_gain;
    (rate > 0.0).then(|| CatchNote::EnergyFeedbackNeverSettles { time: 2.0 / (rate * rod.gravity * HOLD_SPEED) })
}
