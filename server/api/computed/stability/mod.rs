//! `/v1/stability`: the verdict on a scene.

pub mod budget;
pub mod evidence;
mod open_metrics;
pub mod request;
pub mod verdict;

use equipoise_physics::analysis::basin::{NoBasin, find_basin};
use equipoise_physics::analysis::boundary::loss_kind;
use equipoise_physics::analysis::contact_regime::stick_cone;
use equipoise_physics::analysis::evidence::{Balance, Evidence, SMALL_RUN, judge};
use equipoise_physics::analysis::fixed_point::{FixedPoint, is_plain, plain_drift};
use equipoise_physics::analysis::losses::search_ends;
use equipoise_physics::analysis::margins::judgement::NoMargins;
use equipoise_physics::analysis::margins::{Tolerance, ValueRange, margins_over_tolerances};
use equipoise_physics::analysis::nonlinear_run::run_watched;
use equipoise_physics::analysis::regularity::{Regularity, TOLERANCE};
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::small_deviations::SmallDeviations;
use equipoise_physics::analysis::verdict::Verdict;
use equipoise_physics::control::bounce_model::BounceModel;
use equipoise_physics::map::body::PreImpact;
use equipoise_physics::map::strike::State;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::{Name, Scene};
use prometheus_client::metrics::counter::Counter;

use crate::api::computed::stability::budget::{BudgetAnswer, add_release_margins};
use crate::api::computed::stability::evidence::{
    Basin, Chaos, LinearPart, LossKind, LossOfStability, Lyapunov, RotationNumber, cycle_sentence, explain,
};
use crate::api::computed::stability::request::{StabilityRequest, Tolerated};
use crate::api::computed::stability::verdict::{
    SteadyDriftAnswer, SwingPumpAnswer, VerdictAnswer, code, delay_notes, friction_note, gain_notes, height_note,
};
use crate::api::prelude::*;
use crate::api::shared::answer_parts::draw_closed_loop;
use crate::api::shared::margins::{
    ENERGY_GAIN, HasMargins, Margin, MarginEnd, RELEASE, SMALL, TILT_GAIN, least, limits, margins, release_limits,
    release_margins,
};
use crate::api::shared::model_words::belief;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::refusal::sentence;
use crate::charts::{Eigenvalues, Spectrum, eigenvalues};

/// Computes an answer, and counts its bounces.
///
/// # Errors
/// Cancelled work.
pub fn computed(
    request: &StabilityRequest,
    slice: &TimeSlice,
    bounces: &Counter,
) -> Result<StabilityAnswer, Cancelled> {
    let answer = StabilityAnswer::compute(request, || slice.should_continue()).ok_or(Cancelled)?;
    bounces.inc_by(answer.bounces());
    Ok(answer)
}

impl ComputedResource for StabilityRequest {
    const NAME: &'static str = "stability";
    const SINGULAR: &'static str = "Stability";
    type Format = GaugeFormat;
    const WORK: Work<Self, GaugeFormat> = Work::Pure {
        canonical: canonical_of,
        compute: |request, format, slice, bounces| format.write(&computed(request, slice, bounces)?, slice),
    };

    fn describe(contract: &mut Description<'_>) {
        let words = |columns: &[RowColumn<StabilityAnswer>], only: &'static str| -> Vec<ColumnWord> {
            columns.iter().map(|column| column.word().only(only)).collect()
        };
        let columns = [
            words(&StabilityAnswer::COLUMNS, ""),
            words(&limits(), ""),
            words(&margins(), ""),
            words(&release_limits(), "with `release_margins`"),
            words(&release_margins(), "with `release_margins`"),
            words(&least(), "with `tolerances`"),
            COLUMNS.map(|column| column.word().only("with `tolerances`")).to_vec(),
        ];
        contract
            .answer::<StabilityAnswer>()
            .table("One row.", columns.concat())
            .end_of::<StabilityAnswer>(StabilityAnswer::END);
    }
}

/// Parts of an answer that need a bounce that repeats.
const WITHOUT_BALANCE: &str = "fixed_point, linear, boundary, loss_of_stability, lyapunov, rotation_number, chaos and predictable_bounces are null";

