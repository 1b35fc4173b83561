//! Collects the values of a scene one by one, each checked against its row, and builds the scene from them.

use super::fields::{FIELDS, Name, Value};
use super::{BodyShape, Scene, Striking};
use crate::body::Release;
use crate::body::polygon::{FLUSH, Outline, PolygonError, Vertices};
use crate::bounce::friction::{RestitutionLaw, Slide};
use crate::bounce::state::State;
use crate::numbers::trig;
use crate::table::actuator_load::ActuatorLimits;
use crate::table::control_law::{Gains, Steering};
use crate::table::noise::{Noise, NoiseModel};

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

/// Path of the vertices of a polygon.
pub const VERTICES: &str = "body.vertices";

/// Stands in for a body that cannot be told until the errors are returned.
const UNKNOWN: BodyShape = BodyShape::Rod { contact_distance: f64::NAN, radius_of_gyration: f64::NAN };

/// The values said so far, one slot for each row of [`FIELDS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Draft {
    values: [Option<Value>; FIELDS.len()],
    vertices: Option<Vertices>,
}

impl Default for Draft {
    fn default() -> Self {
        Self { values: [None; FIELDS.len()], vertices: None }
    }
}

impl Draft {
    /// Says a value, or takes what was said back.
    ///
    /// # Errors
    /// Where the value is not of the field's kind or out of its range.
    pub fn set(&mut self, name: Name, value: Option<Value>) -> Result<(), FieldError> {
        let row = name.row();
        if let Some(value) = value.filter(|&value| !row.admits(value)) {
            return Err(FieldError::new(name, format!("{} is {value}; it must be {}", row.key(), row.limits())));
        }
        self.values[name as usize] = value;
        Ok(())
    }

    /// What was said, or the default after [`Draft::build`].
    pub fn get(&self, name: Name) -> Option<Value> {
        self.values[name as usize]
    }

    /// Says the vertices of a polygon, or takes them back.
    pub fn set_vertices(&mut self, vertices: Option<Vertices>) {
        self.vertices = vertices;
    }

    /// The vertices of a polygon, where the body is said to be one.
    pub fn vertices(&self) -> Option<&Vertices> {
        self.vertices.as_ref()
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
        let (body, outline) = self.body(&mut errors);
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
        let assumed_restitution = self.number(Name::AssumedRestitution);
        if strike == Striking::Still && assumed_restitution.is_some() {
            let detail =
                "assumed_restitution moves the table and strike says `still`; leave one of them out".to_owned();
            errors.push(FieldError::new(Name::AssumedRestitution, detail));
        }
        let steering = self.steering(&mut errors);
        let friction = self.required(Name::Friction, &mut errors);
        let matched = self.get(Name::Slide) == Some(Value::Choice("matched"));
        let slide = if matched { Slide::Matched } else { Slide::None };
        let noise = self.noise();
        for (name, said) in [
            (Name::Friction, friction != 0.0),
            (Name::Slide, matched),
            (Name::FeedbackTheta, steering != Steering::TiltGain),
            (Name::TimingSd, noise.is_some()),
        ] {
            if said && body == BodyShape::Point {
                let path = name.row().path;
                let detail = format!("{path} is for a body with an angle; a point mass has none here");
                errors.push(FieldError::new(name, detail));
            }
        }
        let scene = Scene {
            body,
            outline,
            gravity: full_gravity * trig::sin_cos(incline).0,
            full_gravity,
            incline,
            restitution: self.required(Name::Restitution, &mut errors),
            friction,
            law: match self.get(Name::Law) {
                Some(Value::Choice("newton")) => RestitutionLaw::Newton,
                Some(Value::Choice("stronge")) => RestitutionLaw::Stronge,
                _ => RestitutionLaw::Poisson,
            },
            slide,
            steering,
            tilt_gain: self.number(Name::TiltGain).unwrap_or(0.0),
            assumed_restitution,
            energy_gain,
            target_height: if energy_gain == 0.0 { None } else { self.number(Name::TargetHeight) },
            strike,
            release: self.release(body, outline.as_ref(), &mut errors),
            topple_angle: self.required(Name::ToppleAngle, &mut errors),
            limits: self.limits(),
            noise,
            draft: self,
        };
        if errors.is_empty() { Ok(scene) } else { Err(errors) }
    }

