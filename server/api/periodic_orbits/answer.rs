//! The request and the answer of `periodic-orbits`: an orbit, or a branch of them along a field of the scene.

use equipoise_physics::periodic_orbits::branch::{Branch, Point, Start, Sweep, follow};
use equipoise_physics::periodic_orbits::{Failure, PeriodicOrbit, Setting, find, symmetric};
use equipoise_physics::scene::{Field, Kind, Name, Scene, Value, field};
use equipoise_physics::stability::boundary::period_two_angle;
use equipoise_physics::stability::fixed_point::find_fixed_point;
use equipoise_physics::stability::linear_verdict::linear_verdict;
use nalgebra::Complex;
use serde::{Serialize, Serializer};

use crate::api::jacobians::answer::{Eigenvalue, read_state};
use crate::api::scene::Resolved;
use crate::api::shared::table::{Cells, Column, Table};
use crate::api::trajectories::answer::Choice;
use crate::charts::{Branches, Change as Mark, branches};
use crate::http::Reader;
use crate::limits;

/// A range of a field.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Range {
    #[serde(serialize_with = "path")]
    parameter: Name,
    from: f64,
    to: f64,
    points: u64,
}

fn path<S: Serializer>(name: &Name, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name.row().path)
}

/// What is asked for beside the scene.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    period: u64,
    start: Start,
    sweep: Option<Range>,
}

impl Serialize for Request {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let start = match self.start {
            Start::Upright => ("upright", [0.0; 4]),
            Start::Near(state) => ("guess", [state.theta, state.x_dot, state.y_dot, state.theta_dot]),
            Start::Symmetric(theta) => ("symmetric", [theta, 0.0, 0.0, 0.0]),
        };
        (self.period, start, self.sweep).serialize(serializer)
    }
}

impl Request {
    /// Reads everything but the scene.
    pub fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let before = reader.errors().len();
        let period = reader.integer("period", 1..=limits::ORBIT_PERIOD);
        let guess = reader.within("guess", read_state);
        let family = reader.choice("family", &[("symmetric", ())]);
        let theta = reader.number("theta", -1.5..=1.5, "rad");
        let sweep = if reader.has("sweep") { reader.within("sweep", Range::read).flatten() } else { None };
        let start = match (guess, family, theta) {
            (Some(_), Some(()), _) => {
                reader.refuse("family", "family and guess both say where to start; leave one of them out");
                None
            }
            (None, Some(()), Some(theta)) if theta != 0.0 && period.unwrap_or(2) == 2 => Some(Start::Symmetric(theta)),
            (None, Some(()), Some(_)) if period.unwrap_or(2) != 2 => {
                reader.refuse("period", "period must be 2 for the symmetric family");
                None
            }
            (None, Some(()), Some(_)) => {
                reader.refuse("theta", "theta is 0; the symmetric family needs another angle, rad");
                None
            }
            (None, Some(()), None) => {
                reader.require(&["theta"]);
                None
            }
            (_, None, Some(_)) => {
                reader.refuse("theta", "theta goes with family; leave it out or add family \"symmetric\"");
                None
            }
            (Some(state), None, None) => Some(Start::Near(state)),
            (None, None, None) if period.unwrap_or(1) == 1 => Some(Start::Upright),
            (None, None, None) if reader.errors().len() > before => None,
            (None, None, None) => {
                reader.refuse_whole("give a guess, or family \"symmetric\" with theta; only period 1 needs neither");
                None
            }
        };
        if reader.errors().len() > before {
            return None;
        }
        let start = start?;
        let default = if start == Start::Upright { 1 } else { 2 };
        Some(Self { period: period.unwrap_or(default), start, sweep })
    }

    /// What it costs, in bounces of the plain rod: a bounce with derivatives is some twelve of them.
    pub fn price(&self) -> u64 {
        limits::ANSWER_PRICE + 12 * self.period * self.sweep.map_or(60, |sweep| 10 * sweep.points + 2000)
    }

    /// Where an error of the start points.
    fn pointer(&self) -> &'static str {
        match (self.start, self.sweep) {
            (Start::Symmetric(_), _) => "/theta",
            (Start::Near(_), _) => "/guess",
            (Start::Upright, Some(_)) => "/sweep/from",
            (Start::Upright, None) => "/period",
        }
    }
}

