//! The mirror-symmetric orbits of period 2 in closed form: Gρ²θ cos κθ = V² l sin((κ − 1)θ), at (θ, V tan κθ, −V, Gθ/V).
//!
//! They branch off the upright bounce at κ_c; at a fixed energy as κ − κ_c ≈ a C θ².

use super::closed::ParameterPath;
use super::{OrbitFailure, Place};
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::numbers::trig;

/// The orbit through an angle, rad, at the energy that it has; none where V² would not be positive.
pub fn symmetric(rod: &Rod, theta: f64) -> Option<State> {
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

/// How finely a range is searched for the symmetric orbit through an angle.
const CELLS: u32 = 512;

/// The first place along a course where the symmetric orbit through an angle has the energy, or with feedback the
/// target's, of the setting there.
pub(super) fn on_course(course: &ParameterPath<'_>, theta: f64) -> Result<Place, OrbitFailure> {
    let mut last: Option<(f64, f64)> = None;
    for cell in 0..=CELLS {
        let share = f64::from(cell) / f64::from(CELLS);
        let here = excess(course, theta, share);
        if let (Some((before, low)), Some(high)) = (last, here)
            && (low <= 0.0) != (high <= 0.0)
        {
            let (mut left, mut right) = (before, share);
            while right - left > 1e-15 {
                let middle = 0.5 * (left + right);
                match excess(course, theta, middle) {
                    Some(value) if (value <= 0.0) == (low <= 0.0) => left = middle,
                    Some(_) => right = middle,
                    None => break,
                }
            }
            let share = 0.5 * (left + right);
            if let Some(state) = symmetric(&course.setting(share)?.rod, theta) {
                return Ok(course.place(&state, share));
            }
        }
        last = here.map(|value| (share, value));
    }
    let detail = format!(
        "no mirror-symmetric orbit through theta {theta} rad has the scene's energy for a parameter from {} to {}",
        course.from, course.to
    );
    Err(OrbitFailure::Scene(detail))
}

/// How much more energy, or height at the top with feedback, the symmetric orbit has than it should.
fn excess(course: &ParameterPath<'_>, theta: f64, share: f64) -> Option<f64> {
    let setting = course.setting(share).ok()?;
    let state = symmetric(&setting.rod, theta)?;
    Some(match setting.energy {
        Some(energy) => setting.rod.energy(&state) - energy,
        None => {
            let (_, cos) = trig::sin_cos(theta);
            let bounce = setting.rod.gravity * setting.rod.contact_distance * cos + 0.5 * state.y_dot * state.y_dot;
            bounce - setting.rod.target_energy
        }
    })
}
