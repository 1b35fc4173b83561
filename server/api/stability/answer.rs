//! The answer of `stability`: the verdict and the evidence for it.

use std::borrow::Cow;

use equipoise_physics::analysis::basin::{NoBasin, find_basin};
use equipoise_physics::analysis::boundary::underived;
use equipoise_physics::analysis::contact_regime::stick_cone;
use equipoise_physics::analysis::evidence::{self, Balance, SMALL_RUN, judge};
use equipoise_physics::analysis::fixed_point::{FixedPoint, is_plain, plain_drift};
use equipoise_physics::analysis::losses::search_ends;
use equipoise_physics::analysis::nonlinear_run::run_watched;
use equipoise_physics::analysis::repeating::NoRepeatingBounce;
use equipoise_physics::analysis::small_deviations::SmallDeviations;
use equipoise_physics::run::ending::Ending;
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{Name, Scene};
use serde::Serialize;

use crate::api::formats::Tabular;
use crate::api::scene::{Derived, Resolved};
use crate::api::shared::actuator_load::LoadAnswer;
use crate::api::shared::fixed_point::FixedPointAnswer;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::outcome::Outcome;
use crate::api::shared::refusal::sentence;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::stability::budget::BudgetAnswer;
use crate::api::stability::cycle::cycle_sentence;
use crate::api::stability::evidence::{Basin, Chaos, Evidence, LossOfStability, Lyapunov, RotationNumber};
use crate::api::stability::gain_margins::GainMarginAnswer;
use crate::api::stability::linear::LinearPart;
use crate::api::stability::margins::MarginsAnswer;
use crate::api::stability::request::StabilityRequest;
use crate::api::stability::rig::{
    SteadyDriftAnswer, SwingPumpAnswer, delay_notes, friction_note, gain_notes, height_note,
};
use crate::api::stability::verdict_name::code;
use crate::api::stability::words;

/// Parts of an answer that need a bounce that repeats.
const WITHOUT_BALANCE: &str = "fixed_point, linear, boundary, loss_of_stability, lyapunov, rotation_number, chaos and predictable_impacts are null";

#[derive(Debug, Clone, Serialize)]
pub(super) struct Boundary {
    pub(super) coefficient: f64,
    kind: &'static str,
}

#[derive(Debug, Clone, Serialize)]
pub(super) struct NonlinearPart {
    pub(super) outcome: &'static str,
    pub(super) impacts: u64,
    pub(super) t: f64,
    pub(super) max_theta: f64,
    demand: LoadAnswer,
    detail: String,
}

/// A verdict without its evidence.
#[derive(Debug, Serialize)]
pub struct Judgement {
    verdict: Option<String>,
    verdict_code: Option<&'static str>,
    decided_by: Option<&'static str>,
    /// Reason, in a sentence with numbers.
    pub reason: String,
}

/// Answer of `/v1/stability`.
#[derive(Debug, Clone, Serialize)]
pub struct StabilityAnswer<'a> {
    pub(super) scene: Resolved<'a>,
    derived: Derived,
    pub(super) model: ModelChoice,
    pub(super) verdict: Option<String>,
    pub(super) verdict_code: Option<&'static str>,
    decided_by: Option<&'static str>,
    pub(super) reason: String,
    pub(super) fixed_point: Option<FixedPointAnswer>,
    pub(super) linear: Option<LinearPart>,
    pub(super) boundary: Option<Boundary>,
    loss_of_stability: Option<Vec<LossOfStability>>,
    pub(super) lyapunov: Option<Lyapunov>,
    pub(super) nonlinear: NonlinearPart,
    pub(super) drift_speed: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    steady_drift: Option<SteadyDriftAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    swing_pump: Option<SwingPumpAnswer>,
    pub(super) agree: Option<bool>,
    rotation_number: Option<RotationNumber>,
    chaos: Option<Chaos>,
    predictable_impacts: Option<u64>,
    pub(super) basin: Option<Basin>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) margins: Option<MarginsAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<BudgetAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gain_margins: Option<[GainMarginAnswer; 2]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    dial: Option<String>,
    notes: Vec<String>,
    #[serde(skip)]
    bounces: u64,
}

