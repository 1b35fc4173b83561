//! The return map of a body: from the state just before a contact to the state just before a later one, in any kind of number.
//!
//! Every analysis here is a function of this map and knows no part of the body.

use crate::map::body::{Body, PreImpact};
use crate::map::flight::Flight;
use crate::map::strike::{PlannedTableMotion, State};
use crate::numbers::dual::Dual;
use crate::numbers::number::Number;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use nalgebra::{DMatrix, DVector};

/// Components of a state: ρθ (m), ẋ, ẏ and ρθ̇ (m/s), x (m); tilt (rad) and velocities (m/s) of a table that has planned its motion before
/// the last strike.
pub const COMPONENTS: usize = 8;

/// Indices of the components.
pub const ARC: usize = 0;
/// Index of ẋ.
pub const X_DOT: usize = 1;
/// Index of ẏ.
pub const Y_DOT: usize = 2;
/// Index of ρθ̇.
pub const SPIN: usize = 3;
/// Index of x.
pub const X: usize = 4;
/// Index of the tilt of a planned motion.
const TILT: usize = 5;
/// Index of the velocity of a planned motion along its normal.
pub const PLANNED_SPEED: usize = 6;

/// Names of the components in answers.
pub const NAMES: [&str; COMPONENTS] = [
    "rho_theta",
    "x_dot",
    "y_dot",
    "rho_theta_dot",
    "x",
    "planned_tilt",
    "planned_normal_velocity",
    "planned_tangential_velocity",
];

/// Share of the bounce speed up to which the residual of a fixed point is rounding.
pub const SOLVED: f64 = 1e-12;

/// A state just before a contact.
pub type Vector<N = f64> = [N; COMPONENTS];

/// θ, ẋ, ẏ, θ̇, x and the planned motion of a contact, 0 where none is planned.
pub(crate) fn parts<N: Number>(contact: &PreImpact<N>) -> Vector<N> {
    let State { theta, x_dot, y_dot, theta_dot } = contact.state;
    let none = [N::from_f64(0.0); 3];
    let [alpha, normal, tangential] =
        contact.plan.map_or(none, |plan| [plan.alpha, plan.normal_velocity, plan.tangential_velocity]);
    [theta, x_dot, y_dot, theta_dot, contact.x, alpha, normal, tangential]
}

/// The contact of these parts, with a planned motion if there is one. The angle of a point mass is that of its velocity.
pub(crate) fn contact_of<N: Number>(n: u64, parts: Vector<N>, is_point: bool, plans: bool) -> PreImpact<N> {
    let [theta, x_dot, y_dot, theta_dot, x, alpha, normal_velocity, tangential_velocity] = parts;
    let plan = plans.then_some(PlannedTableMotion { alpha, normal_velocity, tangential_velocity });
    let state = if is_point { Body::point_state(x_dot, y_dot) } else { State { theta, x_dot, y_dot, theta_dot } };
    PreImpact { plan, ..PreImpact::at(n, x, state) }
}

/// The return map of a body over some bounces.
#[derive(Clone, Copy, Debug)]
pub struct ReturnMap {
    /// The body, without its noise and its outline.
    pub body: Body,
    /// Number of bounces.
    pub period: u64,
    /// True if x is one of the components: strikes depend on it.
    pub has_place: bool,
    /// True if the motion of the table is one of the components: it is planned before the last strike.
    pub(crate) plans: bool,
    /// Indices that are none of the components: they start each time as they are.
    held: &'static [usize],
}

/// A map with its derivative at a state.
#[derive(Clone, Debug)]
pub struct DifferentiatedMap {
    /// The state at the end.
    pub image: Vector,
    /// Its derivative by the components of the map, in their order.
    pub matrix: DMatrix<f64>,
}

impl ReturnMap {
    /// The map of a body without random errors over `period` bounces. x is a component only where strikes depend on it.
    pub fn new(body: &Body, period: u64) -> Self {
        let has_place = body.feedback().is_some_and(|[x, ..]| x != 0.0) || body.turning.is_some_and(|it| it.strikes());
        Self { body: Body { noise: None, outline: None, ..*body }, period, has_place, plans: false, held: &[] }
    }

    /// The map of a body without random errors over one bounce, or over the heights of its program.
    pub fn of_cycle(body: &Body) -> Self {
        Self::new(body, body.program.map_or(1, |program| program.heights().len() as u64))
    }

    /// The same map whose table plans each motion before the last strike, since its delay is longer than a flight.
    #[must_use]
    pub fn planning(self) -> Self {
        Self { plans: true, ..self }
    }

    /// The same map of a body of which some parts start each time as they are.
    #[must_use]
    pub fn holding(self, held: &'static [usize]) -> Self {
        Self { held, ..self }
    }

