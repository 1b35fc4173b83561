//! The problem of a periodic orbit: a body with the energy and drift that close its equations, along a scene's field.

use crate::analysis::limits::Parameter;
use crate::analysis::repeating::SceneMap;
use crate::analysis::return_map::{COMPONENTS, ReturnMap, SPIN, X, Y_DOT, contact_of, parts};
use crate::analysis::small_deviations::small_deviations;
use crate::map::body::{Body, PreImpact};
use crate::map::strike::{Rod, State};
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use crate::run::ending::Ending;
use crate::scene::model::ModelLevel;
use crate::scene::{Name, Scene};
use nalgebra::DVector;
use thiserror::Error;

/// Remainder of the equations, in parts of the scene's speed, up to which they count as solved.
pub(super) const SOLVED: f64 = 1e-11;

/// The body of an orbit and the conditions that close its equations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitProblem {
    /// The scene.
    pub scene: Scene,
    /// The body. Of one with a program of heights, periods are multiples of their number.
    pub body: Body,
    /// Energy per unit mass that orbits must have, ½|v|² + Gy at a contact, m²/s²; `None` if feedback sets it.
    pub energy: Option<f64>,
    /// V of the upright bounce, m/s: the scale of velocities.
    pub speed: f64,
    /// True for the rod with friction or without, whose strikes look at angle and velocities alone: its energy and its drift are free unless its
    /// table steers them. Of other bodies the map itself tells what is free.
    pub is_rod: bool,
    /// True if orbits must have no drift.
    pub rests: bool,
}

impl OrbitProblem {
    /// The problem of a scene without its noise. Its energy is that of the release without the drift, as for the fixed point, or the energy that the table
    /// holds: orbits have no drift.
    /// Fails with a sentence that says why the scene has no periodic orbits.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let scene = &scene.without_noise();
        let body = scene.model();
        let Rod { gravity, contact_distance, .. } = body.rod;
        let is_rod = !body.is_point && scene.needs_at_most(&[ModelLevel::Friction]);
        let speed = match &body.program {
            None if is_rod => {
                small_deviations(scene)
                    .and_then(|small| small.without_drift(scene))
                    .map_err(|why| format!("no bounce repeats: {why}"))?
                    .fixed_point
                    .speed
            }
            _ => SceneMap::of(scene).map_err(|_| "the release comes to no contact")?.guess[Y_DOT].abs(),
        };
        let energy = 0.5 * speed * speed + gravity * contact_distance;
        let energy = (!scene.steers_energy()).then_some(energy);
        Ok(Self { scene: *scene, body, energy, speed, is_rod, rests: true })
    }

    /// The same with fewer conditions, in the order in which they are tried. What nothing keeps along an orbit has the value that the orbit gives it.
    pub(super) fn with_fewer_conditions(self) -> Vec<Self> {
        if self.is_rod {
            return vec![self];
        }
        let free = Self { energy: None, ..self };
        let mut tried = vec![self, free, Self { rests: false, ..self }, Self { rests: false, ..free }];
        tried.dedup();
        tried
    }

    /// The upright bounce, which is the orbit of period 1; with a program, the bounce before its first strike.
    pub fn upright(&self) -> State {
        State { theta: 0.0, x_dot: 0.0, y_dot: -self.speed, theta_dot: 0.0 }
    }
}

/// Components of a contact over their scales, and the parameter's share of its range.
pub(super) type ScaledPoint = DVector<f64>;

/// Largest number of components of a contact with the share.
pub(super) const MOST: usize = COMPONENTS + 1;

/// The share at the end of a point.
pub(super) fn share_of(place: &ScaledPoint) -> f64 {
    place[place.len() - 1]
}

/// A point with another share.
pub(super) fn at_share(mut place: ScaledPoint, share: f64) -> ScaledPoint {
    let last = place.len() - 1;
    place[last] = share;
    place
}

/// Share of the upright flight from which on a delay may be longer than a flight of an orbit.
const LONG_DELAY: f64 = 0.25;

/// The problem along a parameter that goes through a range as its share goes from 0 to 1; or standing still.
#[derive(Clone)]
pub(super) struct ParameterPath {
    pub(super) name: Option<Name>,
    pub(super) start: OrbitProblem,
    pub(super) from: f64,
    pub(super) to: f64,
    /// Indices of the components of a contact: θ, ẋ, ẏ, θ̇, x where strikes depend on it, tilt and velocities of a table that plans before the last
    /// strike.
    pub(super) components: Vec<usize>,
    /// Scales of all components: rad, m/s, m/s, rad/s, m, rad, m/s and m/s.
    pub(super) scales: [f64; COMPONENTS],
}

impl ParameterPath {
    pub(super) fn resting(start: OrbitProblem) -> Self {
        Self::between(start, start, None, [0.0, 1.0])
    }

    pub(super) fn along(scene: &Scene, name: Name, from: f64, to: f64) -> Result<Self, OrbitFailure> {
        let start = problem_at(scene, name, from)?;
        let end = problem_at(scene, name, to).unwrap_or(start);
        Ok(Self::between(start, end, Some(name), [from, to]))
    }

