//! Periodic orbits: states that come back after a number of contacts, found by Newton's iteration with exact derivatives.
//!
//! f^k(x) = x alone is singular, since orbits come in families: by their energy, where nothing steers it, and by their mean
//! drift. So it is closed with the scene's energy and with zero drift. That is more equations than unknowns, all of which
//! an orbit satisfies; they are solved by least squares, and a remainder means that there is no orbit.
//! Following an orbit along a parameter is in [`branch`], judging it in [`multipliers`].

pub mod branch;
mod closed;
pub mod multipliers;
mod symmetric;

pub use symmetric::symmetric;

use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::run::ending::Ending;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::Scene;
use crate::scene::model::Model;
use crate::stability::fixed_point::find_fixed_point;
use closed::{ClosedOrbit, ParameterPath, SearchPlane, correct};
use multipliers::{Multipliers, TrivialMultipliers};
use nalgebra::SVector;

/// What an orbit is sought in: a rod and what closes the equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitProblem {
    /// The rod.
    pub rod: Rod,
    /// Energy per unit mass that orbits must have, ½|v|² + Gy at a contact, m²/s²; none where feedback sets it.
    pub energy: Option<f64>,
    /// V of the upright bounce, m/s: the scale of velocities.
    pub speed: f64,
    /// |θ| at which a contact has toppled, rad.
    pub topple_angle: f64,
}

impl OrbitProblem {
    /// That of a scene: its energy is the release's, less what drift would keep, as for its fixed point.
    ///
    /// # Errors
    /// Why the scene has no periodic orbits, in a sentence.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        if let Some(error) = scene.beyond(&[]) {
            return Err(error.detail);
        }
        let Model::Rod(rod) = scene.model() else {
            return Err("a point mass has no angle, so no orbits but its bounce in place".to_owned());
        };
        let speed = find_fixed_point(scene)?.speed;
        let energy = 0.5 * speed * speed + rod.gravity * rod.contact_distance;
        Ok(Self {
            rod,
            energy: (rod.strike_gain_per_energy == 0.0).then_some(energy),
            speed,
            topple_angle: scene.topple_angle,
        })
    }

    /// The upright bounce, which is the orbit of period 1.
    pub fn upright(&self) -> State {
        State { theta: 0.0, x_dot: 0.0, y_dot: -self.speed, theta_dot: 0.0 }
    }
}

/// Why there is no orbit to give.
#[derive(Clone, Debug, PartialEq)]
pub enum OrbitFailure {
    /// The run from the best state so far ends before it could come back.
    Ends {
        /// At which contact, from 1.
        contact: u64,
        /// How.
        ending: Ending,
    },
    /// The iteration came to no orbit.
    NoConvergence {
        /// What was left of the equations, in parts of the scene's speed.
        residual: f64,
        /// Steps taken.
        steps: u32,
    },
    /// The iteration came to the body at rest on the table.
    AtRest {
        /// Largest |ẏ| before a contact, m/s.
        speed: f64,
    },
    /// The scene itself does not allow it here.
    Scene(String),
    /// Nobody wants it any more.
    Cancelled,
}

impl std::fmt::Display for OrbitFailure {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Ends { contact, ending } => {
                write!(formatter, "the run ends as `{}` at contact {contact}, before it could come back", ending.name())
            }
            Self::NoConvergence { residual, steps } => write!(
                formatter,
                "Newton's iteration found no orbit: after {steps} steps the equations are off by {residual} (no unit; \
                 {} is taken as solved)",
                closed::SOLVED
            ),
            Self::AtRest { speed } => write!(
                formatter,
                "Newton's iteration came to the body at rest on the table (ẏ = {speed} m/s), which bounces no more: \
                 give another guess"
            ),
            Self::Scene(why) => formatter.write_str(why),
            Self::Cancelled => formatter.write_str("cancelled"),
        }
    }
}

/// A periodic orbit with its evidence.
#[derive(Clone, Debug)]
pub struct PeriodicOrbit {
    /// The states just before its contacts, as many as its period.
    pub states: Vec<State>,
    /// The least period: a divisor of the one asked for.
    pub least_period: usize,
    /// What is left of the equations, in parts of the scene's speed.
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
    /// What the derivative over the period says.
    pub multipliers: Multipliers,
}

/// Difference of two states, in parts of the scales, up to which they are the same for the least period.
const SAME: f64 = 1e-7;

impl PeriodicOrbit {
    /// Largest |θ| at a contact, rad.
    pub fn max_theta(&self) -> f64 {
        self.states.iter().map(|state| state.theta.abs()).fold(0.0, f64::max)
    }

    fn new(setting: &OrbitProblem, solution: &ClosedOrbit) -> Result<Self, OrbitFailure> {
        let ClosedOrbit { closed, steps, .. } = solution;
        let states = closed.states.clone();
        let period = states.len();
        let rod = &setting.rod;
        let far = |one: &State, other: &State| {
            let spin = rod.radius_of_gyration * (one.theta_dot - other.theta_dot);
            let speeds = f64::max((one.x_dot - other.x_dot).abs(), (one.y_dot - other.y_dot).abs()).max(spin.abs());
            f64::max((one.theta - other.theta).abs(), speeds / setting.speed)
        };
        let repeats = |shift: usize| (0..period).all(|n| far(&states[n], &states[(n + shift) % period]) < SAME);
        let least_period = (1..=period).find(|&n| period.is_multiple_of(n) && repeats(n)).unwrap_or(period);
        let known =
            if setting.energy.is_some() { TrivialMultipliers::EnergyAndDrift } else { TrivialMultipliers::Drift };
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
        let toppled = orbit.states.iter().position(|state| state.theta.abs() >= setting.topple_angle);
        match toppled {
            None => Ok(orbit),
            Some(n) => Err(OrbitFailure::Ends {
                contact: n as u64 + 1,
                ending: Ending::Toppled { theta: orbit.states[n].theta, limit: setting.topple_angle },
            }),
        }
    }
}

/// The orbit of `period` contacts near a state, at the setting's energy and without drift.
///
/// # Errors
/// [`OrbitFailure`], with the numbers it stopped at.
pub fn find(setting: &OrbitProblem, period: usize, guess: &State) -> Result<PeriodicOrbit, OrbitFailure> {
    let course = ParameterPath::resting(*setting);
    let plane = SearchPlane::at_parameter(course.place(guess, 0.0));
    let solution = correct(&course, period, plane.point, &plane)?;
    PeriodicOrbit::new(setting, &solution)
}

/// The state after a number of contacts and the contact at which it could not go on, if there is one.
fn advance(rod: &Rod, state: State) -> Result<(State, f64), Ending> {
    let mut orbit = Orbit::at(*rod, Rules::BARE_MAP, state);
    let contact = orbit.advance();
    match (contact.flight_time, contact.ending) {
        (Some(flight_time), _) => Ok((*orbit.state(), flight_time)),
        (None, ending) => Err(ending.unwrap_or(Ending::Completed)),
    }
}

/// θ, ẋ, ẏ, θ̇ over their scales, and the parameter's share of its range.
type Place = SVector<f64, 5>;