/// Behaviour at the critical tilt gain. Null for a point mass, with friction on a table that only tilts, with state feedback of more than
/// `theta`, with noise, without a fixed point, and where a swing at κ_c moves a kept quantity.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct Boundary {
    /// Positive: soft, the motion is bounded at the critical gain and a little beyond. Negative: hard, the body falls.
    coefficient: f64,
    #[schemars(with = "LossKind")]
    kind: &'static str,
}

/// The run of the scene.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "NonlinearRun")]
pub(crate) struct NonlinearPart {
    outcome: Outcome,
    /// Largest angle at a contact, either way, rad.
    #[schemars(with = "Option<f64>")]
    max_theta: f64,
    demand: LoadAnswer,
}

/// Answer of `/v1/stability`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Stability")]
pub struct StabilityAnswer {
    scene: Resolved,
    derived: Derived,
    model: ModelChoice,
    pub(crate) verdict: VerdictAnswer,
    fixed_point: Option<FixedPointAnswer>,
    linear: Option<LinearPart>,
    boundary: Option<Boundary>,
    /// The way stability is lost at the ends of the linear verdict, with friction, air and turning tables too. An end at which a motion moves a
    /// kept quantity is omitted, with a note. Null without a fixed point.
    loss_of_stability: Option<Vec<LossOfStability>>,
    lyapunov: Option<Lyapunov>,
    pub(crate) nonlinear: NonlinearPart,
    /// Permanent horizontal velocity by the linear map, m/s. Null at tilt gain 1, for a point mass, with noise, and where feedback, friction or
    /// the air brings every drift to one.
    drift_speed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    steady_drift: Option<SteadyDriftAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    swing_pump: Option<SwingPumpAnswer>,
    /// True if the linear verdict and the run agree.
    agree: Option<bool>,
    rotation_number: Option<RotationNumber>,
    pub(crate) chaos: Option<Chaos>,
    /// The impact at which rounding, multiplied by the derivatives along the run, has reached a thousandth of the speed of the bounce: from there
    /// on a single run has no meaning. Null if this does not happen within the first 500 impacts, with noise, and without a fixed point.
    predictable_bounces: Option<u64>,
    basin: Option<Basin>,
    /// The reason why there is no basin, if one was requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_basin: Option<String>,
    /// Margins of the gains as they are set. A gain of which no value is stable has none. Empty without a bounce that repeats, but for those of the
    /// release.
    margins: Vec<Margin>,
    #[serde(skip_serializing_if = "Option::is_none")]
    over_tolerances: Option<OverTolerances>,
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<BudgetAnswer>,
    /// Reasons for null values, and further remarks.
    notes: Vec<String>,
    #[serde(skip)]
    computed: u64,
}

