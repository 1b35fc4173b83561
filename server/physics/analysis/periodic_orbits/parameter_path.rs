//! The path of a problem along a field of a scene, and how its body and its energy move along it.

use crate::analysis::periodic_orbits::problem::{OrbitFailure, OrbitProblem};
use crate::map::body::Body;
use crate::map::strike::State;
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
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
        let theta_dot = problem.speed / problem.body.rod.radius_of_gyration;
        Self { scene: None, start: problem, from: 0.0, to: 1.0, theta_dot }
    }

    /// Along a field of a scene.
    pub(super) fn along(scene: &'a Scene, name: Name, from: f64, to: f64) -> Result<Self, OrbitFailure> {
        let mut path =
            Self { scene: Some((scene, name)), start: problem_at(scene, name, from)?, from, to, theta_dot: 1.0 };
        path.theta_dot = path.start.speed / path.start.body.rod.radius_of_gyration;
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

    /// The body at a share of the way, with its derivative by the share along direction 4.
    pub(super) fn body(&self, problem: &OrbitProblem, share: f64) -> Result<Body<Dual<5>>, OrbitFailure> {
        let Some((scene, name)) = self.scene else { return Ok(problem.body.map(Dual::from_f64)) };
        let along = |other, value| {
            if other == name { Dual::along(value, 4, self.to - self.from) } else { Dual::from_f64(value) }
        };
        Ok(scene_at(scene, name, self.parameter(share))?.body_by(along))
    }

    /// Derivative of the energy by the share: a central difference. It steers the iteration, and no answer depends on it.
    pub(super) fn energy_rate(&self, share: f64) -> Result<f64, OrbitFailure> {
        let Some((_, name)) = self.scene else { return Ok(0.0) };
        let step = 1e-6;
        let inside = |share: f64| name.row().admits(Value::Number(self.parameter(share)));
        let ahead = if inside(share + step) { share + step } else { share };
        let behind = if inside(share - step) { share - step } else { share };
        let energy = |share: f64| Ok(self.problem(share)?.energy.unwrap_or(0.0));
        Ok((energy(ahead)? - energy(behind)?) / (ahead - behind))
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
    OrbitProblem::of(&scene_at(scene, name, value)?).map_err(OrbitFailure::Scene)
}

fn scene_at(scene: &Scene, name: Name, value: f64) -> Result<Scene, OrbitFailure> {
    let mut draft = scene.draft();
    let value = match name.row().kind {
        FieldKind::Number { .. } => Value::Number(value),
        FieldKind::Integer { .. } | FieldKind::Choice(_) | FieldKind::Flag | FieldKind::Numbers { .. } => {
            return Err(OrbitFailure::Scene(format!("{} is not a number", name.row().path)));
        }
    };
    draft.set(name, Some(value)).map_err(|error| OrbitFailure::Scene(error.detail))?;
    draft.build().map_err(|errors| {
        OrbitFailure::Scene(errors.into_iter().map(|error| error.detail).collect::<Vec<_>>().join("; "))
    })
}
