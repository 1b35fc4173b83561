//! The answer of `periodic-orbits`: an orbit, or a branch of orbits along a field of the scene.

use std::borrow::Cow;

use equipoise_physics::analysis::boundary::period_two_angle;
use equipoise_physics::analysis::periodic_orbits::branch::{
    Bifurcation, Branch, BranchPoint, BranchStart, ParameterRange, follow,
};
use equipoise_physics::analysis::periodic_orbits::{
    OrbitFailure, OrbitProblem, PeriodicOrbit, find, find_at_theta, symmetric,
};
use equipoise_physics::analysis::repeating::of_scene;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::scene::{Name, Scene};
use nalgebra::Complex;
use serde::Serialize;

use crate::api::formats::Tabular;
use crate::api::periodic_orbits::request::{PeriodicOrbitRequest, SweptRange};
use crate::api::scene::{Resolved, has_angle};
use crate::api::shared::eigenvalue::Eigenvalue;
use crate::api::shared::model_choice::ModelChoice;
use crate::api::shared::refusal::{Refusal, noiseless};
use crate::api::shared::table::{Cells, Column, Table};

#[derive(Debug, Clone, Serialize)]
pub(super) struct Swept {
    #[serde(flatten)]
    pub(super) range: SweptRange,
    start: f64,
}

#[derive(Debug, Clone, Serialize)]
struct StabilityChangeAnswer {
    kind: &'static str,
    parameter: f64,
    theta: f64,
    residue: Option<f64>,
    detail: &'static str,
}

/// Answer of `/v1/periodic-orbits`.
#[derive(Debug, Clone, Serialize)]
pub struct PeriodicOrbitAnswer<'a> {
    scene: Resolved<'a>,
    model: ModelChoice,
    pub(super) period: u64,
    least_period: usize,
    states: Table,
    residual: f64,
    steps: u32,
    energy: f64,
    drift: f64,
    eigenvalues: Vec<Eigenvalue>,
    residue: Option<f64>,
    stable: Option<bool>,
    flight_time: f64,
    contact_speed: f64,
    pub(super) sweep: Option<Swept>,
    branch: Option<Table>,
    changes: Option<Vec<StabilityChangeAnswer>>,
    notes: Vec<String>,
    #[serde(skip)]
    pub(super) points: Vec<BranchPoint>,
    #[serde(skip)]
    pub(super) critical: Option<f64>,
}

