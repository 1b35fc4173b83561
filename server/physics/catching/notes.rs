//! Facts told beside a catch: laws of the scene that would not catch, and what a reader of the numbers should know.

use super::attempt::Attempt;
use super::outcome::CatchNote;
use super::settings::{Approach, HOLD_SPEED};
use crate::bounce::friction::Slide;
use crate::bounce::rod::Rod;
use crate::contact::{ContactStart, HoldEnding};
use crate::scene::Scene;

/// Angular velocity, rad/s, above which a body counts as turning.
const TURNING: f64 = 1e-3;

/// Angle, rad, up to which a body counts as upright at the end.
const UPRIGHT: f64 = 1e-3;

/// Difference of height ratios that a wrong belief explains, not rounding.
const MISSED_RATIO: f64 = 1e-6;

/// The facts about an attempt.
pub(super) fn notes(scene: &Scene, attempt: &Attempt) -> Vec<CatchNote> {
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
