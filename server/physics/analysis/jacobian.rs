//! The derivative of the map from contact to contact, at any state, by differentiating its formulas with the contact
//! time implicit; and the same by finite differences, only to compare.
//!
//! A state is (ρθ, ẋ, ẏ, ρθ̇) just before a contact, followed by x if the table has state feedback, or turns about a fixed place and acts
//! on the body by that. The state of a point mass is (ẋ, ẏ). A table with a delay that is longer than a flight plans its motion before the last
//! strike: that motion belongs to the state too.

use crate::analysis::return_map::ReturnMap;
use crate::map::body::{Body, PreImpact};
use crate::map::flight::Flight;
use crate::map::friction::{FrictionBranch, RestitutionLaw, Slide, actual_branch};
use crate::map::strike::{ContactMode, State, Strike};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::run::orbit::{Contact, Orbit};
use crate::run::rules::Rules;
use nalgebra::{Complex, DMatrix, DVector, Schur};

/// The map linearized about one orbit segment.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// Derivative of the state at the end with respect to the state at the start: 4 × 4, 5 × 5 where it depends on x, for a
    /// point mass 2 × 2, with three more of a planned motion. Components are in m/s, except ρθ and x in m and a planned tilt in rad.
    pub matrix: DMatrix<f64>,
    /// The state at the end.
    pub end: State,
    /// Horizontal position of the centre of gravity at the end, m.
    pub x: f64,
    /// Length of the flights passed, s.
    pub flight_time: f64,
    /// ẏ_c just before the contact nearest to grazing, m/s: derivatives grow without bound as it goes to 0.
    pub contact_speed: f64,
    /// Contact mode of the first contact.
    pub contact_mode: ContactMode,
    /// Names of the rows and columns of the matrix: [`state_order`], or with the motion of a table that plans before the last strike those of
    /// [`ReturnMap::names`].
    pub order: Vec<&'static str>,
    /// Derivatives on all sides of a kink of the map; empty away from kinks.
    pub one_sided: Vec<OneSidedDerivative>,
}

/// A derivative of the map on one side of a kink.
#[derive(Clone, Debug, PartialEq)]
pub struct OneSidedDerivative {
    /// Contact mode on that side.
    pub contact_mode: ContactMode,
    /// Same as [`Linearization::matrix`].
    pub matrix: DMatrix<f64>,
}

/// Relative distance from a switch between two branches of an impact with friction up to which both branches are followed. It is a
/// few thousand ulps.
pub const TIED: f64 = 1e-12;

/// Maximum number of sides that are reported. Each contact on a kink doubles the number.
pub const MOST_SIDES: usize = 16;

/// Names of the components of a state, in the order of a matrix's rows and columns.
pub fn state_order(model: &Body) -> &'static [&'static str] {
    if model.is_point {
        if model.depends_on_place() { &["x_dot", "y_dot", "x"] } else { &["x_dot", "y_dot"] }
    } else if model.depends_on_place() {
        &["rho_theta", "x_dot", "y_dot", "rho_theta_dot", "x"]
    } else {
        &["rho_theta", "x_dot", "y_dot", "rho_theta_dot"]
    }
}

/// Derivative of the map over `period` contacts from a state, exact but for rounding.
///
/// # Errors
/// The contact that ends the run early; it has no derivative.
pub fn jacobian(model: &Body, start: &State, period: u64) -> Result<Linearization, Box<Contact>> {
    jacobian_at(model, 0.0, start, period)
}

/// [`jacobian`] from a horizontal position x, m. The derivative depends on x only if the table feeds it back or turns.
///
/// # Errors
/// Same as [`jacobian`].
pub fn jacobian_at(model: &Body, x: f64, start: &State, period: u64) -> Result<Linearization, Box<Contact>> {
    let (mut linearization, is_hurried) = at_contacts(model, x, start, period)?;
    if is_hurried && model.noise.is_none() {
        let map = ReturnMap::new(model, period).planning();
        let size = map.components().len();
        let found = map.derivative(&map.planned(&map.vector(start, x)));
        linearization.matrix = found.map_or_else(|| DMatrix::from_element(size, size, f64::NAN), |found| found.matrix);
        (linearization.order, linearization.one_sided) = (map.names(), Vec::new());
    }
    Ok(linearization)
}