    fn between(start: OrbitProblem, end: OrbitProblem, name: Option<Name>, [from, to]: [f64; 2]) -> Self {
        let maps = [start, end].map(|problem| {
            let map = ReturnMap::new(&problem.body, 1);
            let is_late = problem.body.lag > LONG_DELAY * 2.0 * problem.speed / problem.body.rod.gravity;
            if is_late { map.planning() } else { map }.components()
        });
        let components = (0..COMPONENTS).filter(|index| maps.iter().any(|map| map.contains(index))).collect();
        let (speed, Rod { gravity, radius_of_gyration, .. }) = (start.speed, start.body.rod);
        let scales = [1.0, speed, speed, speed / radius_of_gyration, 2.0 * speed * speed / gravity, 1.0, speed, speed];
        Self { name, start, from, to, components, scales }
    }

    pub(super) fn plans(&self) -> bool {
        self.components.contains(&(X + 1))
    }

    /// The direction of a component, or at the end of the share.
    pub(super) fn direction(&self, component: usize, sign: f64) -> ScaledPoint {
        let mut direction = ScaledPoint::zeros(self.components.len() + 1);
        direction[component] = sign;
        direction
    }

    pub(super) fn parameter(&self, share: f64) -> f64 {
        // Exact at both ends.
        if share == 1.0 { self.to } else { self.from + share * (self.to - self.from) }
    }

    /// The problem at a share of the way, with the conditions of the first.
    pub(super) fn problem(&self, share: f64) -> Result<OrbitProblem, OrbitFailure> {
        let Some(name) = self.name else { return Ok(self.start) };
        let OrbitProblem { energy, rests, ref scene, .. } = self.start;
        let problem = problem_at(scene, name, self.parameter(share))?;
        Ok(OrbitProblem { energy: energy.and(problem.energy), rests, ..problem })
    }

    /// The body of a problem with its derivative by the share along the last direction.
    pub(super) fn body(&self, problem: &OrbitProblem) -> Body<Dual<MOST>> {
        if self.name.is_none() {
            return problem.body.map(Dual::from_f64);
        }
        let body = problem.scene.body_by(|name, value| {
            let rate = if Some(name) == self.name { self.to - self.from } else { 0.0 };
            Dual::along(value, MOST - 1, rate)
        });
        Body { noise: None, outline: None, ..body }
    }

    /// Derivative of the energy by the share: a central difference. It steers the iteration, and no answer depends on it.
    pub(super) fn energy_rate(&self, share: f64) -> Result<f64, OrbitFailure> {
        if self.name.is_none() {
            return Ok(0.0);
        }
        let step = 1e-6;
        let inside = share.clamp(step, 1.0 - step);
        let energy = |share: f64| Ok(self.problem(share)?.energy.unwrap_or(0.0));
        Ok((energy(inside + step)? - energy(inside - step)?) / (2.0 * step))
    }

    /// The point of a contact, with the motion that the table plans for it where it plans.
    pub(super) fn place(&self, contact: &PreImpact, share: f64) -> ScaledPoint {
        let PreImpact { x, state, .. } = contact;
        let own = || self.start.body.planned_motion(1, *x, state, 0.0, f64::INFINITY);
        let plan = contact.plan.or_else(|| self.plans().then(own));
        let all = parts(&PreImpact { plan, ..*contact });
        let scaled = self.components.iter().map(|&index| all[index] / self.scales[index]);
        ScaledPoint::from_vec(scaled.chain([share]).collect())
    }

    /// The contact of a point, in numbers made of the parts by their places in the point.
    pub(super) fn contact<N: Number>(&self, place: &ScaledPoint, lift: impl Fn(f64, usize, f64) -> N) -> PreImpact<N> {
        let mut parts = [N::from_f64(0.0); COMPONENTS];
        for (position, &index) in self.components.iter().enumerate() {
            parts[index] = lift(place[position] * self.scales[index], position, self.scales[index]);
        }
        contact_of(1, parts, !self.components.contains(&SPIN), self.plans())
    }
}

fn problem_at(scene: &Scene, name: Name, value: f64) -> Result<OrbitProblem, OrbitFailure> {
    Parameter::Field(name).moved(scene, value).and_then(|moved| OrbitProblem::of(&moved)).map_err(OrbitFailure::Scene)
}

/// Reason for which there is no orbit.
#[derive(Clone, Debug, PartialEq, Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum OrbitFailure {
    #[error("the run ends as `{}` at contact {contact}, before it could come back", ending.name())]
    Ends {
        /// At which contact, from 1.
        contact: u64,
        ending: Ending,
    },
    #[error(
        "Newton's iteration found no orbit: after {steps} steps the equations are off by {residual} (no unit; {SOLVED} is taken as solved)"
    )]
    NoConvergence { residual: f64, steps: u32 },
    #[error(
        "Newton's iteration came to the body at rest on the table (ẏ = {speed} m/s), which bounces no more: give another guess"
    )]
    AtRest { speed: f64 },
    #[error("{0}")]
    Scene(String),
    #[error("cancelled")]
    Cancelled,
}
