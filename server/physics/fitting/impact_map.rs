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
use crate::scene::{Draft, FieldError, FieldKind, Name, Value};

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

/// θ, ẋ, ẏ, θ̇ and x, by which an impact depends on the one before, and the unknown fields.
const DIRECTIONS: usize = T + MOST_UNKNOWNS;

type Number13 = Dual<DIRECTIONS>;

/// Relative step by which a field is moved to see whether the scene allows it.
const STEP: f64 = 6e-6;

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
}

fn to_vector(state: &State, x: f64, t: f64) -> Vector {
    [state.theta, state.x_dot, state.y_dot, state.theta_dot, x, t]
}

/// A map with its derivatives.
#[derive(Clone, Debug)]
pub(super) struct DifferentiatedMap {
    map: ImpactMap,
    body: Body<Number13>,
    release: Release<Number13>,
    /// Number of fields.
    fields: usize,
}

/// Derivatives of the map from one impact to the next.
#[derive(Clone, Debug)]
pub(super) struct ImpactDerivative {
    /// The next impact.
    pub(super) next: Vector,
    /// Row i, column j: derivative of component i by component j before.
    pub(super) by_state: [Vector; STATES],
    /// Derivatives by each field.
    pub(super) by_field: Vec<Vector>,
}

impl DifferentiatedMap {
    /// The map at a draft, with its derivatives by these fields, at most [`MOST_UNKNOWNS`].
    pub(super) fn new(draft: &Draft, names: &[Name]) -> Result<Self, Vec<FieldError>> {
        let scene = draft.build()?;
        let along = |name: Name, value: f64| match names.iter().position(|&other| other == name) {
            Some(place) => Dual::along(value, T + place, 1.0),
            None => Dual::from_f64(value),
        };
        Ok(Self {
            map: ImpactMap::new(draft)?,
            body: scene.body_by(along),
            release: scene.release_by(along),
            fields: names.len(),
        })
    }

    /// Just before the first impact of the scene's own run, and its derivatives by each field.
    pub(super) fn release(&self) -> Option<(Vector, Vec<Vector>)> {
        let release = self.map.release?;
        let Arrival { t, state, way, .. } = self.body.fall(&self.release).ok()?;
        let first = [state.theta, state.x_dot, state.y_dot, state.theta_dot, self.release.x + way, t];
        Some((release, self.by_field(&first)))
    }

    /// The next impact after impact `n`, with derivatives; `None` where the run would end.
    pub(super) fn next(&mut self, n: u64, at: &Vector) -> Option<ImpactDerivative> {
        let next = self.map.next(n, at)?;
        let along = |component: usize| Dual::along(at[component], component, 1.0);
        let [theta, x_dot, y_dot, theta_dot, x] = std::array::from_fn(along);
        let state =
            if self.body.is_point { Body::point_state(x_dot, y_dot) } else { State { theta, x_dot, y_dot, theta_dot } };
        let coming = PreImpact { n, x, state, clearance: Dual::from_f64(0.0), plan: None };
        let arrival = self.body.fly(&coming, &self.body.strike(&coming)).ok()?;
        let State { theta, x_dot, y_dot, theta_dot } = arrival.state;
        let end = [theta, x_dot, y_dot, theta_dot, x + arrival.way, arrival.t];
        let mut by_state = end.map(|number| {
            let mut row = [0.0; STATES];
            row[..T].copy_from_slice(&number.partials[..T]);
            row
        });
        by_state[T][T] = 1.0;
        Some(ImpactDerivative { next, by_state, by_field: self.by_field(&end) })
    }

    fn by_field(&self, numbers: &[Number13; STATES]) -> Vec<Vector> {
        (0..self.fields).map(|field| numbers.map(|number| number.partials[T + field])).collect()
    }
}

/// Refuses a field that the scene does not let move from its value.
pub(super) fn check_movable(draft: &Draft, name: Name) -> Result<(), Vec<FieldError>> {
    let value = draft.value_of(name);
    let (minimum, maximum) = range(name);
    let step = STEP * value.abs().max(0.01 * (maximum - minimum).min(1.0));
    for moved in [value + step, value - step].into_iter().filter(|moved| (minimum..=maximum).contains(moved)) {
        let mut draft = *draft;
        draft.set(name, Some(Value::Number(moved))).map_err(|error| vec![error])?;
        draft.build()?;
    }
    Ok(())
}

/// Range of a field that is a number.
pub(super) fn range(name: Name) -> (f64, f64) {
    match name.row().kind {
        FieldKind::Number { minimum, maximum } => (minimum, maximum),
        FieldKind::Integer { .. } | FieldKind::Choice(_) | FieldKind::Flag | FieldKind::Numbers { .. } => {
            (f64::NEG_INFINITY, f64::INFINITY)
        }
    }
}

trait NumberOf {
    fn value_of(&self, name: Name) -> f64;
}

