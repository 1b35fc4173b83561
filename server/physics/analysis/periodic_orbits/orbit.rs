//! A periodic orbit with its evidence, and the search for one at the energy of a scene.

use crate::analysis::jacobian::jacobian_at;
use crate::analysis::periodic_orbits::closed::{ClosedOrbit, SearchPlane, correct};
use crate::analysis::periodic_orbits::multipliers::{Multipliers, TrivialMultipliers};
use crate::analysis::periodic_orbits::parameter_path::ParameterPath;
use crate::analysis::periodic_orbits::problem::{OrbitFailure, OrbitProblem};
use crate::analysis::return_map::{ReturnMap, X};
use crate::map::body::PreImpact;
use crate::map::strike::State;
use crate::run::ending::Ending;

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

/// Difference of two states, in parts of the scales, up to which they are the same for the least period.
const SAME: f64 = 1e-7;

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
        let known = match (problem.body.friction, problem.energy) {
            _ if !problem.is_rod => TrivialMultipliers::Any,
            (Some(friction), _) if friction.coefficient != 0.0 => TrivialMultipliers::with_friction(&closed.product()),
            (_, Some(_)) => TrivialMultipliers::EnergyAndDrift,
            (_, None) => TrivialMultipliers::Drift,
        };
        let multipliers = Multipliers::new(&closed.product(), known).ok_or_else(|| {
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
        let toppled = orbit.states.iter().position(|state| state.theta.abs() >= problem.topple_angle);
        match toppled {
            None => Ok(orbit),
            Some(n) => Err(OrbitFailure::Ends {
                contact: n as u64 + 1,
                ending: Ending::Toppled { theta: orbit.states[n].theta, limit: problem.topple_angle },
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

/// Seeks an orbit on a path, with fewer conditions where it has none with all: the path keeps those that it has.
///
/// # Errors
/// That of the first search.
pub(super) fn with_fewer_conditions<'a>(
    path: &mut ParameterPath<'a>,
    mut seek: impl FnMut(&ParameterPath<'a>) -> Result<ClosedOrbit, OrbitFailure>,
) -> Result<ClosedOrbit, OrbitFailure> {
    let mut first = None;
    for problem in path.start.with_fewer_conditions() {
        let tried = path.with_conditions(&problem);
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
///
/// # Errors
/// [`OrbitFailure`], with the numbers it stopped at.
pub fn find(problem: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    find_in(problem, period, |path| SearchPlane::at_parameter(path.place(guess, 0.0)))
}

/// The orbit near a state with its angle at the first contact, at the energy that it has.
///
/// # Errors
/// Same as [`find`].
pub fn find_at_theta(problem: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    let free = OrbitProblem { energy: None, ..*problem };
    find_in(&free, period, |path| SearchPlane::at_theta(path.place(guess, 0.0)))
}

fn find_in(
    problem: &OrbitProblem,
    period: usize,
    plane: impl Fn(&ParameterPath<'_>) -> SearchPlane,
) -> Result<PeriodicOrbit, OrbitFailure> {
    let mut path = ParameterPath::resting(*problem);
    let plane = plane(&path);
    let solution = with_fewer_conditions(&mut path, |path| correct(path, period, &plane.point, &plane))?;
    PeriodicOrbit::new(problem, &solution)
}
