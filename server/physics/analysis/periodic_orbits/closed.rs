//! The closed equations of a periodic orbit, their exact derivative, and Newton's iteration on them.
//!
//! Derivatives by state and parameter come from dual numbers that go through all bounces of the period.

use crate::analysis::periodic_orbits::parameter_path::{ParameterPath, ScaledPoint};
use crate::analysis::periodic_orbits::problem::{OrbitFailure, SOLVED};
use crate::map::body::{Body, PreImpact};
use crate::map::strike::State;
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::run::ending::Ending;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use nalgebra::{DMatrix, DVector, Matrix4};

/// Speed at the contacts, in parts of the scene's, up to which a body rests on the table.
const AT_REST: f64 = 1e-6;

/// Remainder and step that rounding allows no better than.
const ROUNDING: f64 = 1e-15;

/// Most steps of one iteration; near an orbit it takes three or four.
const MOST_STEPS: u32 = 40;

/// Times that a step is halved when it leads away.
const MOST_HALVINGS: u32 = 6;

type Five = Dual<5>;

/// The equations at a place, with their derivatives by its five components.
#[derive(Clone, Debug)]
pub(super) struct ClosedEquations {
    /// Remainders: of the state's return, of the energy (unless feedback sets it), of the drift.
    remainder: DVector<f64>,
    pub(super) derivative: DMatrix<f64>,
    pub(super) states: Vec<State>,
    /// Mean horizontal velocity, m/s.
    pub(super) drift: f64,
    /// s.
    pub(super) flight_time: f64,
}

impl ClosedEquations {
    fn new(path: &ParameterPath<'_>, period: usize, place: &ScaledPoint) -> Result<Self, OrbitFailure> {
        let problem = path.problem(place[4])?;
        let body: Body<Five> = path.body(&problem, place[4])?;
        let rod = &body.rod;
        let (speed, spin) = (path.start.speed, path.theta_dot);
        let start = path.state(place);
        let first = State {
            theta: Dual::along(start.theta, 0, 1.0),
            x_dot: Dual::along(start.x_dot, 1, speed),
            y_dot: Dual::along(start.y_dot, 2, speed),
            theta_dot: Dual::along(start.theta_dot, 3, spin),
        };
        let (mut state, mut states) = (first, Vec::with_capacity(period));
        let number = Five::from_f64;
        let (mut x, mut t) = (number(0.0), number(0.0));
        for contact in 1..=period as u64 {
            let before = values(&state);
            states.push(before);
            check_bounce(&problem.body.from_contact(contact), before)
                .map_err(|ending| OrbitFailure::Ends { contact, ending })?;
            let coming = PreImpact { n: contact, x, state, clearance: number(0.0), plan: None };
            let flight = body.fly(&coming, &body.strike(&coming));
            let arrival =
                flight.map_err(|no_contact| OrbitFailure::Ends { contact, ending: no_contact.ending(0.0, 0.0) })?;
            (state, x, t) = (arrival.state, x + arrival.way, t + arrival.t);
        }
        let drift = x / t;
        let mut equations = vec![
            state.theta - first.theta,
            (state.x_dot - first.x_dot) / number(speed),
            (state.y_dot - first.y_dot) / number(speed),
            (state.theta_dot - first.theta_dot) / number(spin),
            drift / number(speed),
        ];
        if let Some(energy) = problem.energy {
            let turn = rod.radius_of_gyration * first.theta_dot;
            let (_, versine) = first.theta.sin_versine();
            let own = number(0.5) * (first.x_dot * first.x_dot + first.y_dot * first.y_dot + turn * turn)
                + rod.gravity * rod.contact_distance * (number(1.0) - versine);
            equations.push((own - Dual::along(energy, 4, path.energy_rate(place[4])?)) / number(speed * speed));
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
    pub(super) fn tangent(&self, before: &ScaledPoint) -> Option<ScaledPoint> {
        let v_t = self.derivative.clone().svd(false, true).v_t?;
        let row = v_t.row(4);
        let tangent = ScaledPoint::from_fn(|n, _| row[n]);
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
    pub(super) normal: ScaledPoint,
    pub(super) point: ScaledPoint,
}

impl SearchPlane {
    /// The plane of a fixed parameter.
    pub(super) fn at_parameter(point: ScaledPoint) -> Self {
        Self { normal: ScaledPoint::ith(4, 1.0), point }
    }

    /// The plane of a fixed angle at the first contact.
    pub(super) fn at_theta(point: ScaledPoint) -> Self {
        Self { normal: ScaledPoint::ith(0, 1.0), point }
    }
}

/// An orbit as a place, with the equations there.
#[derive(Clone, Debug)]
pub(super) struct ClosedOrbit {
    pub(super) place: ScaledPoint,
    pub(super) closed: ClosedEquations,
    pub(super) steps: u32,
}

/// Newton's iteration (Gauss and Newton's, since there are more equations than unknowns) within a plane.
pub(super) fn correct(
    path: &ParameterPath<'_>,
    period: usize,
    guess: ScaledPoint,
    plane: &SearchPlane,
) -> Result<ClosedOrbit, OrbitFailure> {
    let mut place = guess;
    let mut closed = ClosedEquations::new(path, period, &place)?;
    let off = |place: &ScaledPoint| plane.normal.dot(&(place - plane.point));
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
        let step = ScaledPoint::from_fn(|n, _| step[n]);
        if step.amax() <= ROUNDING {
            break;
        }
        let size = |closed: &ClosedEquations, place: &ScaledPoint| closed.remainder.norm() + off(place).abs();
        let now = size(&closed, &place);
        let mut share = 1.0;
        let mut better = None;
        for _ in 0..=MOST_HALVINGS {
            let next = place + step * share;
            if let Ok(there) = ClosedEquations::new(path, period, &next)
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
    if speed <= AT_REST * path.start.speed {
        Err(OrbitFailure::AtRest { speed })
    } else if residual <= SOLVED {
        Ok(ClosedOrbit { place, closed, steps })
    } else {
        Err(OrbitFailure::NoConvergence { residual, steps })
    }
}

/// The ending of a run at a contact that no flight follows.
fn check_bounce(body: &Body, state: State) -> Result<(), Ending> {
    Orbit::at(*body, Rules::BARE_MAP, state).advance().ending.map_or(Ok(()), Err)
}