    /// A state with the motion that the table would plan for it, where the map has that.
    #[must_use]
    pub fn planned(&self, state: &Vector) -> Vector {
        let mut planned = *state;
        if self.plans {
            let plan = self.body.planned_motion(1, state[X], &self.state(state), 0.0, f64::INFINITY);
            planned[TILT..].copy_from_slice(&[plan.alpha, plan.normal_velocity, plan.tangential_velocity]);
        }
        planned
    }

    /// Indices of its components.
    pub fn components(&self) -> Vec<usize> {
        let of_body = if self.body.is_point { X_DOT..SPIN } else { ARC..X };
        let place = self.has_place.then_some(X);
        let plan = if self.plans { TILT..COMPONENTS } else { 0..0 };
        of_body.chain(place).chain(plan).filter(|index| !self.held.contains(index)).collect()
    }

    /// Place of a component of [`Vector`] among those of the map; `None` if it is none of them.
    pub fn place_of(&self, component: usize) -> Option<usize> {
        self.components().into_iter().position(|index| index == component)
    }

    /// A state as a vector.
    pub fn vector<N: Number>(&self, state: &State<N>, x: N) -> Vector<N> {
        self.vector_of(&PreImpact::at(1, x, *state))
    }

    /// A contact as a vector, with its planned motion where the map has that.
    pub(crate) fn vector_of<N: Number>(&self, contact: &PreImpact<N>) -> Vector<N> {
        let plan = contact.plan.filter(|_| self.plans);
        let (rho, mut vector) = (N::from_f64(self.body.rod.radius_of_gyration), parts(&PreImpact { plan, ..*contact }));
        (vector[ARC], vector[SPIN]) = (rho * vector[ARC], rho * vector[SPIN]);
        vector
    }

    /// The state of a vector.
    pub fn state<N: Number>(&self, vector: &Vector<N>) -> State<N> {
        self.contact(vector).state
    }

    fn contact<N: Number>(&self, vector: &Vector<N>) -> PreImpact<N> {
        let (rho, mut parts) = (N::from_f64(self.body.rod.radius_of_gyration), *vector);
        (parts[ARC], parts[SPIN]) = (parts[ARC] / rho, parts[SPIN] / rho);
        contact_of(1, parts, self.body.is_point, self.plans)
    }

    /// The state after its bounces; `None` if there is no strike or no next contact from above.
    pub fn image<N: Number>(&self, start: &Vector<N>) -> Option<Vector<N>> {
        self.image_by(&self.body.map(N::from_f64), start)
    }

    /// The image by a body whose numbers may vary.
    pub(crate) fn image_by<N: Number>(&self, body: &Body<N>, start: &Vector<N>) -> Option<Vector<N>> {
        let (coming, _) = self.passed(body, self.contact(start))?;
        let end = self.vector_of(&coming);
        end.iter().all(|number| number.to_f64().is_finite()).then_some(end)
    }

    /// The contact after its bounces from contact 1 of a body whose numbers may vary, and the time until then, s; `None` as in
    /// [`ReturnMap::image`].
    pub(crate) fn passed<N: Number>(&self, body: &Body<N>, mut coming: PreImpact<N>) -> Option<(PreImpact<N>, N)> {
        let mut t = N::from_f64(0.0);
        for n in 1..=self.period {
            let strike = body.strike(&coming);
            if !(strike.push.to_f64() < 0.0 && strike.contact_rise.to_f64() > 0.0) {
                return None;
            }
            let arrival = body.fly(&coming, &strike).ok()?;
            let x = coming.x + arrival.way;
            let (state, plan) = (arrival.state, arrival.plan);
            let own = || body.planned_motion(n + 1, x, &state, 0.0, N::from_f64(f64::INFINITY));
            let plan = plan.or_else(|| self.plans.then(own));
            coming = PreImpact { plan, ..PreImpact::at(n + 1, x, state) };
            t = t + arrival.t;
        }
        Some((coming, t))
    }

    /// The shortest flight of its bounces from a state, s; infinite where there is none.
    pub fn shortest_flight(&self, at: &Vector) -> f64 {
        let mut orbit = Orbit::at(self.body, Rules::BARE_MAP, self.state(at)).moved(at[X]);
        (0..self.period).map_while(|_| orbit.advance().flight_time).fold(f64::INFINITY, f64::min)
    }

