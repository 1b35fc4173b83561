//! Choice of the strategy: the first in a fixed order that catches the body within the limits of the table.
//!
//! The order is from strategies that ask little of the table and forgive errors to those that ask much: `bounce_down` quickly and slowly,
//! a plan quickly and slowly, `brake`.

use super::attempt::{Attempt, CatchStart};
use super::outcome::{Candidate, CatchFailure};
use super::settings::{Approach, CatchSettings, Strategy};
use crate::scene::Scene;

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
pub(super) fn choose(
    scene: &Scene,
    settings: &CatchSettings,
    start: CatchStart,
    compare: bool,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<(Attempt, Vec<Candidate>), CatchFailure> {
    if let Some(strategy) = settings.strategy {
        let approach = settings.approach(strategy, scene.gravity());
        return Ok((Attempt::new(scene, settings, approach, start, go_on)?, Vec::new()));
    }
    let (mut candidates, mut taken): (Vec<Candidate>, Option<(usize, Attempt)>) = (Vec::new(), None);
    for approach in approaches(settings, scene.gravity()) {
        let attempt = Attempt::new(scene, settings, approach, start, go_on)?;
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
