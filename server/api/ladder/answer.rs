//! The answer of `ladder`: the same scene on each rung up to its own, and the change from rung to rung.

use std::borrow::Cow;

use equipoise_physics::scene::model::ModelLevel;
use equipoise_physics::scene::model_hierarchy::{LargestDifference, LevelChange, LevelResult, LevelRun, run_hierarchy};
use serde::Serialize;

use crate::api::formats::Tabular;
use crate::api::ladder::request::LadderRequest;
use crate::api::scene::Resolved;
use crate::api::shared::demand::DemandAnswer;
use crate::api::shared::model_choice::RequirementAnswer;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::table::{Cells, Column, Table};

/// Answer of `/v1/ladder`.
#[derive(Debug, Serialize)]
pub struct LadderAnswer<'a> {
    scene: Resolved<'a>,
    impacts: u64,
    tolerance: f64,
    /// The rung that the scene is run on.
    rung: &'static str,
    /// The lowest rung that is sufficient.
    enough: &'static str,
    reason: String,
    rungs: Vec<RungAnswer>,
    #[serde(skip)]
    bounces: u64,
}

#[derive(Debug, Serialize)]
struct RungAnswer {
    name: &'static str,
    forced: Option<RequirementAnswer>,
    scene: serde_json::Value,
    /// The reason why the rung does not apply, if it does not.
    reason: Option<String>,
    outcome: Option<Outcome>,
    demand: Option<DemandAnswer>,
    cost_ns_per_impact: f64,
    change: Option<ChangeAnswer>,
    needed: Option<bool>,
}

#[derive(Debug, Clone, Serialize)]
struct ChangeAnswer {
    against: &'static str,
    impacts: u64,
    same_outcome: bool,
    t: LargestAnswer,
    x: LargestAnswer,
    theta: LargestAnswer,
    x_dot: LargestAnswer,
    y_dot: LargestAnswer,
    theta_dot: LargestAnswer,
    state: LargestAnswer,
}

#[derive(Debug, Clone, Copy, Serialize)]
struct LargestAnswer {
    difference: f64,
    impact: Option<u64>,
}

impl From<LargestDifference> for LargestAnswer {
    fn from(LargestDifference { value, impact }: LargestDifference) -> Self {
        Self { difference: value, impact: (impact > 0).then_some(impact) }
    }
}

impl ChangeAnswer {
    fn new(change: &LevelChange, against: &'static str) -> Self {
        let LevelChange { impacts, t, x, theta, x_dot, y_dot, theta_dot, state, same_outcome } = *change;
        Self {
            against,
            impacts,
            same_outcome,
            t: t.into(),
            x: x.into(),
            theta: theta.into(),
            x_dot: x_dot.into(),
            y_dot: y_dot.into(),
            theta_dot: theta_dot.into(),
            state: state.into(),
        }
    }
}

