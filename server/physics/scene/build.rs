//! Builds a scene from a draft: fills in defaults and refuses fields that are missing or contradict one another.

use super::Striking;
use super::draft::{Draft, VERTICES};
use super::error::{FieldError, FieldErrorKind};
use super::fields::{ERRORS, FIELDS, GAINS, NOISE, Name, Value};
use crate::Named;
use crate::map::body::{Body, Release};
use crate::map::friction::Slide;
use crate::map::polygon::{FLUSH, Outline, PolygonError, Vertices};
use crate::map::strike::{EnergyFeedback, EnergyLaw, EnergyMeasure, Rod, State};
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
    /// The body of its runs, with the constant errors of the rig in its gains, its laws and its lengths.
    pub(crate) running_model: Body,
    pub(crate) release: Release,
    pub(super) draft: Draft,
}

impl Scene {
    /// Value of a field, defaults included; None if the field does not apply.
    pub fn value(&self, name: Name) -> Option<Value> {
        self.draft.get(name)
    }

    /// Value of a field that is a number.
    pub fn number(&self, name: Name) -> Option<f64> {
        self.draft.number(name)
    }

    /// Draft of this scene with all defaults, to change a field and build again.
    pub fn draft(&self) -> Draft {
        self.draft
    }

    /// The same scene with other numbers in fields, or without a value. Fails with the reason in a sentence.
    pub(crate) fn with(&self, values: impl IntoIterator<Item = (Name, Option<f64>)>) -> Result<Self, String> {
        let draft = self.draft.with(values).map_err(|error| error.detail)?;
        draft.build().map_err(|errors| errors.into_iter().next().map_or_else(String::new, |error| error.detail))
    }

    /// Tells whether the body is a point mass.
    pub(crate) fn is_point(&self) -> bool {
        self.running_model.is_point
    }

    /// Outline, if the body is a polygon.
    pub fn outline(&self) -> Option<&Outline> {
        self.running_model.outline.as_ref()
    }

    /// The same scene with the rod of the same l and ρ in place of a polygon. Fails with the fields that refuse it.
    pub fn as_rod(&self) -> Result<Self, Vec<FieldError>> {
        let Some(Outline { contact_distance, radius_of_gyration, .. }) = self.running_model.outline else {
            return Ok(*self);
        };
        let mut draft = self.draft;
        draft.set_vertices(None);
        draft.put(Name::ContactVertex, None);
        draft.put(Name::ContactDistance, Some(Value::Number(contact_distance)));
        draft.put(Name::RadiusOfGyration, Some(Value::Number(radius_of_gyration)));
        draft.build()
    }

    /// The same scene with a tilt gain, κ = −K_θ, in place of a state feedback of θ alone, which is the same law; other scenes as they are.
    /// Friction on a table that only tilts is left as it is: nothing drifts or circles there.
    pub fn with_tilt_law(&self) -> Self {
        let Steering::Feedback(Gains { x: 0.0, theta: _, x_dot: 0.0, theta_dot: 0.0 }) = self.running_model.steering
        else {
            return *self;
        };
        let theta = self.number(Name::FeedbackTheta).unwrap_or(0.0);
        if self.running_model.friction.is_some_and(|friction| friction.slide == Slide::None) {
            return *self;
        }
        let mut draft = self.draft;
        for name in GAINS {
            draft.put(name, None);
        }
        draft.put(Name::TiltGain, Some(Value::Number(-theta)));
        let Body { rod, .. } = self.running_model;
        let rod = Rod { tilt_gain: self.table_errors().tilting(-theta), ..rod };
        Self { running_model: Body { rod, steering: Steering::TiltGain, ..self.running_model }, draft, ..*self }
    }

    /// The same scene with a table that does not err at random.
    #[must_use]
    pub fn without_noise(&self) -> Self {
        Self { running_model: Body { noise: None, ..self.running_model }, ..*self }
    }

    /// Vertices of a polygon as they were given.
    pub fn vertices(&self) -> Option<&Vertices> {
        self.draft.vertices()
    }

    /// Tells whether the strikes of the table depend on the energy.
    pub fn steers_energy(&self) -> bool {
        self.draft.steers_energy()
    }

    /// Target height of strike `n`, m, if the table steers the energy.
    pub fn target_height(&self, n: u64) -> Option<f64> {
        self.draft.target(n).filter(|_| self.steers_energy())
    }

