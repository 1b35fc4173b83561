//! The derivative of the map from contact to contact, at any state, with the contact time implicit.
//!
//! A state is (ρθ, ẋ, ẏ, ρθ̇) just before a contact, followed by x if the table has state feedback, or turns about a fixed place and acts
//! on the body by that. The state of a point mass is (ẋ, ẏ). A table with a delay that is longer than a flight plans its motion before the last
//! strike: that motion belongs to the state too.

use crate::analysis::return_map::{ARC, COMPONENTS, ReturnMap, SPIN, Y_DOT, contact_of, parts};
use crate::map::body::{Body, PreImpact};
use crate::map::friction::{Decision, FrictionBranch, RestitutionLaw, Slide, actual_branch};
use crate::map::strike::{ContactMode, State, Strike};
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::run::orbit::{Contact, Orbit};
use crate::run::rules::Rules;
use nalgebra::{Complex, DMatrix, Schur};

type Derived = Dual<COMPONENTS>;

/// The map linearized about one orbit segment.
#[derive(Clone, Debug)]
pub struct Linearization {
    /// Derivative of the state at the end with respect to the state at the start: 4 × 4, 5 × 5 where it depends on x, for a
    /// point mass 2 × 2, with three more of a planned motion. Components are in m/s, except ρθ and x in m and a planned tilt in rad.
    pub matrix: DMatrix<f64>,
    /// Determinant of the matrix: the product of those of its bounces, since that of a product of many is rounding.
    pub determinant: f64,
    /// The state at the end.
    pub end: State,
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

/// Relative distance from a switch of friction up to which both branches are followed: a few thousand ulps.
pub const TIED: f64 = 1e-12;

/// Maximum number of sides that are reported. Each contact on a kink doubles the number.
pub const MOST_SIDES: usize = 16;

/// The map of a body over one bounce, with x among its components under any state feedback.
fn map_of(model: &Body) -> ReturnMap {
    let mut map = ReturnMap::new(model, 1);
    map.has_place = model.depends_on_place();
    map
}

/// Names of the components of a state, in the order of a matrix's rows and columns.
pub fn state_order(model: &Body) -> Vec<&'static str> {
    map_of(model).names()
}

/// Derivative of the map over `period` contacts, exact but for rounding. Fails with the contact that ends it early.
pub fn jacobian(model: &Body, start: &State, period: u64) -> Result<Linearization, Box<Contact>> {
    jacobian_at(model, 0.0, start, period)
}

/// [`jacobian`] from a horizontal position x, m, for the map without random errors. The derivative depends on x only if the table feeds it back
/// or turns.
pub fn jacobian_at(model: &Body, x: f64, start: &State, period: u64) -> Result<Linearization, Box<Contact>> {
    // The outline of a polygon ends runs and changes no bounce.
    let model = &Body { noise: None, outline: None, ..*model };
    let lifted: Body<Derived> = model.map(Dual::from_f64);
    let mut orbit = Orbit::at(*model, Rules::BARE_MAP, *start).moved(x);
    let mut order = state_order(model);
    let mut sides = vec![OneSidedDerivative {
        contact_mode: ContactMode::Frictionless,
        matrix: DMatrix::identity(order.len(), order.len()),
    }];
    let (mut contact_mode, mut is_hurried, mut determinant) = (None, false, 1.0);
    let (mut flight_time, mut contact_speed) = (0.0, f64::NEG_INFINITY);
    for _ in 0..period {
        let contact = orbit.advance();
        let (Some(flight), Some(strike)) = (contact.flight_time, contact.strike) else {
            return Err(Box::new(contact));
        };
        contact_mode = contact_mode.or(Some(strike.mode));
        let factors = derivatives(model, &lifted, &contact, flight);
        determinant *= factors[0].matrix.determinant();
        sides = multiply(&factors, &sides);
        is_hurried |= flight < model.lag;
        flight_time += flight;
        contact_speed = f64::max(contact_speed, model.contact_speed(orbit.state()));
    }
    let mut matrix = sides[0].matrix.clone();
    if is_hurried {
        let map = ReturnMap::new(model, period).planning();
        (order, sides) = (map.names(), Vec::new());
        let none = || DMatrix::from_element(order.len(), order.len(), f64::NAN);
        matrix = map.derivative(&map.planned(&map.vector(start, x))).map_or_else(none, |found| found.matrix);
        determinant = matrix.determinant();
    }
    let one_sided = if sides.len() > 1 { sides } else { Vec::new() };
    let contact_mode = contact_mode.unwrap_or(ContactMode::Frictionless);
    Ok(Linearization {
        matrix,
        determinant,
        end: *orbit.state(),
        flight_time,
        contact_speed,
        contact_mode,
        order,
        one_sided,
    })
}