impl StabilityAnswer {
    /// Columns, of which some are gauges.
    #[rustfmt::skip]
    const COLUMNS: [RowColumn<Self>; 34] = [
        RowColumn::new("verdict", "", "The verdict in words.", Read::Text(|it: &Self| Some(it.verdict.text.clone()))).always(),
        RowColumn::new("verdict_code", "", "The verdict for programs.", Read::Word(|it: &Self| Some(it.verdict.code))).among("VerdictCode").always(),
        RowColumn::new("decided_by", "", "The analysis that decided.", Read::Word(|it: &Self| Some(it.verdict.decided_by))).among("VerdictDecidedBy").always(),
        RowColumn::new("reason", "", "Reason in a sentence.", Read::Text(|it: &Self| Some(it.verdict.reason.clone()))).always(),
        RowColumn::new("agree", "", "True if the linear verdict and the run agree.", Read::Flag(|it| it.agree)),
        RowColumn::new("linear_kind", "", "Kind of the linear map.", Read::Word(|it: &Self| Some(it.linear.as_ref()?.kind))).among("LinearKind"),
        RowColumn::new("residue", "", "Greene's residue, stable between 0 and 1.", Read::Sparse(|it| it.linear.as_ref()?.residue)),
        RowColumn::new("rotation", "rad", "Rotation per bounce.", Read::Sparse(|it| it.linear.as_ref()?.rotation)),
        RowColumn::new("spectral_radius", "", "Largest modulus of the eigenvalues.", Read::Sparse(|it| Some(it.linear.as_ref()?.spectral_radius))),
        RowColumn::new("tilt_gain", "", "Tilt gain.", Read::Sparse(|it| it.gain(TILT_GAIN))),
        RowColumn::new("energy_gain", "s²/m²", "Energy gain.", Read::Sparse(|it| it.gain(ENERGY_GAIN))),
        RowColumn::new("boundary_coefficient", "", "Loss of stability at the upper end: soft if positive.", Read::Sparse(|it| Some(it.boundary.as_ref()?.coefficient))),
        RowColumn::new("boundary_kind", "", "", Read::Word(|it: &Self| Some(it.boundary.as_ref()?.kind))).among("LossKind"),
        RowColumn::new("drift_speed", "m/s", "Permanent horizontal velocity.", Read::Sparse(|it| it.drift_speed)),
        RowColumn::new("outcome", "", "Ending of the run.", Read::Word(|it: &Self| Some(it.nonlinear.outcome.kind))).among("OutcomeKind"),
        RowColumn::new("bounces", "", "Contacts of the run.", Read::Count(|it| it.nonlinear.outcome.bounces)),
        RowColumn::new("t", "s", "Run time of the last contact.", Read::Sparse(|it| Some(it.nonlinear.outcome.t))),
        RowColumn::new("max_theta", "rad", "Largest angle at a contact, either way.", Read::Sparse(|it| Some(it.nonlinear.max_theta))),
        RowColumn::new("energy_eigenvalue", "", "Factor on a deviation of the height at each bounce.", Read::Sparse(|it| Some(it.linear.as_ref()?.energy_eigenvalue))),
        RowColumn::new("fixed_point_y_dot", "m/s", "", Read::Sparse(|it| Some(it.fixed_point.as_ref()?.y_dot))),
        RowColumn::new("fixed_point_flight_time", "s", "", Read::Sparse(|it| Some(it.fixed_point.as_ref()?.flight_time))),
        RowColumn::new("rotation_number_measured", "", "", Read::Sparse(|it| it.rotation_number.as_ref()?.measured)),
        RowColumn::new("rotation_number_small", "", "", Read::Sparse(|it| Some(it.rotation_number.as_ref()?.small))),
        RowColumn::new("resonance_p", "", "", Read::SparseCount(|it| Some(it.rotation_number.as_ref()?.resonance.p.into()))),
        RowColumn::new("resonance_q", "", "", Read::SparseCount(|it| Some(it.rotation_number.as_ref()?.resonance.q.into()))),
        RowColumn::new("resonance_distance", "", "", Read::Sparse(|it| Some(it.rotation_number.as_ref()?.resonance.distance))),
        RowColumn::new("chaos_indicator", "", "", Read::Sparse(|it| Some(it.chaos.as_ref()?.indicator))),
        RowColumn::new("chaotic", "", "", Read::Flag(|it| Some(it.chaos.as_ref()?.chaotic))),
        RowColumn::new("predictable_bounces", "", "", Read::SparseCount(|it| it.predictable_bounces)),
        RowColumn::new("basin_theta", "rad", "Largest angle of release that survives.", Read::Sparse(|it| Some(it.basin.as_ref()?.theta))),
        RowColumn::new("basin_unbroken", "rad", "Largest angle of release below which all survive.", Read::Sparse(|it| Some(it.basin.as_ref()?.unbroken))),
        RowColumn::new("lyapunov_coefficient", "per_rad2", "First Lyapunov coefficient, per bounce: swings grow if positive.", Read::Sparse(|it| Some(it.lyapunov.as_ref()?.coefficient))),
        RowColumn::new("lyapunov_kind", "", "", Read::Word(|it: &Self| Some(it.lyapunov.as_ref()?.kind))).among("LyapunovKind"),
        RowColumn::new("escape_bounces", "", "Impacts in which the swing leaves upright.", Read::SparseCount(|it| it.lyapunov.as_ref()?.escape_bounces)),
    ];

    /// All columns of a row: those of margins with `tolerances` and `release_margins` only if they are requested.
    fn columns(&self) -> Vec<RowColumn<Self>> {
        let small = Self::COLUMNS.into_iter().chain(limits()).chain(margins());
        let has_release = self.margins.iter().any(|margin| margin.of == RELEASE);
        let release = release_limits().into_iter().chain(release_margins()).filter(move |_| has_release);
        small.chain(release).chain(least().into_iter().filter(|_| self.over_tolerances.is_some())).collect()
    }

    /// Value of a gain that has margins.
    fn gain(&self, field: &str) -> Option<f64> {
        self.margins.iter().find(|margin| (margin.of, margin.field) == (SMALL, field)).map(|margin| margin.value)
    }
}

