//! The ladder of models: the same scene on each rung up to its own, and what each of them changed.
//!
//! What a rung leaves out is left out of the scene itself, so each runs as it would if it had been asked for alone.

use crate::bounce::state::State;
use crate::run::cancellation::CHECK_INTERVAL;
use crate::run::ending::Ending;
use crate::run::method::{RunMethod, run_by};
use crate::scene::model::{Forced, Rung};
use crate::scene::{Name, Scene, Value};
use crate::table::actuator_load::{ActuatorLoad, LoadTracker};

/// One rung.
#[derive(Clone, Debug)]
pub struct Step {
    /// Which.
    pub rung: Rung,
    /// The scene with what this rung leaves out taken away.
    pub scene: Scene,
    /// What of the scene asked for it; nothing for the lowest.
    pub forced: Option<Forced>,
    /// What came of it, or why it does not apply.
    pub run: Result<Run, String>,
}

/// How a run on a rung went.
#[derive(Clone, Debug)]
pub struct Run {
    /// How it ended.
    pub ending: Ending,
    /// Contacts until then.
    pub impacts: u64,
    /// When, s.
    pub t: f64,
    /// The most that it asked of the table.
    pub demand: ActuatorLoad,
    /// What this rung changed against the next lower one that applies.
    pub change: Option<Change>,
}

/// The largest differences between two runs of one scene, over the contacts that both have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Contacts compared.
    pub impacts: u64,
    /// Of t, s.
    pub t: Largest,
    /// Of x, m.
    pub x: Largest,
    /// Of θ, rad.
    pub theta: Largest,
    /// Of ẋ, m/s.
    pub x_dot: Largest,
    /// Of ẏ, m/s.
    pub y_dot: Largest,
    /// Of θ̇, rad/s.
    pub theta_dot: Largest,
    /// Of ρθ (m), ẋ, ẏ and ρθ̇ (m/s) together, in the measure of error estimates.
    pub state: Largest,
    /// Whether both ended alike, at the same contact.
    pub same_outcome: bool,
}

/// A largest difference.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Largest {
    /// Without sign.
    pub value: f64,
    /// The contact where it was first; 0 where there was none.
    pub impact: u64,
}

impl Largest {
    fn look(&mut self, n: u64, difference: f64) {
        if difference.abs() > self.value {
            *self = Self { value: difference.abs(), impact: n };
        }
    }
}

/// What of a contact is compared.
#[derive(Clone, Copy)]
struct Here {
    t: f64,
    x: f64,
    state: State,
}

/// The scene on each rung up to its own, for up to `impacts` contacts, the least first. `go_on` is asked now and then; a
/// `false` gives none.
pub fn run_hierarchy(scene: &Scene, impacts: u64, mut go_on: impl FnMut() -> bool) -> Option<Vec<Step>> {
    let mut steps: Vec<Step> = Vec::new();
    let mut below: Option<(Vec<Here>, Ending)> = None;
    for (rung, forced) in rungs(scene) {
        let reduced = at_level(scene, rung);
        let method = if rung == Rung::Linear { RunMethod::Linear } else { RunMethod::Map };
        let (mut course, mut meter) = (Vec::new(), LoadTracker::default());
        let run = run_by(&reduced, method, impacts, |impact| {
            let contact = &impact.contact;
            if let Some(strike) = &contact.strike {
                meter.track(strike, contact.flight_time);
            }
            course.push(Here { t: contact.t, x: contact.x, state: contact.state });
            !contact.n.is_multiple_of(CHECK_INTERVAL) || go_on()
        });
        let run = match run {
            Err(why) => Err(why),
            Ok(ending) => {
                let ending = ending?;
                let rho = scene.model().rod().radius_of_gyration;
                let change =
                    below.as_ref().map(|below| change(&below.0, &course, rho, below.1.name() == ending.name()));
                let run = Run {
                    ending,
                    impacts: course.len() as u64,
                    t: course.last().map_or(0.0, |here| here.t),
                    demand: meter.most,
                    change,
                };
                below = Some((course, ending));
                Ok(run)
            }
        };
        steps.push(Step { rung, scene: reduced, forced, run });
    }
    Some(steps)
}

/// The rungs up to the scene's own, with what asked for each.
fn rungs(scene: &Scene) -> Vec<(Rung, Option<Forced>)> {
    if scene.rung() == Rung::Point {
        return vec![(Rung::Point, None)];
    }
    let above = scene.forced().into_iter().filter(|forced| forced.rung > Rung::Rod);
    let least = [Rung::Linear, Rung::Rod].map(|rung| (rung, None));
    least.into_iter().chain(above.map(|forced| (forced.rung, Some(forced)))).collect()
}

/// The scene without what a rung leaves out.
pub fn at_level(scene: &Scene, rung: Rung) -> Scene {
    let mut draft = if rung < Rung::Polygon { scene.as_rod() } else { *scene }.draft();
    let mut without = |least: Rung, names: &[Name]| {
        if rung < least {
            for &name in names {
                // Taking a value back is always admitted.
                let _ = draft.set(name, None);
            }
        }
    };
    without(Rung::Noise, &[Name::TimingSd, Name::AngleSd, Name::NoiseModel, Name::Seed, Name::NoiseRun]);
    without(Rung::Friction, &[Name::Friction, Name::Slide]);
    if rung < Rung::RodWithX && scene.number(Name::FeedbackX).is_some() {
        let _ = draft.set(Name::FeedbackX, Some(Value::Number(0.0)));
    }
    // A scene without some of what it had is a scene.
    draft.build().unwrap_or(*scene)
}

fn change(below: &[Here], above: &[Here], rho: f64, same_ending: bool) -> Change {
    let same_outcome = same_ending && below.len() == above.len();
    let mut change = Change { same_outcome, ..Change::default() };
    for (one, other) in below.iter().zip(above) {
        change.impacts += 1;
        let n = change.impacts;
        let [theta, x_dot, y_dot, theta_dot] = [
            other.state.theta - one.state.theta,
            other.state.x_dot - one.state.x_dot,
            other.state.y_dot - one.state.y_dot,
            other.state.theta_dot - one.state.theta_dot,
        ];
        change.t.look(n, other.t - one.t);
        change.x.look(n, other.x - one.x);
        change.theta.look(n, theta);
        change.x_dot.look(n, x_dot);
        change.y_dot.look(n, y_dot);
        change.theta_dot.look(n, theta_dot);
        for difference in [rho * theta, x_dot, y_dot, rho * theta_dot] {
            change.state.look(n, difference);
        }
    }
    change
}
