//! Collects the values of a scene one by one, each checked against its row, and builds the scene from them.

use super::field::{Availability, FIELDS, Name, Value};
use super::{BodyShape, Scene, Striking};
use crate::friction::{Law, Slide};
use crate::impact::State;
use crate::map::Release;
use crate::trig;

/// What is wrong with a field, in words with numbers, limits and units.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldError {
    /// Dotted path of the field, or of the group that is missing.
    pub path: &'static str,
    /// The error.
    pub detail: String,
}

impl FieldError {
    fn new(name: Name, detail: String) -> Self {
        Self { path: name.row().path, detail }
    }
}

/// The values said so far, one slot for each row of [`FIELDS`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Draft {
    values: [Option<Value>; FIELDS.len()],
}

impl Draft {
    /// Says a value, or takes what was said back.
    ///
    /// # Errors
    /// Where the value is not of the field's kind, out of its range, or asks for what this version cannot compute.
    pub fn set(&mut self, name: Name, value: Option<Value>) -> Result<(), FieldError> {
        let row = name.row();
        if let Some(value) = value {
            if !row.admits(value) {
                return Err(FieldError::new(name, format!("{} is {value}; it must be {}", row.key(), row.limits())));
            }
            match row.availability {
                Availability::Full => {}
                Availability::Only(only) if only == value => {}
                Availability::Only(only) => {
                    let detail = format!("{} other than {only} is not available in this version", row.key());
                    return Err(FieldError::new(name, detail));
                }
                Availability::None => {
                    return Err(FieldError::new(name, format!("{} is not available in this version", row.path)));
                }
            }
        }
        self.values[name as usize] = value;
        Ok(())
    }

    /// What was said, or the default after [`Draft::build`].
    pub fn get(&self, name: Name) -> Option<Value> {
        self.values[name as usize]
    }

    /// Whether the body is said to be a point mass.
    pub fn is_point(&self) -> bool {
        self.get(Name::PointMass) == Some(Value::Flag(true))
    }