impl HasMargins for StabilityAnswer {
    fn margins(&self) -> &[Margin] {
        &self.margins
    }
}

impl StabilityAnswer {
    /// Judges a scene by its linear verdict and a run, and looks for its basin and its budget on request. None if `go_on` returned false.
    pub fn compute(request: &StabilityRequest, mut go_on: impl FnMut() -> bool) -> Option<Self> {
        let StabilityRequest { ref scene, bounces, basin, budget, release_margins, tolerances } = *request;
        let watched = run_watched(scene, bounces, &mut go_on)?;
        let run = watched.summary;
        let mut notes = Vec::new();
        let judged = &scene.with_tilt_law();
        if judged.model().feedback().is_none() && scene.model().feedback().is_some() {
            let kappa = judged.number(Name::TiltGain).unwrap_or_default();
            notes.push(format!(
                "table.feedback feeds back theta alone, which is a tilt_gain of {kappa}: it is judged as that"
            ));
        }
        let mut judgement = judge(scene, &run, SMALL_RUN, &mut go_on)?;
        let over_tolerances = match tolerances {
            None => None,
            Some(tolerances) => {
                let mut over = OverTolerances::compute(judged, &tolerances, &mut go_on)?;
                over.weigh(judgement.verdict);
                Some(over)
            }
        };
        let mut answer = Self {
            scene: Resolved(*scene),
            derived: Derived::of(scene),
            model: ModelChoice::of(scene),
            verdict: VerdictAnswer {
                code: code(judgement.verdict),
                text: verdict::verdict(&judgement, &run),
                decided_by: judgement.decided_by.name(),
                reason: String::new(),
            },
            fixed_point: None,
            linear: None,
            boundary: None,
            loss_of_stability: None,
            lyapunov: None,
            nonlinear: NonlinearPart {
                outcome: Outcome::new(run.ending, run.impacts, run.t),
                max_theta: run.max_theta,
                demand: run.load.into(),
            },
            drift_speed: None,
            steady_drift: None,
            swing_pump: None,
            agree: Some(judgement.says_bounded == (run.ending == Ending::Completed)),
            rotation_number: None,
            chaos: None,
            predictable_bounces: None,
            basin: None,
            no_basin: None,
            margins: Vec::new(),
            over_tolerances,
            budget: None,
            notes: Vec::new(),
            computed: run.impacts + judgement.bounces,
        };
        let mut chaos = None;
        match &mut judgement.evidence {
            Evidence::Balances(balance) => {
                answer.drifts(scene, Ok(&balance.small), &mut notes);
                let (losses, without) = search_ends(judged, &mut balance.small, &mut go_on)?;
                balance.losses.extend(losses);
                balance.notes.extend(without);
                let regularity = watched.regularity(judged, &balance.small);
                chaos = regularity.as_ref().and_then(|regularity| regularity.chaos);
                notes.extend(answer.balance(judged, balance, regularity.as_ref(), run.max_theta));
            }
            Evidence::NothingRepeats(why) => {
                answer.drifts(scene, Err(why), &mut notes);
                notes.push(format!("{WITHOUT_BALANCE}: no bounce repeats"));
            }
            Evidence::Ensemble { .. } => {
                let noise = scene
                    .noise_field()
                    .and_then(|name| Some(format!(", and {} is {}", name.row().path, scene.number(name)?)))
                    .unwrap_or_default();
                notes.push(format!("drift_speed, {WITHOUT_BALANCE}: they are of runs without noise{noise}"));
            }
            Evidence::NoContact => notes.push(format!("drift_speed, {WITHOUT_BALANCE}: no bounce repeats")),
        }
        answer.verdict.reason = verdict::reason(scene, &judgement, &run, chaos);
        notes.extend(cycle_sentence(scene));
        if basin {
            match find_basin(judged, bounces, &mut go_on) {
                Ok(basin) => {
                    notes.push(format!(
                        "basin: released at rest; no hole wider than {} rad was missed, and its edges are known to {} rad",
                        basin.spacing, basin.tolerance
                    ));
                    answer.computed += basin.bounces;
                    answer.basin = Some(basin.into());
                }
                Err(NoBasin::Stopped) => return None,
                Err(NoBasin::Lacks(lack)) => answer.no_basin = Some(sentence(scene, Analysis::Basin, lack)),
                Err(NoBasin::Because(why)) => answer.no_basin = Some(why),
            }
            notes.extend(answer.no_basin.iter().map(|why| format!("basin is null: {why}")));
        }
        if budget {
            let found = BudgetAnswer::compute(scene, bounces, &mut go_on)?;
            answer.computed += found.computed;
            answer.budget = Some(found);
        }
        if release_margins {
            answer.computed += add_release_margins(&mut answer.margins, scene, bounces, &mut go_on)?;
        }
        answer.notes = notes;
        Some(answer)
    }

