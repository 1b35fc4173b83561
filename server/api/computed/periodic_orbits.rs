//! `/v1/periodic-orbits`: orbits that repeat after some contacts, and branches of them.

use equipoise_physics::analysis::boundary::{period_two_angle, symmetric_orbit};
use equipoise_physics::analysis::periodic_orbits::branch::{Branch, BranchPoint, BranchStart, ParameterRange, follow};
use equipoise_physics::analysis::periodic_orbits::multipliers::Bifurcation;
use equipoise_physics::analysis::periodic_orbits::{OrbitFailure, OrbitProblem, PeriodicOrbit, find, find_at_theta};
use equipoise_physics::analysis::repeating::{NoRepeatingBounce, of_scene};
use equipoise_physics::analysis::return_map::{ARC, SPIN, Vector, X, X_DOT, Y_DOT};
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::map::strike::State;
use equipoise_physics::scene::{Field, FieldKind, Name, Scene, Value, field};
use nalgebra::Complex;
use serde_json::json;

use crate::api::computed::stability::verdict::nothing_repeats;
use crate::api::prelude::*;
use crate::api::scene::field_text;
use crate::api::shared::write;
use crate::charts::{Branches, StabilityChange as Mark, branches};

impl ComputedResource for PeriodicOrbitRequest {
    const NAME: &'static str = "periodic-orbits";
    const SINGULAR: &'static str = "PeriodicOrbits";
    type Format = ChartFormat;
    const WORK: Work<Self, ChartFormat> = Work::Pure {
        canonical: PeriodicOrbitRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = PeriodicOrbitAnswer::compute(request, || slice.should_continue())?;
            bounces.inc_by(answer.bounces());
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .answer::<PeriodicOrbitAnswer>()
            .table("Without `sweep`, one row for each state.", state_words())
            .table("With `sweep`, one row for each point of the branch.", BRANCH.iter().map(RowColumn::word))
            .end_of::<PeriodicOrbitAnswer>(PeriodicOrbitAnswer::END);
    }
}

/// The range that a field is swept over.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct SweptRange {
    /// The field.
    #[serde(serialize_with = "path")]
    #[schemars(with = "String")]
    pub field: Name,
    /// Value at the start.
    pub from: f64,
    /// Value at the end.
    pub to: f64,
    /// Largest number of orbits along the sweep.
    pub points: u64,
}

fn path<S: Serializer>(name: &Name, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(name.row().path)
}

/// A request for an orbit, or for a branch of orbits.
#[derive(Debug, Clone, Copy)]
pub struct PeriodicOrbitRequest {
    /// The scene.
    pub scene: Scene,
    /// Number of contacts after which the orbit repeats.
    pub period: u64,
    /// Start of the search.
    pub start: BranchStart,
    /// The field that is swept, for a branch.
    pub sweep: Option<SweptRange>,
}

request_fields! {
    /// A request for an orbit as it is read. It has `guess`, or `family` with `theta`, unless the period is 1.
    struct AskedOrbit {
        /// The scene.
        scene: Scene = SceneSpec,
        /// Number of impacts after which the orbit recurs. By default 2; without any start, 1, the upright bounce.
        period: Option<u64> = whole(1..=limits::ORBIT_PERIOD).optional(),
        /// A state just before an impact, near that of the orbit. All parts except `y_dot` are 0 by default.
        guess: Option<State> = Object.optional(),
        /// Start at the exact mirror-symmetric orbit of period 2. Needs `theta`.
        family: Option<()> = choice(&[("symmetric", ())]).optional(),
        /// Angle of that orbit; not 0. Needs `family`.
        theta: Option<f64> = number(-1.5..=1.5, "rad").optional(),
        /// The field along which to follow the orbit.
        sweep: Option<SweptRange> = Object.optional(),
    }
}

request_fields! {
    /// A range that a field is swept over, as it is read.
    struct AskedRange {
        /// Dotted path of a numeric field, such as table.tilt_gain; not contact.friction.
        field: &'static Field = SweptField.required(),
        /// First value, in the unit of the field.
        from: f64 = number(-1e4..=1e4, "").required(),
        /// Last value, in the unit of the field; differs from `from`.
        to: f64 = number(-1e4..=1e4, "").required(),
        /// Largest number of points, besides those located.
        points: u64 = whole(2..=limits::BRANCH_POINTS).or(200),
    }
}

