//! The closed equations of a periodic orbit, their exact derivative, and Newton's iteration on them.
//!
//! Derivatives by state and parameter come from dual numbers that go through all bounces of the period.

use crate::analysis::periodic_orbits::parameter_path::{
    MOST, ParameterPath, ScaledPoint, first_contact, parts, share_of,
};
use crate::analysis::periodic_orbits::problem::{OrbitFailure, SOLVED};
use crate::map::body::{Body, PreImpact};
use crate::map::strike::State;
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::run::ending::Ending;
use crate::run::orbit::{ComingContact, Orbit};
use crate::run::rules::Rules;
use nalgebra::{DMatrix, DVector};

/// Speed at the contacts, in parts of the scene's, up to which a body rests on the table.
const AT_REST: f64 = 1e-3;

/// Remainder and step that rounding allows no better than.
const ROUNDING: f64 = 1e-15;

/// Most steps of one iteration; near an orbit it takes three or four.
const MOST_STEPS: u32 = 40;

/// Times that a step is halved when it leads away.
const MOST_HALVINGS: u32 = 6;

type Derived = Dual<MOST>;

/// The equations at a place, with their derivatives by its components.
#[derive(Clone, Debug)]
pub(super) struct ClosedEquations {
    /// Remainders: of the state's return, of the energy (unless feedback sets it), of the drift.
    remainder: DVector<f64>,
    pub(super) derivative: DMatrix<f64>,
    pub(super) contacts: Vec<PreImpact>,
    /// Mean horizontal velocity, m/s.
    pub(super) drift: f64,
    /// s.
    pub(super) flight_time: f64,
}

impl ClosedEquations {
    fn new(path: &ParameterPath<'_>, period: usize, place: &ScaledPoint) -> Result<Self, OrbitFailure> {
        let share = share_of(place);
        let problem = path.problem(share)?;
        let body: Body<Derived> = path.body(&problem, share)?;
        let rod = &body.rod;
        let (speed, scales, components) = (path.start.speed, path.scales(), path.components());
        let mut start = path.parts(place).map(Derived::from_f64);
        for (direction, &index) in components.iter().enumerate() {
            start[index].partials[direction] = scales[index];
        }
        let mut first = first_contact(start, path.plans());
        if body.is_point {
            first.state = Body::point_state(first.state.x_dot, first.state.y_dot);
        }
        let (mut coming, mut contacts) = (first, Vec::with_capacity(period));
        let number = Derived::from_f64;
        let mut t = number(0.0);
        for contact in 1..=period as u64 {
            let before = values(&coming);
            contacts.push(before);
            check_bounce(&problem.body, &before).map_err(|ending| OrbitFailure::Ends { contact, ending })?;
            let flight = body.fly(&coming, &body.strike(&coming));
            let arrival =
                flight.map_err(|no_contact| OrbitFailure::Ends { contact, ending: no_contact.ending(0.0, 0.0) })?;
            let (n, x) = (contact + 1, coming.x + arrival.way);
            let plan = if path.plans() {
                let own = || body.planned_motion(n, x, &arrival.state, 0.0, number(f64::INFINITY));
                Some(arrival.plan.unwrap_or_else(own))
            } else if arrival.plan.is_some() && contact == period as u64 {
                let why = format!("a flight of {} s is shorter than table.delay, and others are not", arrival.t.value);
                return Err(OrbitFailure::Scene(why));
            } else {
                arrival.plan
            };
            coming = PreImpact { n, x, state: arrival.state, clearance: number(0.0), plan };
            t = t + arrival.t;
        }
        let drift = (coming.x - first.x) / t;
        let (before, after) = (parts(&first), parts(&coming));
        let mut equations: Vec<Derived> =
            components.iter().map(|&index| (after[index] - before[index]) / number(scales[index])).collect();
        if problem.rests {
            equations.push(drift / number(speed));
        }
        if let Some(energy) = problem.energy {
            let State { theta, x_dot, y_dot, theta_dot } = first.state;
            let turn = rod.radius_of_gyration * theta_dot;
            let (_, versine) = theta.sin_versine();
            let own = number(0.5) * (x_dot * x_dot + y_dot * y_dot + turn * turn)
                + rod.gravity * rod.contact_distance * (number(1.0) - versine);
            equations.push((own - Dual::along(energy, MOST - 1, path.energy_rate(share)?)) / number(speed * speed));
        }
        let finite =
            |equation: &Derived| equation.value.is_finite() && equation.partials.iter().all(|part| part.is_finite());
        if !equations.iter().all(finite) {
            return Err(OrbitFailure::Scene("the derivative over the period is beyond double precision".to_owned()));
        }
        let size = components.len();
        let part = |row: usize, column: usize| equations[row].partials[if column == size { MOST - 1 } else { column }];
        Ok(Self {
            remainder: DVector::from_iterator(equations.len(), equations.iter().map(|equation| equation.value)),
            derivative: DMatrix::from_fn(equations.len(), size + 1, part),
            contacts,
            drift: drift.value,
            flight_time: t.value,
        })
    }

