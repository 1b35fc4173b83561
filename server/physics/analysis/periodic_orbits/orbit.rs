//! A periodic orbit with its evidence: the problem along a scene's field, the equations that close it, their derivative, Newton's iteration, search at
//! an energy.
//!
//! Derivatives by state and parameter come from dual numbers that go through all bounces of the period.

use crate::analysis::boundary::symmetric_orbit;
use crate::analysis::jacobian::jacobian_at;
use crate::analysis::limits::Parameter;
use crate::analysis::periodic_orbits::multipliers::Multipliers;
use crate::analysis::repeating::SceneMap;
use crate::analysis::return_map::{COMPONENTS, ReturnMap, SPIN, X, Y_DOT, contact_of, parts};
use crate::analysis::small_deviations::small_deviations;
use crate::map::body::{Body, PreImpact};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use crate::run::ending::Ending;
use crate::run::orbit::{ComingContact, Orbit};
use crate::run::rules::Rules;
use crate::scene::model::ModelLevel;
use crate::scene::{Name, Scene};
use nalgebra::{DMatrix, DVector};
use thiserror::Error;

/// Remainder of the equations, in parts of the scene's speed, up to which they count as solved.
const SOLVED: f64 = 1e-11;

/// The body of an orbit and the conditions that close its equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitProblem {
    /// The scene.
    pub scene: Scene,
    /// The body. Of one with a program of heights, periods are multiples of their number.
    pub body: Body,
    /// Energy per unit mass that orbits must have, ½|v|² + Gy at a contact, m²/s²; `None` if feedback sets it.
    pub energy: Option<f64>,
    /// V of the upright bounce, m/s: the scale of velocities.
    pub speed: f64,
    /// True for the rod with friction or without, whose strikes look at angle and velocities alone: its energy and its drift are free unless its
    /// table steers them. Of other bodies the map itself tells what is free.
    pub is_rod: bool,
    /// True if orbits must have no drift.
    pub rests: bool,
}

impl OrbitProblem {
    /// The problem of a scene without its noise. Its energy is that of the release without the drift, as for the fixed point, or the energy that the table
    /// holds: orbits have no drift.
    /// Fails with a sentence that says why the scene has no periodic orbits.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let scene = &scene.without_noise();
        let body = scene.model();
        let Rod { gravity, contact_distance, .. } = body.rod;
        let is_rod = !body.is_point && scene.needs_at_most(&[ModelLevel::Friction]);
        let speed = match &body.program {
            None if is_rod => {
                small_deviations(scene)
                    .and_then(|small| small.without_drift(scene))
                    .map_err(|why| format!("no bounce repeats: {why}"))?
                    .fixed_point
                    .speed
            }
            _ => SceneMap::of(scene).map_err(|_| "the release comes to no contact")?.guess[Y_DOT].abs(),
        };
        let energy = 0.5 * speed * speed + gravity * contact_distance;
        let energy = (!scene.steers_energy()).then_some(energy);
        Ok(Self { scene: *scene, body, energy, speed, is_rod, rests: true })
    }

    /// The upright bounce, which is the orbit of period 1; with a program, the bounce before its first strike.
    pub fn upright(&self) -> State {
        State { theta: 0.0, x_dot: 0.0, y_dot: -self.speed, theta_dot: 0.0 }
    }
}

/// Components of a contact over their scales, and the parameter's share of its range.
pub(super) type ScaledPoint = DVector<f64>;

/// Largest number of components of a contact with the share.
const MOST: usize = COMPONENTS + 1;

/// The share at the end of a point.
pub(super) fn share_of(place: &ScaledPoint) -> f64 {
    place[place.len() - 1]
}

/// A point with another share.
pub(super) fn at_share(mut place: ScaledPoint, share: f64) -> ScaledPoint {
    let last = place.len() - 1;
    place[last] = share;
    place
}

/// Share of the upright flight from which on a delay may be longer than a flight of an orbit.
const LONG_DELAY: f64 = 0.25;

/// The problem along a parameter that goes through a range as its share goes from 0 to 1; or standing still.
#[derive(Clone)]
pub(super) struct ParameterPath {
    name: Option<Name>,
    pub(super) start: OrbitProblem,
    from: f64,
    to: f64,
    /// Indices of the components of a contact: θ, ẋ, ẏ, θ̇, x where strikes depend on it, tilt and velocities of a table that plans before the last
    /// strike.
    pub(super) components: Vec<usize>,
    /// Scales of all components: rad, m/s, m/s, rad/s, m, rad, m/s and m/s.
    scales: [f64; COMPONENTS],
}