    /// Fills in the drift that a balanced run keeps, with notes on what is null beside it.
    fn drifts(&mut self, scene: &Scene, small: Result<&SmallDeviations, &NoRepeatingBounce>, notes: &mut Vec<String>) {
        let judged = scene.with_tilt_law();
        let of_plain = || is_plain(&judged).then(|| plain_drift(&judged)).flatten();
        self.drift_speed = small.map_or_else(|_| of_plain(), |small| small.drift);
        self.steady_drift = SteadyDriftAnswer::of(&judged, small);
        notes.extend(verdict::null_notes(&judged, self.drift_speed, self.steady_drift.is_some(), small.is_ok()));
    }

    /// Fills in the evidence about a bounce that repeats. Gives the notes on it.
    fn balance(
        &mut self,
        scene: &Scene,
        balance: &Balance,
        regularity: Option<&Regularity>,
        max_theta: f64,
    ) -> Vec<String> {
        let Balance { small, boundary, losses, .. } = balance;
        let SmallDeviations { fixed_point, linear, .. } = small;
        let model = scene.model();
        let mut notes = Vec::new();
        if let Some(cone) = stick_cone(&model) {
            notes.push(format!(
                "stick cone: the linear analysis holds where the matched contact sticks, for |θ| up to about {cone} rad \
                 (μ(ρ² + l²)/(l²|κ − 1|)); this run came to {max_theta} rad"
            ));
        }
        self.boundary = boundary.map(|coefficient| Boundary { coefficient, kind: loss_kind(coefficient) });
        self.loss_of_stability = Some(losses.iter().map(LossOfStability::from).collect());
        notes.extend(balance.notes.iter().cloned());
        match Lyapunov::of(balance) {
            Ok(found) => self.lyapunov = Some(found),
            Err(why) => notes.push(format!("lyapunov is null: {why}")),
        }
        if linear.residue.is_some() && linear.rotation.is_none() {
            notes.push("rotation is null: at this tilt_gain the angle does not circle".to_owned());
        }
        self.computed += regularity.map_or(0, Regularity::bounces);
        explain(regularity, linear, &mut notes);
        self.swing_pump = SwingPumpAnswer::of(scene, balance);
        self.predictable_bounces = regularity.and_then(|it| it.predictable_impacts(TOLERANCE));
        self.chaos = regularity.and_then(|it| it.chaos).map(Chaos::from);
        self.rotation_number = regularity.and_then(|it| it.rotation).map(RotationNumber::from);
        notes.extend(height_notes(scene, fixed_point));
        notes.extend(friction_note(scene));
        notes.extend(gain_notes(scene));
        notes.extend(height_note(scene, balance));
        notes.extend(delay_notes(scene, fixed_point));
        self.linear = Some(LinearPart::new(linear));
        self.margins = Margin::of_small(scene, small);
        if let Some(over_tolerances) = &self.over_tolerances {
            over_tolerances.widen(&mut self.margins);
        }
        self.fixed_point = Some((*fixed_point).into());
        notes
    }

    /// Number of bounces computed: those of the run, of the watch over it, of the basin and of the budget.
    pub fn bounces(&self) -> u64 {
        self.computed
    }
}

/// Notes on the height at which a bounce settles.
fn height_notes(scene: &Scene, fixed_point: &FixedPoint) -> Vec<String> {
    let mut notes = Vec::new();
    let drifts = fixed_point.x_dot != 0.0;
    let misses = scene.assumed_restitution() != scene.parameters::<f64>().restitution || scene.moves_late();
    let is_free = scene.running_model().drag.is_none_or(|drag| drag.linear == 0.0) && scene.program().is_none();
    if let Some(target) = scene.target_height(1).filter(|_| misses && is_free && !drifts) {
        let height = fixed_point.apex_height;
        notes.push(format!(
            "{}: the height settles at {height} m, {} m above target_height",
            belief(scene),
            height - target
        ));
    }
    if drifts {
        notes.push(format!(
            "the total energy that the table holds has that of the drift of {} m/s in it: the height settles at {} m",
            fixed_point.x_dot, fixed_point.apex_height
        ));
    }
    notes
}

