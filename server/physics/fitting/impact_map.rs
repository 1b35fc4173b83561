//! The map from one impact to the next, with place and time, and its derivatives by the state and by fields.
//!
//! Derivatives are those of dual numbers through the one map: a field enters through its row and through the body and the release of the
//! scene, whatever formulas it appears in. Tests hold them against runs with 31 digits.

use crate::map::body::{Arrival, Body, PreImpact, Release};
use crate::map::strike::State;
use crate::numbers::dual::Dual;
use crate::numbers::number::Arithmetic;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::{Draft, FieldError, Name};

/// Components of a state with place and time, in the order of [`super::measured::COLUMNS`].
pub(super) const STATES: usize = 6;

/// θ, ẋ, ẏ, θ̇, x and t just before an impact.
pub(super) type Vector = [f64; STATES];

/// Index of x.
pub(super) const X: usize = 4;
/// Index of t.
pub(super) const T: usize = 5;

/// Most unknown fields of a fit.
pub const MOST_UNKNOWNS: usize = 8;

/// The components of a state, and the unknown fields.
const DIRECTIONS: usize = STATES + MOST_UNKNOWNS;

/// A state with its derivatives by the components of another one, and by the fields.
pub(super) type DifferentiatedState = [Dual<DIRECTIONS>; STATES];

/// The map of a scene.
#[derive(Clone, Debug)]
pub(super) struct ImpactMap {
    orbit: Orbit,
    /// Just before the first impact of the scene's own run, if it has one.
    pub(super) release: Option<Vector>,
}

impl ImpactMap {
    /// The map of the scene that a draft becomes, without its noise.
    pub(super) fn new(draft: &Draft) -> Result<Self, Vec<FieldError>> {
        let scene = draft.build()?;
        let model = scene.model();
        let orbit = Orbit::new(model, Rules::BARE_MAP, scene.release()).ok();
        let release = orbit.map(|orbit| to_vector(orbit.state(), orbit.x(), orbit.t()));
        let rest = State { theta: 0.0, x_dot: 0.0, y_dot: -1.0, theta_dot: 0.0 };
        Ok(Self { orbit: Orbit::at(model, Rules::BARE_MAP, rest), release })
    }

    /// The model.
    pub(super) fn model(&self) -> &Body {
        &self.orbit.body
    }

    /// Tells whether the body has an angle of its own.
    pub(super) fn has_angle(&self) -> bool {
        !self.model().is_point
    }

    /// Tells whether a strike depends on the place of the body.
    pub(super) fn follows_place(&self) -> bool {
        let turns_about_a_place = self.model().turning.is_some_and(|turning| turning.strikes());
        turns_about_a_place || self.model().feedback().is_some_and(|gains| gains[0] != 0.0)
    }

    /// From impact `n` to the next; `None` where the run would end.
    pub(super) fn next(&mut self, n: u64, at: &Vector) -> Option<Vector> {
        let state = if self.orbit.body.is_point {
            Body::point_state(at[1], at[2])
        } else {
            State { theta: at[0], x_dot: at[1], y_dot: at[2], theta_dot: at[3] }
        };
        self.orbit.resume(n.saturating_sub(1), at[T], at[X], &Arrival::from((0.0, state)));
        self.orbit.advance().flight_time?;
        Some(to_vector(self.orbit.state(), self.orbit.x(), self.orbit.t()))
    }

    /// From impact `from` to impact `to`; `None` where the run would end.
    pub(super) fn follow(&mut self, from: u64, to: u64, at: &Vector) -> Option<Vector> {
        (from..to).try_fold(*at, |at, n| self.next(n, &at))
    }
}

fn to_vector(state: &State, x: f64, t: f64) -> Vector {
    [state.theta, state.x_dot, state.y_dot, state.theta_dot, x, t]
}

/// A map with its derivatives.
#[derive(Clone, Debug)]
pub(super) struct DifferentiatedMap {
    pub(super) map: ImpactMap,
    body: Body<Dual<DIRECTIONS>>,
    release: Release<Dual<DIRECTIONS>>,
}

/// A state with its derivatives by its own components.
pub(super) fn differentiated(at: &Vector) -> DifferentiatedState {
    std::array::from_fn(|component| Dual::along(at[component], component, 1.0))
}

