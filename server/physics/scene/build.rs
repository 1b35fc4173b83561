//! Builds a scene from a draft: fills in defaults and refuses fields that are missing or contradict one another.

use super::draft::{Draft, VERTICES};
use super::error::{FieldError, FieldErrorKind};
use super::fields::{ERRORS, FIELDS, GAINS, Name, Value};
use super::{BodyShape, Striking};
use crate::Named;
use crate::map::body::{Body, Release};
use crate::map::flight::AirDrag;
use crate::map::friction::{RestitutionLaw, Slide};
use crate::map::polygon::{FLUSH, Outline, PolygonError, Vertices};
use crate::map::strike::{EnergyFeedback, EnergyLaw, EnergyMeasure, State};
use crate::map::table::actuator_load::ActuatorLimits;
use crate::map::table::control_law::{Gains, Steering};
use crate::map::table::errors::TableErrors;
use crate::map::table::noise::{Noise, NoiseModel};
use crate::map::table::pivot::{TiltRate, TurningTable};
use crate::map::table::program::HeightProgram;
use crate::map::table::sensing::Prediction;
use crate::numbers::trig;

/// A scene in which every value is in its range and nothing contradicts anything else. Made by [`Draft::build`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scene {
    pub(crate) body: BodyShape,
    pub(crate) outline: Option<Outline>,
    /// G = g sin φ, m/s².
    pub(crate) gravity: f64,
    /// φ, rad.
    pub(crate) incline: f64,
    pub(crate) restitution: f64,
    pub(crate) friction: f64,
    pub(crate) law: RestitutionLaw,
    pub(crate) slide: Slide,
    pub(crate) steering: Steering,
    /// κ by which the table acts; 0 with state feedback.
    pub(crate) tilt_gain: f64,
    /// ê, if given. With an error of the table's speed: that by which the table acts.
    pub(crate) assumed_restitution: Option<f64>,
    /// κ_E by which the table acts, s²/m².
    pub(crate) energy_gain: f64,
    pub(crate) energy_feedback: EnergyFeedback,
    /// Target height y* of the first strike, m; only where the table steers the energy.
    pub(crate) target_height: Option<f64>,
    /// Target heights of all strikes, where they differ and the table steers the energy.
    pub(crate) program: Option<HeightProgram>,
    pub(crate) strike: Striking,
    pub(crate) release: Release,
    pub(crate) topple_angle: f64,
    pub(crate) limits: Option<ActuatorLimits>,
    /// Half the length of the table, m; infinite if it has no ends.
    pub(crate) half_length: f64,
    pub(crate) noise: Option<Noise>,
    /// Time before a strike of the state by which the table strikes, s; 0 for a table that carries it on.
    pub(crate) lag: f64,
    pub(crate) prediction: Prediction,
    /// Constant errors. The gains, the laws and the body above have them.
    pub(crate) errors: TableErrors,
    /// Tilt of the table beside its law, rad: all that the constant errors do which is no change of a gain.
    pub(crate) constant_tilt: f64,
    pub(crate) turning: Option<TurningTable>,
    pub(crate) drag: Option<AirDrag>,
    draft: Draft,
}

impl Scene {
    /// Value of a field, defaults included; None if the field does not apply.
    pub fn value(&self, name: Name) -> Option<Value> {
        self.draft.get(name)
    }

    /// Value of a field that is a number.
    pub fn number(&self, name: Name) -> Option<f64> {
        match self.value(name) {
            Some(Value::Number(number)) => Some(number),
            _ => None,
        }
    }

    /// Draft of this scene with all defaults, to change a field and build again.
    pub fn draft(&self) -> Draft {
        self.draft
    }

    /// The same scene with other numbers in fields, or without a value. Fails with the reason in a sentence.
    pub(crate) fn with(&self, values: impl IntoIterator<Item = (Name, Option<f64>)>) -> Result<Self, String> {
        let mut draft = self.draft;
        for (name, value) in values {
            draft.set(name, value.map(Value::Number)).map_err(|error| error.detail)?;
        }
        draft.build().map_err(|errors| errors.into_iter().next().map_or_else(String::new, |error| error.detail))
    }

    /// Shape of the body.
    pub fn body(&self) -> BodyShape {
        self.body
    }

    /// Outline, if the body is a polygon.
    pub fn outline(&self) -> Option<&Outline> {
        self.outline.as_ref()
    }

