//! The mirror-symmetric orbits of period 2 in closed form: Gρ²θ cos κθ = V² l sin((κ − 1)θ), at (θ, V tan κθ, −V, Gθ/V).
//!
//! They branch off the upright bounce at κ_c; at a fixed energy as κ − κ_c ≈ a C θ².

use crate::analysis::boundary::symmetric_orbit;
use crate::analysis::periodic_orbits::parameter_path::{ParameterPath, ScaledPoint};
use crate::analysis::periodic_orbits::problem::{OrbitFailure, OrbitProblem};
use crate::map::friction::{Friction, Slide};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::numbers::trig;

/// The orbit through an angle, rad, at the energy that it has; `None` if V² would not be positive, and with friction unless the contact
/// sticks to a table that moves along with it.
pub fn symmetric(rod: &Rod, friction: Option<Friction>, theta: f64) -> Option<State> {
    if let Some(friction) = friction.filter(|friction| friction.coefficient != 0.0) {
        let matched = friction.slide == Slide::Matched;
        let orbit = symmetric_orbit(rod, Some(friction.coefficient), theta).filter(|_| matched)?;
        let speed = orbit.speed_squared.sqrt();
        return Some(State {
            theta,
            x_dot: orbit.slope * speed,
            y_dot: -speed,
            theta_dot: rod.gravity * theta / speed,
        });
    }
    let (_, cos) = trig::sin_cos(rod.tilt_gain * theta);
    let (sin, _) = trig::sin_cos((rod.tilt_gain - 1.0) * theta);
    let rho = rod.radius_of_gyration;
    let square = rod.gravity * rho * rho * theta * cos / (rod.contact_distance * sin);
    (square > 0.0 && square.is_finite() && cos > 0.0).then(|| along(rod, theta, square.sqrt()))
}

fn along(rod: &Rod, theta: f64, speed: f64) -> State {
    let (sin, cos) = trig::sin_cos(rod.tilt_gain * theta);
    State { theta, x_dot: speed * sin / cos, y_dot: -speed, theta_dot: rod.gravity * theta / speed }
}

fn symmetric_of(problem: &OrbitProblem, theta: f64) -> Option<State> {
    symmetric(&problem.body.rod, problem.body.friction, theta)
}

/// Cells in which a range is searched for the symmetric orbit through an angle.
const CELLS: u32 = 512;

/// The first place along a path where the symmetric orbit through an angle has the energy, or with feedback the
/// target's, of the problem there.
pub(super) fn symmetric_orbit_on_path(path: &ParameterPath<'_>, theta: f64) -> Result<ScaledPoint, OrbitFailure> {
    let mut last: Option<(f64, f64)> = None;
    for cell in 0..=CELLS {
        let share = f64::from(cell) / f64::from(CELLS);
        let here = excess(path, theta, share);
        if let (Some((before, low)), Some(high)) = (last, here)
            && (low <= 0.0) != (high <= 0.0)
        {
            let (mut left, mut right) = (before, share);
            while right - left > 1e-15 {
                let middle = 0.5 * (left + right);
                match excess(path, theta, middle) {
                    Some(value) if (value <= 0.0) == (low <= 0.0) => left = middle,
                    Some(_) => right = middle,
                    None => break,
                }
            }
            let share = 0.5 * (left + right);
            if let Some(state) = symmetric_of(&path.problem(share)?, theta) {
                return Ok(path.place(&state, share));
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
fn excess(path: &ParameterPath<'_>, theta: f64, share: f64) -> Option<f64> {
    let problem = path.problem(share).ok()?;
    let state = symmetric_of(&problem, theta)?;
    Some(match problem.energy {
        Some(energy) => problem.body.rod.energy(&state) - energy,
        // At a strike gain of 2 a strike keeps the energy.
        None if problem.body.rod.energy_feedback != EnergyFeedback::Vertical => {
            let strike = problem.body.rod.strike(&state);
            2.0 - strike.push / strike.normal_velocity
        }
        None => {
            let (_, cos) = trig::sin_cos(theta);
            let bounce =
                problem.body.rod.gravity * problem.body.rod.contact_distance * cos + 0.5 * state.y_dot * state.y_dot;
            bounce - problem.body.rod.target_energy
        }
    })
}
