//! The path of a problem along a field of a scene, and how its body and its energy move along it.

use crate::analysis::periodic_orbits::problem::{OrbitFailure, OrbitProblem};
use crate::analysis::return_map::{ARC, ReturnMap, SPIN, X, X_DOT};
use crate::map::body::{Body, PreImpact};
use crate::map::strike::{PlannedTableMotion, State};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::scene::{FieldKind, Name, Scene, Value};
use nalgebra::DVector;

/// θ, ẋ, ẏ, θ̇ over their scales, x where strikes depend on it, tilt and velocities of a table that plans before the last strike, and the
/// parameter's share of its range.
pub(super) type ScaledPoint = DVector<f64>;

/// Largest number of components of a state with the share.
pub(super) const MOST: usize = 9;

/// The share at the end of a point.
pub(super) fn share_of(place: &ScaledPoint) -> f64 {
    place[place.len() - 1]
}

/// Share of the upright flight from which on a delay may be longer than a flight of an orbit.
const LONG_DELAY: f64 = 0.25;

/// The problem along a parameter that goes through a range as its share goes from 0 to 1; or standing still.
pub(super) struct ParameterPath<'a> {
    scene: Option<(&'a Scene, Name)>,
    pub(super) start: OrbitProblem,
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) theta_dot: f64,
    /// Indices of the components of a state.
    components: Vec<usize>,
}

impl<'a> ParameterPath<'a> {
    pub(super) fn resting(problem: OrbitProblem) -> Self {
        let theta_dot = problem.speed / problem.body.rod.radius_of_gyration;
        let components = components(&[problem]);
        Self { scene: None, start: problem, from: 0.0, to: 1.0, theta_dot, components }
    }

    /// Along a field of a scene.
    pub(super) fn along(scene: &'a Scene, name: Name, from: f64, to: f64) -> Result<Self, OrbitFailure> {
        let start = problem_at(scene, name, from)?;
        let ends = [start, problem_at(scene, name, to).unwrap_or(start)];
        Ok(Self { scene: Some((scene, name)), from, to, components: components(&ends), ..Self::resting(start) })
    }

    /// The same path of problems with the conditions of `problem`.
    pub(super) fn with_conditions(&self, problem: &OrbitProblem) -> Self {
        let start = OrbitProblem { energy: problem.energy.and(self.start.energy), rests: problem.rests, ..self.start };
        Self { start, components: self.components.clone(), ..*self }
    }

    /// True if the table plans its motion before the last strike.
    pub(super) fn plans(&self) -> bool {
        self.components.contains(&(X + 1))
    }

    /// Indices of the components.
    pub(super) fn components(&self) -> &[usize] {
        &self.components
    }

    /// The direction of a component, or at the end of the share.
    pub(super) fn direction(&self, component: usize, sign: f64) -> ScaledPoint {
        let mut direction = ScaledPoint::zeros(self.components.len() + 1);
        direction[component] = sign;
        direction
    }

    /// The direction of the parameter.
    pub(super) fn onwards(&self) -> ScaledPoint {
        self.direction(self.components.len(), 1.0)
    }

    /// Scales of the components of a contact: rad, m/s, m/s, rad/s, m, rad, m/s and m/s.
    pub(super) fn scales(&self) -> [f64; 8] {
        let speed = self.start.speed;
        let length = 2.0 * speed * speed / self.start.body.rod.gravity;
        [1.0, speed, speed, self.theta_dot, length, 1.0, speed, speed]
    }

    pub(super) fn parameter(&self, share: f64) -> f64 {
        // Exact at both ends.
        if share == 1.0 { self.to } else { self.from + share * (self.to - self.from) }
    }

    pub(super) fn problem(&self, share: f64) -> Result<OrbitProblem, OrbitFailure> {
        match self.scene {
            None => Ok(self.start),
            Some((scene, name)) => {
                let problem = problem_at(scene, name, self.parameter(share))?;
                let OrbitProblem { energy, rests, .. } = self.start;
                Ok(OrbitProblem { energy: energy.and(problem.energy), rests, ..problem })
            }
        }
    }

    /// The body at a share of the way, with its derivative by the share along the last direction.
    pub(super) fn body(&self, problem: &OrbitProblem, share: f64) -> Result<Body<Dual<MOST>>, OrbitFailure> {
        let Some((scene, name)) = self.scene else { return Ok(problem.body.map(Dual::from_f64)) };
        let along = |other, value| {
            if other == name { Dual::along(value, MOST - 1, self.to - self.from) } else { Dual::from_f64(value) }
        };
        Ok(scene_at(scene, name, self.parameter(share))?.without_noise().body_by(along))
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

    /// A state from the middle of the table, with the motion that the table plans for it where it plans.
    pub(super) fn place(&self, state: &State, share: f64) -> ScaledPoint {
        let plan = self.plans().then(|| self.start.body.planned_motion(1, 0.0, state, 0.0, f64::INFINITY));
        self.place_of(&PreImpact { plan, ..PreImpact::at(1, 0.0, *state) }, share)
    }

    /// A contact.
    pub(super) fn place_of(&self, contact: &PreImpact, share: f64) -> ScaledPoint {
        let (all, scales) = (parts(contact), self.scales());
        let mut place: Vec<f64> = self.components.iter().map(|&index| all[index] / scales[index]).collect();
        place.push(share);
        ScaledPoint::from_vec(place)
    }

    /// The parts of a place, by their indices.
    pub(super) fn parts(&self, place: &ScaledPoint) -> [f64; 8] {
        let (mut parts, scales) = ([0.0; 8], self.scales());
        for (part, &index) in place.iter().zip(&self.components) {
            parts[index] = part * scales[index];
        }
        parts
    }
}

/// θ, ẋ, ẏ, θ̇, x and the planned motion of a contact.
pub(super) fn parts<N: Arithmetic>(contact: &PreImpact<N>) -> [N; 8] {
    let State { theta, x_dot, y_dot, theta_dot } = contact.state;
    let zero = N::from_f64(0.0);
    let [alpha, normal, tangential] =
        contact.plan.map_or([zero; 3], |plan| [plan.alpha, plan.normal_velocity, plan.tangential_velocity]);
    [theta, x_dot, y_dot, theta_dot, contact.x, alpha, normal, tangential]
}

/// The first contact with these parts.
pub(super) fn first_contact<N: Arithmetic>(parts: [N; 8], plans: bool) -> PreImpact<N> {
    let [theta, x_dot, y_dot, theta_dot, x, alpha, normal_velocity, tangential_velocity] = parts;
    let plan = plans.then_some(PlannedTableMotion { alpha, normal_velocity, tangential_velocity });
    let state = State { theta, x_dot, y_dot, theta_dot };
    PreImpact { n: 1, x, state, clearance: N::from_f64(0.0), plan }
}

/// Components of the states of these problems.
fn components(problems: &[OrbitProblem]) -> Vec<usize> {
    let has_place = |problem: &OrbitProblem| ReturnMap::new(&problem.body, 1).components().contains(&X);
    let is_late =
        |problem: &OrbitProblem| problem.body.lag > LONG_DELAY * 2.0 * problem.speed / problem.body.rod.gravity;
    let place = problems.iter().any(has_place).then_some(X);
    let plan = if problems.iter().any(is_late) { X + 1..X + 4 } else { 0..0 };
    let is_point = problems.iter().all(|problem| problem.body.is_point);
    let of_body = if is_point { X_DOT..SPIN } else { ARC..X };
    of_body.chain(place).chain(plan).collect()
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