impl Range {
    fn read(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let sweeps = |row: &&Field| matches!(row.kind, Kind::Number { .. }) && row.name != Name::Friction;
        let row = reader.text("parameter").and_then(field).filter(sweeps);
        if row.is_none() && reader.has("parameter") {
            reader
                .refuse("parameter", "parameter must be the dotted name of a number of the scene, as table.tilt_gain, and not contact.friction");
        }
        let (from, to) = (reader.number("from", -1e4..=1e4, ""), reader.number("to", -1e4..=1e4, ""));
        let points = reader.integer("points", 2..=limits::BRANCH_POINTS).unwrap_or(200);
        reader.require(&["parameter", "from", "to"]);
        let (row, from, to) = (row?, from?, to?);
        for (name, value) in [("from", from), ("to", to)] {
            if !row.admits(Value::Number(value)) {
                reader.refuse(name, format!("{name} is {value}; {} must be {}", row.path, row.limits()));
            }
        }
        if from == to {
            reader.refuse("to", format!("to is {to}, as from; a sweep needs a range"));
        }
        if row.name == Name::EnergyGain && from.min(to) <= 0.0 && from.max(to) >= 0.0 {
            reader.refuse("from", "at energy_gain 0 nothing sets the energy; sweep on one side of it");
        }
        Some(Self { parameter: row.name, from, to, points })
    }
}

#[derive(Debug, Clone, Serialize)]
struct Swept {
    #[serde(flatten)]
    range: Range,
    start: f64,
}

#[derive(Debug, Clone, Serialize)]
struct Change {
    kind: &'static str,
    parameter: f64,
    theta: f64,
    residue: f64,
    detail: &'static str,
}

/// The answer.
#[derive(Debug, Clone, Serialize)]
pub struct PeriodicOrbits<'a> {
    scene: Resolved<'a>,
    model: Choice,
    period: u64,
    least_period: usize,
    states: Table,
    residual: f64,
    steps: u32,
    energy: f64,
    drift: f64,
    eigenvalues: Vec<Eigenvalue>,
    residue: f64,
    stable: Option<bool>,
    flight_time: f64,
    contact_speed: f64,
    sweep: Option<Swept>,
    branch: Option<Table>,
    changes: Option<Vec<Change>>,
    notes: Vec<String>,
    #[serde(skip)]
    points: Vec<Point>,
    #[serde(skip)]
    critical: Option<f64>,
}