/// The path of a field that can be swept.
struct SweptField;

impl Absence for SweptField {}

impl FieldSpec<&'static Field> for SweptField {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<&'static Field> {
        let sweeps = |row: &&Field| matches!(row.kind, FieldKind::Number { .. }) && row.name != Name::Friction;
        let row = reader.text(name).and_then(field).filter(sweeps);
        if row.is_none() && reader.has(name) {
            reader.refuse(
                name,
                "field must be the dotted name of a number of the scene, as table.tilt_gain, and not contact.friction",
            );
        }
        row
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        list.leaf(name, about, json!({"type": "string"}), None);
    }
}

impl Fields for PeriodicOrbitRequest {
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let before = reader.errors().len();
        let AskedOrbit { scene, period, guess, family, theta, sweep } = AskedOrbit::read_fields(reader)?;
        let cycle = scene.program().map_or(1, |program| program.heights().len() as u64);
        if let Some(period) = period.filter(|period| !period.is_multiple_of(cycle)) {
            let detail =
                format!("period is {period}; with a program of {cycle} heights it must be a multiple of {cycle}");
            reader.refuse("period", detail);
        }
        if !has_angle(&scene) && guess.is_some_and(|guess| guess.theta != 0.0 || guess.theta_dot != 0.0) {
            reader.refuse("guess", "a point mass has no theta and no theta_dot; leave them out");
        }
        if let Some(detail) = family.and_then(|()| lacking(&scene, Analysis::SymmetricOrbit)) {
            reader.refuse("family", detail);
        }
        let start = match (guess, family, theta) {
            (Some(_), Some(()), _) => {
                reader.refuse("family", "family and guess both say where to start; leave one of them out");
                None
            }
            (None, Some(()), Some(theta)) if theta != 0.0 && period.unwrap_or(2) == 2 => {
                Some(BranchStart::Symmetric(theta))
            }
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
            (Some(state), None, None) => Some(BranchStart::Near(state)),
            (None, None, None) if period.unwrap_or(cycle) == cycle => Some(BranchStart::Upright),
            (None, None, None) if reader.errors().len() > before => None,
            (None, None, None) => {
                reader.refuse_whole(format!(
                    "give a guess, or family \"symmetric\" with theta; only period {cycle} needs neither"
                ));
                None
            }
        };
        if cycle > 1 && matches!(start, Some(BranchStart::Symmetric(_))) {
            reader.refuse(
                "family",
                "family \"symmetric\" has bounces of one height, and scene.table.program has several",
            );
        }
        if reader.errors().len() > before {
            return None;
        }
        let start = start?;
        let default = if start == BranchStart::Upright || cycle > 1 { cycle } else { 2 };
        Some(Self { scene, period: period.unwrap_or(default), start, sweep })
    }

    fn describe_fields(list: &mut FieldList) {
        AskedOrbit::describe_fields(list);
    }
}

impl ResourceRequest for PeriodicOrbitRequest {
    /// A bounce with derivatives costs as much as about twelve.
    fn work(&self) -> u64 {
        limits::ANSWER_PRICE + 12 * self.period * self.sweep.map_or(60, |sweep| 10 * sweep.points + 2000)
    }
}

impl PeriodicOrbitRequest {
    fn canonical(&self) -> Vec<u8> {
        let start = match self.start {
            BranchStart::Upright => ("upright", [0.0; 4]),
            BranchStart::Near(state) => ("guess", [state.theta, state.x_dot, state.y_dot, state.theta_dot]),
            BranchStart::Symmetric(theta) => ("symmetric", [theta, 0.0, 0.0, 0.0]),
        };
        write::canonical(&self.scene, &(self.period, start, self.sweep))
    }

    /// JSON pointer to the field that caused an error of the start.
    fn pointer(&self) -> &'static str {
        match (self.start, self.sweep) {
            (BranchStart::Symmetric(_), _) => "/theta",
            (BranchStart::Near(_), _) => "/guess",
            (BranchStart::Upright, Some(_)) => "/sweep/from",
            (BranchStart::Upright, None) => "/period",
        }
    }
}

impl Fields for SweptRange {
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self> {
        let AskedRange { field: row, from, to, points } = AskedRange::read_fields(reader)?;
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
        Some(Self { field: row.name, from, to, points })
    }

    fn describe_fields(list: &mut FieldList) {
        AskedRange::describe_fields(list);
    }
}

