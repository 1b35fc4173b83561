//! `/v1/ladder`: the same scene on each level of the model hierarchy up to the level that it needs.

use equipoise_physics::analysis::model_hierarchy::{
    COMPARED, LargestDifference, LevelChange, LevelResult, LevelRun, run_hierarchy,
};
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::model::ModelLevel;

use crate::api::computed::trajectories::LINEAR_PRICE;
use crate::api::prelude::*;
use crate::api::shared::answer_parts::{RequirementAnswer, Rung};
use crate::api::shared::outcome::Outcome;

impl ComputedResource for LadderRequest {
    const NAME: &'static str = "ladder";
    const SINGULAR: &'static str = "Ladder";
    type Format = TableFormat;
    const WORK: Work<Self, TableFormat> = Work::Pure {
        canonical: canonical_of,
        compute: |request, format, slice, bounces| {
            let answer = LadderAnswer::compute(request, || slice.should_continue()).ok_or(Cancelled)?;
            bounces.inc_by(answer.computed());
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<LadderAnswer>()
            .table("One row for each rung.", COLUMNS.iter().map(RowColumn::word))
            .end_of::<LadderAnswer>(LadderAnswer::END);
    }
}

request_fields! {
    /// A request for the ladder.
    #[derive(Debug, Clone, Copy, Serialize)]
    pub struct LadderRequest {
        /// The scene.
        #[serde(serialize_with = "resolved")]
        pub scene: Scene = SceneSpec,
        /// Largest number of impacts to follow on each rung.
        pub bounces: u64 = whole(1..=limits::BOUNCES).or(100),
        /// Largest difference of states for which a rung counts as not needed, m/s.
        pub tolerance: f64 = number(TOLERANCES, "m/s").or(1e-3),
    }
}

/// Tolerances, m/s.
const TOLERANCES: std::ops::RangeInclusive<f64> = 1e-15..=10.0;

/// Number of levels of the tallest hierarchy, and the price of one impact on a level other than the linear one, in bounces.
const LEVELS: u64 = 8;
const LEVEL_PRICE: u64 = 20;

/// Price of the rest of the work, in bounces: the setup of the linear solution, and the answer.
const ONCE_PRICE: u64 = 2500;

impl ResourceRequest for LadderRequest {
    fn work(&self) -> u64 {
        ONCE_PRICE + self.bounces * (LEVELS * LEVEL_PRICE + LINEAR_PRICE)
    }
}

/// Answer of `/v1/ladder`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Ladder")]
pub struct LadderAnswer {
    scene: Resolved,
    /// Largest number of impacts on each rung.
    bounces: u64,
    /// Largest difference of states for which a rung counts as not needed, m/s.
    tolerance: f64,
    /// The rung that the scene is run on.
    #[schemars(with = "Rung")]
    rung: &'static str,
    /// The lowest rung that is sufficient.
    #[schemars(with = "Rung")]
    enough: &'static str,
    /// One sentence, with numbers.
    reason: String,
    /// The rungs, the lowest first.
    rungs: Vec<LadderRung>,
    #[serde(skip)]
    computed: u64,
}

/// A rung.
#[derive(Debug, Serialize, JsonSchema)]
struct LadderRung {
    #[schemars(with = "Rung")]
    name: &'static str,
    /// The field that requires the rung. Null for the lowest.
    forced: Option<RequirementAnswer>,
    /// The scene without the fields that this rung leaves out; null if that scene is refused.
    scene: Option<Resolved>,
    /// Reason, if the rung does not apply.
    reason: Option<String>,
    outcome: Option<Outcome>,
    demand: Option<LoadAnswer>,
    /// Cost by a fixed table, ns. It is of one core.
    cost_ns_per_bounce: f64,
    change: Option<RungChange>,
    /// True if the run ends differently from the rung below, or differs from it by more than the tolerance.
    needed: Option<bool>,
}

/// Largest differences from the next lower rung that applies, over the impacts of both.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct RungChange {
    #[schemars(with = "Rung")]
    against: &'static str,
    /// Impacts compared.
    bounces: u64,
    /// True if both end with the same outcome at the same impact.
    same_outcome: bool,
    #[serde(flatten, serialize_with = "by_quantity")]
    #[schemars(with = "DifferencesByQuantity")]
    largest: [LargestDifference; COMPARED.len()],
}

/// Differences in the order of [`COMPARED`].
#[derive(JsonSchema)]
#[expect(dead_code, reason = "a schema alone: the values are an array")]
struct DifferencesByQuantity {
    /// Difference of the time, s.
    t: LargestAnswer,
    /// Difference of the place, m.
    x: LargestAnswer,
    /// Difference of the angle, rad.
    theta: LargestAnswer,
    /// Difference of the horizontal velocity, m/s.
    x_dot: LargestAnswer,
    /// Difference of the vertical velocity, m/s.
    y_dot: LargestAnswer,
    /// Difference of the angular velocity, rad/s.
    theta_dot: LargestAnswer,
    /// Largest difference of ρθ, ẋ, ẏ and ρθ̇, m/s.
    state: LargestAnswer,
}

fn by_quantity<S: Serializer>(largest: &[LargestDifference; COMPARED.len()], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(COMPARED.into_iter().zip(largest.map(LargestAnswer::from)))
}

/// A largest difference.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "LargestDifference")]
struct LargestAnswer {
    difference: f64,
    /// The first impact with that difference; null without a difference.
    impact: Option<u64>,
}