impl ParameterPath {
    fn resting(start: OrbitProblem) -> Self {
        Self::between(start, start, None, [0.0, 1.0])
    }

    pub(super) fn along(scene: &Scene, name: Name, from: f64, to: f64) -> Result<Self, OrbitFailure> {
        let start = problem_at(scene, name, from)?;
        let end = problem_at(scene, name, to).unwrap_or(start);
        Ok(Self::between(start, end, Some(name), [from, to]))
    }

    fn between(start: OrbitProblem, end: OrbitProblem, name: Option<Name>, [from, to]: [f64; 2]) -> Self {
        let maps = [start, end].map(|problem| {
            let map = ReturnMap::new(&problem.body, 1);
            let is_late = problem.body.lag > LONG_DELAY * 2.0 * problem.speed / problem.body.rod.gravity;
            if is_late { map.planning() } else { map }.components()
        });
        let components = (0..COMPONENTS).filter(|index| maps.iter().any(|map| map.contains(index))).collect();
        let (speed, Rod { gravity, radius_of_gyration, .. }) = (start.speed, start.body.rod);
        let scales = [1.0, speed, speed, speed / radius_of_gyration, 2.0 * speed * speed / gravity, 1.0, speed, speed];
        Self { name, start, from, to, components, scales }
    }

    fn plans(&self) -> bool {
        self.components.contains(&(X + 1))
    }

    /// The direction of a component, or at the end of the share.
    pub(super) fn direction(&self, component: usize, sign: f64) -> ScaledPoint {
        let mut direction = ScaledPoint::zeros(self.components.len() + 1);
        direction[component] = sign;
        direction
    }

    pub(super) fn parameter(&self, share: f64) -> f64 {
        // Exact at both ends.
        if share == 1.0 { self.to } else { self.from + share * (self.to - self.from) }
    }

    /// The problem at a share of the way, with the conditions of the first.
    pub(super) fn problem(&self, share: f64) -> Result<OrbitProblem, OrbitFailure> {
        let Some(name) = self.name else { return Ok(self.start) };
        let OrbitProblem { energy, rests, ref scene, .. } = self.start;
        let problem = problem_at(scene, name, self.parameter(share))?;
        Ok(OrbitProblem { energy: energy.and(problem.energy), rests, ..problem })
    }

    /// The body of a problem with its derivative by the share along the last direction.
    fn body(&self, problem: &OrbitProblem) -> Body<Dual<MOST>> {
        if self.name.is_none() {
            return problem.body.map(Dual::from_f64);
        }
        let body = problem.scene.body_by(|name, value| {
            let rate = if Some(name) == self.name { self.to - self.from } else { 0.0 };
            Dual::along(value, MOST - 1, rate)
        });
        Body { noise: None, outline: None, ..body }
    }

    /// Derivative of the energy by the share: a central difference. It steers the iteration, and no answer depends on it.
    fn energy_rate(&self, share: f64) -> Result<f64, OrbitFailure> {
        if self.name.is_none() {
            return Ok(0.0);
        }
        let step = 1e-6;
        let inside = share.clamp(step, 1.0 - step);
        let energy = |share: f64| Ok(self.problem(share)?.energy.unwrap_or(0.0));
        Ok((energy(inside + step)? - energy(inside - step)?) / (2.0 * step))
    }

    /// The point of a contact, with the motion that the table plans for it where it plans.
    pub(super) fn place(&self, contact: &PreImpact, share: f64) -> ScaledPoint {
        let PreImpact { x, state, .. } = contact;
        let own = || self.start.body.planned_motion(1, *x, state, 0.0, f64::INFINITY);
        let plan = contact.plan.or_else(|| self.plans().then(own));
        let all = parts(&PreImpact { plan, ..*contact });
        let scaled = self.components.iter().map(|&index| all[index] / self.scales[index]);
        ScaledPoint::from_vec(scaled.chain([share]).collect())
    }