    /// The same scene with the rod of the same l and ρ in place of a polygon. Fails with the fields that refuse it.
    pub fn as_rod(&self) -> Result<Self, Vec<FieldError>> {
        let Some(outline) = self.outline else { return Ok(*self) };
        let mut draft = self.draft;
        draft.set_vertices(None);
        let (contact_distance, radius_of_gyration) = (outline.contact_distance, outline.radius_of_gyration);
        for (name, value) in [
            (Name::ContactVertex, None),
            (Name::ContactDistance, Some(Value::Number(contact_distance))),
            (Name::RadiusOfGyration, Some(Value::Number(radius_of_gyration))),
        ] {
            draft.set(name, value).map_err(|error| vec![error])?;
        }
        draft.build()
    }

    /// The same scene with a tilt gain, κ = −K_θ, in place of a state feedback of θ alone, which is the same law; other scenes as they are.
    /// Friction on a table that only tilts is left as it is: nothing drifts or circles there.
    pub fn with_tilt_law(&self) -> Self {
        let Steering::Feedback(Gains { x: 0.0, theta: _, x_dot: 0.0, theta_dot: 0.0 }) = self.steering else {
            return *self;
        };
        let theta = self.number(Name::FeedbackTheta).unwrap_or(0.0);
        if self.friction != 0.0 && self.slide == Slide::None {
            return *self;
        }
        let mut draft = self.draft;
        for name in GAINS {
            draft.put(name, None);
        }
        draft.put(Name::TiltGain, Some(Value::Number(-theta)));
        let tilt_gain = self.errors.tilting(-theta);
        Self { steering: Steering::TiltGain, tilt_gain, draft, ..*self }
    }

    /// The same scene with a table that does not err at random.
    #[must_use]
    pub fn without_noise(&self) -> Self {
        Self { noise: None, ..*self }
    }

    /// Vertices of a polygon as they were given.
    pub fn vertices(&self) -> Option<&Vertices> {
        self.draft.vertices()
    }

    /// Tells whether the strikes of the table depend on the energy.
    pub fn steers_energy(&self) -> bool {
        self.target_height.is_some()
    }

    /// Target height of strike `n`, m, if the table steers the energy.
    pub fn target_height(&self, n: u64) -> Option<f64> {
        self.program.map_or(self.target_height, |program| Some(program.at(n)))
    }

    /// Target heights of the strikes, m, if the table steers the energy to more than one.
    pub fn program(&self) -> Option<&HeightProgram> {
        self.program.as_ref()
    }

    /// G = g sin φ, gravity in the plane of motion, m/s².
    pub fn gravity(&self) -> f64 {
        self.gravity
    }

    /// Release that starts the run.
    pub fn release(&self) -> &Release {
        &self.release
    }

    /// Angle and velocities at release.
    pub fn start(&self) -> &State {
        &self.release.state
    }
}

/// Stands in for a body with errors until they are returned.
const UNKNOWN: BodyShape = BodyShape::Rod { contact_distance: f64::NAN, radius_of_gyration: f64::NAN };

impl Draft {
    /// A number that has to be there. Its absence is one of the errors, and NaN stands in until they are returned.
    pub(super) fn required(&self, name: Name, errors: &mut Vec<FieldError>) -> f64 {
        self.number(name).unwrap_or_else(|| {
            errors.push(FieldError::missing(name));
            f64::NAN
        })
    }

    /// The alternative that a field names by its word. Its absence is one of the errors.
    pub(super) fn chosen<T: Named>(&self, name: Name, errors: &mut Vec<FieldError>) -> T {
        self.word(name).unwrap_or_else(|| {
            errors.push(FieldError::missing(name));
            T::FIRST
        })
    }