impl Tabular for StabilityAnswer {
    const END: &'static [&'static str] = &["notes"];

    /// The scalars, in one row.
    fn to_table(&self) -> Cow<'_, Table> {
        let mut table = table_of(&self.columns(), std::slice::from_ref(self));
        if let Some(over_tolerances) = &self.over_tolerances {
            table.0.extend(table_of(&COLUMNS, std::slice::from_ref(over_tolerances)).0);
        }
        Cow::Owned(table)
    }
}

/// Small deviations over all bodies within the tolerances, if tolerances are requested; the least margins of the gain are in `margins`. Everything
/// except `tolerances` is null, with a `reason` that names the values, for a point mass, and if no bounce of one of the bodies repeats, as with a
/// constant tilt without feedback of x.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct OverTolerances {
    /// In the order of the request.
    tolerances: Vec<FieldTolerance>,
    /// True if small deviations stay bounded for all of them, and the `verdict_code` of the scene is `stable_in_place`, `stable_drifting`,
    /// `weakly_attracting` or `elliptic`.
    holds: Option<bool>,
    /// The body with the least upper limit of the gain: the values of the fields of `tolerances`, in their order. Also null if no tilt gain is
    /// stable.
    worst: Option<Vec<FieldValue>>,
    /// Height of the centre of gravity at the top of the bounce in place, m.
    apex_height: Option<SpanAnswer>,
    energy_eigenvalue: Option<SpanAnswer>,
    reason: String,
    /// The gain, and the spans of its lower and its upper limit.
    #[serde(skip)]
    gain: Option<(&'static str, [ValueRange; 2])>,
}

/// A field with its tolerance.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct FieldTolerance {
    field: &'static str,
    unit: &'static str,
    tolerance: f64,
}

/// A field with its value.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct FieldValue {
    field: &'static str,
    unit: &'static str,
    value: f64,
}

/// Least and greatest value.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "Span")]
struct SpanAnswer {
    least: f64,
    most: f64,
}

impl From<ValueRange> for SpanAnswer {
    fn from(ValueRange { least, most }: ValueRange) -> Self {
        Self { least, most }
    }
}

/// Columns and gauges.
#[rustfmt::skip]
const COLUMNS: [RowColumn<OverTolerances>; 6] = [
    RowColumn::new("over_tolerances_holds", "", "True if the verdict holds for every body within the tolerances.", Read::Flag(|it| it.holds)),
    RowColumn::new("over_tolerances_apex_height_least", "m", "Lowest top of the bounce in place within the tolerances.", Read::Sparse(|it| Some(it.apex_height?.least))),
    RowColumn::new("over_tolerances_apex_height_most", "m", "Highest top of the bounce in place within them.", Read::Sparse(|it| Some(it.apex_height?.most))),
    RowColumn::new("over_tolerances_energy_eigenvalue_least", "", "Smallest eigenvalue of the height within the tolerances.", Read::Sparse(|it| Some(it.energy_eigenvalue?.least))),
    RowColumn::new("over_tolerances_energy_eigenvalue_most", "", "Largest eigenvalue of the height within them.", Read::Sparse(|it| Some(it.energy_eigenvalue?.most))),
    RowColumn::new("over_tolerances_worst", "", "Values of the fields of `tolerances` with the least upper limit of the gain.", Read::List(|it| Some(it.worst().iter().map(|field| field.value).collect()).filter(|it: &Vec<_>| !it.is_empty()))),
];

impl OverTolerances {
    /// Values of the fields of `tolerances` with the least upper limit of the gain.
    fn worst(&self) -> &[FieldValue] {
        self.worst.as_deref().unwrap_or_default()
    }

    /// Adds the least and the greatest margins to those of the scene.
    fn widen(&self, margins: &mut [Margin]) {
        let Some((field, [lower, upper])) = self.gain else { return };
        for margin in margins.iter_mut().filter(|margin| margin.field == field && margin.of == SMALL) {
            let value = margin.value;
            for (end, least, most) in [
                (&mut margin.below, value - lower.most, value - lower.least),
                (&mut margin.above, upper.least - value, upper.most - value),
            ] {
                if let Some(end) = end {
                    let finite = |margin: f64| margin.is_finite().then_some(margin);
                    (end.least, end.most) = (finite(least), finite(most));
                }
            }
        }
    }