    fn number(&self, name: Name) -> Option<f64> {
        match self.get(name) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        }
    }

    /// A value that has to be there; its absence is one of the errors, and NaN stands in until they are returned.
    fn required(&self, name: Name, errors: &mut Vec<FieldError>) -> f64 {
        self.number(name).unwrap_or_else(|| {
            let row = name.row();
            errors.push(FieldError::new(name, format!("{} is missing: {}, {}", row.key(), row.about, row.limits())));
            f64::NAN
        })
    }

    /// The scene, with defaults for what was not said.
    ///
    /// # Errors
    /// Every field that is missing, contradicts another, or cannot be (a release below the table).
    pub fn build(mut self) -> Result<Scene, Vec<FieldError>> {
        let mut errors = Vec::new();
        for row in &FIELDS {
            let slot = &mut self.values[row.name as usize];
            *slot = slot.or(row.default);
        }
        let body = self.body(&mut errors);
        let full_gravity = self.required(Name::Gravity, &mut errors);
        let incline = self.required(Name::Incline, &mut errors);
        let strike = if self.get(Name::Strike) == Some(Value::Choice("still")) {
            Striking::Still
        } else {
            Striking::Compensated
        };
        let energy_gain = self.required(Name::EnergyGain, &mut errors);
        if energy_gain != 0.0 {
            if strike == Striking::Still {
                let detail = "energy_gain moves the table and strike says `still`; leave one of them out".to_owned();
                errors.push(FieldError::new(Name::EnergyGain, detail));
            }
            if self.get(Name::TargetHeight).is_none() {
                let detail = format!(
                    "target_height is missing: energy_gain {energy_gain} s²/m² needs the height it steers to; {}",
                    Name::TargetHeight.row().limits()
                );
                errors.push(FieldError::new(Name::TargetHeight, detail));
            }
        }
        let friction = self.required(Name::Friction, &mut errors);
        let matched = self.get(Name::Slide) == Some(Value::Choice("matched"));
        let slide = if matched { Slide::Matched } else { Slide::None };
        for (name, said) in [(Name::Friction, friction != 0.0), (Name::Slide, matched)] {
            if said && body == BodyShape::Point {
                let detail = format!("{} is for a body with an angle; a point mass has none here", name.row().key());
                errors.push(FieldError::new(name, detail));
            }
        }
        let scene = Scene {
            body,
            gravity: full_gravity * trig::sin_cos(incline).0,
            full_gravity,
            incline,
            restitution: self.required(Name::Restitution, &mut errors),
            friction,
            law: match self.get(Name::Law) {
                Some(Value::Choice("newton")) => Law::Newton,
                Some(Value::Choice("stronge")) => Law::Stronge,
                _ => Law::Poisson,
            },
            slide,
            tilt_gain: self.required(Name::TiltGain, &mut errors),
            energy_gain,
            target_height: if energy_gain == 0.0 { None } else { self.number(Name::TargetHeight) },
            strike,
            release: self.release(body, &mut errors),
            topple_angle: self.required(Name::ToppleAngle, &mut errors),
            draft: self,
        };
        if errors.is_empty() { Ok(scene) } else { Err(errors) }
    }

    fn body(&self, errors: &mut Vec<FieldError>) -> BodyShape {
        let lengths = [Name::ContactDistance, Name::RadiusOfGyration];
        if !self.is_point() {
            if lengths.iter().all(|&name| self.get(name).is_none()) {
                let detail = "body is missing: give contact_distance and radius_of_gyration in m, or {\"point\": true}";
                errors.push(FieldError { path: "body", detail: detail.to_owned() });
                return BodyShape::Point;
            }
            return BodyShape::Rod {
                contact_distance: self.required(Name::ContactDistance, errors),
                radius_of_gyration: self.required(Name::RadiusOfGyration, errors),
            };
        }
        for name in lengths {
            if self.get(name).is_some() {
                errors.push(FieldError::new(
                    name,
                    format!("a point mass has no {}; leave one of them out", name.row().key()),
                ));
            }
        }
        BodyShape::Point
    }

    fn release(&mut self, body: BodyShape, errors: &mut Vec<FieldError>) -> Release {
        let height = self.required(Name::Height, errors);
        let state = State {
            theta: self.required(Name::Theta, errors),
            x_dot: self.required(Name::XDot, errors),
            y_dot: self.required(Name::YDot, errors),
            theta_dot: self.required(Name::ThetaDot, errors),
        };
        match body {
            BodyShape::Point => {
                for name in [Name::Theta, Name::ThetaDot] {
                    if self.number(name).is_some_and(|number| number != 0.0) {
                        errors.push(FieldError::new(
                            name,
                            format!("a point mass has no {}; leave it out", name.row().key()),
                        ));
                    }
                    self.values[name as usize] = None;
                }
            }
            BodyShape::Rod { contact_distance, .. } => {
                let contact_height = contact_distance * trig::sin_cos(state.theta).1;
                if contact_height - height > 4.0 * f64::EPSILON * contact_height.abs().max(height) {
                    let detail = format!(
                        "height is {height} m, which puts the contact point {} m below the table; at theta {} rad it must be at \
                         least {contact_height} m",
                        contact_height - height,
                        state.theta
                    );
                    errors.push(FieldError::new(Name::Height, detail));
                }
            }
        }
        Release { x: self.required(Name::X, errors), height, state }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(crate) fn draft(values: &[(Name, f64)]) -> Draft {
        let mut draft = Draft::default();
        for &(name, number) in values {
            draft.set(name, Some(Value::Number(number))).unwrap();
        }
        draft
    }

    const ROD: [(Name, f64); 4] = [
        (Name::ContactDistance, 0.4 / 3.0),
        (Name::RadiusOfGyration, 0.094),
        (Name::TiltGain, 1.1),
        (Name::Height, 0.2),
    ];

    fn paths(draft: Draft) -> Vec<&'static str> {
        draft.build().unwrap_err().iter().map(|error| error.path).collect()
    }

    #[test]
    fn defaults_are_filled_in() {
        let scene = draft(&ROD).build().unwrap();
        assert_eq!(scene.value(Name::Gravity), Some(Value::Number(9.81)));
        assert_eq!(scene.gravity(), 9.81);
        assert_eq!(scene.value(Name::TargetHeight), None);
    }

    #[test]
    fn everything_missing_is_named_at_once() {
        assert_eq!(paths(Draft::default()), ["body", "table.tilt_gain", "release.height"]);
        assert_eq!(paths(draft(&ROD[1..])), ["body.contact_distance"]);
    }

    #[test]
    fn contradictions_are_errors() {
        let mut point = draft(&ROD);
        point.set(Name::PointMass, Some(Value::Flag(true))).unwrap();
        assert_eq!(paths(point), ["body.contact_distance", "body.radius_of_gyration"]);
        let mut still = draft(&ROD);
        still.set(Name::Strike, Some(Value::Choice("still"))).unwrap();
        still.set(Name::EnergyGain, Some(Value::Number(0.1))).unwrap();
        assert_eq!(paths(still), ["table.energy_gain", "table.target_height"]);
    }

    #[test]
    fn a_release_below_the_table_is_refused_and_one_on_it_is_not() {
        let mut low = draft(&ROD);
        low.set(Name::Height, Some(Value::Number(0.13))).unwrap();
        assert_eq!(paths(low), ["release.height"]);
        low.set(Name::Theta, Some(Value::Number(0.3))).unwrap();
        low.set(Name::Height, Some(Value::Number(0.4 / 3.0 * trig::sin_cos(0.3).1))).unwrap();
        low.build().unwrap();
    }

    #[test]
    fn what_is_not_there_yet_is_refused() {
        let mut draft = Draft::default();
        draft.set(Name::TimingSd, Some(Value::Number(0.0))).unwrap();
        let error = draft.set(Name::TimingSd, Some(Value::Number(0.1))).unwrap_err();
        assert_eq!(error.detail, "timing_sd other than 0 is not available in this version");
        assert!(draft.set(Name::FeedbackX, Some(Value::Number(1.0))).is_err());
    }
}