    /// The scene, with defaults. Fails with every field that is missing, contradicts another, or cannot be.
    pub fn build(mut self) -> Result<Scene, Vec<FieldError>> {
        let mut errors = Vec::new();
        for row in &FIELDS {
            if let Some(default) = row.default {
                self.fill(row.name, default);
            }
        }
        let [angle_bias, tilt_offset, tilt_gain, speed, offset] = ERRORS.map(|name| self.number(name).unwrap_or(0.0));
        let off = TableErrors { angle_bias, tilt_offset, tilt_gain, speed, offset };
        let (body, outline) = self.body(&off, &mut errors);
        let strike = self.chosen(Name::Strike, &mut errors);
        let energy_feedback = self.energy_feedback();
        let (target_height, program) = self.targets(strike, &mut errors);
        let assumed_restitution = self.number(Name::AssumedRestitution);
        if strike == Striking::Still && assumed_restitution.is_some() {
            let detail = "assumed_restitution moves the table and strike says `still`; leave one of them out";
            errors.push(FieldError::new(Name::AssumedRestitution, detail));
        }
        let steering = self.steering(&mut errors);
        if strike == Striking::Still && off.speed != 0.0 {
            let detail = "errors.speed is of a table that moves and strike says `still`; leave one of them out";
            errors.push(FieldError::new(Name::SpeedError, detail));
        }
        let slide = self.chosen(Name::Slide, &mut errors);
        let (delay, prediction) = self.delay(&mut errors);
        self.check_air(body, &mut errors);
        let noise = self.noise(if prediction == Prediction::Flight { delay } else { 0.0 }, &mut errors);
        let lag = if prediction == Prediction::None { delay } else { 0.0 };
        for name in [Name::FeedbackThetaDot, Name::ThetaDotSd] {
            if body == BodyShape::Point && self.number(name).is_some_and(|number| number != 0.0) {
                let path = name.row().path;
                let detail =
                    format!("{path} is for a body that turns; a point mass has the angle of its velocity alone");
                errors.push(FieldError::new(name, detail));
            }
        }
        let restitution = self.required(Name::Restitution, &mut errors);
        let turning = self.turning(noise, &mut errors);
        let moves_wrong = off.speed != 0.0 && strike == Striking::Compensated;
        let mut scene = Scene {
            body,
            outline,
            gravity: 0.0,
            incline: self.required(Name::Incline, &mut errors),
            restitution,
            friction: self.required(Name::Friction, &mut errors),
            law: self.chosen(Name::Law, &mut errors),
            slide,
            steering,
            tilt_gain: 0.0,
            assumed_restitution: if moves_wrong {
                Some(off.effective_restitution(assumed_restitution.unwrap_or(restitution)))
            } else {
                assumed_restitution
            },
            energy_gain: off.moving(self.required(Name::EnergyGain, &mut errors)),
            energy_feedback,
            target_height,
            program,
            strike,
            release: self.release(body, outline.as_ref(), &mut errors),
            topple_angle: self.required(Name::ToppleAngle, &mut errors),
            limits: self.limits(),
            half_length: self.number(Name::TableLength).map_or(f64::INFINITY, |length| 0.5 * length),
            noise,
            lag,
            prediction,
            errors: off,
            constant_tilt: 0.0,
            turning,
            drag: None,
            draft: self,
        };
        if !errors.is_empty() {
            return Err(errors);
        }
        let Body { rod, steering, constant_tilt, drag, .. } = scene.body_in();
        (scene.gravity, scene.tilt_gain) = (rod.gravity, rod.tilt_gain);
        (scene.steering, scene.constant_tilt, scene.drag) = (steering, constant_tilt, drag);
        Ok(scene)
    }

    /// The target height of the first strike, and those of all strikes where they differ; `None` if nothing steers the energy. Refuses
    /// what contradicts the table's strike, or another field of the energy feedback.
    fn targets(&self, strike: Striking, errors: &mut Vec<FieldError>) -> (Option<f64>, Option<HeightProgram>) {
        let gain = self.number(Name::EnergyGain).unwrap_or(0.0);
        let one_strike = self.energy_feedback() == EnergyFeedback::OneStrike;
        let mut refuse = |name, detail: &str| errors.push(FieldError::new(name, detail));
        if one_strike {
            if gain != 0.0 {
                let detail = "energy_gain belongs to energy_law `proportional`; energy_law says `one_strike`, which has no gain: \
                              leave one of them out";
                refuse(Name::EnergyGain, detail);
            }
            if self.word(Name::EnergyMeasure) == Some(EnergyMeasure::Vertical) {
                let detail = "energy_measure is `vertical` and energy_law `one_strike` brings the total energy to its target; say \
                              `total`, or leave one of them out";
                refuse(Name::EnergyMeasure, detail);
            }
            if strike == Striking::Still {
                let detail = "energy_law `one_strike` moves the table and strike says `still`; leave one of them out";
                refuse(Name::EnergyLaw, detail);
            }
        } else if gain != 0.0 && strike == Striking::Still {
            refuse(Name::EnergyGain, "energy_gain moves the table and strike says `still`; leave one of them out");
        }
        let (height, program) = (self.number(Name::TargetHeight), self.program());
        if let (Some(height), Some(_)) = (height, program) {
            let detail =
                format!("target_height ({height} m) and program both say where to steer; leave one of them out");
            errors.push(FieldError { path: Name::Program.row().path, detail, kind: FieldErrorKind::TwoTargets });
        }
        let steers = one_strike || gain != 0.0;
        let first = height.or(program.map(|program| program.at(1)));
        if steers && first.is_none() {
            let law =
                if one_strike { "energy_law `one_strike`".to_owned() } else { format!("energy_gain {gain} s²/m²") };
            let limits = Name::TargetHeight.row().limits();
            let detail = format!("target_height is missing: {law} needs the height it steers to; {limits}");
            errors.push(FieldError::new(Name::TargetHeight, detail));
        }
        let varied = program.filter(|program| program.heights().iter().any(|height| *height != program.at(1)));
        (first.filter(|_| steers), varied.filter(|_| steers))
    }