    /// The contact of a point, in numbers made of the parts by their places in the point.
    fn contact<N: Number>(&self, place: &ScaledPoint, lift: impl Fn(f64, usize, f64) -> N) -> PreImpact<N> {
        let mut parts = [N::from_f64(0.0); COMPONENTS];
        for (position, &index) in self.components.iter().enumerate() {
            parts[index] = lift(place[position] * self.scales[index], position, self.scales[index]);
        }
        contact_of(1, parts, !self.components.contains(&SPIN), self.plans())
    }
}

fn problem_at(scene: &Scene, name: Name, value: f64) -> Result<OrbitProblem, OrbitFailure> {
    Parameter::Field(name).moved(scene, value).and_then(|moved| OrbitProblem::of(&moved)).map_err(OrbitFailure::Scene)
}

/// Reason for which there is no orbit.
#[derive(Clone, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum OrbitFailure {
    #[error("the run ends as `{}` at contact {contact}, before it could come back", ending.name())]
    Ends {
        /// At which contact, from 1.
        contact: u64,
        ending: Ending,
    },
    #[error(
        "Newton's iteration found no orbit: after {steps} steps the equations are off by {residual} (no unit; {SOLVED} is taken as solved)"
    )]
    NoConvergence { residual: f64, steps: u32 },
    #[error(
        "Newton's iteration came to the body at rest on the table (ẏ_c = {speed} m/s), which bounces no more: give another guess"
    )]
    AtRest { speed: f64 },
    #[error("{0}")]
    Scene(String),
    #[error("cancelled")]
    Cancelled,
}

/// Speed at the contacts, in parts of the scene's, up to which a body rests on the table.
const AT_REST: f64 = 1e-3;

/// Remainder and step that rounding allows no better than.
const ROUNDING: f64 = 1e-15;

/// Most steps of one iteration; near an orbit it takes three or four.
const MOST_STEPS: u32 = 40;

/// Times that a step is halved when it leads away.
const MOST_HALVINGS: u32 = 6;

/// Difference of two states, in parts of the scales, up to which they are the same for the least period.
const SAME: f64 = 1e-7;

type Derived = Dual<MOST>;

/// The equations at a place, with their derivatives by its components.
#[derive(Clone, Debug)]
pub(super) struct ClosedEquations {
    /// Remainders: of the state's return, of the energy (unless feedback sets it), of the drift.
    remainder: DVector<f64>,
    pub(super) derivative: DMatrix<f64>,
    pub(super) contacts: Vec<PreImpact>,
    /// Mean horizontal velocity, m/s.
    pub(super) drift: f64,
    /// s.
    pub(super) flight_time: f64,
}

impl ClosedEquations {
    fn new(path: &ParameterPath, period: usize, place: &ScaledPoint) -> Result<Self, OrbitFailure> {
        let share = share_of(place);
        let problem = path.problem(share)?;
        let coming = ComingContact { t: 0.0, coming: path.contact(place, |value, _, _| value), before: None };
        let mut orbit = Orbit::under_way(problem.body, Rules::BARE_MAP, &coming);
        let mut contacts = Vec::with_capacity(period);
        for contact in 1..=period as u64 {
            contacts.push(orbit.coming());
            if let Some(ending) = orbit.advance().ending {
                return Err(OrbitFailure::Ends { contact, ending });
            }
        }
        if orbit.coming().plan.is_some() && !path.plans() {
            let why = "a flight is shorter than table.delay, and others are not".to_owned();
            return Err(OrbitFailure::Scene(why));
        }
        let beyond = || OrbitFailure::Scene("the derivative over the period is beyond double precision".to_owned());
        let body = path.body(&problem);
        let map = ReturnMap::new(&problem.body, period as u64);
        let map = if path.plans() { map.planning() } else { map };
        let first = path.contact(place, Dual::along);
        let (last, t) = map.passed(&body, first).ok_or_else(beyond)?;
        let number = Derived::from_f64;
        let (components, scales, speed) = (&path.components, path.scales, path.start.speed);
        let (before, after) = (parts(&first), parts(&last));
        let mut equations: Vec<Derived> =
            components.iter().map(|&index| (after[index] - before[index]) / number(scales[index])).collect();
        let drift = (last.x - first.x) / t;
        if problem.rests {
            equations.push(drift / number(speed));
        }
        if let Some(energy) = problem.energy {
            let rod = &body.rod;
            let State { theta, x_dot, y_dot, theta_dot } = first.state;
            let turn = rod.radius_of_gyration * theta_dot;
            let (_, versine) = theta.sin_versine();
            let own = number(0.5) * (x_dot * x_dot + y_dot * y_dot + turn * turn)
                + rod.gravity * rod.contact_distance * (number(1.0) - versine);
            equations.push((own - Dual::along(energy, MOST - 1, path.energy_rate(share)?)) / number(speed * speed));
        }
        let finite =
            |equation: &Derived| equation.value.is_finite() && equation.partials.iter().all(|part| part.is_finite());
        if !equations.iter().all(finite) {
            return Err(beyond());
        }
        let size = components.len();
        let part = |row: usize, column: usize| equations[row].partials[if column == size { MOST - 1 } else { column }];
        Ok(Self {
            remainder: DVector::from_iterator(equations.len(), equations.iter().map(|equation| equation.value)),
            derivative: DMatrix::from_fn(equations.len(), size + 1, part),
            contacts,
            drift: drift.value,
            flight_time: t.value,
        })
    }

