//! The closed equations of a periodic orbit, their exact derivative, and Newton's iteration on them.
//!
//! Derivatives by state and parameter come from dual numbers that go through all bounces of the period. How the rod's own
//! parameters move with a field of the scene is a central difference, since one field may move several of them or one of
//! them nonlinearly; it steers the iteration, and no answer depends on it.

use super::{OrbitFailure, OrbitProblem, Place, advance};
use crate::bounce::flight::Flight;
use crate::bounce::rod::Rod;
use crate::bounce::state::State;
use crate::numbers::dual::Dual;
use crate::numbers::number::Number;
use crate::scene::{Kind, Name, Scene, Value};
use nalgebra::{DMatrix, DVector, Matrix4};

/// Remainder of the equations, in parts of the scene's speed, up to which they count as solved.
pub(super) const SOLVED: f64 = 1e-11;

/// Speed at the contacts, in parts of the scene's, up to which a body rests on the table.
const AT_REST: f64 = 1e-6;

/// Remainder and step that rounding allows no better than.
const ROUNDING: f64 = 1e-15;

/// Most steps of one iteration; near an orbit it takes three or four.
const MOST_STEPS: u32 = 40;

/// Times that a step is halved when it leads away.
const MOST_HALVINGS: u32 = 6;

type Five = Dual<5>;

/// The setting along a parameter that goes through a range as its share goes from 0 to 1; or standing still.
pub(super) struct ParameterPath<'a> {
    scene: Option<(&'a Scene, Name)>,
    start: OrbitProblem,
    pub(super) from: f64,
    pub(super) to: f64,
    theta_dot: f64,
}

impl<'a> ParameterPath<'a> {
    pub(super) fn resting(setting: OrbitProblem) -> Self {
        let theta_dot = setting.speed / setting.rod.radius_of_gyration;
        Self { scene: None, start: setting, from: 0.0, to: 1.0, theta_dot }
    }

    /// Along a field of a scene.
    pub(super) fn along(scene: &'a Scene, name: Name, from: f64, to: f64) -> Result<Self, OrbitFailure> {
        let mut course =
            Self { scene: Some((scene, name)), start: setting_at(scene, name, from)?, from, to, theta_dot: 1.0 };
        course.theta_dot = course.start.speed / course.start.rod.radius_of_gyration;
        Ok(course)
    }

    pub(super) fn parameter(&self, share: f64) -> f64 {
        // Exact at both ends.
        if share == 1.0 { self.to } else { self.from + share * (self.to - self.from) }
    }

    pub(super) fn setting(&self, share: f64) -> Result<OrbitProblem, OrbitFailure> {
        match self.scene {
            None => Ok(self.start),
            Some((scene, name)) => setting_at(scene, name, self.parameter(share)),
        }
    }

    /// How rod and energy move with the share.
    fn rates(&self, share: f64) -> Result<(Rod, f64), OrbitFailure> {
        let still = |setting: &OrbitProblem| (setting.rod, setting.energy.unwrap_or(0.0));
        let Some((_, name)) = self.scene else {
            return Ok((rod_with(|part| part(&self.start.rod) * 0.0), 0.0));
        };
        let step = 1e-6;
        let inside = |share: f64| name.row().admits(Value::Number(self.parameter(share)));
        let ahead = if inside(share + step) { share + step } else { share };
        let behind = if inside(share - step) { share - step } else { share };
        let (high, low) = (still(&self.setting(ahead)?), still(&self.setting(behind)?));
        let per_share = 1.0 / (ahead - behind);
        Ok((rod_with(|part| (part(&high.0) - part(&low.0)) * per_share), (high.1 - low.1) * per_share))
    }

    pub(super) fn place(&self, state: &State, share: f64) -> Place {
        let speed = self.start.speed;
        let State { theta, x_dot, y_dot, theta_dot } = *state;
        Place::from([theta, x_dot / speed, y_dot / speed, theta_dot / self.theta_dot, share])
    }

    pub(super) fn state(&self, place: &Place) -> State {
        let speed = self.start.speed;
        State {
            theta: place[0],
            x_dot: place[1] * speed,
            y_dot: place[2] * speed,
            theta_dot: place[3] * self.theta_dot,
        }
    }
}

