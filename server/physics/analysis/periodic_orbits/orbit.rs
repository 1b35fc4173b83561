//! A periodic orbit with its evidence, and the search for one at the energy of a scene.

use crate::analysis::jacobian::jacobian;
use crate::analysis::periodic_orbits::closed::{ClosedOrbit, SearchPlane, correct};
use crate::analysis::periodic_orbits::multipliers::{Multipliers, TrivialMultipliers};
use crate::analysis::periodic_orbits::parameter_path::ParameterPath;
use crate::analysis::periodic_orbits::problem::{OrbitFailure, OrbitProblem};
use crate::map::strike::State;
use crate::run::ending::Ending;

/// A periodic orbit with its evidence.
#[derive(Clone, Debug)]
pub struct PeriodicOrbit {
    /// The states just before its contacts, as many as its period.
    pub states: Vec<State>,
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
        let states = closed.states.clone();
        let period = states.len();
        let rod = &problem.body.rod;
        let far = |one: &State, other: &State| {
            let spin = rod.radius_of_gyration * (one.theta_dot - other.theta_dot);
            let speeds = f64::max((one.x_dot - other.x_dot).abs(), (one.y_dot - other.y_dot).abs()).max(spin.abs());
            f64::max((one.theta - other.theta).abs(), speeds / problem.speed)
        };
        let repeats = |shift: usize| (0..period).all(|n| far(&states[n], &states[(n + shift) % period]) < SAME);
        let least_period = (1..=period).find(|&n| period.is_multiple_of(n) && repeats(n)).unwrap_or(period);
        if on_kink(problem, &states) {
            return Err(OrbitFailure::Scene(
                "a contact of this orbit is at the switch between two modes of friction, where the map has no derivative".to_owned(),
            ));
        }
        let known = match (problem.body.friction, problem.energy) {
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
fn on_kink(problem: &OrbitProblem, states: &[State]) -> bool {
    problem.body.friction.is_some()
        && states.iter().zip(1..).any(|(state, n)| {
            jacobian(&problem.body.from_contact(n), state, 1).is_ok_and(|contact| !contact.one_sided.is_empty())
        })
}

/// The orbit of `period` contacts near a state, at the problem's energy and without drift.
///
/// # Errors
/// [`OrbitFailure`], with the numbers it stopped at.
pub fn find(problem: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    let path = ParameterPath::resting(*problem);
    let plane = SearchPlane::at_parameter(path.place(guess, 0.0));
    let solution = correct(&path, period, plane.point, &plane)?;
    PeriodicOrbit::new(problem, &solution)
}