words! {
    /// Kind of a change of stability.
    pub BranchChangeKind = Bifurcation::ALL.map(Bifurcation::name);
}

column_lists! {
    /// The states just before the impacts.
    pub OrbitStates = state_words();
    /// The points of the branch in order; `theta` is the largest angle of the orbit, `first_…` its first state.
    pub OrbitBranch = BRANCH.iter().map(RowColumn::word);
}

/// The sweep, with the place of the orbit above in it.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct OrbitSweep {
    #[serde(flatten)]
    range: SweptRange,
    start: f64,
}

/// A point of a branch at which stability changes.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct BranchChange {
    #[schemars(with = "BranchChangeKind")]
    kind: &'static str,
    /// Value of the field.
    value: f64,
    /// Largest angle of the orbit, rad.
    theta: f64,
    residue: Option<f64>,
    detail: &'static str,
}

/// Why the upright bounce of the scene does not repeat, and what it does instead.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct NothingRepeats {
    /// The reason in a sentence.
    reason: String,
    /// The upright bounce; null where the body comes to rest, misses the table, or has no such bounce.
    moves: Option<Moves>,
}

/// A bounce beside the upright one, and how each such bounce changes the state.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "MovingBounce")]
struct Moves {
    /// State just before a contact.
    state: BounceState,
    /// Change of that state by a bounce.
    change: BounceState,
    /// Length of the bounce, s.
    flight_time: f64,
}

/// A state just before a contact, or a change of it.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct BounceState {
    /// Horizontal position, m.
    x: f64,
    /// Angle, rad.
    theta: f64,
    /// Horizontal velocity, m/s.
    x_dot: f64,
    /// Vertical velocity, m/s.
    y_dot: f64,
    /// Angular velocity, rad/s.
    theta_dot: f64,
}

impl NothingRepeats {
    fn new(scene: &Scene, why: &NoRepeatingBounce) -> Self {
        let angle = |arc: f64| if has_angle(scene) { arc / scene.model().rod.radius_of_gyration } else { 0.0 };
        let of = |vector: &Vector| BounceState {
            x: vector[X],
            theta: angle(vector[ARC]),
            x_dot: vector[X_DOT],
            y_dot: vector[Y_DOT],
            theta_dot: angle(vector[SPIN]),
        };
        let moves = match why {
            NoRepeatingBounce::Moves { at, change, flight_time } => {
                Some(Moves { state: of(at), change: of(change), flight_time: *flight_time })
            }
            _ => None,
        };
        Self { reason: nothing_repeats(scene, why), moves }
    }
}

/// Answer of `/v1/periodic-orbits`.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "PeriodicOrbits")]
pub struct PeriodicOrbitAnswer {
    scene: Resolved,
    model: ModelChoice,
    period: u64,
    /// Smallest divisor of `period` after which the orbit recurs. Null if nothing repeats.
    least_period: Option<usize>,
    /// The states of the orbit; none if nothing repeats.
    #[schemars(with = "OrbitStates")]
    states: Table,
    /// Residual of the equations, as a share of the scene's speed. Null if nothing repeats.
    residual: Option<f64>,
    /// Steps of the iteration. Null if nothing repeats.
    steps: Option<u32>,
    /// Energy per unit mass at an impact, m²/s². Null if nothing repeats.
    energy: Option<f64>,
    /// Mean horizontal velocity, m/s. Zero up to rounding, but for a body that its table or the air lets drift at one speed alone. Null if nothing
    /// repeats.
    drift: Option<f64>,
    eigenvalues: Vec<Eigenvalue>,
    /// Greene's residue of the eigenvalue pair of the angle: stable from 0 to 1. Null for a point mass.
    residue: Option<f64>,
    /// Null on the boundary itself, and if nothing repeats.
    stable: Option<bool>,
    /// Length of the period, s. Null if nothing repeats.
    flight_time: Option<f64>,
    /// Vertical velocity of the contact point at the impact nearest to grazing, m/s. Null if nothing repeats.
    contact_velocity: Option<f64>,
    /// Null where an orbit was found.
    nothing_repeats: Option<NothingRepeats>,
    sweep: Option<OrbitSweep>,
    #[schemars(with = "Option<OrbitBranch>")]
    branch: Option<Table>,
    changes: Option<Vec<BranchChange>>,
    notes: Vec<String>,
    #[serde(skip)]
    points: Vec<BranchPoint>,
    #[serde(skip)]
    critical: Option<f64>,
}