    pub(super) fn residual(&self) -> f64 {
        self.remainder.amax()
    }

    /// Derivative of the state after the period by that before it, in scaled components.
    pub(super) fn product(&self) -> DMatrix<f64> {
        let size = self.derivative.ncols() - 1;
        self.derivative.view((0, 0), (size, size)) + DMatrix::identity(size, size)
    }

    /// The direction in which the equations stay solved, of length 1; along `before`.
    pub(super) fn tangent(&self, before: &ScaledPoint) -> Option<ScaledPoint> {
        let (rows, columns) = self.derivative.shape();
        let square = self.derivative.clone().resize_vertically(rows.max(columns), 0.0);
        let v_t = square.svd(false, true).v_t?;
        let tangent = v_t.row(columns - 1).transpose();
        Some(if tangent.dot(before) < 0.0 { -tangent } else { tangent })
    }
}

/// The plane in which an orbit is sought, since one parameter is one unknown too many.
pub(super) struct SearchPlane {
    pub(super) normal: ScaledPoint,
    pub(super) point: ScaledPoint,
}

impl SearchPlane {
    /// The plane of a fixed parameter.
    pub(super) fn at_parameter(point: ScaledPoint) -> Self {
        Self::at(point.len() - 1, point)
    }

    /// The plane of a fixed component: 0 for the angle at the first contact.
    pub(super) fn at(component: usize, point: ScaledPoint) -> Self {
        let mut normal = ScaledPoint::zeros(point.len());
        normal[component] = 1.0;
        Self { normal, point }
    }
}

#[derive(Clone, Debug)]
pub(super) struct ClosedOrbit {
    pub(super) place: ScaledPoint,
    pub(super) closed: ClosedEquations,
    pub(super) steps: u32,
}

/// Newton's iteration (Gauss and Newton's, since there are more equations than unknowns) within a plane.
pub(super) fn correct(
    path: &ParameterPath,
    period: usize,
    guess: &ScaledPoint,
    plane: &SearchPlane,
) -> Result<ClosedOrbit, OrbitFailure> {
    let mut place = guess.clone();
    let mut closed = ClosedEquations::new(path, period, &place)?;
    let off = |place: &ScaledPoint| plane.normal.dot(&(place - &plane.point));
    let mut steps = 0;
    while steps < MOST_STEPS {
        let rows = closed.remainder.len();
        let mut matrix = closed.derivative.clone().insert_row(rows, 0.0);
        matrix.row_mut(rows).copy_from(&plane.normal.transpose());
        let mut right = closed.remainder.clone().insert_row(rows, off(&place));
        right.neg_mut();
        let svd = matrix.svd(true, true);
        let least = 1e-13 * svd.singular_values.max();
        let Ok(step) = svd.solve(&right, least) else { break };
        if step.amax() <= ROUNDING {
            break;
        }
        let size = |closed: &ClosedEquations, place: &ScaledPoint| closed.remainder.norm() + off(place).abs();
        let now = size(&closed, &place);
        let mut share = 1.0;
        let mut better = None;
        for _ in 0..=MOST_HALVINGS {
            let next = &place + &step * share;
            if let Ok(there) = ClosedEquations::new(path, period, &next)
                && size(&there, &next) < now
            {
                better = Some((next, there));
                break;
            }
            share *= 0.5;
        }
        let Some((next, there)) = better else { break };
        (place, closed) = (next, there);
        steps += 1;
    }
    let residual = closed.residual().max(off(&place).abs());
    // At rest on the table all is closed, and nothing bounces.
    let body = &path.start.body;
    let speed = closed.contacts.iter().map(|contact| body.contact_speed(&contact.state).abs()).fold(0.0, f64::max);
    if speed <= AT_REST * path.start.speed {
        Err(OrbitFailure::AtRest { speed })
    } else if residual <= SOLVED {
        Ok(ClosedOrbit { place, closed, steps })
    } else {
        Err(OrbitFailure::NoConvergence { residual, steps })
    }
}

