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

use crate::catching::attempt::{Landing, attempt, guided_body};
use crate::catching::outcome::{Candidate, Catch, CatchFailure, CatchOutcome};
use crate::catching::settings::{Approach, CatchSettings, Strategy};
use crate::run::orbit::ComingContact;
use crate::scene::Scene;

/// Catches the body of a scene from its release, or from a contact that a run has come to, at its time.
pub fn catch(
    scene: &Scene,
    settings: &CatchSettings,
    from: Option<&ComingContact>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Catch, CatchFailure> {
    choose(scene, settings, from, true, go_on)
}

/// Outcome of the catch of a scene from its release, without its record, and the time from which the body rests, s: upright within 1 mrad and
/// 1 mm, or on an edge.
pub fn catch_outcome(
    scene: &Scene,
    settings: &CatchSettings,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<(CatchOutcome, Option<f64>), CatchFailure> {
    let Catch { hold, outcome, .. } = choose(scene, settings, None, false, go_on)?;
    let rest = hold.and_then(|hold| match outcome {
        CatchOutcome::Held => Some(hold.theta_within?.max(hold.x_within?)),
        CatchOutcome::RestsOnEdge(_) => Some(hold.t_end),
        CatchOutcome::Ended { .. } | CatchOutcome::Escaped { .. } => None,
    });
    Ok((outcome, rest))
}

/// Work by which the lasting contact of one attempt at a catch is priced, in steps of an integrator; 0 if there is no catch.
pub fn contact_work(scene: &Scene, settings: &CatchSettings) -> u64 {
    if scene.is_point() {
        return 0;
    }
    Landing::new(&guided_body(scene), &scene.rules(), scene.leaning_errors(), settings).work()
}

/// Height ratio of a slow `bounce_down`, which asks for less tilt and speed.
const SLOW_RATIO: f64 = 0.9;

/// Height ratio of a slow plan: its strikes keep the height.
const SLOW_PLAN_RATIO: f64 = 1.0;

/// The approaches to compare, from strategies that ask little of the table to those that ask much. A ratio that was asked for leaves no slow ones.
fn approaches(settings: &CatchSettings, gravity: f64) -> Vec<Approach> {
    let by = |strategy, ratio: Option<f64>| {
        CatchSettings { ratio: settings.ratio.or(ratio), ..*settings }.approach(strategy, gravity)
    };
    let mut approaches = vec![
        by(Strategy::BounceDown, None),
        by(Strategy::BounceDown, Some(SLOW_RATIO)),
        by(Strategy::Plan, None),
        by(Strategy::Plan, Some(SLOW_PLAN_RATIO)),
        by(Strategy::Brake, None),
    ];
    approaches.dedup();
    approaches
}

/// The catch with the strategy that was asked for, or the first that catches; the first of all if none does. With `compare`, all
/// are tried and told; without it, none after the first that catches.
fn choose(
    scene: &Scene,
    settings: &CatchSettings,
    from: Option<&ComingContact>,
    compare: bool,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Catch, CatchFailure> {
    if scene.is_point() {
        return Err(CatchFailure::Point);
    }
    if let Some(strategy) = settings.strategy {
        return attempt(scene, settings, settings.approach(strategy, scene.gravity()), from, go_on);
    }
    let mut tried: Vec<Catch> = Vec::new();
    for approach in approaches(settings, scene.gravity()) {
        tried.push(attempt(scene, settings, approach, from, go_on)?);
        if !compare && tried.iter().any(|catch| catch.outcome.is_caught()) {
            break;
        }
    }
    let taken = tried.iter().position(|catch| catch.outcome.is_caught()).unwrap_or(0);
    let candidate = |(index, catch): (usize, &Catch)| {
        let Catch { approach, demand, contact_from, outcome, .. } = *catch;
        Candidate { approach, demand, contact_from, end: catch.end(), outcome, taken: index == taken }
    };
    let candidates = tried.iter().enumerate().map(candidate).collect();
    Ok(Catch { candidates, ..tried.swap_remove(taken) })
}
