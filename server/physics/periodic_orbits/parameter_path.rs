//! The path of a problem along a field of a scene, and how the parameters of the rod move along it.
//!
//! The derivative of the rod's parameters by a field of the scene is a central difference, since one field may move several of them or
//! one of them nonlinearly; it steers the iteration, and no answer depends on it.

use crate::bounce::energy_feedback::EnergyFeedback;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::periodic_orbits::problem::{OrbitFailure, OrbitProblem};
use crate::scene::{FieldKind, Name, Scene, Value};
use nalgebra::SVector;

/// θ, ẋ, ẏ, θ̇ over their scales, and the parameter's share of its range.
pub(super) type ScaledPoint = SVector<f64, 5>;

/// The problem along a parameter that goes through a range as its share goes from 0 to 1; or standing still.
pub(super) struct ParameterPath<'a> {
    scene: Option<(&'a Scene, Name)>,
    pub(super) start: OrbitProblem,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) theta_dot: f64,
}

impl<'a> ParameterPath<'a> {
    pub(super) fn resting(problem: OrbitProblem) -> Self {
        let theta_dot = problem.speed / problem.rod.radius_of_gyration;
        Self { scene: None, start: problem, from: 0.0, to: 1.0, theta_dot }
    }

    /// Along a field of a scene.
    pub(super) fn along(scene: &'a Scene, name: Name, from: f64, to: f64) -> Result<Self, OrbitFailure> {
        let mut path =
            Self { scene: Some((scene, name)), start: problem_at(scene, name, from)?, from, to, theta_dot: 1.0 };
        path.theta_dot = path.start.speed / path.start.rod.radius_of_gyration;
        Ok(path)
    }

    pub(super) fn parameter(&self, share: f64) -> f64 {
        // Exact at both ends.
        if share == 1.0 { self.to } else { self.from + share * (self.to - self.from) }
    }

    pub(super) fn problem(&self, share: f64) -> Result<OrbitProblem, OrbitFailure> {
        match self.scene {
            None => Ok(self.start),
            Some((scene, name)) => problem_at(scene, name, self.parameter(share)),
        }
    }

    /// Derivatives of rod and energy by the share.
    pub(super) fn rates(&self, share: f64) -> Result<(Rod, f64), OrbitFailure> {
        let feedback = self.start.rod.energy_feedback;
        let still = |problem: &OrbitProblem| (problem.rod, problem.energy.unwrap_or(0.0));
        let Some((_, name)) = self.scene else {
            return Ok((rod_with(feedback, |part| part(&self.start.rod) * 0.0), 0.0));
        };
        let step = 1e-6;
        let inside = |share: f64| name.row().admits(Value::Number(self.parameter(share)));
        let ahead = if inside(share + step) { share + step } else { share };
        let behind = if inside(share - step) { share - step } else { share };
        let (high, low) = (still(&self.problem(ahead)?), still(&self.problem(behind)?));
        let per_share = 1.0 / (ahead - behind);
        Ok((rod_with(feedback, |part| (part(&high.0) - part(&low.0)) * per_share), (high.1 - low.1) * per_share))
    }

    pub(super) fn place(&self, state: &State, share: f64) -> ScaledPoint {
        let speed = self.start.speed;
        let State { theta, x_dot, y_dot, theta_dot } = *state;
        ScaledPoint::from([theta, x_dot / speed, y_dot / speed, theta_dot / self.theta_dot, share])
    }

    pub(super) fn state(&self, place: &ScaledPoint) -> State {
        let speed = self.start.speed;
        State {
            theta: place[0],
            x_dot: place[1] * speed,
            y_dot: place[2] * speed,
            theta_dot: place[3] * self.theta_dot,
        }
    }
}

fn problem_at(scene: &Scene, name: Name, value: f64) -> Result<OrbitProblem, OrbitFailure> {
    let mut draft = scene.draft();
    let value = match name.row().kind {
        FieldKind::Number { .. } => Value::Number(value),
        FieldKind::Integer { .. } | FieldKind::Choice(_) | FieldKind::Flag | FieldKind::Numbers { .. } => {
            return Err(OrbitFailure::Scene(format!("{} is not a number", name.row().path)));
        }
    };
    draft.set(name, Some(value)).map_err(|error| OrbitFailure::Scene(error.detail))?;
    let built = draft.build().map_err(|errors| {
        OrbitFailure::Scene(errors.into_iter().map(|error| error.detail).collect::<Vec<_>>().join("; "))
    })?;
    OrbitProblem::of(&built).map_err(OrbitFailure::Scene)
}

/// A rod with parameters from `each`.
pub(super) fn rod_with<N>(energy_feedback: EnergyFeedback, each: impl Fn(fn(&Rod) -> f64) -> N) -> Rod<N> {
    Rod {
        contact_distance: each(|rod| rod.contact_distance),
        radius_of_gyration: each(|rod| rod.radius_of_gyration),
        gravity: each(|rod| rod.gravity),
        restitution: each(|rod| rod.restitution),
        tilt_gain: each(|rod| rod.tilt_gain),
        strike_gain: each(|rod| rod.strike_gain),
        strike_gain_per_energy: each(|rod| rod.strike_gain_per_energy),
        target_energy: each(|rod| rod.target_energy),
        energy_feedback,
    }
}
