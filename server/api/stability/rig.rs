//! Effects of the constant errors of a rig on a verdict, as part of the answer.

use equipoise_physics::control::steady_drift::SteadyDrift;
use equipoise_physics::scene::Scene;
use serde::Serialize;

/// The motion to which a constant tilt of the table drives a balanced body.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct SteadyDriftAnswer {
    /// Lean of the body, rad.
    theta: Option<f64>,
    /// Acceleration while the drift is slow, m/s².
    acceleration: Option<f64>,
    /// Steady velocity, m/s.
    speed: Option<f64>,
    /// Time on a table with ends, from rest in the middle, s.
    time_on_table: Option<f64>,
}

impl SteadyDriftAnswer {
    /// The motion of a scene, if a constant tilt leaves it no bounce in place.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let drift = SteadyDrift::of(scene)?;
        let (theta, acceleration, speed) = match drift {
            SteadyDrift::Accelerates { theta, acceleration } => (Some(theta), acceleration, None),
            SteadyDrift::Moves { speed } => (Some(0.0), Some(0.0), Some(speed)),
            SteadyDrift::Turns => (None, None, None),
        };
        let time_on_table = drift.time_on_table(scene.rules().half_length);
        Some(Self { theta, acceleration, speed, time_on_table })
    }
}

/// Sentences on gains that the table has by its errors, which are not those that it was given.
pub(super) fn gain_notes(scene: &Scene) -> Vec<String> {
    let errors = scene.table_errors();
    let mut notes = Vec::new();
    if errors.tilt_gain != 0.0 {
        notes.push(format!(
            "linear.tilt_gain is of the gain as it is set; the table tilts by {} times its law, and reason has the gain by which it acts",
            scene.tilt_factor()
        ));
    }
    if errors.speed != 0.0 && scene.steers_energy() {
        notes.push(format!(
            "linear.energy_gain is of the gain as it is set; the table moves at {} times its law",
            scene.speed_factor()
        ));
    }
    notes
}