impl<'a> StabilityAnswer<'a> {
    /// Judges a scene by its linear verdict and a run, and looks for its basin and its budget on request. None if `go_on` returned false.
    pub fn compute(request: &'a StabilityRequest, mut go_on: impl FnMut() -> bool) -> Option<Self> {
        let StabilityRequest { ref scene, impacts, basin, budget, dial, gain_margins, tolerances } = *request;
        let watched = run_watched(scene, impacts, &mut go_on)?;
        let run = watched.summary;
        let mut notes = Vec::new();
        let judged = &scene.with_tilt_law();
        if judged.model().feedback().is_none() && scene.model().feedback().is_some() {
            let kappa = judged.number(Name::TiltGain).unwrap_or_default();
            notes.push(format!(
                "table.feedback feeds back theta alone, which is a tilt_gain of {kappa}: it is judged as that"
            ));
        }
        let margins = match tolerances {
            None => None,
            Some(tolerances) => {
                let tilt_gain = judged.number(Name::TiltGain).unwrap_or_default();
                Some(MarginsAnswer::compute(judged, &tolerances, tilt_gain, &mut go_on)?)
            }
        };
        let mut answer = Self {
            scene: Resolved(scene),
            derived: Derived::of(scene),
            model: ModelChoice::of(scene),
            verdict: None,
            verdict_code: None,
            decided_by: None,
            reason: String::new(),
            fixed_point: None,
            linear: None,
            boundary: None,
            loss_of_stability: None,
            lyapunov: None,
            nonlinear: NonlinearPart {
                outcome: run.ending.name(),
                impacts: run.impacts,
                t: run.t,
                max_theta: run.max_theta,
                demand: run.load.into(),
                detail: Outcome::new(run.ending, run.impacts, run.t).detail,
            },
            drift_speed: None,
            steady_drift: None,
            swing_pump: None,
            agree: None,
            rotation_number: None,
            chaos: None,
            predictable_impacts: None,
            basin: None,
            margins,
            budget: None,
            gain_margins: None,
            dial: None,
            notes: Vec::new(),
            bounces: run.impacts,
        };
        let mut judgement = judge(scene, &run, SMALL_RUN, &mut go_on)?;
        answer.bounces += judgement.bounces;
        answer.verdict = Some(words::verdict(&judgement, &run));
        answer.verdict_code = Some(code(judgement.verdict));
        answer.decided_by = Some(judgement.decided_by.name());
        answer.agree = Some(judgement.says_bounded == (run.ending == Ending::Completed));
        if let Some(margins) = &mut answer.margins {
            margins.weigh(judgement.verdict);
        }
        let mut chaos = None;
        match &mut judgement.evidence {
            evidence::Evidence::Balances(balance) => {
                answer.drifts(scene, Ok(&balance.small), &mut notes);
                let (losses, without) = search_ends(judged, &mut balance.small, &mut go_on)?;
                balance.losses.extend(losses);
                balance.notes.extend(without);
                let regularity = Evidence::new(judged, &watched, balance);
                chaos = regularity.chaos();
                notes.extend(answer.balance(judged, balance, &regularity, run.max_theta));
            }
            evidence::Evidence::NothingRepeats { why, .. } => {
                answer.drifts(scene, Err(why), &mut notes);
                notes.push(format!("{WITHOUT_BALANCE}: no bounce repeats"));
            }
            evidence::Evidence::Ensemble { .. } => {
                let noise = scene
                    .noise_field()
                    .and_then(|name| Some(format!(", and {} is {}", name.row().path, scene.number(name)?)))
                    .unwrap_or_default();
                notes.push(format!("drift_speed, {WITHOUT_BALANCE}: they are of runs without noise{noise}"));
            }
            evidence::Evidence::NoContact => notes.push(format!("drift_speed, {WITHOUT_BALANCE}: no bounce repeats")),
        }
        answer.reason = words::reason(scene, &judgement, &run, chaos);
        notes.extend(cycle_sentence(scene));
        if basin {
            match find_basin(judged, impacts, &mut go_on) {
                Ok(basin) => {
                    notes.push(format!(
                        "basin: released at rest; no hole wider than {} rad was missed, and its edges are known to {} rad",
                        basin.spacing, basin.tolerance
                    ));
                    answer.bounces += basin.bounces;
                    answer.basin = Some(basin.into());
                }
                Err(NoBasin::Stopped) => return None,
                Err(NoBasin::Lacks(lack)) => {
                    notes.push(format!("basin is null: {}", sentence(scene, Analysis::Basin, lack)));
                }
                Err(NoBasin::Because(why)) => notes.push(format!("basin is null: {why}")),
            }
        }
        if budget {
            let found = BudgetAnswer::compute(scene, impacts, &mut go_on)?;
            answer.bounces += found.bounces;
            answer.budget = Some(found);
        }
        if gain_margins {
            let (found, bounces) = GainMarginAnswer::compute(scene, impacts, &mut go_on)?;
            answer.bounces += bounces;
            answer.gain_margins = Some(found);
        }
        answer.notes = notes;
        answer.dial = dial.then(|| answer.draw_dial()).flatten();
        Some(answer)
    }