/// The derivative by the state at contacts, and whether a flight is shorter than the delay of the table.
fn at_contacts(model: &Body, x: f64, start: &State, period: u64) -> Result<(Linearization, bool), Box<Contact>> {
    let smooth = |matrix| vec![OneSidedDerivative { contact_mode: ContactMode::Frictionless, matrix }];
    let size = state_order(model).len();
    along(model, x, start, period, |Contact { n, x, state, .. }| match size {
        // The derivative with noise is not derived; NaN marks it as unknown.
        _ if model.noise.is_some() => Some(smooth(DMatrix::from_element(size, size, f64::NAN))),
        // The outline of a polygon ends runs and changes no bounce.
        2 => jacobians::<2>(model, *n, *x, state),
        3 => jacobians::<3>(model, *n, *x, state),
        5 => jacobians::<5>(model, *n, *x, state),
        _ => jacobians::<4>(model, *n, *x, state),
    })
}

/// The derivative by central differences with a step of `step` m/s (m for ρθ) in each component.
///
/// # Errors
/// Same as [`jacobian`], also for the runs that start one step aside.
pub fn finite_difference(model: &Body, start: &State, period: u64, step: f64) -> Result<Linearization, Box<Contact>> {
    finite_difference_at(model, 0.0, start, period, step)
}

/// [`finite_difference`] from a horizontal position x, m.
///
/// # Errors
/// Same as [`finite_difference`].
pub fn finite_difference_at(
    model: &Body,
    x: f64,
    start: &State,
    period: u64,
    step: f64,
) -> Result<Linearization, Box<Contact>> {
    let (mut linearization, is_hurried) = at_contacts(model, x, start, period)?;
    if is_hurried && model.noise.is_none() {
        let map = ReturnMap::new(model, period).planning();
        let at = map.planned(&map.vector(start, x));
        let end = |column: usize, step: f64| {
            let mut change = DVector::zeros(map.components().len());
            change[column] = step;
            map.image(&map.moved(&at, &change)).map(|image| map.reduced(&image))
        };
        let columns: Option<Vec<_>> =
            (0..map.components().len()).map(|n| Some((end(n, step)? - end(n, -step)?) / (2.0 * step))).collect();
        if let Some(columns) = columns {
            (linearization.matrix, linearization.order) = (DMatrix::from_columns(&columns), map.names());
            return Ok(linearization);
        }
    }
    let size = state_order(model).len();
    let mut matrix = DMatrix::zeros(size, size);
    for column in 0..size {
        let mut ends = [DMatrix::zeros(size, 1), DMatrix::zeros(size, 1)];
        for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
            let mut vector = to_vector(model, start, x);
            vector[column] += sign * step;
            let (start, x) = from_vector(model, &vector);
            let (Linearization { end: state, x, .. }, _) = along(model, x, &start, period, |_| None)?;
            *end = to_vector(model, &state, x);
        }
        matrix.set_column(column, &((&ends[0] - &ends[1]) / (2.0 * step)).column(0));
    }
    linearization.matrix = matrix;
    Ok(linearization)
}

/// Eigenvalues, largest modulus first.
///
/// A defective pair has an error of the order of √ε, so do not decide stability by these values. `None` if the iteration does not
/// converge.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let schur = Schur::try_new(matrix.clone(), f64::EPSILON, 10_000)?;
    // The imaginary part of a double eigenvalue may be the root of a negative rounding.
    let real = |value: &Complex<f64>| if value.im.is_nan() { Complex::new(value.re, 0.0) } else { *value };
    let mut values: Vec<_> = schur.complex_eigenvalues().iter().map(real).collect();
    sort_eigenvalues(&mut values);
    Some(values)
}

/// Modulus of a complex number, with the same bits on every platform.
pub fn modulus(value: Complex<f64>) -> f64 {
    libm::hypot(value.re, value.im)
}

pub(crate) fn sort_eigenvalues(values: &mut [Complex<f64>]) {
    values.sort_by(|a, b| modulus(*b).total_cmp(&modulus(*a)).then(b.re.total_cmp(&a.re)).then(b.im.total_cmp(&a.im)));
}