    /// Target heights of the strikes, m, if the table steers the energy to more than one.
    pub fn program(&self) -> Option<&HeightProgram> {
        self.running_model.program.as_ref()
    }

    /// G = g sin φ, gravity in the plane of motion, m/s².
    pub fn gravity(&self) -> f64 {
        self.running_model.rod.gravity
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

/// Stands for the numbers of a body until its fields are known to be there.
const UNKNOWN: Rod = Rod::lossless(f64::NAN, f64::NAN, f64::NAN);

impl Draft {
    /// A number that has to be there. Its absence is one of the errors, and NaN stands in until they are returned.
    fn required(&self, name: Name, errors: &mut Vec<FieldError>) -> f64 {
        self.number(name).unwrap_or_else(|| {
            errors.push(FieldError::missing(name));
            f64::NAN
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
        let (rod, outline) = self.body(&mut errors);
        self.check_energy(&mut errors);
        let stands_still = self.word::<Striking>(Name::Strike) == Striking::Still;
        if stands_still && self.number(Name::AssumedRestitution).is_some() {
            let detail = "assumed_restitution moves the table and strike says `still`; leave one of them out";
            errors.push(FieldError::new(Name::AssumedRestitution, detail));
        }
        let steering = self.steering(&mut errors);
        if stands_still && self.is_set(Name::SpeedError) {
            let detail = "errors.speed is of a table that moves and strike says `still`; leave one of them out";
            errors.push(FieldError::new(Name::SpeedError, detail));
        }
        self.check_air(&mut errors);
        if self.is_set(Name::Delay) {
            self.fill(Name::Prediction, Value::Choice(Prediction::FIRST.name()));
        }
        let noise = self.noise();
        if self.is_point() {
            for name in [Name::FeedbackThetaDot, Name::ThetaDotSd].into_iter().filter(|&name| self.is_set(name)) {
                let path = name.row().path;
                let detail =
                    format!("{path} is for a body that turns; a point mass has the angle of its velocity alone");
                errors.push(FieldError::new(name, detail));
            }
        }
        let turning = self.turning(noise, &mut errors);
        self.check_release(&rod, outline.as_ref(), &mut errors);
        if !errors.is_empty() {
            return Err(errors);
        }
        let is_varied = |program: &HeightProgram| program.heights().iter().any(|height| *height != program.at(1));
        let parts = Body {
            is_point: self.is_point(),
            steering,
            turning,
            program: self.program().filter(|program| is_varied(program) && self.steers_energy()),
            noise,
            outline,
            ..Body::plain(Rod { energy_feedback: self.energy_feedback(), ..rod })
        };
        let scene = Scene { running_model: parts, release: Release::default(), draft: self };
        Ok(Scene { running_model: scene.body_in(), release: scene.release_by(|_, value| value), ..scene })
    }

    /// The constant errors of the rig.
    pub(super) fn table_errors(&self) -> TableErrors {
        TableErrors::of(ERRORS.map(|name| self.number(name).unwrap_or(0.0)))
    }

    /// Tells whether a field has a number other than 0.
    pub(super) fn is_set(&self, name: Name) -> bool {
        self.number(name).is_some_and(|number| number != 0.0)
    }

    /// The first of these fields that has a number other than 0.
    pub(super) fn first_set(&self, names: &[Name]) -> Option<Name> {
        names.iter().copied().find(|&name| self.is_set(name))
    }

    /// Refuses what contradicts the table's strike, or another field of the energy feedback, and a target that is missing.
    fn check_energy(&self, errors: &mut Vec<FieldError>) {
        let gain = self.number(Name::EnergyGain).unwrap_or(0.0);
        let one_strike = self.energy_feedback() == EnergyFeedback::OneStrike;
        let stands_still = self.word::<Striking>(Name::Strike) == Striking::Still;
        let mut refuse = |name, detail: &str| errors.push(FieldError::new(name, detail));
        if one_strike {
            if gain != 0.0 {
                let detail = "energy_gain belongs to energy_law `proportional`; energy_law says `one_strike`, which has no gain: \
                              leave one of them out";
                refuse(Name::EnergyGain, detail);
            }
            if self.get(Name::EnergyMeasure) == Some(Value::Choice(EnergyMeasure::Vertical.name())) {
                let detail = "energy_measure is `vertical` and energy_law `one_strike` brings the total energy to its target; say \
                              `total`, or leave one of them out";
                refuse(Name::EnergyMeasure, detail);
            }
            if stands_still {
                let detail = "energy_law `one_strike` moves the table and strike says `still`; leave one of them out";
                refuse(Name::EnergyLaw, detail);
            }
        } else if gain != 0.0 && stands_still {
            refuse(Name::EnergyGain, "energy_gain moves the table and strike says `still`; leave one of them out");
        }
        if let (Some(height), Some(_)) = (self.number(Name::TargetHeight), self.program()) {
            let detail =
                format!("target_height ({height} m) and program both say where to steer; leave one of them out");
            errors.push(FieldError { path: Name::Program.row().path, detail, kind: FieldErrorKind::SaidTwice });
        }
        if self.steers_energy() && self.target(1).is_none() {
            let law =
                if one_strike { "energy_law `one_strike`".to_owned() } else { format!("energy_gain {gain} s²/m²") };
            let limits = Name::TargetHeight.row().limits();
            let detail = format!("target_height is missing: {law} needs the height it steers to; {limits}");
            errors.push(FieldError::new(Name::TargetHeight, detail));
        }
    }

    /// The energy feedback by its law and its measure, which has no effect without a gain.
    fn energy_feedback(&self) -> EnergyFeedback {
        match (self.word(Name::EnergyLaw), self.word(Name::EnergyMeasure)) {
            (EnergyLaw::OneStrike, _) => EnergyFeedback::OneStrike,
            (EnergyLaw::Proportional, EnergyMeasure::Vertical) => EnergyFeedback::Vertical,
            (EnergyLaw::Proportional, EnergyMeasure::Total) => EnergyFeedback::Total,
        }
    }

    pub(super) fn steers_energy(&self) -> bool {
        self.energy_feedback() == EnergyFeedback::OneStrike || self.is_set(Name::EnergyGain)
    }

    /// Height to which the table steers at strike `n`, m, if it does.
    pub(super) fn target(&self, n: u64) -> Option<f64> {
        self.number(Name::TargetHeight).or(self.program().map(|program| program.at(n)))
    }

    fn program(&self) -> Option<HeightProgram> {
        match self.get(Name::Program) {
            Some(Value::Numbers(program)) => Some(program),
            _ => None,
        }
    }

    /// The alternative that a field names by its word; the first one of a field without a value.
    pub(super) fn word<T: Named>(&self, name: Name) -> T {
        match self.get(name) {
            Some(Value::Choice(word)) => T::named(word).unwrap_or(T::FIRST),
            _ => T::FIRST,
        }
    }

    /// Law by which the table tilts, without its numbers: a tilt gain, or state feedback, in which gains that are not given are 0.
    fn steering(&mut self, errors: &mut Vec<FieldError>) -> Steering {
        let Some(said) = GAINS.into_iter().find(|&name| self.get(name).is_some()) else {
            self.required(Name::TiltGain, errors);
            return Steering::TiltGain;
        };
        if self.get(Name::TiltGain).is_some() {
            let feedback = said.row().path;
            let detail = format!("tilt_gain and {feedback} both say how the table tilts; leave one of them out");
            let kind = FieldErrorKind::SaidTwice;
            errors.push(FieldError { path: Name::TiltGain.row().path, detail, kind });
        }
        for name in GAINS {
            self.fill(name, Value::Number(0.0));
        }
        Steering::Feedback(Gains::default())
    }

    /// The turning table. `None` if it does not turn as it strikes, and if it turns about the contact.
    fn turning(&self, noise: Option<Noise>, errors: &mut Vec<FieldError>) -> Option<TurningTable> {
        let rate: TiltRate = self.word(Name::TiltRate);
        if rate == TiltRate::None {
            return None;
        }
        if noise.is_some_and(|noise| noise.model == NoiseModel::Plan) {
            let detail = format!(
                "tilt_rate `{}` is of a table that follows the body, and noise.model `plan` of one that holds what it has planned; \
                 leave one of them out",
                rate.name()
            );
            errors.push(FieldError::new(Name::TiltRate, detail));
        }
        let (place, depth) = (self.number(Name::PivotX), self.number(Name::PivotDepth).unwrap_or(0.0));
        let is_corrected = rate == TiltRate::Corrected;
        (place.is_some() || depth != 0.0).then_some(TurningTable { place, depth, is_corrected })
    }

    fn check_air(&self, errors: &mut Vec<FieldError>) {
        if self.is_point() && self.is_set(Name::RotationDrag) {
            let detail = "air.rotation_drag is for a body that turns; a point mass has no angle of its own";
            errors.push(FieldError::new(Name::RotationDrag, detail));
        }
        if self.is_set(Name::Wind) && self.number(Name::Drag).is_none() {
            let detail = "air.wind acts by the drag of the air; give air.drag too, or leave the wind out";
            errors.push(FieldError::new(Name::Wind, detail));
        }
    }

    /// Noise with its defaults filled in; `None` if all standard deviations are 0. Errors of velocities grow while the table carries the state on,
    /// and decay in air that drags the body.
    fn noise(&mut self) -> Option<Noise> {
        self.first_set(&NOISE)?;
        let [timing_sd, angle_sd, x_sd, x_dot_sd, y_dot_sd, theta_dot_sd, restitution_sd] =
            NOISE.map(|name| self.number(name).unwrap_or(0.0));
        let noise =
            Noise { timing_sd, angle_sd, x_sd, x_dot_sd, y_dot_sd, theta_dot_sd, restitution_sd, ..Noise::NONE };
        self.fill(Name::NoiseModel, Value::Choice(NoiseModel::FIRST.name()));
        let [seed, run] = [Name::Seed, Name::NoiseRun].map(|name| {
            self.fill(name, Value::Integer(0));
            match self.get(name) {
                Some(Value::Integer(number)) => number,
                _ => 0,
            }
        });
        let grows = x_dot_sd != 0.0 || theta_dot_sd != 0.0 || (self.is_set(Name::Drag) && y_dot_sd != 0.0);
        let is_carried_on = self.is_set(Name::Delay) && self.word::<Prediction>(Name::Prediction) == Prediction::Flight;
        let horizon = self.number(Name::Delay).filter(|_| grows && is_carried_on).unwrap_or(0.0);
        Some(Noise { horizon, model: self.word(Name::NoiseModel), seed, run, ..noise })
    }

    /// The rod of the body without its table, and the outline of a polygon.
    fn body(&mut self, errors: &mut Vec<FieldError>) -> (Rod, Option<Outline>) {
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
            return (UNKNOWN, None);
        }
        if let Some(vertices) = self.vertices {
            for name in lengths.into_iter().chain([Name::Offset]).filter(said) {
                let key = name.row().key();
                let detail = format!("{key} follows from vertices, which are given too; leave one of them out");
                errors.push(FieldError::new(name, detail));
            }
            return self.polygon(&vertices, errors).map_or((UNKNOWN, None), |outline| {
                let Outline { contact_distance, radius_of_gyration, .. } = outline;
                (Rod { contact_distance, radius_of_gyration, ..UNKNOWN }, Some(outline))
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
        let [along, radius_of_gyration] = lengths.map(|name| self.required(name, errors));
        let contact_distance = self.table_errors().contact_distance(along);
        (Rod { contact_distance, radius_of_gyration, ..UNKNOWN }, None)
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

    /// Refuses a release below the table, and takes the angle off that of a point mass.
    fn check_release(&mut self, rod: &Rod, outline: Option<&Outline>, errors: &mut Vec<FieldError>) {
        let height = self.required(Name::Height, errors);
        if self.is_point() {
            for name in [Name::Theta, Name::ThetaDot] {
                if self.is_set(name) {
                    let detail = format!("a point mass has no {}; leave it out", name.row().key());
                    errors.push(FieldError::new(name, detail));
                }
                self.put(name, None);
            }
            return;
        }
        let theta = self.number(Name::Theta).unwrap_or(0.0);
        let sin_cos = trig::sin_cos(theta);
        let contact_height = rod.contact_distance * sin_cos.1;
        if contact_height - height > 4.0 * f64::EPSILON * contact_height.abs().max(height) {
            let detail = format!(
                "height is {height} m, which puts the contact point {} m below the table; at theta {theta} rad it must be at least \
                 {contact_height} m",
                contact_height - height
            );
            errors.push(FieldError::new(Name::Height, detail));
        } else if let Some(nearest) = outline.map(|outline| outline.nearest(sin_cos))
            && height - contact_height + nearest.clearance < -FLUSH * rod.contact_distance
        {
            let least = contact_height - nearest.clearance;
            let detail = format!(
                "height is {height} m, which puts vertex {} {} m below the table; at theta {theta} rad it must be at least {least} m",
                nearest.vertex,
                least - height
            );
            errors.push(FieldError::new(Name::Height, detail));
        }
    }
}
