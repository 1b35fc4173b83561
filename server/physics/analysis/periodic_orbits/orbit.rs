//! A periodic orbit with its evidence: closed equations, their derivative, Newton's iteration, search at an energy.
//!
//! Derivatives by state and parameter come from dual numbers that go through all bounces of the period.

use crate::analysis::boundary::symmetric_orbit;
use crate::analysis::jacobian::jacobian_at;
use crate::analysis::periodic_orbits::multipliers::Multipliers;
use crate::analysis::periodic_orbits::problem::{
    MOST, OrbitFailure, OrbitProblem, ParameterPath, SOLVED, ScaledPoint, share_of,
};
use crate::analysis::return_map::{ReturnMap, X, parts};
use crate::map::body::PreImpact;
use crate::map::friction::{Friction, Slide};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::run::ending::Ending;
use crate::run::orbit::{ComingContact, Orbit};
use crate::run::rules::Rules;
use nalgebra::{DMatrix, DVector};

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
        DMatrix::from_fn(size, size, |row, column| {
            self.derivative[(row, column)] + if row == column { 1.0 } else { 0.0 }
        })
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
    let speed = closed.contacts.iter().map(|contact| contact.state.y_dot.abs()).fold(0.0, f64::max);
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
        let has_place = ReturnMap::new(&problem.body, 1).components().contains(&X);
        let has_friction = problem.body.friction.is_some_and(|friction| friction.coefficient != 0.0);
        let (least, most) = match problem.energy {
            _ if !problem.is_rod => (0, usize::MAX),
            Some(_) if !has_friction => (2, 2),
            _ => (0, if has_friction { 2 } else { 1 }),
        };
        let multipliers = Multipliers::new(&closed.product(), least, most).ok_or_else(|| {
            OrbitFailure::Scene("the eigenvalues of this orbit are beyond double precision".to_owned())
        })?;
        let orbit = Self {
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
        };
        let toppled = orbit.states.iter().position(|state| state.theta.abs() >= problem.scene.topple_angle());
        match toppled {
            None => Ok(orbit),
            Some(n) => Err(OrbitFailure::Ends {
                contact: n as u64 + 1,
                ending: Ending::Toppled { theta: orbit.states[n].theta, limit: problem.scene.topple_angle() },
            }),
        }
    }
}

/// Tells whether a contact of an orbit is at a switch between two modes of friction.
fn on_kink(problem: &OrbitProblem, contacts: &[PreImpact]) -> bool {
    problem.body.friction.is_some()
        && contacts.iter().any(|PreImpact { n, x, state, .. }| {
            jacobian_at(&problem.body.from_contact(*n), *x, state, 1).is_ok_and(|there| !there.one_sided.is_empty())
        })
}

/// Seeks an orbit on a path, with fewer conditions where it has none with all. Fails as the first search does.
pub(super) fn with_fewer_conditions(
    path: &mut ParameterPath,
    mut seek: impl FnMut(&ParameterPath) -> Result<ClosedOrbit, OrbitFailure>,
) -> Result<ClosedOrbit, OrbitFailure> {
    let mut first = None;
    for start in path.start.with_fewer_conditions() {
        let tried = ParameterPath { start, ..path.clone() };
        match seek(&tried) {
            Ok(found) => {
                *path = tried;
                return Ok(found);
            }
            Err(failure) => first = first.or(Some(failure)),
        }
    }
    Err(first.unwrap_or(OrbitFailure::Cancelled))
}

/// The orbit of `period` contacts near a state, at the problem's energy and without drift. Where the body keeps neither along its orbits, those are
/// what the orbit gives them.
pub fn find(problem: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    find_in(problem, period, |path| SearchPlane::at_parameter(path.place(&PreImpact::at(1, 0.0, *guess), 0.0)))
}

/// The orbit near a state with its angle at the first contact, at the energy that it has.
pub fn find_at_theta(problem: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    let free = OrbitProblem { energy: None, ..*problem };
    find_in(&free, period, |path| SearchPlane::at(0, path.place(&PreImpact::at(1, 0.0, *guess), 0.0)))
}

fn find_in(
    problem: &OrbitProblem,
    period: usize,
    plane: impl Fn(&ParameterPath) -> SearchPlane,
) -> Result<PeriodicOrbit, OrbitFailure> {
    let mut path = ParameterPath::resting(*problem);
    let plane = plane(&path);
    let solution = with_fewer_conditions(&mut path, |path| correct(path, period, &plane.point, &plane))?;
    PeriodicOrbit::new(problem, &solution)
}

/// The mirror-symmetric orbit of period 2 through an angle, rad, at the energy that it has; `None` if V² would not be positive, and with friction
/// unless the contact sticks to a table that moves along with it. These orbits branch off the upright bounce at κ_c; at a fixed energy as
/// κ − κ_c ≈ a C θ².
pub fn symmetric(rod: &Rod, friction: Option<Friction>, theta: f64) -> Option<State> {
    let friction = friction.filter(|friction| friction.coefficient != 0.0);
    if friction.is_some_and(|friction| friction.slide != Slide::Matched) {
        return None;
    }
    let orbit = symmetric_orbit(rod, friction.map(|friction| friction.coefficient), theta)?;
    let speed = orbit.speed_squared.sqrt();
    Some(State { theta, x_dot: orbit.slope * speed, y_dot: -speed, theta_dot: rod.gravity * theta / speed })
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
            if let Some(state) = symmetric_in(&path.problem(share)?, theta) {
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

fn symmetric_in(problem: &OrbitProblem, theta: f64) -> Option<State> {
    symmetric(&problem.body.rod, problem.body.friction, theta)
}

/// Excess of energy, or with feedback of height, of the symmetric orbit over the required one.
fn excess(path: &ParameterPath, theta: f64, share: f64) -> Option<f64> {
    let problem = path.problem(share).ok()?;
    let state = symmetric_in(&problem, theta)?;
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