/// Follows the run and multiplies the `derivatives` at its contacts.
fn along(
    model: &Body,
    x: f64,
    start: &State,
    period: u64,
    derivatives: impl Fn(&Contact) -> Option<Vec<OneSidedDerivative>>,
) -> Result<(Linearization, bool), Box<Contact>> {
    let size = state_order(model).len();
    let mut orbit = Orbit::at(*model, Rules::BARE_MAP, *start).moved(x);
    let mut sides =
        vec![OneSidedDerivative { contact_mode: ContactMode::Frictionless, matrix: DMatrix::identity(size, size) }];
    let mut contact_mode = None;
    let mut is_hurried = false;
    let (mut flight_time, mut contact_speed) = (0.0, f64::NEG_INFINITY);
    for _ in 0..period {
        let contact = orbit.advance();
        let Some(flight) = contact.flight_time else { return Err(Box::new(contact)) };
        contact_mode = contact_mode.or(contact.strike.map(|strike| strike.mode));
        is_hurried |= flight < model.lag;
        if let Some(factors) = derivatives(&contact) {
            sides = multiply(&factors, &sides);
        }
        flight_time += flight;
        contact_speed = f64::max(contact_speed, model.contact_speed(orbit.state()));
    }
    let linearization = Linearization {
        matrix: sides[0].matrix.clone(),
        order: state_order(model).to_vec(),
        end: *orbit.state(),
        x: orbit.x(),
        flight_time,
        contact_speed,
        contact_mode: contact_mode.unwrap_or(ContactMode::Frictionless),
        one_sided: if sides.len() > 1 { sides } else { Vec::new() },
    };
    Ok((linearization, is_hurried))
}

/// Products of each derivative of a contact with each derivative before it; the product of the two main ones comes first.
fn multiply(factors: &[OneSidedDerivative], sides: &[OneSidedDerivative]) -> Vec<OneSidedDerivative> {
    let pairs = factors.iter().flat_map(|factor| sides.iter().map(move |side| (factor, side)));
    let product = |(factor, side): (&OneSidedDerivative, &OneSidedDerivative)| OneSidedDerivative {
        contact_mode: if factors.len() > 1 { factor.contact_mode } else { side.contact_mode },
        matrix: &factor.matrix * &side.matrix,
    };
    pairs.take(MOST_SIDES).map(product).collect()
}

/// The derivative on the branch that the impact takes, followed by those on the other sides if it lies on a kink.
///
/// An impact without sliding, v_t = 0, is smooth if friction holds the contact: the impulse depends on the sliding only through its
/// end, and in the same way from both sides.
fn jacobians<const K: usize>(body: &Body, n: u64, x: f64, state: &State) -> Option<Vec<OneSidedDerivative>> {
    let lifted: Body<Dual<K>> = body.map(Dual::from_f64);
    let (start, place) = along_all(body, x, state);
    let coming = PreImpact { n, x: place, state: start, clearance: Dual::from_f64(0.0), plan: None };
    let mut tied = Vec::new();
    let slide = body.friction.map(|friction| friction.slide);
    let mut held = slide == Some(Slide::Matched) && body.lag == 0.0;
    let strike = body.strike_deciding(&PreImpact::at(n, x, *state), |decision| {
        let is_tied = slide.is_some() && decision.margin.abs() <= TIED * decision.scale;
        held |= decision.branch == FrictionBranch::Holds && decision.answer && !is_tied;
        if is_tied {
            tied.push(decision.branch);
        }
        actual_branch(decision)
    });
    // Without restitution the impact ends with compression.
    let ends_early = [FrictionBranch::Rests, FrictionBranch::RestsEarly].iter().all(|branch| tied.contains(branch));
    tied.retain(|branch| match (branch, body.friction.map(|friction| friction.law)) {
        (FrictionBranch::Forward, _) => !held,
        // The work of compression has no kink where the sliding ends.
        (FrictionBranch::RestsEarly, Some(RestitutionLaw::Poisson)) => !ends_early,
        (FrictionBranch::RestsEarly, Some(RestitutionLaw::Newton | RestitutionLaw::Stronge) | None) => false,
        (FrictionBranch::Rests | FrictionBranch::Holds, _) => true,
    });
    let root = body.flight_time(&strike).ok()?;
    let mut sides: Vec<OneSidedDerivative> = Vec::new();
    for flipped in 0..1_u32 << tied.len() {
        let mut rests = false;
        let strike = lifted.strike_deciding(&coming, |decision| {
            let at = tied.iter().position(|branch| *branch == decision.branch);
            let mut answer = decision.answer ^ at.is_some_and(|at| flipped >> at & 1 == 1);
            answer |= decision.branch == FrictionBranch::RestsEarly && ends_early;
            rests |= decision.branch == FrictionBranch::Rests && answer;
            answer
        });
        let contact_mode = match strike.mode {
            ContactMode::SlideThrough if !tied.contains(&FrictionBranch::Forward) => ContactMode::SlideThrough,
            ContactMode::SlideThrough if rests => ContactMode::ReverseSlide,
            ContactMode::SlideThrough => ContactMode::Slide,
            mode => mode,
        };
        let side = OneSidedDerivative { contact_mode, matrix: after_flight(&lifted, place, &strike, root) };
        if !sides.contains(&side) {
            sides.push(side);
        }
    }
    Some(sides)
}