/// A periodic orbit with its evidence.
#[derive(Clone, Debug)]
pub struct PeriodicOrbit {
    /// The states just before its contacts, as many as its period.
    pub states: Vec<State>,
    /// x at its contacts, m.
    pub places: Vec<f64>,
    /// True if its strikes depend on x.
    pub has_place: bool,
    /// The least period: a divisor of the one asked for.
    pub least_period: usize,
    /// Remainder of the equations, in parts of the scene's speed.
    pub residual: f64,
    /// Steps of the iteration.
    pub steps: u32,
    /// ½|v|² + Gy at its first contact, m²/s².
    pub energy: f64,
    /// Mean horizontal velocity, m/s: zero but for rounding.
    pub drift: f64,
    /// Length of the period, s.
    pub flight_time: f64,
    /// ẏ_c just before the contact nearest to grazing, m/s.
    pub contact_speed: f64,
    /// Verdict on the derivative over the period.
    pub multipliers: Multipliers,
}

impl PeriodicOrbit {
    /// Largest |θ| at a contact, rad.
    pub fn max_theta(&self) -> f64 {
        self.states.iter().map(|state| state.theta.abs()).fold(0.0, f64::max)
    }

    pub(super) fn new(problem: &OrbitProblem, solution: &ClosedOrbit) -> Result<Self, OrbitFailure> {
        let ClosedOrbit { closed, steps, .. } = solution;
        let states: Vec<State> = closed.contacts.iter().map(|contact| contact.state).collect();
        let places = closed.contacts.iter().map(|contact| contact.x).collect();
        let period = states.len();
        let rod = &problem.body.rod;
        let far = |one: &State, other: &State| {
            let spin = rod.radius_of_gyration * (one.theta_dot - other.theta_dot);
            let speeds = f64::max((one.x_dot - other.x_dot).abs(), (one.y_dot - other.y_dot).abs()).max(spin.abs());
            f64::max((one.theta - other.theta).abs(), speeds / problem.speed)
        };
        let repeats = |shift: usize| (0..period).all(|n| far(&states[n], &states[(n + shift) % period]) < SAME);
        let least_period = (1..=period).find(|&n| period.is_multiple_of(n) && repeats(n)).unwrap_or(period);
        if on_kink(problem, &closed.contacts) {
            return Err(OrbitFailure::Scene(
                "a contact of this orbit is at the switch between two modes of friction, where the map has no derivative".to_owned(),
            ));
        }
        let has_place = ReturnMap::new(&problem.body, 1).has_place;
        let has_friction = problem.body.rough().is_some();
        let (least, most) = match problem.energy {
            _ if !problem.is_rod => (0, usize::MAX),
            Some(_) if !has_friction => (2, 2),
            _ => (0, if has_friction { 2 } else { 1 }),
        };
        let multipliers = Multipliers::new(&closed.product(), least, most).ok_or_else(|| {
            OrbitFailure::Scene("the eigenvalues of this orbit are beyond double precision".to_owned())
        })?;
        let limit = problem.scene.topple_angle();
        if let Some(n) = states.iter().position(|state| state.theta.abs() >= limit) {
            let ending = Ending::Toppled { theta: states[n].theta, limit };
            return Err(OrbitFailure::Ends { contact: n as u64 + 1, ending });
        }
        Ok(Self {
            least_period,
            residual: closed.residual(),
            steps: *steps,
            energy: rod.energy(&states[0]),
            drift: closed.drift,
            flight_time: closed.flight_time,
            contact_speed: states.iter().map(|state| rod.contact_speed(state)).fold(f64::NEG_INFINITY, f64::max),
            multipliers,
            states,
            places,
            has_place,
        })
    }
}

