//! The map from one impact to the next, with place and time, and its derivatives by the state and by fields.
//!
//! Derivatives are those of dual numbers through the one map: a field enters through its row and through the body and the release of the
//! scene, whatever formulas it appears in. Tests hold them against runs with 31 digits.

use crate::analysis::return_map::ReturnMap;
use crate::map::body::{Arrival, Body};
use crate::map::strike::State;
use crate::numbers::dual::Dual;
use crate::numbers::number::{Arithmetic, Number};
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::{Draft, FieldError, Name};

/// Components of a state with place and time, in the order of [`super::measured::COLUMNS`].
pub(super) const STATES: usize = 6;

/// θ, ẋ, ẏ, θ̇, x and t just before an impact.
pub(super) type Vector<N = f64> = [N; STATES];

pub(super) const X: usize = 4;
pub(super) const T: usize = 5;

/// Most unknown fields of a fit.
pub const MOST_UNKNOWNS: usize = 8;

/// A number with its derivatives by the components of a state, and by the unknown fields.
pub(super) type Differentiated = Dual<{ STATES + MOST_UNKNOWNS }>;

/// The map of a scene, in any kind of number.
#[derive(Clone, Debug)]
pub(super) struct ImpactMap<N: Number = f64> {
    orbit: Orbit<N>,
    /// Just before the first impact of the scene's own run, if it has one.
    pub(super) release: Option<Vector<N>>,
}

impl ImpactMap {
    /// The map of the scene that a draft becomes, without its noise.
    pub(super) fn new(draft: &Draft) -> Result<Self, Vec<FieldError>> {
        Self::by(draft, |_, value| value)
    }

    /// Tells whether the body has an angle of its own.
    pub(super) fn has_angle(&self) -> bool {
        !self.body().is_point
    }

    /// Tells whether a strike depends on the place of the body.
    pub(super) fn follows_place(&self) -> bool {
        ReturnMap::new(self.body(), 1).has_place
    }
}

impl ImpactMap<Differentiated> {
    /// The map at a draft, with its derivatives by these fields, at most [`MOST_UNKNOWNS`].
    pub(super) fn differentiated(draft: &Draft, names: &[Name]) -> Result<Self, Vec<FieldError>> {
        Self::by(draft, |name, value| match names.iter().position(|&other| other == name) {
            Some(place) => Dual::along(value, STATES + place, 1.0),
            None => Dual::from_f64(value),
        })
    }
}

impl<N: Number> ImpactMap<N> {
    fn by(draft: &Draft, field: impl Fn(Name, f64) -> N) -> Result<Self, Vec<FieldError>> {
        let scene = draft.build()?;
        let body = scene.body_by(&field);
        let turning = body.turning.filter(|_| scene.acting_turn().is_some());
        let body = Body { turning, outline: None, ..body };
        let release = scene.release_by(&field);
        let first = body.fall_to(&release, None).ok();
        let first = first.map(|Arrival { t, state, way, .. }| to_vector(&state, release.x + way, t));
        Ok(Self { orbit: Orbit::at(body, Rules::BARE_MAP, release.state), release: first })
    }

    pub(super) fn body(&self) -> &Body<N> {
        &self.orbit.body
    }

    /// From impact `n` to the next; `None` where the run would end.
    pub(super) fn next(&mut self, n: u64, at: &Vector<N>) -> Option<Vector<N>> {
        let [theta, x_dot, y_dot, theta_dot, x, t] = *at;
        let is_point = self.orbit.body.is_point;
        let state = if is_point { Body::point_state(x_dot, y_dot) } else { State { theta, x_dot, y_dot, theta_dot } };
        let zero = N::from_f64(0.0);
        let arrival = Arrival { t: zero, state, clearance: zero, plan: None, way: zero };
        self.orbit.resume(n.saturating_sub(1), t, x, &arrival);
        self.orbit.advance().flight_time?;
        Some(to_vector(self.orbit.state(), self.orbit.x(), self.orbit.t()))
    }

    /// From impact `from` to impact `to`; `None` where the run would end.
    pub(super) fn follow(&mut self, from: u64, to: u64, at: &Vector<N>) -> Option<Vector<N>> {
        (from..to).try_fold(*at, |at, n| self.next(n, &at))
    }
}

fn to_vector<N: Number>(state: &State<N>, x: N, t: N) -> Vector<N> {
    [state.theta, state.x_dot, state.y_dot, state.theta_dot, x, t]
}

/// A state with its derivatives by its own components.
pub(super) fn differentiated(at: &Vector) -> Vector<Differentiated> {
    std::array::from_fn(|component| Dual::along(at[component], component, 1.0))
}
