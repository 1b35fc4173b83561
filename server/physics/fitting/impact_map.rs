//! The map from one impact to the next, with place and time, and its derivatives by the state and by fields.
//!
//! Derivatives are central differences of the exact map, relative steps of 6e-6, so their relative error is about 1e-10. One way for all
//! fields: a field enters through its row and through the model of the scene, whatever formulas it appears in. Tests hold them
//! against dual numbers and against runs with 31 digits.

use crate::body::Arrival;
use crate::body::Body;
use crate::bounce::state::State;
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

/// Relative step of a central difference: about the cube root of rounding.
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

/// The maps of scenes a step aside in one field, and the weights with which they make the derivative.
#[derive(Clone, Debug)]
struct FieldStencil {
    /// Weight of the map in the middle.
    middle: f64,
    aside: Vec<(f64, ImpactMap)>,
}

/// A map with its derivatives.
#[derive(Clone, Debug)]
pub(super) struct DifferentiatedMap {
    middle: ImpactMap,
    fields: Vec<FieldStencil>,
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
    /// The map at a draft, with its derivatives by these fields. A field at an end of its range is stepped to one side.
    pub(super) fn new(draft: &Draft, names: &[Name]) -> Result<Self, Vec<FieldError>> {
        let middle = ImpactMap::new(draft)?;
        let fields = names.iter().map(|&name| stencil(draft, name)).collect::<Result<_, _>>()?;
        Ok(Self { middle, fields })
    }

    /// Just before the first impact of the scene's own run, and its derivatives by each field.
    pub(super) fn release(&self) -> Option<(Vector, Vec<Vector>)> {
        let middle = self.middle.release?;
        let by_field = self.fields.iter().map(|field| {
            let mut sum = middle.map(|component| component * field.middle);
            for (weight, map) in &field.aside {
                add(&mut sum, *weight, &map.release?);
            }
            Some(sum)
        });
        Some((middle, by_field.collect::<Option<_>>()?))
    }

    /// The next impact after impact `n`, with derivatives; `None` where the run would end.
    pub(super) fn next(&mut self, n: u64, at: &Vector) -> Option<ImpactDerivative> {
        let next = self.middle.next(n, at)?;
        let mut by_state = [[0.0; STATES]; STATES];
        for component in 0..T {
            let step = STEP * at[component].abs().max(1.0);
            let mut aside = [*at; 2];
            aside[0][component] += step;
            aside[1][component] -= step;
            let width = aside[0][component] - aside[1][component];
            let (high, low) = (self.middle.next(n, &aside[0])?, self.middle.next(n, &aside[1])?);
            for row in 0..STATES {
                by_state[row][component] = (high[row] - low[row]) / width;
            }
        }
        by_state[T][T] = 1.0;
        let mut by_field = Vec::with_capacity(self.fields.len());
        for field in &mut self.fields {
            let mut sum = next.map(|component| component * field.middle);
            for (weight, map) in &mut field.aside {
                add(&mut sum, *weight, &map.next(n, at)?);
            }
            by_field.push(sum);
        }
        Some(ImpactDerivative { next, by_state, by_field })
    }
}

fn add(sum: &mut Vector, weight: f64, term: &Vector) {
    for (sum, term) in sum.iter_mut().zip(term) {
        *sum += weight * term;
    }
}

fn stencil(draft: &Draft, name: Name) -> Result<FieldStencil, Vec<FieldError>> {
    let value = draft.value_of(name);
    let (minimum, maximum) = range(name);
    let step = STEP * value.abs().max(0.01 * (maximum - minimum).min(1.0));
    let map = |value: f64| {
        let mut draft = *draft;
        draft.set(name, Some(Value::Number(value))).map_err(|error| vec![error])?;
        Ok::<_, Vec<FieldError>>((value, ImpactMap::new(&draft)?))
    };
    if value - step >= minimum && value + step <= maximum {
        let ((high, above), (low, below)) = (map(value + step)?, map(value - step)?);
        let weight = 1.0 / (high - low);
        return Ok(FieldStencil { middle: 0.0, aside: vec![(weight, above), (-weight, below)] });
    }
    // Three points on one side, of second order like the central difference.
    let step = if value + 2.0 * step <= maximum { step } else { -step };
    let ((_, near), (_, far)) = (map(value + step)?, map(value + 2.0 * step)?);
    Ok(FieldStencil { middle: -1.5 / step, aside: vec![(2.0 / step, near), (-0.5 / step, far)] })
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
    use crate::scene::Scene;
    use crate::stability::jacobian::jacobian_at;

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
    fn a_field_at_an_end_of_its_range_is_stepped_to_one_side() {
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