    /// The energy feedback by its law and its measure, which has no effect without a gain.
    fn energy_feedback(&self) -> EnergyFeedback {
        match (self.word(Name::EnergyLaw), self.word(Name::EnergyMeasure)) {
            (Some(EnergyLaw::OneStrike), _) => EnergyFeedback::OneStrike,
            (None | Some(EnergyLaw::Proportional), None | Some(EnergyMeasure::Vertical)) => EnergyFeedback::Vertical,
            (None | Some(EnergyLaw::Proportional), Some(EnergyMeasure::Total)) => EnergyFeedback::Total,
        }
    }

    fn program(&self) -> Option<HeightProgram> {
        match self.get(Name::Program) {
            Some(Value::Numbers(program)) => Some(program),
            _ => None,
        }
    }

    /// The alternative that a field names by its word, if it has a value.
    fn word<T: Named>(&self, name: Name) -> Option<T> {
        match self.get(name) {
            Some(Value::Choice(word)) => T::named(word),
            _ => None,
        }
    }

    /// Law by which the table tilts, without the error of its gains: a tilt gain, or state feedback, in which gains that are not given are 0.
    fn steering(&mut self, errors: &mut Vec<FieldError>) -> Steering {
        let Some(said) = GAINS.into_iter().find(|&name| self.get(name).is_some()) else {
            self.required(Name::TiltGain, errors);
            return Steering::TiltGain;
        };
        if self.get(Name::TiltGain).is_some() {
            let feedback = said.row().path;
            let detail = format!("tilt_gain and {feedback} both say how the table tilts; leave one of them out");
            let kind = FieldErrorKind::TwoTiltLaws;
            errors.push(FieldError { path: Name::TiltGain.row().path, detail, kind });
        }
        for name in GAINS {
            self.fill(name, Value::Number(0.0));
        }
        Steering::Feedback(Gains::default())
    }

    /// The turning table. `None` if it does not turn as it strikes, and if it turns about the contact.
    fn turning(&self, noise: Option<Noise>, errors: &mut Vec<FieldError>) -> Option<TurningTable> {
        let rate = self.word::<TiltRate>(Name::TiltRate).filter(|rate| *rate != TiltRate::None)?;
        let is_corrected = rate == TiltRate::Corrected;
        if noise.is_some_and(|noise| noise.model == NoiseModel::Plan) {
            let detail = format!(
                "tilt_rate `{}` is of a table that follows the body, and noise.model `plan` of one that holds what it has planned; \
                 leave one of them out",
                rate.name()
            );
            errors.push(FieldError::new(Name::TiltRate, detail));
        }
        let (place, depth) = (self.number(Name::PivotX), self.number(Name::PivotDepth).unwrap_or(0.0));
        (place.is_some() || depth != 0.0).then_some(TurningTable { place, depth, is_corrected })
    }

    fn check_air(&self, body: BodyShape, errors: &mut Vec<FieldError>) {
        if body == BodyShape::Point && self.number(Name::RotationDrag).is_some_and(|rate| rate != 0.0) {
            let detail = "air.rotation_drag is for a body that turns; a point mass has no angle of its own";
            errors.push(FieldError::new(Name::RotationDrag, detail));
        }
        if self.number(Name::Wind).is_some_and(|wind| wind != 0.0) && self.number(Name::Drag).is_none() {
            let detail = "air.wind acts by the drag of the air; give air.drag too, or leave the wind out";
            errors.push(FieldError::new(Name::Wind, detail));
        }
    }