/// Eigenvalues, largest modulus first.
///
/// A defective pair is off by some √ε: do not decide stability by it. `None` if the iteration does not converge.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if matrix.is_empty() {
        return Some(Vec::new());
    }
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
/// An impact without sliding, v_t = 0, is smooth if friction holds the contact: the impulse depends on the sliding only through its
/// end, and in the same way from both sides.
fn derivatives(body: &Body, lifted: &Body<Derived>, contact: &Contact, flight_time: f64) -> Vec<OneSidedDerivative> {
    let Contact { n, x, ref state, .. } = *contact;
    let map = map_of(body);
    // Not by way of ρθ, whose rounding may lead beyond a switch of friction.
    let values = parts(&PreImpact::at(n, x, *state));
    let per_length = 1.0 / body.rod.radius_of_gyration;
    let rate = |index: usize| if [ARC, SPIN].contains(&index) { per_length } else { 1.0 };
    let along_all = std::array::from_fn(|index| Dual::along(values[index], index, rate(index)));
    let coming = contact_of(n, along_all, body.is_point, false);
    let mut tied = Vec::new();
    let slide = body.friction.map(|friction| friction.slide);
    let mut held = slide == Some(Slide::Matched) && body.lag == 0.0;
    // Nothing else has branches.
    if slide.is_some() {
        body.strike_deciding(&PreImpact::at(n, x, *state), |decision| {
            let is_tied = decision.margin.abs() <= TIED * decision.scale;
            held |= decision.branch == FrictionBranch::Holds && decision.answer && !is_tied;
            if is_tied {
                tied.push(decision.branch);
            }
            actual_branch(decision)
        });
    }
    // Without restitution the impact ends with compression.
    let ends_early = [FrictionBranch::Rests, FrictionBranch::RestsEarly].iter().all(|branch| tied.contains(branch));
    tied.retain(|branch| match (branch, body.friction.map(|friction| friction.law)) {
        (FrictionBranch::Forward, _) => !held,
        // The work of compression has no kink where the sliding ends.
        (FrictionBranch::RestsEarly, Some(RestitutionLaw::Poisson)) => !ends_early,
        (FrictionBranch::RestsEarly, Some(RestitutionLaw::Newton | RestitutionLaw::Stronge) | None) => false,
        (FrictionBranch::Rests | FrictionBranch::Holds, _) => true,
    });
    let mut sides: Vec<OneSidedDerivative> = Vec::new();
    for flipped in 0..1_u32 << tied.len() {
        let mut rests = false;
        let strike = strike_deciding(lifted, &coming, &mut |decision| {
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
        let end = lifted.land(&coming, &strike, flight_time);
        let mut end = end.map_or([Dual::from_f64(f64::NAN); COMPONENTS], |end| map.vector_of(&end));
        // Without air a point mass comes down as fast as it rose.
        if body.is_point && body.drag.is_none() {
            end[Y_DOT] = -strike.after.y_dot;
        }
        let side = OneSidedDerivative { contact_mode, matrix: map.rates(&end) };
        if !sides.contains(&side) {
            sides.push(side);
        }
    }
    sides
}

/// [`Body::strike_deciding`] as a function of its own: with the answers compiled into it, it would take the compiler many times as long.
#[inline(never)]
fn strike_deciding(
    body: &Body<Derived>,
    coming: &PreImpact<Derived>,
    decide: &mut dyn FnMut(Decision<Derived>) -> bool,
) -> Strike<Derived> {
    body.strike_deciding(coming, decide)
}