    /// Takes back that the margins hold where the verdict on the scene itself does not.
    fn weigh(&mut self, verdict: Verdict) {
        if self.holds.is_some() && !verdict.holds() {
            self.holds = Some(false);
            self.reason = format!("the verdict on the scene itself is `{}`; {}", code(verdict), self.reason);
        }
    }

    /// Those of a scene with a tilt law. None if `go_on` returned false.
    pub fn compute(scene: &Scene, tolerated: &Tolerated, go_on: &mut dyn FnMut() -> bool) -> Option<Self> {
        let fields: Vec<Tolerance> = tolerated.iter().flatten().copied().collect();
        let tolerance = |&Tolerance { name, off }: &Tolerance| FieldTolerance {
            field: name.row().path,
            unit: name.row().unit,
            tolerance: off,
        };
        let tolerances = fields.iter().map(tolerance).collect();
        Some(match margins_over_tolerances(scene, &fields, go_on) {
            Err(NoMargins::Stopped) => return None,
            Err(NoMargins::Because(reason)) => Self {
                tolerances,
                holds: None,
                worst: None,
                apex_height: None,
                energy_eigenvalue: None,
                reason,
                gain: None,
            },
            Ok(margins) => {
                let worst = |field: &Tolerance| {
                    let (name, value) = *margins.worst.iter().find(|(name, _)| *name == field.name)?;
                    Some(FieldValue { field: name.row().path, unit: name.row().unit, value })
                };
                let reason = if margins.holds {
                    "small deviations stay bounded for every body within the tolerances"
                } else {
                    "small deviations grow for some body within the tolerances"
                };
                Self {
                    tolerances,
                    holds: Some(margins.holds),
                    worst: margins.critical.least.is_finite().then(|| fields.iter().filter_map(worst).collect()),
                    apex_height: Some(margins.apex_height.into()),
                    energy_eigenvalue: Some(margins.energy_eigenvalue.into()),
                    reason: reason.to_owned(),
                    gain: Some((margins.gain.name(), [margins.lower, margins.critical])),
                }
            }
        })
    }
}

impl Pictured for StabilityAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let body = self.scene.0.with_tilt_law().model();
        if let (Some(gain), Some(place)) = (body.feedback(), &self.fixed_point) {
            let upright = State { theta: 0.0, x_dot: 0.0, y_dot: place.y_dot, theta_dot: 0.0 };
            let model = BounceModel::of(&body, &PreImpact::at(1, place.x.unwrap_or(0.0), upright), place.flight_time);
            let title = format!("Closed loop: {}", self.verdict.text);
            return Ok(draw_closed_loop(&title, &self.verdict.reason, &model, gain));
        }
        let values = self.eigenvalues();
        Ok(eigenvalues(&Eigenvalues {
            title: &format!("Eigenvalues of a {}", self.model.name.replace('_', " ")),
            verdict: &self.verdict.text,
            reason: &self.verdict.reason,
            linear: self.spectrum(&values).filter(|spectrum| !spectrum.lower.is_nan()),
        }))
    }
}

impl StabilityAnswer {
    fn eigenvalues(&self) -> Vec<(f64, f64)> {
        self.linear.iter().flat_map(|linear| &linear.eigenvalues).map(|value| (value.re, value.im)).collect()
    }

    /// The linear analysis as it is drawn. Without a tilt gain that balances, its numbers are NaN, and there is no path to draw.
    fn spectrum<'a>(&self, eigenvalues: &'a [(f64, f64)]) -> Option<Spectrum<'a>> {
        let linear = self.linear.as_ref()?;
        let margin = self.margins.iter().find(|margin| (margin.of, margin.field) == (SMALL, TILT_GAIN));
        let [tilt_gain, lower, critical] = margin.map_or([f64::NAN; 3], |Margin { value, below, above, .. }| {
            let limit = |end: &Option<MarginEnd>, none: f64| end.as_ref().map_or(none, |end| end.limit);
            [*value, limit(below, f64::NAN), limit(above, f64::INFINITY)]
        });
        let (residue, rotation) = (linear.residue, linear.rotation);
        Some(Spectrum { eigenvalues, tilt_gain, lower, critical, residue, rotation })
    }
}