    /// By a tilt gain or by feedback of the state, where gains that are not said are 0.
    fn steering(&mut self, errors: &mut Vec<FieldError>) -> Steering {
        let names = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];
        let Some(said) = names.into_iter().find(|&name| self.get(name).is_some()) else {
            self.required(Name::TiltGain, errors);
            return Steering::TiltGain;
        };
        if self.get(Name::TiltGain).is_some() {
            let detail = format!(
                "tilt_gain and {} both say how the table tilts; leave one of them out (null takes a preset's back)",
                said.row().path
            );
            errors.push(FieldError::new(Name::TiltGain, detail));
        }
        let [x, theta, x_dot, theta_dot] = names.map(|name| {
            let gain = self.number(name).unwrap_or(0.0);
            self.values[name as usize] = Some(Value::Number(gain));
            gain
        });
        Steering::Feedback(Gains { x, theta, x_dot, theta_dot })
    }

    /// None where both standard deviations are 0; where not, what is not said of it takes its default.
    fn noise(&mut self) -> Option<Noise> {
        let [timing_sd, angle_sd] = [Name::TimingSd, Name::AngleSd].map(|name| self.number(name).unwrap_or(0.0));
        if timing_sd == 0.0 && angle_sd == 0.0 {
            return None;
        }
        let model = match self.values[Name::NoiseModel as usize].get_or_insert(Value::Choice("strike")) {
            Value::Choice("plan") => NoiseModel::Plan,
            _ => NoiseModel::Strike,
        };
        let [seed, run] = [Name::Seed, Name::NoiseRun].map(|name| {
            match self.values[name as usize].get_or_insert(Value::Integer(0)) {
                Value::Integer(number) => *number,
                _ => 0,
            }
        });
        Some(Noise { timing_sd, angle_sd, model, seed, run })
    }

    fn limits(&self) -> Option<ActuatorLimits> {
        let names = [Name::TiltLimit, Name::TiltRateLimit, Name::SpeedLimit, Name::StrokeLimit];
        let [tilt, tilt_rate, speed, stroke] = names.map(|name| self.number(name));
        let most = |limit: Option<f64>| limit.unwrap_or(f64::INFINITY);
        names.iter().any(|&name| self.get(name).is_some()).then(|| ActuatorLimits {
            tilt: most(tilt),
            tilt_rate: most(tilt_rate),
            speed: most(speed),
            stroke: most(stroke),
        })
    }

    fn body(&mut self, errors: &mut Vec<FieldError>) -> (BodyShape, Option<Outline>) {
        let lengths = [Name::ContactDistance, Name::RadiusOfGyration];
        let said = |name: &Name| self.get(*name).is_some();
        if self.is_point() {
            for name in lengths.into_iter().chain([Name::ContactVertex]).filter(said) {
                let key = name.row().key();
                errors.push(FieldError::new(name, format!("a point mass has no {key}; leave one of them out")));
            }
            if self.vertices.is_some() {
                let detail = "a point mass has no vertices; leave one of them out".to_owned();
                errors.push(FieldError { path: VERTICES, detail });
            }
            return (BodyShape::Point, None);
        }
        if let Some(vertices) = self.vertices {
            for name in lengths.into_iter().filter(said) {
                let key = name.row().key();
                let detail = format!("{key} follows from vertices, which are given too; leave one of them out");
                errors.push(FieldError::new(name, detail));
            }
            return self.polygon(&vertices, errors).map_or((UNKNOWN, None), |outline| {
                let (contact_distance, radius_of_gyration) = (outline.contact_distance(), outline.radius_of_gyration());
                (BodyShape::Rod { contact_distance, radius_of_gyration }, Some(outline))
            });
        }
        if said(&Name::ContactVertex) {
            let detail =
                "contact_vertex is one of a polygon's vertices, and there are none; give vertices, or leave it out";
            errors.push(FieldError::new(Name::ContactVertex, detail.to_owned()));
        }
        if !lengths.iter().any(said) {
            let detail =
                "body is missing: give contact_distance and radius_of_gyration in m, vertices, or {\"point\": true}";
            errors.push(FieldError { path: "body", detail: detail.to_owned() });
            return (UNKNOWN, None);
        }
        let body = BodyShape::Rod {
            contact_distance: self.required(Name::ContactDistance, errors),
            radius_of_gyration: self.required(Name::RadiusOfGyration, errors),
        };
        (body, None)
    }

    /// None where it is no body; the contact vertex is the lowest, where none is said.
    fn polygon(&mut self, vertices: &Vertices, errors: &mut Vec<FieldError>) -> Option<Outline> {
        let contact_vertex = match self.get(Name::ContactVertex) {
            Some(Value::Integer(vertex)) => Ok(vertex as usize),
            _ => vertices.lowest(),
        };
        let outline = contact_vertex.and_then(|vertex| {
            self.values[Name::ContactVertex as usize] = Some(Value::Integer(vertex as u64));
            Outline::new(vertices, vertex)
        });
        let path = |error: &PolygonError| match error.is_of_contact_vertex() {
            true => Name::ContactVertex.row().path,
            false => VERTICES,
        };
        outline.map_err(|error| errors.push(FieldError { path: path(&error), detail: error.to_string() })).ok()
    }

    fn release(&mut self, body: BodyShape, outline: Option<&Outline>, errors: &mut Vec<FieldError>) -> Release {
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
                } else if let Some(nearest) = outline.map(|outline| outline.nearest(trig::sin_cos(state.theta)))
                    && height - contact_height + nearest.clearance < -FLUSH * contact_distance
                {
                    let detail = format!(
                        "height is {height} m, which puts vertex {} {} m below the table; at theta {} rad it must be at least {} m",
                        nearest.vertex,
                        contact_height - nearest.clearance - height,
                        state.theta,
                        contact_height - nearest.clearance
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
    fn feedback_takes_the_place_of_the_tilt_gain() {
        let mut both = draft(&ROD);
        both.set(Name::FeedbackX, Some(Value::Number(1.0))).unwrap();
        assert_eq!(paths(both), ["table.tilt_gain"]);
        both.set(Name::TiltGain, None).unwrap();
        let scene = both.build().unwrap();
        assert_eq!(scene.value(Name::FeedbackThetaDot), Some(Value::Number(0.0)));
    }

    #[test]
    fn noise_has_a_model_and_a_seed_where_there_is_any() {
        let quiet = draft(&[&ROD[..], &[(Name::TimingSd, 0.0)]].concat()).build().unwrap();
        assert_eq!(quiet.value(Name::Seed), None);
        let noisy = draft(&[&ROD[..], &[(Name::AngleSd, 0.01)]].concat()).build().unwrap();
        assert_eq!(noisy.value(Name::Seed), Some(Value::Integer(0)));
        assert_eq!(noisy.value(Name::NoiseModel), Some(Value::Choice("strike")));
    }
}