    /// Fills in the drift that a balanced run keeps, with notes on what is null beside it.
    fn drifts(&mut self, scene: &Scene, small: Result<&SmallDeviations, &NoRepeatingBounce>, notes: &mut Vec<String>) {
        let judged = scene.with_tilt_law();
        let of_plain = || is_plain(&judged).then(|| plain_drift(&judged)).flatten();
        self.drift_speed = small.map_or_else(|_| of_plain(), |small| small.drift);
        self.steady_drift = SteadyDriftAnswer::of(scene);
        notes.extend(words::null_notes(&judged, self.drift_speed, self.steady_drift.is_some()));
    }

    /// Fills in the evidence about a bounce that repeats. Gives the notes on it.
    fn balance(&mut self, scene: &Scene, balance: &Balance, regularity: &Evidence, max_theta: f64) -> Vec<String> {
        let Balance { small, boundary, losses, .. } = balance;
        let SmallDeviations { fixed_point, linear, .. } = small;
        let model = scene.model();
        let mut notes = Vec::new();
        if let Some(case) = underived(&model, fixed_point).filter(|_| boundary.is_none()) {
            notes.push(format!("boundary is null: its coefficient is not derived {case}"));
        }
        if let Some(cone) = stick_cone(&model) {
            notes.push(format!(
                "stick cone: the linear analysis holds where the matched contact sticks, for |θ| up to about {cone} rad \
                 (μ(ρ² + l²)/(l²|κ − 1|)); this run came to {max_theta} rad"
            ));
        }
        self.boundary = boundary.map(|boundary| Boundary { coefficient: boundary.coefficient, kind: boundary.kind() });
        self.loss_of_stability = Some(losses.iter().map(LossOfStability::from).collect());
        notes.extend(balance.notes.iter().cloned());
        match Lyapunov::of(balance) {
            Ok(found) => self.lyapunov = Some(found),
            Err(why) => notes.push(format!("lyapunov is null: {why}")),
        }
        if linear.residue.is_some() && linear.rotation.is_none() {
            notes.push("rotation is null: at this tilt_gain the angle does not circle".to_owned());
        }
        self.bounces += regularity.bounces();
        regularity.explain(linear, &mut notes);
        self.swing_pump = SwingPumpAnswer::of(scene, balance);
        self.predictable_impacts = regularity.predictable_impacts();
        self.chaos = regularity.chaos().map(Chaos::from);
        self.rotation_number = regularity.rotation().map(RotationNumber::from);
        notes.extend(height_notes(scene, fixed_point));
        notes.extend(friction_note(scene));
        notes.extend(gain_notes(scene));
        notes.extend(height_note(scene, balance));
        notes.extend(delay_notes(scene, fixed_point));
        self.linear = Some(LinearPart::new(scene, linear));
        self.fixed_point = Some((*fixed_point).into());
        notes
    }

    /// The verdict without its evidence.
    pub fn judgement(self) -> Judgement {
        let Self { verdict, verdict_code, decided_by, reason, .. } = self;
        Judgement { verdict, verdict_code, decided_by, reason }
    }

    /// Number of bounces computed: those of the run, of the watch over it, of the basin and of the budget.
    pub fn bounces(&self) -> u64 {
        self.bounces
    }
}