impl<'a> LadderAnswer<'a> {
    /// Runs a scene on its rungs. `None` once `go_on` returns `false`.
    pub fn compute(request: &'a LadderRequest, go_on: impl FnMut() -> bool) -> Option<Self> {
        let LadderRequest { scene, impacts, tolerance } = request;
        let (impacts, tolerance) = (*impacts, *tolerance);
        let steps = run_hierarchy(scene, impacts, go_on)?;
        let (mut rungs, mut bounces) = (Vec::new(), 0);
        let (mut below, mut enough) = (None::<ModelLevel>, None::<ModelLevel>);
        for LevelResult { level: rung, scene, requirement: forced, run } in steps {
            let (mut reason, mut outcome, mut demand, mut change, mut needed) = (None, None, None, None, None);
            match run {
                Err(why) => reason = Some(why),
                Ok(LevelRun { ending, impacts, t, demand: found_demand, change: found }) => {
                    demand = Some(found_demand.into());
                    bounces += impacts;
                    outcome = Some(Outcome::new(ending, impacts, t));
                    needed = found.map(|found| !found.same_outcome || found.state.value > tolerance);
                    change = found.zip(below).map(|(found, below)| ChangeAnswer::new(&found, below.name()));
                    // A needed rung makes every rung below it insufficient.
                    if needed != Some(false) {
                        enough = Some(rung);
                    }
                    below = Some(rung);
                }
            }
            rungs.push(RungAnswer {
                name: rung.name(),
                forced: forced.map(RequirementAnswer::from),
                scene: crate::api::scene::scene_to_json(&scene),
                reason,
                outcome,
                demand,
                cost_ns_per_impact: rung.cost_ns(),
                change,
                needed,
            });
        }
        let (rung, enough) = (scene.model_level(), enough.unwrap_or(scene.model_level()));
        let reason = if enough == rung {
            format!(
                "the scene needs its rung, {}: on the one below it ends otherwise or differs by more than {tolerance} m/s",
                rung.name()
            )
        } else {
            format!(
                "{} would have done: up to {}, {impacts} impacts end alike and differ by at most {tolerance} m/s from rung to rung",
                enough.name(),
                rung.name()
            )
        };
        let reason = if rungs.len() == 1 { "there is no other rung for this body".to_owned() } else { reason };
        Some(Self {
            scene: Resolved(scene),
            impacts,
            tolerance,
            rung: rung.name(),
            enough: enough.name(),
            reason,
            rungs,
            bounces,
        })
    }

    /// Number of bounces computed.
    pub fn bounces(&self) -> u64 {
        self.bounces
    }
}

impl Tabular for LadderAnswer<'_> {
    /// A row for each rung.
    fn to_table(&self) -> Cow<'_, Table> {
        let rungs = &self.rungs;
        let words = |of: &dyn Fn(&RungAnswer) -> Option<&'static str>| Cells::Words(rungs.iter().map(of).collect());
        let texts = |of: &dyn Fn(&RungAnswer) -> Option<String>| Cells::Texts(rungs.iter().map(of).collect());
        let sparse = |of: &dyn Fn(&RungAnswer) -> Option<f64>| Cells::Sparse(rungs.iter().map(of).collect());
        let counts = |of: &dyn Fn(&RungAnswer) -> Option<u64>| Cells::SparseCounts(rungs.iter().map(of).collect());
        let flags = |of: &dyn Fn(&RungAnswer) -> Option<bool>| Cells::Flags(rungs.iter().map(of).collect());
        let change = |of: fn(&ChangeAnswer) -> LargestAnswer| {
            sparse(&move |rung: &RungAnswer| rung.change.as_ref().map(|change| of(change).difference))
        };
        let columns = [
            ("rung", "", words(&|rung| Some(rung.name))),
            ("field", "", words(&|rung| rung.forced.as_ref().map(RequirementAnswer::field))),
            ("outcome", "", words(&|rung| rung.outcome.as_ref().map(|outcome| outcome.kind))),
            ("impacts", "", counts(&|rung| rung.outcome.as_ref().map(|outcome| outcome.impacts))),
            ("t", "s", sparse(&|rung| rung.outcome.as_ref().map(|outcome| outcome.t))),
            ("cost", "ns_per_impact", sparse(&|rung| Some(rung.cost_ns_per_impact))),
            ("needed", "", flags(&|rung| rung.needed)),
            ("change_t", "s", change(|change| change.t)),
            ("change_x", "m", change(|change| change.x)),
            ("change_theta", "rad", change(|change| change.theta)),
            ("change_x_dot", "m_per_s", change(|change| change.x_dot)),
            ("change_y_dot", "m_per_s", change(|change| change.y_dot)),
            ("change_theta_dot", "rad_per_s", change(|change| change.theta_dot)),
            ("reason", "", texts(&|rung| rung.reason.clone())),
        ];
        Cow::Owned(Table(columns.map(|(name, unit, cells)| Column { name, unit, cells }).into()))
    }

    fn end(&self) -> impl Serialize {
        serde_json::json!({ "rung": self.rung, "enough": self.enough, "reason": self.reason })
    }
}