impl PeriodicOrbitAnswer {
    /// Finds the orbit, and follows its branch; of an upright bounce that does not repeat, tells what it does instead.
    ///
    /// # Errors
    /// The reason why there is no orbit.
    pub fn compute(request: &PeriodicOrbitRequest, go_on: impl FnMut() -> bool) -> Result<Self, Refusal> {
        let scene = &request.scene;
        let mut notes: Vec<String> = noiseless(scene, "the orbit").into_iter().collect();
        if !has_angle(scene) {
            notes.push("theta is the angle of the velocity from straight down, theta_dot is 0 and residue is null: a point mass has no angle".to_owned());
        }
        Self::with_orbit(request, notes.clone(), go_on).or_else(|refusal| {
            let is_upright = request.start == BranchStart::Upright && request.sweep.is_none();
            let nothing = if is_upright { of_scene(scene).err() } else { None };
            nothing.map(|why| Self::without_orbit(request, &why, notes)).ok_or(refusal)
        })
    }

    fn with_orbit(
        request: &PeriodicOrbitRequest,
        mut notes: Vec<String>,
        go_on: impl FnMut() -> bool,
    ) -> Result<Self, Refusal> {
        let scene = &request.scene;
        let refuse = |failure: OrbitFailure| match failure {
            OrbitFailure::Cancelled => Refusal::Cancelled,
            failure => Refusal::At(request.pointer(), failure.to_string()),
        };
        let period = request.period as usize;
        let setting = OrbitProblem::of(scene).map_err(|why| ("/scene", why))?;
        let branch = match request.sweep {
            Some(SweptRange { field: name, from, to, points }) => {
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
            } else if setting.body.rough().is_some() {
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
            .map(|(range, branch)| OrbitSweep { range, start: branch.points[branch.start].parameter });
        let tilts = request.sweep.is_some_and(|sweep| sweep.field == Name::TiltGain);
        let upright = small_deviations(scene).and_then(|small| small.without_drift(scene)).ok().filter(|_| tilts);
        Ok(Self {
            scene: Resolved(*scene),
            model: ModelChoice::of(scene),
            period: request.period,
            least_period: Some(orbit.least_period),
            states: states(&orbit),
            residual: Some(orbit.residual),
            steps: Some(orbit.steps),
            energy: Some(orbit.energy),
            drift: Some(orbit.drift),
            eigenvalues: orbit.multipliers.eigenvalues.iter().map(|&value| value.into()).collect(),
            residue: orbit.multipliers.residue,
            stable: orbit.multipliers.stable,
            flight_time: Some(orbit.flight_time),
            contact_velocity: Some(orbit.contact_speed),
            nothing_repeats: None,
            sweep,
            branch: branch.as_ref().map(|branch| table_of(&BRANCH, &branch.points)),
            changes: branch.as_ref().map(changes),
            notes,
            points: branch.map_or_else(Vec::new, |branch| branch.points),
            critical: upright.map(|small| small.linear.critical_tilt_gain),
        })
    }

    /// The answer on a scene whose upright bounce does not repeat.
    fn without_orbit(request: &PeriodicOrbitRequest, why: &NoRepeatingBounce, mut notes: Vec<String>) -> Self {
        let scene = &request.scene;
        notes.push("no orbit was found: nothing_repeats says what the upright bounce does instead; a guess may lead to another orbit".to_owned());
        Self {
            scene: Resolved(*scene),
            model: ModelChoice::of(scene),
            period: request.period,
            least_period: None,
            states: table_of(&STATES[..4], &[]),
            residual: None,
            steps: None,
            energy: None,
            drift: None,
            eigenvalues: Vec::new(),
            residue: None,
            stable: None,
            flight_time: None,
            contact_velocity: None,
            nothing_repeats: Some(NothingRepeats::new(scene, why)),
            sweep: None,
            branch: None,
            changes: None,
            notes,
            points: Vec::new(),
            critical: None,
        }
    }

    /// Approximate number of bounces computed.
    pub fn bounces(&self) -> u64 {
        self.period * (self.points.len().max(1) * 4) as u64
    }
}

impl Tabular for PeriodicOrbitAnswer {
    const END: &'static [&'static str] = &["changes", "notes"];

    /// The branch, or the states of the orbit without a branch.
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Borrowed(self.branch.as_ref().unwrap_or(&self.states))
    }