/// Derivatives with the values of a run in doubles.
fn with_values(mut state: DifferentiatedState, values: &Vector) -> DifferentiatedState {
    for (number, value) in state.iter_mut().zip(values) {
        number.value = *value;
    }
    state
}

impl DifferentiatedMap {
    /// The map at a draft, with its derivatives by these fields, at most [`MOST_UNKNOWNS`].
    pub(super) fn new(draft: &Draft, names: &[Name]) -> Result<Self, Vec<FieldError>> {
        let scene = draft.build()?;
        let along = |name: Name, value: f64| match names.iter().position(|&other| other == name) {
            Some(place) => Dual::along(value, STATES + place, 1.0),
            None => Dual::from_f64(value),
        };
        Ok(Self { map: ImpactMap::new(draft)?, body: scene.body_by(along), release: scene.release_by(along) })
    }

    /// Just before the first impact of the scene's own run.
    pub(super) fn release(&self) -> Option<DifferentiatedState> {
        let Arrival { t, state, way, .. } = self.body.fall(&self.release).ok()?;
        let State { theta, x_dot, y_dot, theta_dot } = state;
        Some(with_values([theta, x_dot, y_dot, theta_dot, self.release.x + way, t], &self.map.release?))
    }

    /// The next impact after impact `n`; `None` where the run would end.
    pub(super) fn next(&mut self, n: u64, at: &DifferentiatedState) -> Option<DifferentiatedState> {
        let values = self.map.next(n, &at.map(|number| number.value))?;
        let [theta, x_dot, y_dot, theta_dot, x, t] = *at;
        let state =
            if self.body.is_point { Body::point_state(x_dot, y_dot) } else { State { theta, x_dot, y_dot, theta_dot } };
        let coming = PreImpact { n, x, state, clearance: Dual::from_f64(0.0), plan: None };
        let arrival = self.body.fly(&coming, &self.body.strike(&coming)).ok()?;
        let State { theta, x_dot, y_dot, theta_dot } = arrival.state;
        Some(with_values([theta, x_dot, y_dot, theta_dot, x + arrival.way, t + arrival.t], &values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Value;

    #[test]
    fn derivatives_by_fields_are_those_of_runs_with_31_digits() {
        let names = [Name::RadiusOfGyration, Name::Gravity, Name::Restitution, Name::TiltGain, Name::Height];
        let mut draft = Draft::default();
        for (name, number) in [
            (Name::ContactDistance, 0.13),
            (Name::RadiusOfGyration, 0.09),
            (Name::TiltGain, 1.2),
            (Name::Height, 0.25),
            (Name::Theta, 0.2),
            (Name::ThetaDot, 0.3),
            (Name::XDot, 0.1),
            (Name::Restitution, 0.7),
            (Name::EnergyGain, 0.2),
            (Name::TargetHeight, 0.2),
            (Name::AssumedRestitution, 0.75),
        ] {
            draft.set(name, Some(Value::Number(number))).unwrap();
        }
        let scene = draft.build().unwrap();
        let mut map = DifferentiatedMap::new(&draft, &names).unwrap();
        let first = map.release().unwrap();
        let derivative = map.next(1, &first).unwrap();
        for (field, &name) in names.iter().enumerate() {
            // The second impact of the run, with 31 digits: a difference over 1e-7 of the field has 14 of them right.
            let second = |value: f64| {
                let mut draft = scene.draft();
                draft.set(name, Some(Value::Number(value))).unwrap();
                let mut orbit = draft.build().unwrap().extended_orbit().unwrap();
                orbit.advance();
                let state = *orbit.state();
                [state.theta, state.x_dot, state.y_dot, state.theta_dot, orbit.x(), orbit.t()]
            };
            let value = scene.number(name).unwrap();
            let (high, low) = (value + 1e-7 * value, value - 1e-7 * value);
            let (above, below) = (second(high), second(low));
            for row in 0..STATES {
                let expected = (above[row] - below[row]).to_f64() / (high - low);
                let found = derivative[row].partials[STATES + field];
                assert!(
                    (found - expected).abs() < 1e-8 * (1.0 + expected.abs()),
                    "{name:?} {row}: {found} for {expected}"
                );
            }
        }
    }
}
