//! The ladder of models: the same scene on each level up to its own, and what each of them changed.
//!
//! A level leaves fields out of the scene itself, so each level runs exactly as a scene without these fields.

use crate::analysis::method::{RunMethod, run_by};
use crate::map::strike::State;
use crate::map::table::actuator_load::{ActuatorLoad, LoadTracker};
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::Ending;
use crate::scene::error::FieldError;
use crate::scene::model::{ModelLevel, ModelRequirement};
use crate::scene::{AIR, ERRORS, Name, Scene, TURNING, Value, names_of};

/// One level.
#[derive(Clone, Debug)]
pub struct LevelResult {
    /// Which.
    pub level: ModelLevel,
    /// The scene with what this level leaves out taken away; `None` if that scene is refused.
    pub scene: Option<Scene>,
    /// Requirement of the scene that needs this level; `None` for the lowest levels.
    pub requirement: Option<ModelRequirement>,
    /// The run, or the reason for which the level does not apply.
    pub run: Result<LevelRun, String>,
}

/// A run on a level.
#[derive(Clone, Debug)]
pub struct LevelRun {
    /// End of the run.
    pub ending: Ending,
    /// Contacts until then.
    pub impacts: u64,
    /// Time of the last contact, s.
    pub t: f64,
    /// Largest load on the table.
    pub load: ActuatorLoad,
    /// Change against the next lower one that applies.
    pub change: Option<LevelChange>,
}

/// Compared quantities: t in s, x in m, θ in rad, velocities in m/s and rad/s, and ρθ (m), ẋ, ẏ and ρθ̇ (m/s) together, in the measure of
/// error estimates.
pub const COMPARED: [&str; 7] = ["t", "x", "theta", "x_dot", "y_dot", "theta_dot", "state"];

/// The largest differences between two runs of one scene, over the contacts that both have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LevelChange {
    /// Contacts compared.
    pub impacts: u64,
    /// True if both ended alike, at the same contact.
    pub same_outcome: bool,
    /// Differences of the [`COMPARED`] quantities.
    pub largest: [LargestDifference; COMPARED.len()],
}

impl LevelChange {
    /// Largest difference of the states.
    pub fn state(&self) -> LargestDifference {
        self.largest[COMPARED.len() - 1]
    }
}

/// A largest difference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LargestDifference {
    /// Without sign.
    pub value: f64,
    /// The contact where it was first; 0 where there was none.
    pub impact: u64,
}

impl LargestDifference {
    fn include(&mut self, impact: u64, difference: f64) {
        if difference > self.value {
            *self = Self { value: difference, impact };
        }
    }
}

/// The scene on each level up to its own, the least first, for `impacts` contacts; `None` if `go_on` says `false`.
pub fn run_hierarchy(scene: &Scene, impacts: u64, mut go_on: impl FnMut() -> bool) -> Option<Vec<LevelResult>> {
    let mut steps: Vec<LevelResult> = Vec::new();
    let mut below: Option<(Vec<Compared>, Ending)> = None;
    for (level, requirement) in levels(scene) {
        let reduced = match at_level(scene, level) {
            Ok(reduced) => reduced,
            Err(errors) => {
                steps.push(LevelResult { level, scene: None, requirement, run: Err(refused(&errors)) });
                continue;
            }
        };
        let method = if level == ModelLevel::Linear { RunMethod::Linear } else { RunMethod::Map };
        let (mut course, mut tracker) = (Vec::new(), LoadTracker::default());
        let run = run_by(&reduced, method, impacts, |impact| {
            let contact = &impact.contact;
            if let Some(strike) = &contact.strike {
                tracker.track(strike, contact.flight_time);
            }
            let State { theta, x_dot, y_dot, theta_dot } = contact.state;
            course.push([contact.t, contact.x, theta, x_dot, y_dot, theta_dot]);
            !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
        });
        let run = run.transpose()?.map(|ending| {
            let rho = scene.model().rod.radius_of_gyration;
            let (impacts, t) = (course.len() as u64, course.last().map_or(0.0, |[t, ..]| *t));
            let change = below.as_ref().map(|below| change(&below.0, &course, rho, below.1.name() == ending.name()));
            below = Some((course, ending));
            LevelRun { ending, impacts, t, load: tracker.most, change }
        });
        steps.push(LevelResult { level, scene: Some(reduced), requirement, run });
    }
    Some(steps)
}

/// The levels up to the scene's own, with what asked for each.
fn levels(scene: &Scene) -> Vec<(ModelLevel, Option<ModelRequirement>)> {
    let above = scene.requirements().into_iter().filter(|requirement| requirement.level > ModelLevel::Rod);
    let least: &[ModelLevel] =
        if scene.is_point() { &[ModelLevel::Point] } else { &[ModelLevel::Linear, ModelLevel::Rod] };
    least
        .iter()
        .map(|level| (*level, None))
        .chain(above.map(|requirement| (requirement.level, Some(requirement))))
        .collect()
}

/// The scene without what a level leaves out. Fails with the fields for which that scene is refused.
pub fn at_level(scene: &Scene, level: ModelLevel) -> Result<Scene, Vec<FieldError>> {
    let mut draft = if level < ModelLevel::Polygon { scene.as_rod()? } else { *scene }.draft();
    let left_out: [(ModelLevel, &[Name]); 6] = [
        (ModelLevel::Noise, &names_of("noise")),
        (ModelLevel::Friction, &[Name::Friction, Name::Slide]),
        (ModelLevel::Turning, &TURNING),
        (ModelLevel::Drag, &AIR),
        (ModelLevel::Delay, &[Name::Delay, Name::Prediction]),
        (ModelLevel::RigErrors, &ERRORS),
    ];
    for &name in left_out.iter().filter(|(least, _)| level < *least).flat_map(|(_, names)| *names) {
        // Taking a value back is always admitted.
        let _ = draft.set(name, None);
    }
    if level < ModelLevel::RodWithX && !scene.is_point() && scene.number(Name::FeedbackX).is_some() {
        let _ = draft.set(Name::FeedbackX, Some(Value::Number(0.0)));
    }
    draft.build()
}

/// The reason for which a scene is refused, in a sentence.
pub(crate) fn refused(errors: &[FieldError]) -> String {
    let said: Vec<_> = errors.iter().map(|FieldError { path, detail, .. }| format!("{path}: {detail}")).collect();
    format!("the scene without the fields that this body or model leaves out is refused: {}", said.join("; "))
}

type Compared = [f64; COMPARED.len() - 1];

fn change(below: &[Compared], above: &[Compared], rho: f64, same_ending: bool) -> LevelChange {
    let same_outcome = same_ending && below.len() == above.len();
    let mut change = LevelChange { same_outcome, ..LevelChange::default() };
    for (one, other) in below.iter().zip(above) {
        change.impacts += 1;
        let difference: Compared = std::array::from_fn(|index| (other[index] - one[index]).abs());
        let [.., theta, x_dot, y_dot, theta_dot] = difference;
        let state = [rho * theta, x_dot, y_dot, rho * theta_dot].into_iter().fold(0.0, f64::max);
        for (largest, difference) in change.largest.iter_mut().zip(difference.into_iter().chain([state])) {
            largest.include(change.impacts, difference);
        }
    }
    change
}