/// Tells whether a contact of an orbit is at a switch between two modes of friction.
fn on_kink(problem: &OrbitProblem, contacts: &[PreImpact]) -> bool {
    problem.body.friction.is_some()
        && contacts.iter().any(|PreImpact { n, x, state, .. }| {
            jacobian_at(&problem.body.from_contact(*n), *x, state, 1).is_ok_and(|there| !there.one_sided.is_empty())
        })
}

/// Seeks an orbit on a path, of other bodies than the rod with fewer conditions where there is none with all: what nothing keeps along an orbit has the
/// value that the orbit gives it. Fails as the first search does.
pub(super) fn with_fewer_conditions(
    path: &mut ParameterPath,
    mut seek: impl FnMut(&ParameterPath) -> Result<ClosedOrbit, OrbitFailure>,
) -> Result<ClosedOrbit, OrbitFailure> {
    let all = path.start;
    let first = seek(path);
    if first.is_ok() || all.is_rod {
        return first;
    }
    for (energy, rests) in [(None, true), (all.energy, false), (None, false)] {
        path.start = OrbitProblem { energy, rests, ..all };
        if let Ok(found) = seek(path) {
            return Ok(found);
        }
    }
    first
}

/// The orbit of `period` contacts near a state, at the problem's energy and without drift. Where the body keeps neither along its orbits, those are
/// what the orbit gives them.
pub fn find(problem: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    find_in(problem, period, guess, SearchPlane::at_parameter)
}

/// The orbit near a state with its angle at the first contact, at the energy that it has.
pub fn find_at_theta(problem: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    find_in(&OrbitProblem { energy: None, ..*problem }, period, guess, |point| SearchPlane::at(0, point))
}

/// The orbit near a state, in a plane through its point.
fn find_in(
    problem: &OrbitProblem,
    period: usize,
    guess: &State,
    plane: fn(ScaledPoint) -> SearchPlane,
) -> Result<PeriodicOrbit, OrbitFailure> {
    let mut path = ParameterPath::resting(*problem);
    let plane = plane(path.place(&PreImpact::at(1, 0.0, *guess), 0.0));
    let solution = with_fewer_conditions(&mut path, |path| correct(path, period, &plane.point, &plane))?;
    PeriodicOrbit::new(problem, &solution)
}

/// Cells in which a range is searched for the symmetric orbit through an angle.
const CELLS: u32 = 512;

/// The first place along a path where the symmetric orbit through an angle has the energy, or with feedback the
/// target's, of the problem there.
pub(super) fn symmetric_orbit_on_path(path: &ParameterPath, theta: f64) -> Result<ScaledPoint, OrbitFailure> {
    let mut last: Option<(f64, f64)> = None;
    for cell in 0..=CELLS {
        let share = f64::from(cell) / f64::from(CELLS);
        let here = excess(path, theta, share);
        if let (Some((before, low)), Some(high)) = (last, here)
            && (low <= 0.0) != (high <= 0.0)
        {
            let share = before + (share - before) * low / (low - high);
            if let Some(state) = symmetric_orbit(&path.problem(share)?.body, theta) {
                return Ok(path.place(&PreImpact::at(1, 0.0, state), share));
            }
        }
        last = here.map(|value| (share, value));
    }
    let detail = format!(
        "no mirror-symmetric orbit through theta {theta} rad has the scene's energy for a parameter from {} to {}",
        path.from, path.to
    );
    Err(OrbitFailure::Scene(detail))
}

/// Excess of energy, or with feedback of height, of the symmetric orbit over the required one.
fn excess(path: &ParameterPath, theta: f64, share: f64) -> Option<f64> {
    let problem = path.problem(share).ok()?;
    let state = symmetric_orbit(&problem.body, theta)?;
    Some(match problem.energy {
        Some(energy) => problem.body.rod.energy(&state) - energy,
        // At a strike gain of 2 a strike keeps the energy.
        None if problem.body.rod.energy_feedback != EnergyFeedback::Vertical => {
            let strike = problem.body.rod.strike(&state);
            2.0 - strike.push / strike.normal_velocity
        }
        None => {
            let rod = &problem.body.rod;
            rod.energy(&State { x_dot: 0.0, theta_dot: 0.0, ..state }) - rod.target_energy
        }
    })
}