    pub(super) fn residual(&self) -> f64 {
        self.remainder.amax()
    }

    /// Derivative of the state after the period by that before it, in scaled components.
    pub(super) fn product(&self) -> DMatrix<f64> {
        let size = self.derivative.ncols() - 1;
        DMatrix::from_fn(size, size, |row, column| {
            self.derivative[(row, column)] + if row == column { 1.0 } else { 0.0 }
        })
    }

    /// The direction in which the equations stay solved, of length 1; along `before`.
    pub(super) fn tangent(&self, before: &ScaledPoint) -> Option<ScaledPoint> {
        let (rows, columns) = self.derivative.shape();
        let square = self.derivative.clone().resize_vertically(rows.max(columns), 0.0);
        let v_t = square.svd(false, true).v_t?;
        let tangent = v_t.row(columns - 1).transpose();
        Some(if tangent.dot(before) < 0.0 { -tangent } else { tangent })
    }
}

fn values(contact: &PreImpact<Derived>) -> PreImpact {
    let value = |number: Derived| number.value;
    PreImpact {
        n: contact.n,
        x: contact.x.value,
        state: contact.state.map(value),
        clearance: 0.0,
        plan: contact.plan.map(|plan| plan.map(value)),
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
        Self::at(point.len() - 1, point)
    }

    /// The plane of a fixed angle at the first contact.
    pub(super) fn at_theta(point: ScaledPoint) -> Self {
        Self::at(0, point)
    }

    fn at(component: usize, point: ScaledPoint) -> Self {
        let mut normal = ScaledPoint::zeros(point.len());
        normal[component] = 1.0;
        Self { normal, point }
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
    guess: &ScaledPoint,
    plane: &SearchPlane,
) -> Result<ClosedOrbit, OrbitFailure> {
    let mut place = guess.clone();
    let mut closed = ClosedEquations::new(path, period, &place)?;
    let off = |place: &ScaledPoint| plane.normal.dot(&(place - &plane.point));
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
        if step.amax() <= ROUNDING {
            break;
        }
        let size = |closed: &ClosedEquations, place: &ScaledPoint| closed.remainder.norm() + off(place).abs();
        let now = size(&closed, &place);
        let mut share = 1.0;
        let mut better = None;
        for _ in 0..=MOST_HALVINGS {
            let next = &place + &step * share;
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
    let speed = closed.contacts.iter().map(|contact| contact.state.y_dot.abs()).fold(0.0, f64::max);
    if speed <= AT_REST * path.start.speed {
        Err(OrbitFailure::AtRest { speed })
    } else if residual <= SOLVED {
        Ok(ClosedOrbit { place, closed, steps })
    } else {
        Err(OrbitFailure::NoConvergence { residual, steps })
    }
}

/// The ending of a run at a contact that no flight follows.
fn check_bounce(body: &Body, coming: &PreImpact) -> Result<(), Ending> {
    let coming = ComingContact { t: 0.0, coming: *coming, before: None };
    Orbit::under_way(*body, Rules::BARE_MAP, &coming).advance().ending.map_or(Ok(()), Err)
}