/// A state and its place (m) in dual numbers, with one partial derivative for each component.
fn along_all<const K: usize>(body: &Body, x: f64, state: &State) -> (State<Dual<K>>, Dual<K>) {
    let place = state_order(body).iter().position(|name| *name == "x");
    let x = place.map_or(Dual::from_f64(x), |index| Dual::along(x, index, 1.0));
    if body.is_point {
        return (Body::point_state(Dual::along(state.x_dot, 0, 1.0), Dual::along(state.y_dot, 1, 1.0)), x);
    }
    let per_length = 1.0 / body.rod.radius_of_gyration;
    let state = State {
        theta: Dual::along(state.theta, 0, per_length),
        x_dot: Dual::along(state.x_dot, 1, 1.0),
        y_dot: Dual::along(state.y_dot, 2, 1.0),
        theta_dot: Dual::along(state.theta_dot, 3, per_length),
    };
    (state, x)
}

/// The derivative of the state at the end of a flight of duration `root`, s.
fn after_flight<const K: usize>(
    body: &Body<Dual<K>>,
    place: Dual<K>,
    strike: &Strike<Dual<K>>,
    root: f64,
) -> DMatrix<f64> {
    let flight = Flight { drag: body.drag, ..body.rod.flight(strike) };
    let t = flight.lift_root(root);
    let (end, travel) = (flight.end(t), flight.travel(t).0);
    let (rho, x) = (body.rod.radius_of_gyration, place + travel);
    if body.is_point {
        // Without air it comes down as fast as it rose.
        let y_dot = if body.drag.is_none() { -strike.after.y_dot } else { end.y_dot };
        return rows(&[end.x_dot, y_dot, x]);
    }
    rows(&[rho * end.theta, end.x_dot, end.y_dot, rho * end.theta_dot, x])
}

/// The matrix of the partial derivatives of the first K components.
fn rows<const K: usize>(components: &[Dual<K>]) -> DMatrix<f64> {
    DMatrix::from_fn(K, K, |row, column| components[row].partials[column])
}

fn to_vector(model: &Body, state: &State, x: f64) -> DMatrix<f64> {
    let size = state_order(model).len();
    if model.is_point {
        return DMatrix::from_column_slice(size, 1, &[state.x_dot, state.y_dot, x][..size]);
    }
    let rho = model.rod.radius_of_gyration;
    let components = [rho * state.theta, state.x_dot, state.y_dot, rho * state.theta_dot, x];
    DMatrix::from_column_slice(size, 1, &components[..size])
}

fn from_vector(model: &Body, vector: &DMatrix<f64>) -> (State, f64) {
    if model.is_point {
        return (Body::point_state(vector[0], vector[1]), vector.get(2).copied().unwrap_or(0.0));
    }
    let rho = model.rod.radius_of_gyration;
    let state = State { theta: vector[0] / rho, x_dot: vector[1], y_dot: vector[2], theta_dot: vector[3] / rho };
    (state, vector.get(4).copied().unwrap_or(0.0))
}