impl<'a> PeriodicOrbits<'a> {
    /// Finds the orbit, and follows its branch.
    ///
    /// # Errors
    /// [`None`] in place of a pointer where it was cancelled; else a JSON pointer and why there is no orbit.
    pub fn compute(
        scene: &'a Scene,
        request: &Request,
        go_on: impl FnMut() -> bool,
    ) -> Result<Self, Option<(&'static str, String)>> {
        let refuse = |failure: Failure| match failure {
            Failure::Cancelled => None,
            failure => Some((request.pointer(), failure.to_string())),
        };
        let period = request.period as usize;
        let mut notes = Vec::new();
        let setting = Setting::of(scene).map_err(|why| Some(("/scene", why)))?;
        let branch = match request.sweep {
            Some(Range { parameter: name, from, to, points }) => {
                let sweep = Sweep { scene, name, from, to };
                Some(follow(&sweep, period, request.start, points as usize, go_on).map_err(refuse)?)
            }
            None => None,
        };
        let orbit = match &branch {
            Some(branch) => branch.points[branch.start].orbit.clone(),
            None => one(scene, &setting, period, request.start, &mut notes).map_err(refuse)?,
        };
        notes.push(
            if setting.energy.is_some() {
                "one eigenvalue is 1 by the drift, and one more by the energy, which nothing sets"
            } else if orbit.multipliers.eigenvalues.contains(&Complex::new(1.0, 0.0)) {
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
        let fixed_point = find_fixed_point(scene).ok().filter(|_| tilts);
        Ok(Self {
            scene: Resolved(scene),
            model: Choice::model(scene),
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
            critical: fixed_point.map(|fixed_point| linear_verdict(scene, &fixed_point).critical_tilt_gain),
        })
    }

    /// The branch, or the states where there is none.
    pub fn to_table(&self) -> &Table {
        self.branch.as_ref().unwrap_or(&self.states)
    }

    /// What ends it as NDJSON.
    pub fn end(&self) -> impl Serialize {
        serde_json::json!({ "changes": self.changes, "notes": self.notes })
    }

    /// The branch diagram as SVG; none without a sweep.
    pub fn to_picture(&self) -> Option<String> {
        let sweep = self.sweep.as_ref()?;
        let row = sweep.range.parameter.row();
        let points: Vec<_> = self
            .points
            .iter()
            .map(|point| (point.parameter, point.orbit.max_theta(), point.orbit.multipliers.stable))
            .collect();
        let marks: Vec<_> = self
            .points
            .iter()
            .filter_map(|point| {
                let kind = point.change?.name();
                Some(Mark { at: (point.parameter, point.orbit.max_theta()), kind })
            })
            .collect();
        Some(branches(&Branches {
            title: &format!("Orbits of period {}", self.period),
            name: row.title,
            symbol: row.symbol,
            unit: if row.unit == "1" { "" } else { row.unit },
            ends: (sweep.range.from, sweep.range.to),
            points: &points,
            changes: &marks,
            critical: self.critical,
        }))
    }

    /// How many bounces were computed for it, about.
    pub fn bounces(&self) -> u64 {
        self.period * (self.points.len().max(1) * 4) as u64
    }
}

/// The orbit of the scene itself.
fn one(
    scene: &Scene,
    setting: &Setting,
    period: usize,
    start: Start,
    notes: &mut Vec<String>,
) -> Result<PeriodicOrbit, Failure> {
    match start {
        Start::Upright => find(setting, period, &setting.upright()),
        Start::Near(state) => find(setting, period, &state),
        Start::Symmetric(theta) => {
            let state = symmetric(&setting.rod, theta).ok_or_else(|| {
                let kappa = setting.rod.tilt_gain;
                Failure::Scene(format!("no mirror-symmetric orbit passes theta {theta} rad at tilt_gain {kappa}"))
            })?;
            if setting.energy.is_none() {
                has_target_height(scene, theta)?;
            }
            let own = Setting { energy: setting.energy.map(|_| setting.rod.energy(&state)), ..*setting };
            if setting.energy.is_some() {
                notes.push("the energy is that of the symmetric orbit through theta, not of the release".to_owned());
            }
            find(&own, period, &state)
        }
    }
}

/// Angle, rad, up to which a symmetric orbit is the one that was asked for.
const SAME_THETA: f64 = 1e-6;

/// Checks that with energy feedback the symmetric orbit through an angle is the one of the scene's target height.
fn has_target_height(scene: &Scene, theta: f64) -> Result<(), Failure> {
    let found = find_fixed_point(scene)
        .ok()
        .and_then(|fixed_point| period_two_angle(&scene.model(), scene.rules().topple_angle, &fixed_point));
    if found.is_some_and(|found| (found - theta.abs()).abs() <= SAME_THETA) {
        return Ok(());
    }
    let kappa = scene.number(Name::TiltGain).unwrap_or_default();
    let there =
        found.map_or_else(|| "there is none".to_owned(), |found| format!("that is the one through theta {found} rad"));
    Err(Failure::Scene(format!(
        "theta is {theta} rad; with energy_gain a symmetric orbit must have the target height, and at tilt_gain {kappa} {there}: give \
         that angle, or sweep a parameter"
    )))
}

fn number(name: &'static str, unit: &'static str, cells: impl Iterator<Item = f64>) -> Column {
    Column { name, unit, cells: Cells::Numbers(cells.collect()) }
}

fn states(orbit: &PeriodicOrbit) -> Table {
    let all = || orbit.states.iter();
    Table(vec![
        number("theta", "rad", all().map(|state| state.theta)),
        number("x_dot", "m_per_s", all().map(|state| state.x_dot)),
        number("y_dot", "m_per_s", all().map(|state| state.y_dot)),
        number("theta_dot", "rad_per_s", all().map(|state| state.theta_dot)),
    ])
}

fn columns(branch: &Branch) -> Table {
    let all = || branch.points.iter();
    let first = || all().map(|point| point.orbit.states[0]);
    let flags = |cells: Vec<Option<bool>>| Cells::Flags(cells);
    let kinds: Vec<_> = all().map(|point| point.change.map(|kind| kind.name())).collect();
    let folds = kinds.iter().map(|kind| Some(*kind == Some("fold"))).collect();
    Table(vec![
        number("parameter", "", all().map(|point| point.parameter)),
        number("theta", "rad", all().map(|point| point.orbit.max_theta())),
        number("residue", "", all().map(|point| point.orbit.multipliers.residue)),
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

fn changes(branch: &Branch) -> Vec<Change> {
    let detail = |point: &Point, kind: &str| match kind {
        "period_doubling" if point.springs => "the branch springs here from an orbit of half its period",
        "period_doubling" => "an eigenvalue passes −1",
        "fold" => "the branch turns back",
        "pitchfork" => "an eigenvalue passes 1, and the branch goes on",
        _ => "a pair of eigenvalues leaves the unit circle",
    };
    let change = |point: &Point| {
        let kind = point.change?.name();
        let residue = point.orbit.multipliers.residue;
        let theta = point.orbit.max_theta();
        Some(Change { kind, parameter: point.parameter, theta, residue, detail: detail(point, kind) })
    };
    branch.points.iter().filter_map(change).collect()
}