impl<'a> PeriodicOrbitAnswer<'a> {
    /// Finds the orbit, and follows its branch.
    ///
    /// # Errors
    /// The reason why there is no orbit.
    pub fn compute(request: &'a PeriodicOrbitRequest, go_on: impl FnMut() -> bool) -> Result<Self, Refusal> {
        let scene = &request.scene;
        let refuse = |failure: OrbitFailure| match failure {
            OrbitFailure::Cancelled => Refusal::Cancelled,
            failure => Refusal::At(request.pointer(), failure.to_string()),
        };
        let period = request.period as usize;
        let mut notes: Vec<String> = noiseless(scene, "the orbit").into_iter().collect();
        if !has_angle(scene) {
            notes.push("theta is the angle of the velocity from straight down, theta_dot is 0 and residue is null: a point mass has no angle".to_owned());
        }
        let setting = OrbitProblem::of(scene).map_err(|why| ("/scene", why))?;
        let branch = match request.sweep {
            Some(SweptRange { parameter: name, from, to, points }) => {
                let sweep = ParameterRange { scene, name, from, to };
                Some(follow(&sweep, period, request.start, points as usize, go_on).map_err(refuse)?)
            }
            None => None,
        };
        let orbit = match &branch {
            Some(branch) => branch.points[branch.start].orbit.clone(),
            None => one(scene, &setting, period, request.start, &mut notes).map_err(refuse)?,
        };
        let ones = orbit.multipliers.eigenvalues.iter().filter(|value| **value == Complex::new(1.0, 0.0)).count();
        notes.push(
            if !setting.is_rod {
                match ones {
                    0 => "no eigenvalue of this orbit is 1: nothing of its motion is free",
                    1 => "one eigenvalue is 1: one direction of its motion is free",
                    _ => "more than one eigenvalue is 1: as many directions of its motion are free",
                }
            } else if setting.body.friction.is_some_and(|friction| friction.coefficient != 0.0) {
                match ones {
                    0 => "with friction no eigenvalue of this orbit is 1: nothing of its motion is free",
                    1 => "one eigenvalue is 1: one direction of its motion is free",
                    _ => "two eigenvalues are 1, as without friction: the contact sticks to a table that moves along with it",
                }
            } else if setting.energy.is_some() {
                "one eigenvalue is 1 by the drift, and one more by the energy, which nothing sets"
            } else if ones > 0 {
                "one eigenvalue is 1 by the drift"
            } else {
                "with energy feedback no eigenvalue of this orbit is 1: neither its energy nor its drift is free"
            }
            .to_owned(),
        );
        if orbit.least_period < period {
            notes.push(format!("this orbit repeats after {} contacts already", orbit.least_period));
        }
        if orbit.multipliers.stable.is_none() {
            notes.push("stable is null: an eigenvalue is at 1 or −1, where the linear analysis is silent".to_owned());
        }
        if let Some(branch) = &branch {
            notes.push("the orbit above the branch is the one it was followed from".to_owned());
            notes.extend(branch.ends.iter().cloned());
        }
        let sweep = request
            .sweep
            .zip(branch.as_ref())
            .map(|(range, branch)| Swept { range, start: branch.points[branch.start].parameter });
        let tilts = request.sweep.is_some_and(|sweep| sweep.parameter == Name::TiltGain);
        let upright = small_deviations(scene).and_then(|small| small.without_drift(scene)).ok().filter(|_| tilts);
        Ok(Self {
            scene: Resolved(scene),
            model: ModelChoice::of(scene),
            period: request.period,
            least_period: orbit.least_period,
            states: states(&orbit),
            residual: orbit.residual,
            steps: orbit.steps,
            energy: orbit.energy,
            drift: orbit.drift,
            eigenvalues: orbit.multipliers.eigenvalues.iter().map(|&value| value.into()).collect(),
            residue: orbit.multipliers.residue,
            stable: orbit.multipliers.stable,
            flight_time: orbit.flight_time,
            contact_speed: orbit.contact_speed,
            sweep,
            branch: branch.as_ref().map(columns),
            changes: branch.as_ref().map(changes),
            notes,
            points: branch.map_or_else(Vec::new, |branch| branch.points),
            critical: upright.map(|small| small.linear.critical_tilt_gain),
        })
    }

    /// Approximate number of bounces computed.
    pub fn bounces(&self) -> u64 {
        self.period * (self.points.len().max(1) * 4) as u64
    }
}

impl Tabular for PeriodicOrbitAnswer<'_> {
    /// The branch, or the states of the orbit without a branch.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Borrowed(self.branch.as_ref().unwrap_or(&self.states))
    }

    fn in_table(&self) -> &'static [&'static str] {
        if self.branch.is_some() { &["branch"] } else { &["states"] }
    }

    fn end(&self) -> impl Serialize {
        serde_json::json!({ "changes": self.changes, "notes": self.notes })
    }
}

/// The orbit of the scene itself.
fn one(
    scene: &Scene,
    setting: &OrbitProblem,
    period: usize,
    start: BranchStart,
    notes: &mut Vec<String>,
) -> Result<PeriodicOrbit, OrbitFailure> {
    match start {
        BranchStart::Upright => find(setting, period, &setting.upright()).map_err(|failure| match of_scene(scene) {
            Err(why) if !setting.is_rod => OrbitFailure::Scene(format!("{failure}: {why}")),
            Ok(_) | Err(_) => failure,
        }),
        BranchStart::Near(state) => find(setting, period, &state),
        BranchStart::Symmetric(theta) => {
            let state = symmetric(&setting.body.rod, setting.body.friction, theta).ok_or_else(|| {
                let kappa = setting.body.rod.tilt_gain;
                let where_it_sticks = if setting.body.friction.is_some() {
                    " where the contact sticks to a table that moves along with it"
                } else {
                    ""
                };
                OrbitFailure::Scene(format!(
                    "no mirror-symmetric orbit passes theta {theta} rad at tilt_gain {kappa}{where_it_sticks}"
                ))
            })?;
            if !setting.is_rod {
                return find_at_theta(setting, period, &state);
            }
            if setting.energy.is_none() {
                has_target_height(scene, theta)?;
            }
            let own = OrbitProblem { energy: setting.energy.map(|_| setting.body.rod.energy(&state)), ..*setting };
            if setting.energy.is_some() {
                notes.push("the energy is that of the symmetric orbit through theta, not of the release".to_owned());
            }
            find(&own, period, &state)
        }
    }
}