/// Notes on the height at which a bounce settles.
fn height_notes(scene: &Scene, fixed_point: &FixedPoint) -> Vec<String> {
    let mut notes = Vec::new();
    let drifts = fixed_point.x_dot != 0.0;
    let misses = scene.assumed_restitution() != scene.parameters::<f64>().restitution || scene.moves_late();
    let is_free = scene.drag().is_none_or(|drag| drag.linear == 0.0) && scene.program().is_none();
    if let Some(target) = scene.target_height(1).filter(|_| misses && is_free && !drifts) {
        let height = fixed_point.apex_height;
        notes.push(format!(
            "{}: the height settles at {height} m, {} m above target_height",
            scene.belief(),
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

impl Tabular for StabilityAnswer<'_> {
    fn in_table(&self) -> &'static [&'static str] {
        &[]
    }

    fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End {
            reason: String,
            notes: Vec<String>,
        }
        End { reason: self.reason.clone(), notes: self.notes.clone() }
    }

    /// The scalars, in one row.
    fn to_table(&self) -> Cow<'_, Table> {
        let linear = self.linear.as_ref();
        let fixed_point = self.fixed_point.as_ref();
        let tilt_gain = linear.and_then(|it| it.tilt_gain.as_ref());
        let rotation = self.rotation_number.as_ref();
        let word = |name, word| Column { name, unit: "", cells: Cells::Words(vec![word]) };
        let number = |name, unit, value| Column { name, unit, cells: Cells::Sparse(vec![value]) };
        let count = |name, value| Column { name, unit: "", cells: Cells::SparseCounts(vec![value]) };
        let mut columns = vec![
            Column { name: "verdict", unit: "", cells: Cells::Texts(vec![self.verdict.clone()]) },
            word("decided_by", self.decided_by),
            Column { name: "agree", unit: "", cells: Cells::Flags(vec![self.agree]) },
            word("class", linear.map(|it| it.class)),
            number("residue", "", linear.and_then(|it| it.residue)),
            number("rotation", "rad", linear.and_then(|it| it.rotation)),
            number("spectral_radius", "", linear.map(|it| it.spectral_radius)),
            number("tilt_gain", "", tilt_gain.map(|it| it.value)),
            number("tilt_gain_lower", "", tilt_gain.map(|it| it.lower)),
            number("tilt_gain_critical", "", tilt_gain.map(|it| it.critical)),
            number("energy_gain", "s2_per_m2", linear.map(|it| it.energy_gain.value)),
            number("energy_gain_upper", "s2_per_m2", linear.and_then(|it| it.energy_gain.upper)),
            number("boundary_coefficient", "", self.boundary.as_ref().map(|it| it.coefficient)),
            word("boundary_kind", self.boundary.as_ref().map(|it| it.kind)),
            number("drift_speed", "m_per_s", self.drift_speed),
            word("outcome", Some(self.nonlinear.outcome)),
            Column { name: "impacts", unit: "", cells: Cells::Counts(vec![self.nonlinear.impacts]) },
            number("t", "s", Some(self.nonlinear.t)),
            number("max_theta", "rad", Some(self.nonlinear.max_theta)),
            number("tilt_gain_margin_below", "", tilt_gain.map(|it| it.margin_below)),
            number("tilt_gain_margin_above", "", tilt_gain.map(|it| it.margin_above)),
            number("energy_gain_eigenvalue", "", linear.map(|it| it.energy_gain.eigenvalue)),
            number("energy_gain_margin", "s2_per_m2", linear.and_then(|it| it.energy_gain.margin)),
            number("fixed_point_y_dot", "m_per_s", fixed_point.map(|it| it.y_dot)),
            number("fixed_point_flight_time", "s", fixed_point.map(|it| it.flight_time)),
            number("rotation_number_measured", "", rotation.and_then(|it| it.measured)),
            number("rotation_number_linear", "", rotation.map(|it| it.linear)),
            count("resonance_p", rotation.map(|it| it.resonance.p.into())),
            count("resonance_q", rotation.map(|it| it.resonance.q.into())),
            number("resonance_distance", "", rotation.map(|it| it.resonance.distance)),
            number("chaos_indicator", "", self.chaos.as_ref().map(|it| it.indicator)),
            Column { name: "chaotic", unit: "", cells: Cells::Flags(vec![self.chaos.as_ref().map(|it| it.chaotic)]) },
            count("predictable_impacts", self.predictable_impacts),
            number("basin_theta", "rad", self.basin.as_ref().map(|it| it.theta)),
            number("basin_unbroken", "rad", self.basin.as_ref().map(|it| it.unbroken)),
            number("lyapunov_coefficient", "per_rad2", self.lyapunov.as_ref().map(|it| it.coefficient)),
            word("lyapunov_kind", self.lyapunov.as_ref().map(|it| it.kind)),
            count("escape_impacts", self.lyapunov.as_ref().and_then(|it| it.escape_impacts)),
            word("verdict_code", self.verdict_code),
        ];
        columns.extend(self.margins.iter().flat_map(MarginsAnswer::columns));
        Cow::Owned(Table(columns))
    }
}
