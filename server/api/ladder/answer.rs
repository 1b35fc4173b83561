//! The answer of `ladder`: the same scene on each level of the model hierarchy up to its own, and the change from level to level.

use std::borrow::Cow;

use equipoise_physics::analysis::model_hierarchy::{
    COMPARED, LargestDifference, LevelChange, LevelResult, LevelRun, run_hierarchy,
};
use equipoise_physics::scene::model::ModelLevel;
use serde::{Serialize, Serializer};

use crate::api::formats::Tabular;
use crate::api::ladder::request::LadderRequest;
use crate::api::scene::Resolved;
use crate::api::shared::actuator_load::LoadAnswer;
use crate::api::shared::model_choice::RequirementAnswer;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::table::{Cells, Column, Table};

/// Answer of `/v1/ladder`.
#[derive(Debug, Serialize)]
pub struct LadderAnswer<'a> {
    scene: Resolved<'a>,
    impacts: u64,
    tolerance: f64,
    /// The level that the scene is run on.
    rung: &'static str,
    /// The lowest level that is sufficient.
    enough: &'static str,
    reason: String,
    rungs: Vec<LevelAnswer>,
    #[serde(skip)]
    bounces: u64,
}

#[derive(Debug, Serialize)]
struct LevelAnswer {
    name: &'static str,
    forced: Option<RequirementAnswer>,
    scene: Option<serde_json::Value>,
    /// The reason for which the level does not apply, if it does not.
    reason: Option<String>,
    outcome: Option<Outcome>,
    demand: Option<LoadAnswer>,
    cost_ns_per_impact: f64,
    change: Option<ChangeAnswer>,
    needed: Option<bool>,
}

#[derive(Debug, Clone, Serialize)]
struct ChangeAnswer {
    against: &'static str,
    impacts: u64,
    same_outcome: bool,
    #[serde(flatten, serialize_with = "by_quantity")]
    largest: [LargestDifference; COMPARED.len()],
}

fn by_quantity<S: Serializer>(largest: &[LargestDifference; COMPARED.len()], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(COMPARED.into_iter().zip(largest.map(LargestAnswer::from)))
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
    fn new(LevelChange { impacts, same_outcome, largest }: LevelChange, against: &'static str) -> Self {
        Self { against, impacts, same_outcome, largest }
    }
}

impl<'a> LadderAnswer<'a> {
    /// Runs a scene on its levels. `None` once `go_on` returns `false`.
    pub fn compute(request: &'a LadderRequest, go_on: impl FnMut() -> bool) -> Option<Self> {
        let LadderRequest { scene, impacts, tolerance } = request;
        let (impacts, tolerance) = (*impacts, *tolerance);
        let steps = run_hierarchy(scene, impacts, go_on)?;
        let (mut rungs, mut bounces) = (Vec::new(), 0);
        let (mut below, mut enough) = (None::<ModelLevel>, None::<ModelLevel>);
        for LevelResult { level, scene, requirement: forced, run } in steps {
            let (mut reason, mut outcome, mut demand, mut change, mut needed) = (None, None, None, None, None);
            match run {
                Err(why) => reason = Some(why),
                Ok(LevelRun { ending, impacts, t, load, change: found }) => {
                    demand = Some(load.into());
                    bounces += impacts;
                    outcome = Some(Outcome::new(ending, impacts, t));
                    needed = found.map(|found| !found.same_outcome || found.state().value > tolerance);
                    change = found.zip(below).map(|(found, below)| ChangeAnswer::new(found, below.name()));
                    // A needed level makes every level below it insufficient.
                    if needed != Some(false) {
                        enough = Some(level);
                    }
                    below = Some(level);
                }
            }
            rungs.push(LevelAnswer {
                name: level.name(),
                forced: forced.map(RequirementAnswer::from),
                scene: scene.as_ref().map(crate::api::scene::scene_to_json),
                reason,
                outcome,
                demand,
                cost_ns_per_impact: level.cost_ns(),
                change,
                needed,
            });
        }
        let (level, enough) = (scene.model_level(), enough.unwrap_or(scene.model_level()));
        let reason = if enough == level {
            format!(
                "the scene needs its rung, {}: on the one below it ends otherwise or differs by more than {tolerance} m/s",
                level.name()
            )
        } else {
            format!(
                "{} would have done: up to {}, {impacts} impacts end alike and differ by at most {tolerance} m/s from rung to rung",
                enough.name(),
                level.name()
            )
        };
        let reason = if rungs.len() == 1 { "there is no other rung for this body".to_owned() } else { reason };
        Some(Self {
            scene: Resolved(scene),
            impacts,
            tolerance,
            rung: level.name(),
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
    /// A row for each level.
    fn to_table(&self) -> Cow<'_, Table> {
        let rungs = &self.rungs;
        let words = |of: &dyn Fn(&LevelAnswer) -> Option<&'static str>| Cells::Words(rungs.iter().map(of).collect());
        let texts = |of: &dyn Fn(&LevelAnswer) -> Option<String>| Cells::Texts(rungs.iter().map(of).collect());
        let sparse = |of: &dyn Fn(&LevelAnswer) -> Option<f64>| Cells::Sparse(rungs.iter().map(of).collect());
        let counts = |of: &dyn Fn(&LevelAnswer) -> Option<u64>| Cells::SparseCounts(rungs.iter().map(of).collect());
        let flags = |of: &dyn Fn(&LevelAnswer) -> Option<bool>| Cells::Flags(rungs.iter().map(of).collect());
        let change = |quantity: usize| {
            sparse(&move |level: &LevelAnswer| level.change.as_ref().map(|change| change.largest[quantity].value))
        };
        let columns = [
            ("rung", "", words(&|level| Some(level.name))),
            ("field", "", words(&|level| level.forced.as_ref().map(RequirementAnswer::field))),
            ("outcome", "", words(&|level| level.outcome.as_ref().map(|outcome| outcome.kind))),
            ("impacts", "", counts(&|level| level.outcome.as_ref().map(|outcome| outcome.impacts))),
            ("t", "s", sparse(&|level| level.outcome.as_ref().map(|outcome| outcome.t))),
            ("cost", "ns_per_impact", sparse(&|level| Some(level.cost_ns_per_impact))),
            ("needed", "", flags(&|level| level.needed)),
            ("change_t", "s", change(0)),
            ("change_x", "m", change(1)),
            ("change_theta", "rad", change(2)),
            ("change_x_dot", "m_per_s", change(3)),
            ("change_y_dot", "m_per_s", change(4)),
            ("change_theta_dot", "rad_per_s", change(5)),
            ("reason", "", texts(&|level| level.reason.clone())),
        ];
        Cow::Owned(Table(columns.map(|(name, unit, cells)| Column { name, unit, cells }).into()))
    }

    fn in_table(&self) -> &'static [&'static str] {
        &[]
    }

    fn end(&self) -> impl Serialize {
        serde_json::json!({ "rung": self.rung, "enough": self.enough, "reason": self.reason })
    }
}