/// Largest difference of angles, rad, at which a symmetric orbit is the requested one.
const SAME_THETA: f64 = 1e-6;

/// Checks that with energy feedback the symmetric orbit through an angle is the one of the scene's target height.
fn has_target_height(scene: &Scene, theta: f64) -> Result<(), OrbitFailure> {
    let found = small_deviations(scene)
        .and_then(|small| small.without_drift(scene))
        .ok()
        .and_then(|small| period_two_angle(&scene.model(), scene.rules().topple_angle, &small.fixed_point));
    if found.is_some_and(|found| (found - theta.abs()).abs() <= SAME_THETA) {
        return Ok(());
    }
    let kappa = scene.number(Name::TiltGain).unwrap_or_default();
    let there =
        found.map_or_else(|| "there is none".to_owned(), |found| format!("that is the one through theta {found} rad"));
    Err(OrbitFailure::Scene(format!(
        "theta is {theta} rad; with energy_gain a symmetric orbit must have the target height, and at tilt_gain {kappa} {there}: give \
         that angle, or sweep a parameter"
    )))
}

fn number(name: &'static str, unit: &'static str, cells: impl Iterator<Item = f64>) -> Column {
    Column { name, unit, cells: Cells::Numbers(cells.collect()) }
}

fn states(orbit: &PeriodicOrbit) -> Table {
    let all = || orbit.states.iter();
    let mut columns = vec![
        number("theta", "rad", all().map(|state| state.theta)),
        number("x_dot", "m_per_s", all().map(|state| state.x_dot)),
        number("y_dot", "m_per_s", all().map(|state| state.y_dot)),
        number("theta_dot", "rad_per_s", all().map(|state| state.theta_dot)),
    ];
    if orbit.has_place {
        columns.push(number("x", "m", orbit.places.iter().copied()));
    }
    Table(columns)
}

fn columns(branch: &Branch) -> Table {
    let all = || branch.points.iter();
    let first = || all().map(|point| point.orbit.states[0]);
    let flags = |cells: Vec<Option<bool>>| Cells::Flags(cells);
    let kinds = all().map(|point| point.change.map(Bifurcation::name)).collect();
    let folds = all().map(|point| Some(point.change == Some(Bifurcation::Fold))).collect();
    Table(vec![
        number("parameter", "", all().map(|point| point.parameter)),
        number("theta", "rad", all().map(|point| point.orbit.max_theta())),
        Column {
            name: "residue",
            unit: "",
            cells: Cells::Sparse(all().map(|point| point.orbit.multipliers.residue).collect()),
        },
        Column { name: "stable", unit: "", cells: flags(all().map(|point| point.orbit.multipliers.stable).collect()) },
        Column { name: "fold", unit: "", cells: flags(folds) },
        Column { name: "change", unit: "", cells: Cells::Words(kinds) },
        number("residual", "", all().map(|point| point.orbit.residual)),
        number("energy", "m2_per_s2", all().map(|point| point.orbit.energy)),
        number("flight_time", "s", all().map(|point| point.orbit.flight_time)),
        number("first_theta", "rad", first().map(|state| state.theta)),
        number("first_x_dot", "m_per_s", first().map(|state| state.x_dot)),
        number("first_y_dot", "m_per_s", first().map(|state| state.y_dot)),
        number("first_theta_dot", "rad_per_s", first().map(|state| state.theta_dot)),
    ])
}

fn changes(branch: &Branch) -> Vec<StabilityChangeAnswer> {
    let detail = |point: &BranchPoint, kind: Bifurcation| match kind {
        Bifurcation::PeriodDoubling if point.springs => "the branch springs here from an orbit of half its period",
        Bifurcation::PeriodDoubling => "an eigenvalue passes −1",
        Bifurcation::Fold => "the branch turns back",
        Bifurcation::Pitchfork => "an eigenvalue passes 1, and the branch goes on",
        Bifurcation::NeimarkSacker => "a pair of eigenvalues leaves the unit circle",
    };
    let change = |point: &BranchPoint| {
        let kind = point.change?;
        let residue = point.orbit.multipliers.residue;
        let theta = point.orbit.max_theta();
        Some(StabilityChangeAnswer {
            kind: kind.name(),
            parameter: point.parameter,
            theta,
            residue,
            detail: detail(point, kind),
        })
    };
    branch.points.iter().filter_map(change).collect()
}