    fn in_table(&self) -> &'static [&'static str] {
        if self.branch.is_some() { &["branch"] } else { &["states"] }
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
        BranchStart::Upright => find(setting, period, &setting.upright()),
        BranchStart::Near(state) => find(setting, period, &state),
        BranchStart::Symmetric(theta) => {
            let state = symmetric_orbit(&setting.body, theta).ok_or_else(|| {
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
         that angle, or sweep a field"
    )))
}

/// Columns of the states of an orbit with their places. The last is for orbits with a place.
const STATES: [RowColumn<(State, f64)>; 5] = [
    RowColumn::new("theta", "rad", "", Read::Number(|(state, _)| state.theta)),
    RowColumn::new("x_dot", "m/s", "", Read::Number(|(state, _)| state.x_dot)),
    RowColumn::new("y_dot", "m/s", "", Read::Number(|(state, _)| state.y_dot)),
    RowColumn::new("theta_dot", "rad/s", "", Read::Number(|(state, _)| state.theta_dot)),
    RowColumn::new("x", "m", "", Read::Number(|(_, x)| *x)),
];

/// Descriptions in the contract of the columns of states.
fn state_words() -> [ColumnWord; 5] {
    let [theta, x_dot, y_dot, theta_dot, x] = STATES.each_ref().map(RowColumn::word);
    [theta, x_dot, y_dot, theta_dot, x.only("if strikes depend on x")]
}

fn states(orbit: &PeriodicOrbit) -> Table {
    let places = orbit.places.iter().copied().chain(std::iter::repeat(0.0));
    let rows: Vec<_> = orbit.states.iter().copied().zip(places).collect();
    table_of(if orbit.has_place { &STATES } else { &STATES[..4] }, &rows)
}

/// Columns of the points of a branch.
#[rustfmt::skip]
const BRANCH: [RowColumn<BranchPoint>; 13] = [
    RowColumn::new("value", "", "Value of the field.", Read::Number(|point| point.parameter)),
    RowColumn::new("theta", "rad", "Largest angle of the orbit.", Read::Number(|point| point.orbit.max_theta())),
    RowColumn::new("residue", "", "", Read::Sparse(|point| point.orbit.multipliers.residue)),
    RowColumn::new("stable", "", "", Read::Flag(|point| point.orbit.multipliers.stable)),
    RowColumn::new("fold", "", "", Read::Flag(|point: &BranchPoint| Some(point.change == Some(Bifurcation::Fold)))).always(),
    RowColumn::new("change", "", "", Read::Word(|point: &BranchPoint| point.change.map(Bifurcation::name))).among("BranchChangeKind"),
    RowColumn::new("residual", "", "", Read::Number(|point| point.orbit.residual)),
    RowColumn::new("energy", "m²/s²", "", Read::Number(|point| point.orbit.energy)),
    RowColumn::new("flight_time", "s", "", Read::Number(|point| point.orbit.flight_time)),
    RowColumn::new("first_theta", "rad", "", Read::Number(|point| point.orbit.states[0].theta)),
    RowColumn::new("first_x_dot", "m/s", "", Read::Number(|point| point.orbit.states[0].x_dot)),
    RowColumn::new("first_y_dot", "m/s", "", Read::Number(|point| point.orbit.states[0].y_dot)),
    RowColumn::new("first_theta_dot", "rad/s", "", Read::Number(|point| point.orbit.states[0].theta_dot)),
];

fn changes(branch: &Branch) -> Vec<BranchChange> {
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
        Some(BranchChange { kind: kind.name(), value: point.parameter, theta, residue, detail: detail(point, kind) })
    };
    branch.points.iter().filter_map(change).collect()
}

impl Pictured for PeriodicOrbitAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let no_branch = || Problem::invalid_at("/sweep", "the picture is of a branch; give a sweep");
        let sweep = self.sweep.as_ref().ok_or_else(no_branch)?;
        let (row, text) = (sweep.range.field.row(), field_text(sweep.range.field));
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
        Ok(branches(&Branches {
            title: &format!("Orbits of period {}", self.period),
            name: text.title,
            symbol: text.symbol,
            unit: if row.unit == "1" { "" } else { row.unit },
            ends: (sweep.range.from, sweep.range.to),
            points: &points,
            changes: &marks,
            critical: self.critical,
        }))
    }
}