    /// Tells whether mirrored states have mirrored images, so that what holds on one side holds on the other, for bounces of about this speed
    /// (m/s) from the middle of the table. It is tried at some states.
    pub fn is_mirrored(&self, speed: f64) -> bool {
        let rho = self.body.rod.radius_of_gyration;
        [(0.03, 0.0, 0.0, 0.0), (0.1, 0.2, -0.05, 0.02)].into_iter().all(|(theta, x_dot, spin, x)| {
            let mut start = [0.0; COMPONENTS];
            [start[ARC], start[X_DOT], start[Y_DOT], start[SPIN], start[X]] =
                [rho * theta, x_dot * speed, -speed, spin * speed, x];
            let mirrored = |vector: &Vector| {
                let mut mirrored = vector.map(|part| -part);
                mirrored[Y_DOT] = vector[Y_DOT];
                mirrored
            };
            match (self.image(&start), self.image(&mirrored(&start))) {
                (Some(one), Some(other)) => {
                    let parts = mirrored(&one).into_iter().zip(other);
                    parts.map(|(one, other)| (one - other).abs()).fold(0.0, f64::max) <= 1e-12 * speed
                }
                (one, other) => one.is_none() && other.is_none(),
            }
        })
    }

    /// Names of its components in answers.
    pub fn names(&self) -> Vec<&'static str> {
        self.components().into_iter().map(|index| NAMES[index]).collect()
    }

    /// The map and its derivative at a state; `None` as in [`ReturnMap::image`].
    pub fn derivative(&self, at: &Vector) -> Option<DifferentiatedMap> {
        let start: Vector<Dual<COMPONENTS>> = std::array::from_fn(|index| Dual::along(at[index], index, 1.0));
        let end = self.image(&start)?;
        let matrix = self.rates(&end);
        let is_finite = matrix.iter().all(|entry| entry.is_finite());
        is_finite.then(|| DifferentiatedMap { image: end.map(|number| number.value), matrix })
    }

    /// Derivatives of an image by the components of the map, in their order, for a start that moves along each of them.
    pub(crate) fn rates(&self, end: &Vector<Dual<COMPONENTS>>) -> DMatrix<f64> {
        let components = self.components();
        let size = components.len();
        DMatrix::from_fn(size, size, |row, column| end[components[row]].partials[components[column]])
    }

    /// The derivative by central differences with a step in m/s (m for ρθ and x): a check of [`ReturnMap::derivative`]. `None` if a run that starts
    /// so far aside ends before.
    pub fn differences(&self, at: &Vector, step: f64) -> Option<DMatrix<f64>> {
        let end = |index: usize, step: f64| {
            let mut start = *at;
            start[index] += step;
            self.image(&start).map(|end| self.reduced(&end))
        };
        let columns: Option<Vec<_>> =
            self.components().into_iter().map(|n| Some((end(n, step)? - end(n, -step)?) / (2.0 * step))).collect();
        columns.map(|columns| DMatrix::from_columns(&columns))
    }

    /// The image of a state some of whose components vary, as `varied` says for the value of each component of the map, by a body whose numbers may
    /// vary too; `None` as in [`ReturnMap::image`].
    pub(crate) fn expanded<N: Number>(
        &self,
        body: &Body<N>,
        at: &Vector,
        varied: impl Fn(usize, f64) -> N,
    ) -> Option<Vec<N>> {
        let mut start = at.map(N::from_f64);
        for (place, index) in self.components().into_iter().enumerate() {
            start[index] = varied(place, at[index]);
        }
        let image = self.image_by(body, &start)?;
        Some(self.components().into_iter().map(|index| image[index]).collect())
    }

    /// Length of the flights of its period from a state, s; NaN where there are none.
    pub fn flight_time(&self, at: &Vector) -> f64 {
        self.passed(&self.body, self.contact(at)).map_or(f64::NAN, |(_, t)| t)
    }

    /// Height of the centre of gravity at the top of the flight after a state, m.
    pub fn apex_height(&self, at: &Vector) -> f64 {
        let coming = self.contact(at);
        let strike = self.body.strike(&coming);
        let flight = Flight { drag: self.body.drag, ..self.body.rod.flight(&strike) };
        self.body.contact_height(&coming.state) + flight.travel(flight.time_to_top()).1
    }

    /// The components of a vector that are those of the map.
    pub fn reduced(&self, vector: &Vector) -> DVector<f64> {
        DVector::from_iterator(self.components().len(), self.components().into_iter().map(|index| vector[index]))
    }

    /// Tells whether two states are the same but for rounding.
    pub(crate) fn is_near(&self, one: &Vector, other: &Vector) -> bool {
        (self.reduced(one) - self.reduced(other)).amax() <= 10.0 * SOLVED * one[Y_DOT].abs()
    }

    /// A vector moved by a change of the components of the map.
    pub fn moved(&self, vector: &Vector, change: &DVector<f64>) -> Vector {
        let mut moved = *vector;
        for (index, change) in self.components().into_iter().zip(change.iter()) {
            moved[index] += change;
        }
        moved
    }
}