impl NumberOf for Draft {
    fn value_of(&self, name: Name) -> f64 {
        match self.get(name) {
            Some(Value::Number(number)) => number,
            Some(Value::Integer(_) | Value::Choice(_) | Value::Flag(_) | Value::Numbers(_)) | None => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::jacobian::jacobian_at;
    use crate::scene::Scene;

    const ROD: [(Name, f64); 8] = [
        (Name::ContactDistance, 0.13),
        (Name::RadiusOfGyration, 0.09),
        (Name::TiltGain, 1.2),
        (Name::Height, 0.25),
        (Name::Theta, 0.2),
        (Name::ThetaDot, 0.3),
        (Name::XDot, 0.1),
        (Name::Restitution, 0.7),
    ];

    fn scene(more: &[(Name, f64)], words: &[(Name, &'static str)]) -> Scene {
        let mut draft = Draft::default();
        for &(name, number) in ROD.iter().chain(more) {
            draft.set(name, Some(Value::Number(number))).unwrap();
        }
        for &(name, word) in words {
            draft.set(name, Some(Value::Choice(word))).unwrap();
        }
        draft.build().unwrap()
    }

    /// Scenes of each model.
    fn scenes() -> [Scene; 4] {
        let mut feedback = scene(&[], &[]).draft();
        feedback.set(Name::TiltGain, None).unwrap();
        for (name, gain) in [(Name::FeedbackTheta, -1.2), (Name::FeedbackX, 0.3), (Name::FeedbackThetaDot, -0.02)] {
            feedback.set(name, Some(Value::Number(gain))).unwrap();
        }
        [
            scene(&[(Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2), (Name::AssumedRestitution, 0.75)], &[]),
            scene(&[(Name::Friction, 0.1)], &[(Name::Strike, "still")]),
            scene(&[(Name::Friction, 0.6)], &[(Name::Slide, "matched")]),
            feedback.build().unwrap(),
        ]
    }

    #[test]
    fn derivatives_by_the_state_are_those_of_dual_numbers() {
        for scene in scenes() {
            let mut map = DifferentiatedMap::new(&scene.draft(), &[]).unwrap();
            let (at, _) = map.release().unwrap();
            let found = map.next(1, &at).unwrap().by_state;
            let state = State { theta: at[0], x_dot: at[1], y_dot: at[2], theta_dot: at[3] };
            let model = scene.model();
            let exact = jacobian_at(&model, at[X], &state, 1).unwrap().matrix;
            let scales = [model.rod.radius_of_gyration, 1.0, 1.0, model.rod.radius_of_gyration, 1.0];
            for row in 0..exact.nrows() {
                for column in 0..exact.ncols() {
                    let expected = exact[(row, column)] * scales[column] / scales[row];
                    let error = (found[row][column] - expected).abs();
                    assert!(
                        error < 1e-8 * (1.0 + expected.abs()),
                        "{row} {column}: {} for {expected}",
                        found[row][column]
                    );
                }
            }
        }
    }

    #[test]
    fn derivatives_by_fields_are_those_of_runs_with_31_digits() {
        let names = [Name::RadiusOfGyration, Name::Gravity, Name::Restitution, Name::TiltGain, Name::Height];
        let scene = scene(&[(Name::EnergyGain, 0.2), (Name::TargetHeight, 0.2), (Name::AssumedRestitution, 0.75)], &[]);
        let mut map = DifferentiatedMap::new(&scene.draft(), &names).unwrap();
        let (at, by_release) = map.release().unwrap();
        let derivative = map.next(1, &at).unwrap();
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
                let expected = crate::numbers::number::Number::to_f64(above[row] - below[row]) / (high - low);
                let carried: f64 = (0..STATES).map(|k| derivative.by_state[row][k] * by_release[field][k]).sum();
                let found = carried + derivative.by_field[field][row];
                assert!(
                    (found - expected).abs() < 1e-8 * (1.0 + expected.abs()),
                    "{name:?} {row}: {found} for {expected}"
                );
            }
        }
    }

    #[test]
    fn a_field_at_an_end_of_its_range_has_its_derivative_there() {
        let scene = scene(&[(Name::Restitution, 1.0), (Name::AssumedRestitution, 0.9)], &[]);
        let [end, near] = [1.0, 1.0 - 1e-4].map(|restitution| {
            let mut draft = scene.draft();
            draft.set(Name::Restitution, Some(Value::Number(restitution))).unwrap();
            let mut map = DifferentiatedMap::new(&draft, &[Name::Restitution]).unwrap();
            let (at, _) = map.release().unwrap();
            map.next(1, &at).unwrap().by_field[0]
        });
        for row in 0..STATES {
            assert!((end[row] - near[row]).abs() < 1e-3 * (1.0 + near[row].abs()), "{row}");
        }
    }
}