fn setting_at(scene: &Scene, name: Name, value: f64) -> Result<OrbitProblem, OrbitFailure> {
    let mut draft = scene.draft();
    let value = match name.row().kind {
        Kind::Number { .. } => Value::Number(value),
        _ => return Err(OrbitFailure::Scene(format!("{} is not a number", name.row().path))),
    };
    draft.set(name, Some(value)).map_err(|error| OrbitFailure::Scene(error.detail))?;
    let built = draft.build().map_err(|errors| {
        OrbitFailure::Scene(errors.into_iter().map(|error| error.detail).collect::<Vec<_>>().join("; "))
    })?;
    OrbitProblem::of(&built).map_err(OrbitFailure::Scene)
}

/// A rod made of what `each` gives for each of its parameters.
fn rod_with<N>(each: impl Fn(fn(&Rod) -> f64) -> N) -> Rod<N> {
    Rod {
        contact_distance: each(|rod| rod.contact_distance),
        radius_of_gyration: each(|rod| rod.radius_of_gyration),
        gravity: each(|rod| rod.gravity),
        restitution: each(|rod| rod.restitution),
        tilt_gain: each(|rod| rod.tilt_gain),
        strike_gain: each(|rod| rod.strike_gain),
        strike_gain_per_energy: each(|rod| rod.strike_gain_per_energy),
        target_energy: each(|rod| rod.target_energy),
    }
}

/// The equations at a place, with their derivatives by its five components.
#[derive(Clone, Debug)]
pub(super) struct ClosedEquations {
    /// What is left of each: the state's return, the energy (where nothing steers it), the drift.
    remainder: DVector<f64>,
    pub(super) derivative: DMatrix<f64>,
    pub(super) states: Vec<State>,
    /// Mean horizontal velocity, m/s.
    pub(super) drift: f64,
    /// s.
    pub(super) flight_time: f64,
}

impl ClosedEquations {
    fn new(course: &ParameterPath<'_>, period: usize, place: &Place) -> Result<Self, OrbitFailure> {
        let setting = course.setting(place[4])?;
        let (rates, energy_rate) = course.rates(place[4])?;
        let rod: Rod<Five> = rod_with(|part| Dual::along(part(&setting.rod), 4, part(&rates)));
        let (speed, spin) = (course.start.speed, course.theta_dot);
        let start = course.state(place);
        let first = State {
            theta: Dual::along(start.theta, 0, 1.0),
            x_dot: Dual::along(start.x_dot, 1, speed),
            y_dot: Dual::along(start.y_dot, 2, speed),
            theta_dot: Dual::along(start.theta_dot, 3, spin),
        };
        let (mut state, mut states) = (first, Vec::with_capacity(period));
        let (mut x, mut t) = (Five::from_f64(0.0), Five::from_f64(0.0));
        for contact in 1..=period as u64 {
            let before = values(&state);
            states.push(before);
            let (_, root) = advance(&setting.rod, before).map_err(|ending| OrbitFailure::Ends { contact, ending })?;
            let flight: Flight<Five> = rod.flight(&rod.strike(&state));
            let flight_time = flight.lift_root(root);
            state = flight.end(flight_time);
            x = x + state.x_dot * flight_time;
            t = t + flight_time;
        }
        let number = Five::from_f64;
        let drift = x / t;
        let mut equations = vec![
            state.theta - first.theta,
            (state.x_dot - first.x_dot) / number(speed),
            (state.y_dot - first.y_dot) / number(speed),
            (state.theta_dot - first.theta_dot) / number(spin),
            drift / number(speed),
        ];
        if let Some(energy) = setting.energy {
            let turn = rod.radius_of_gyration * first.theta_dot;
            let (_, versine) = first.theta.sin_versine();
            let own = number(0.5) * (first.x_dot * first.x_dot + first.y_dot * first.y_dot + turn * turn)
                + rod.gravity * rod.contact_distance * (number(1.0) - versine);
            equations.push((own - Dual::along(energy, 4, energy_rate)) / number(speed * speed));
        }
        let finite =
            |equation: &Five| equation.value.is_finite() && equation.partials.iter().all(|part| part.is_finite());
        if !equations.iter().all(finite) {
            return Err(OrbitFailure::Scene("the derivative over the period is beyond double precision".to_owned()));
        }
        Ok(Self {
            remainder: DVector::from_iterator(equations.len(), equations.iter().map(|equation| equation.value)),
            derivative: DMatrix::from_fn(equations.len(), 5, |row, column| equations[row].partials[column]),
            states,
            drift: drift.value,
            flight_time: t.value,
        })
    }