impl From<LargestDifference> for LargestAnswer {
    fn from(LargestDifference { value, impact }: LargestDifference) -> Self {
        Self { difference: value, impact: (impact > 0).then_some(impact) }
    }
}

impl RungChange {
    fn new(LevelChange { impacts, same_outcome, largest }: LevelChange, against: &'static str) -> Self {
        Self { against, bounces: impacts, same_outcome, largest }
    }
}

/// Cost of an impact, ns of one core, fixed as once measured (Zen 4, 3.0 GHz; `cargo bench --bench bounce levels`).
fn cost_ns(level: ModelLevel) -> f64 {
    match level {
        ModelLevel::Point => 135.0,
        ModelLevel::Linear => 120.0,
        ModelLevel::Rod => 86.0,
        ModelLevel::RodWithX | ModelLevel::RigErrors | ModelLevel::Turning => 112.0,
        ModelLevel::Friction => 107.0,
        ModelLevel::Noise | ModelLevel::Delay => 195.0,
        ModelLevel::Drag => 900.0,
        ModelLevel::Polygon => 130.0,
    }
}

impl LadderAnswer {
    /// Runs a scene on its levels. `None` once `go_on` returns `false`.
    pub fn compute(request: &LadderRequest, go_on: impl FnMut() -> bool) -> Option<Self> {
        let LadderRequest { scene, bounces, tolerance } = request;
        let (bounces, tolerance) = (*bounces, *tolerance);
        let steps = run_hierarchy(scene, bounces, go_on)?;
        let (mut rungs, mut computed) = (Vec::new(), 0);
        let (mut below, mut enough) = (None::<ModelLevel>, None::<ModelLevel>);
        for LevelResult { level, scene, requirement: forced, run } in steps {
            let (mut reason, mut outcome, mut demand, mut change, mut needed) = (None, None, None, None, None);
            match run {
                Err(why) => reason = Some(why),
                Ok(LevelRun { ending, impacts, t, load, change: found }) => {
                    demand = Some(load.into());
                    computed += impacts;
                    outcome = Some(Outcome::new(ending, impacts, t));
                    needed = found.map(|found| !found.same_outcome || found.state().value > tolerance);
                    change = found.zip(below).map(|(found, below)| RungChange::new(found, below.name()));
                    // A needed level makes every level below it insufficient.
                    if needed != Some(false) {
                        enough = Some(level);
                    }
                    below = Some(level);
                }
            }
            rungs.push(LadderRung {
                name: level.name(),
                forced: forced.map(|requirement| RequirementAnswer::new(&request.scene, requirement)),
                scene: scene.map(Resolved),
                reason,
                outcome,
                demand,
                cost_ns_per_bounce: cost_ns(level),
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
                "{} would have done: up to {}, {bounces} bounces end alike and differ by at most {tolerance} m/s from rung to rung",
                enough.name(),
                level.name()
            )
        };
        let reason = if rungs.len() == 1 { "there is no other rung for this body".to_owned() } else { reason };
        Some(Self {
            scene: Resolved(*scene),
            bounces,
            tolerance,
            rung: level.name(),
            enough: enough.name(),
            reason,
            rungs,
            computed,
        })
    }

    /// Number of bounces computed.
    pub fn computed(&self) -> u64 {
        self.computed
    }
}

/// Columns of the rungs.
#[rustfmt::skip]
const COLUMNS: [RowColumn<LadderRung>; 14] = [
    RowColumn::new("rung", "", "Name of the rung.", Read::Word(|rung| Some(rung.name))),
    RowColumn::new("field", "", "The field that requires it.", Read::Word(|rung| rung.forced.as_ref().map(RequirementAnswer::field))),
    RowColumn::new("outcome", "", "Ending of its run.", Read::Word(|rung: &LadderRung| rung.outcome.as_ref().map(|outcome| outcome.kind)))
        .among("OutcomeKind"),
    RowColumn::new("bounces", "", "Impacts of its run.", Read::SparseCount(|rung| rung.outcome.as_ref().map(|outcome| outcome.bounces))),
    RowColumn::new("t", "s", "Time of its last impact.", Read::Sparse(|rung| rung.outcome.as_ref().map(|outcome| outcome.t))),
    RowColumn::new("cost", "ns_per_bounce", "Cost by a fixed table.", Read::Sparse(|rung| Some(rung.cost_ns_per_bounce))),
    RowColumn::new("needed", "", "True if it is needed.", Read::Flag(|rung| rung.needed)),
    RowColumn::new("change_t", "s", "Largest difference from the rung below.", Read::Sparse(change::<0>)),
    RowColumn::new("change_x", "m", "", Read::Sparse(change::<1>)),
    RowColumn::new("change_theta", "rad", "", Read::Sparse(change::<2>)),
    RowColumn::new("change_x_dot", "m_per_s", "", Read::Sparse(change::<3>)),
    RowColumn::new("change_y_dot", "m_per_s", "", Read::Sparse(change::<4>)),
    RowColumn::new("change_theta_dot", "rad_per_s", "", Read::Sparse(change::<5>)),
    RowColumn::new("reason", "", "Reason, if it does not apply.", Read::Text(|rung| rung.reason.clone())),
];

/// Largest difference of a quantity from the rung below.
fn change<const QUANTITY: usize>(rung: &LadderRung) -> Option<f64> {
    rung.change.as_ref().map(|change| change.largest[QUANTITY].value)
}

impl Tabular for LadderAnswer {
    const END: &'static [&'static str] = &["rung", "enough", "reason"];

    /// A row for each level.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Owned(table_of(&COLUMNS, &self.rungs))
    }
}