    /// Noise with its defaults filled in; `None` if all standard deviations are 0. Errors of velocities grow while the table carries the
    /// state on for a time `ahead` (s), and decay in air that drags the body.
    fn noise(&mut self, ahead: f64, errors: &mut Vec<FieldError>) -> Option<Noise> {
        let sd = |name| self.number(name).unwrap_or(0.0);
        let noise = Noise {
            timing_sd: sd(Name::TimingSd),
            angle_sd: sd(Name::AngleSd),
            x_sd: sd(Name::XSd),
            x_dot_sd: sd(Name::XDotSd),
            y_dot_sd: sd(Name::YDotSd),
            theta_dot_sd: sd(Name::ThetaDotSd),
            restitution_sd: sd(Name::RestitutionSd),
            ..Noise::NONE
        };
        if noise == Noise::NONE {
            return None;
        }
        self.fill(Name::NoiseModel, Value::Choice(NoiseModel::FIRST.name()));
        let model = self.chosen(Name::NoiseModel, errors);
        let [seed, run] = [Name::Seed, Name::NoiseRun].map(|name| {
            self.fill(name, Value::Integer(0));
            match self.get(name) {
                Some(Value::Integer(number)) => number,
                _ => 0,
            }
        });
        let decays = self.number(Name::Drag).is_some_and(|drag| drag != 0.0);
        let grows = noise.x_dot_sd != 0.0 || noise.theta_dot_sd != 0.0 || (decays && noise.y_dot_sd != 0.0);
        Some(Noise { horizon: if grows { ahead } else { 0.0 }, model, seed, run, ..noise })
    }

    /// Time from sensing to the strike, s, and the use that the table makes of it, with its default filled in if there is a delay.
    fn delay(&mut self, errors: &mut Vec<FieldError>) -> (f64, Prediction) {
        let delay = self.number(Name::Delay).unwrap_or(0.0);
        if delay == 0.0 {
            return (0.0, Prediction::None);
        }
        self.fill(Name::Prediction, Value::Choice(Prediction::FIRST.name()));
        (delay, self.chosen(Name::Prediction, errors))
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

    fn body(&mut self, off: &TableErrors, errors: &mut Vec<FieldError>) -> (BodyShape, Option<Outline>) {
        let lengths = [Name::ContactDistance, Name::RadiusOfGyration];
        let said = |name: &Name| self.get(*name).is_some();
        if self.is_point() {
            for name in lengths.into_iter().chain([Name::ContactVertex, Name::Offset]).filter(said) {
                let key = name.row().key();
                errors.push(FieldError::new(name, format!("a point mass has no {key}; leave one of them out")));
            }
            if self.vertices.is_some() {
                errors.push(FieldError::at(VERTICES, "a point mass has no vertices; leave one of them out"));
            }
            return (BodyShape::Point, None);
        }
        if let Some(vertices) = self.vertices {
            for name in lengths.into_iter().chain([Name::Offset]).filter(said) {
                let key = name.row().key();
                let detail = format!("{key} follows from vertices, which are given too; leave one of them out");
                errors.push(FieldError::new(name, detail));
            }
            return self.polygon(&vertices, errors).map_or((UNKNOWN, None), |outline| {
                let (contact_distance, radius_of_gyration) = (outline.contact_distance, outline.radius_of_gyration);
                (BodyShape::Rod { contact_distance, radius_of_gyration }, Some(outline))
            });
        }
        if said(&Name::ContactVertex) {
            let detail =
                "contact_vertex is one of a polygon's vertices, and there are none; give vertices, or leave it out";
            errors.push(FieldError::new(Name::ContactVertex, detail));
        }
        if !lengths.iter().any(said) {
            let detail =
                "body is missing: give contact_distance and radius_of_gyration in m, vertices, or {\"point\": true}";
            errors.push(FieldError::at("body", detail));
            return (UNKNOWN, None);
        }
        let contact_distance = off.contact_distance(self.required(Name::ContactDistance, errors));
        let radius_of_gyration = self.required(Name::RadiusOfGyration, errors);
        (BodyShape::Rod { contact_distance, radius_of_gyration }, None)
    }

    /// Outline of a polygon; None if the vertices make no body. The default contact vertex is the lowest.
    fn polygon(&mut self, vertices: &Vertices, errors: &mut Vec<FieldError>) -> Option<Outline> {
        let contact_vertex = match self.get(Name::ContactVertex) {
            Some(Value::Integer(vertex)) => Ok(vertex as usize),
            _ => vertices.lowest(),
        };
        let outline = contact_vertex.and_then(|vertex| {
            self.put(Name::ContactVertex, Some(Value::Integer(vertex as u64)));
            Outline::new(vertices, vertex)
        });
        let path = |error: &PolygonError| match error.is_of_contact_vertex {
            true => Name::ContactVertex.row().path,
            false => VERTICES,
        };
        outline.map_err(|error| errors.push(FieldError::at(path(&error), error.to_string()))).ok()
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
                    self.put(name, None);
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