    pub(super) fn residual(&self) -> f64 {
        self.remainder.amax()
    }

    /// Derivative of the state after the period by that before it, in scaled components.
    pub(super) fn product(&self) -> Matrix4<f64> {
        Matrix4::from_fn(|row, column| self.derivative[(row, column)] + if row == column { 1.0 } else { 0.0 })
    }

    /// The direction in which the equations stay solved, of length 1; along `before`.
    pub(super) fn tangent(&self, before: &Place) -> Option<Place> {
        let v_t = self.derivative.clone().svd(false, true).v_t?;
        let row = v_t.row(4);
        let tangent = Place::from_fn(|n, _| row[n]);
        Some(if tangent.dot(before) < 0.0 { -tangent } else { tangent })
    }
}

fn values(state: &State<Five>) -> State {
    State {
        theta: state.theta.value,
        x_dot: state.x_dot.value,
        y_dot: state.y_dot.value,
        theta_dot: state.theta_dot.value,
    }
}

/// The plane in which an orbit is sought, since one parameter is one unknown too many.
pub(super) struct SearchPlane {
    pub(super) normal: Place,
    pub(super) point: Place,
}

impl SearchPlane {
    /// That of a fixed parameter.
    pub(super) fn at_parameter(point: Place) -> Self {
        Self { normal: Place::ith(4, 1.0), point }
    }

    /// That of a fixed angle at the first contact.
    pub(super) fn at_theta(point: Place) -> Self {
        Self { normal: Place::ith(0, 1.0), point }
    }
}

/// An orbit as a place, with the equations there.
#[derive(Clone, Debug)]
pub(super) struct ClosedOrbit {
    pub(super) place: Place,
    pub(super) closed: ClosedEquations,
    pub(super) steps: u32,
}

/// Newton's iteration (Gauss and Newton's, since there are more equations than unknowns) within a plane.
pub(super) fn correct(
    course: &ParameterPath<'_>,
    period: usize,
    guess: Place,
    plane: &SearchPlane,
) -> Result<ClosedOrbit, OrbitFailure> {
    let mut place = guess;
    let mut closed = ClosedEquations::new(course, period, &place)?;
    let off = |place: &Place| plane.normal.dot(&(place - plane.point));
    let mut steps = 0;
    while steps < MOST_STEPS {
        let rows = closed.remainder.len();
        let mut matrix = closed.derivative.clone().insert_row(rows, 0.0);
        matrix.row_mut(rows).copy_from(&plane.normal.transpose());
        let mut right = closed.remainder.clone().insert_row(rows, off(&place));
        right.neg_mut();
        let svd = matrix.svd(true, true);
        let least = 1e-13 * svd.singular_values.max();
        let Ok(step) = svd.solve(&right, least) else { break };
        let step = Place::from_fn(|n, _| step[n]);
        if step.amax() <= ROUNDING {
            break;
        }
        let size = |closed: &ClosedEquations, place: &Place| closed.remainder.norm() + off(place).abs();
        let now = size(&closed, &place);
        let mut share = 1.0;
        let mut better = None;
        for _ in 0..=MOST_HALVINGS {
            let next = place + step * share;
            if let Ok(there) = ClosedEquations::new(course, period, &next)
                && size(&there, &next) < now
            {
                better = Some((next, there));
                break;
            }
            share *= 0.5;
        }
        let Some((next, there)) = better else { break };
        (place, closed) = (next, there);
        steps += 1;
    }
    let residual = closed.residual().max(off(&place).abs());
    // At rest on the table all is closed, and nothing bounces.
    let speed = closed.states.iter().map(|state| state.y_dot.abs()).fold(0.0, f64::max);
    if speed <= AT_REST * course.start.speed {
        Err(OrbitFailure::AtRest { speed })
    } else if residual <= SOLVED {
        Ok(ClosedOrbit { place, closed, steps })
    } else {
        Err(OrbitFailure::NoConvergence { residual, steps })
    }
}
