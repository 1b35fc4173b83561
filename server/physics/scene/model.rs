//! Chooses the smallest model that is exact for a scene, and says why.

use crate::body::Body;
use crate::body::NoContact;
use crate::body::polygon::Outline;
use crate::bounce::friction::{Friction, Slide};
use crate::bounce::rod::Rod;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::number::Number;
use crate::run::extended::ExtendedOrbit;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::energy::energy_reason;
use crate::scene::{BodyShape, FieldError, Name, Scene, Striking, VERTICES};
use crate::table::control_law::Steering;
use crate::table::noise::Noise;
use crate::table::pivot::TurningTable;

/// The levels of the model hierarchy, from the simplest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ModelLevel {
    /// A point mass: a ladder of its own.
    Point,
    /// The angle block of the linearized rod, in closed form.
    Linear,
    /// The rod without friction, on a table that looks at its angle and velocities.
    Rod,
    /// The rod without friction, on a table that also senses its position.
    RodWithX,
    /// On a rig with constant errors: of what the table senses and does, and of the place of the centre of gravity.
    RigErrors,
    /// On a table that turns as it strikes.
    Turning,
    /// On a table that strikes by the state of an earlier moment.
    Delay,
    /// Through air that drags the body in flight.
    Drag,
    /// The rod on a table with friction, or that moves along itself.
    Friction,
    /// On a table that errs at random in time or in what it senses, or with a restitution that scatters.
    Noise,
    /// With the vertices of a polygon, any of which may touch the table.
    Polygon,
}

impl ModelLevel {
    /// Name in answers.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Linear => "linear",
            Self::Rod => "rod",
            Self::RodWithX => "rod_with_x",
            Self::RigErrors => "rig_errors",
            Self::Turning => "turning_table",
            Self::Delay => "delay",
            Self::Drag => "drag",
            Self::Friction => "friction",
            Self::Noise => "noise",
            Self::Polygon => "polygon",
        }
    }

    /// Cost of an impact, ns of one core as it was when this table was measured (AMD EPYC, Zen 4, 3.0 GHz; `cargo bench --bench
    /// bounce levels`). Fixed, so that the same question gets the same answer.
    pub fn cost_ns(self) -> f64 {
        match self {
            Self::Point => 135.0,
            Self::Linear => 120.0,
            Self::Rod => 86.0,
            Self::RodWithX | Self::RigErrors | Self::Turning => 112.0,
            Self::Friction => 107.0,
            Self::Noise | Self::Delay => 195.0,
            Self::Drag => 900.0,
            Self::Polygon => 130.0,
        }
    }
}

/// A step of the ladder that a scene asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelRequirement {
    /// The level.
    pub level: ModelLevel,
    /// The field that asked for it.
    pub path: &'static str,
    /// A sentence that says why the field needs that level.
    pub detail: String,
}

impl Scene {
    /// The smallest model that is exact for the bounces of this scene.
    ///
    /// The outline of a polygon is not in it: it ends runs and changes no bounce, so that what is derived for one holds. Neither is a turning
    /// of the table that moves its surface and no body.
    pub fn model(&self) -> Body {
        self.model_of(self.noise, self.acting_turn(), None)
    }

    /// The smallest model that is exact for the runs of this scene, and for where they end.
    pub fn running_model(&self) -> Body {
        self.model_of(self.noise, self.turning, self.outline)
    }

    fn model_of<N: Number>(
        &self,
        noise: Option<Noise>,
        turning: Option<TurningTable>,
        outline: Option<Outline>,
    ) -> Body<N> {
        if self.body == BodyShape::Point {
            return Body { program: self.program, ..Body::point(self.parameters()) };
        }
        Body { noise, turning, outline, ..self.general_body() }
    }

    /// The body of its bounces with all its parts but the outline, in any kind of number; of a point mass, a rod of no length.
    pub fn general_body<N: Number>(&self) -> Body<N> {
        Body {
            rod: self.parameters(),
            is_point: self.body == BodyShape::Point,
            steering: self.steering,
            constant_tilt: self.constant_tilt,
            turning: self.turning,
            program: self.program,
            friction: self.contact_friction(),
            noise: self.noise,
            lag: self.lag,
            drag: self.drag,
            outline: None,
        }
    }

    /// The parameters of its strikes and flights in any kind of number: what is derived from the fields is derived in it. A
    /// point mass has those of a rod of no length.
    pub fn parameters<N: Number>(&self) -> Rod<N> {
        let number = N::from_f64;
        let off = &self.errors;
        let told = |name, acted: f64| number(self.number(name).unwrap_or(acted));
        let (contact_distance, radius_of_gyration) = match self.body {
            BodyShape::Rod { contact_distance, radius_of_gyration } if off.offset != 0.0 => {
                (off.contact_distance(told(Name::ContactDistance, contact_distance)), radius_of_gyration)
            }
            BodyShape::Rod { contact_distance, radius_of_gyration } => (number(contact_distance), radius_of_gyration),
            BodyShape::Point => (number(0.0), 1.0),
        };
        let restitution = number(self.restitution);
        let one_and_restitution = number(1.0) + restitution;
        let gravity = number(self.full_gravity) * number(self.incline).sincos().0;
        Rod {
            contact_distance,
            radius_of_gyration: number(radius_of_gyration),
            gravity,
            restitution,
            tilt_gain: match self.steering {
                Steering::TiltGain => off.tilting(told(Name::TiltGain, self.tilt_gain)),
                Steering::Feedback(_) => number(self.tilt_gain),
            },
            strike_gain: match self.strike {
                // γ = (1 + e)(1 − w/v_nc).
                Striking::Compensated if off.speed != 0.0 => {
                    one_and_restitution * (number(1.0) + off.make_up(number(self.told_restitution())))
                }
                Striking::Compensated => match self.assumed_restitution {
                    // P = −(1 + e)(v_nc − v_table)/B with the table's velocity by ê.
                    Some(assumed) if assumed != self.restitution => {
                        number(2.0) * one_and_restitution / (number(1.0) + number(assumed))
                    }
                    _ => number(2.0),
                },
                Striking::Still => one_and_restitution,
            },
            strike_gain_per_energy: one_and_restitution * off.moving(told(Name::EnergyGain, self.energy_gain)),
            target_energy: gravity * number(self.target_height.unwrap_or(0.0)),
            energy_feedback: self.energy_feedback,
        }
    }

    /// Rules that end its runs.
    pub fn rules(&self) -> Rules {
        Rules {
            topple_angle: match self.body {
                BodyShape::Rod { .. } => self.topple_angle,
                BodyShape::Point => f64::INFINITY,
            },
            settles: !self.keeps_energy()
                || self.friction != 0.0
                || self.acting_turn().is_some()
                || self.drag.is_some()
                || self.errs_in_energy(),
            holds_energy: self.keeps_energy()
                && !self.is_rough()
                && self.noise.is_none()
                && self.acting_turn().is_none()
                && self.drag.is_none()
                && self.lag == 0.0,
            limits: self.limits,
            half_length: self.half_length,
        }
    }

    /// Restitution that the table assumes; with an error of its speed, the one by which it acts.
    pub fn assumed_restitution(&self) -> f64 {
        self.assumed_restitution.unwrap_or(self.restitution)
    }

    /// Tells whether bounces lose energy for good.
    pub fn is_lossy(&self) -> bool {
        let lost = match self.strike {
            Striking::Still => self.restitution < 1.0,
            Striking::Compensated => self.assumed_restitution() > self.restitution,
        };
        lost && !self.steers_energy()
    }

    /// Tells whether the table takes no energy away. With energy feedback it does where a run has too much, and with a negative gain where it
    /// has too little, down to nothing.
    fn keeps_energy(&self) -> bool {
        !self.is_lossy() && !self.steers_energy()
    }

    /// The friction, if the contact has some or the table moves along itself.
    pub(crate) fn contact_friction(&self) -> Option<Friction> {
        self.is_rough().then_some(Friction { coefficient: self.friction, law: self.law, slide: self.slide })
    }

    /// Tells whether the contact has friction or the table moves along itself.
    pub fn is_rough(&self) -> bool {
        self.friction != 0.0 || self.slide != Slide::None
    }

    /// The first field that takes the scene outside the plain rod and the levels `known`, with a message; `None` if the scene is
    /// within them.
    pub fn beyond(&self, known: &[ModelLevel]) -> Option<FieldError> {
        // Errors that only change gains leave the rod a rod, and so does a turning that changes no bounce.
        let idle = |level| match level {
            ModelLevel::RigErrors => self.constant_tilt == 0.0,
            ModelLevel::Turning => self.acting_turn().is_none(),
            ModelLevel::Polygon => true,
            ModelLevel::Point
            | ModelLevel::Linear
            | ModelLevel::Rod
            | ModelLevel::RodWithX
            | ModelLevel::Delay
            | ModelLevel::Drag
            | ModelLevel::Friction
            | ModelLevel::Noise => false,
        };
        let beyond = |level| !idle(level) && !known.contains(&level);
        let ModelRequirement { level, path, .. } =
            self.requirements().into_iter().find(|requirement| beyond(requirement.level))?;
        let shown = crate::scene::field(path).map_or_else(String::new, |row| self.shown(row.name));
        let feature = match level {
            ModelLevel::Friction => "with friction",
            ModelLevel::Noise => "with noise",
            ModelLevel::Delay => "with a delay that the table does not predict",
            ModelLevel::Drag => "with air that drags the body",
            ModelLevel::RigErrors => "with a constant error of the tilt",
            ModelLevel::Turning => "with a table that turns as it strikes",
            ModelLevel::Rod | ModelLevel::RodWithX => "with state feedback",
            ModelLevel::Point | ModelLevel::Linear | ModelLevel::Polygon => "for this body",
        };
        Some(FieldError::at(path, format!("{path} is {shown}; this is not available {feature} in this version")))
    }

    fn shown(&self, name: Name) -> String {
        self.value(name).map_or_else(String::new, |value| value.to_string())
    }

    /// The run of the scene from its release.
    ///
    /// # Errors
    /// The reason for which there is no first contact.
    pub fn orbit(&self) -> Result<Orbit, NoContact> {
        Orbit::new(self.running_model(), self.rules(), &self.release)
    }

    /// Same as [`Scene::model`], with 31 digits.
    pub fn extended_model(&self) -> Body<DoubleDouble> {
        self.model_of(self.noise, self.acting_turn(), None)
    }

    /// The run of the scene from its release with 31 digits.
    ///
    /// # Errors
    /// The reason for which there is no first contact.
    pub fn extended_orbit(&self) -> Result<ExtendedOrbit, NoContact> {
        Orbit::new(self.model_of(self.noise, self.turning, self.outline), self.rules(), &self.release)
    }

    /// Run `run` of the scene's ensemble, whichever the scene itself is; all are the same without noise.
    ///
    /// # Errors
    /// Same as [`Scene::orbit`].
    pub fn orbit_of(&self, run: u64) -> Result<Orbit, NoContact> {
        let noise = self.noise.map(|noise| Noise { run, ..noise });
        Orbit::new(self.model_of(noise, self.turning, self.outline), self.rules(), &self.release)
    }

    /// The level of the ladder that the scene needs.
    pub fn model_level(&self) -> ModelLevel {
        match self.body {
            BodyShape::Point => ModelLevel::Point,
            BodyShape::Rod { .. } => {
                self.requirements().last().map_or(ModelLevel::Rod, |requirement| requirement.level)
            }
        }
    }

    /// The requirements of the scene beyond the plain rod, from the lowest level.
    pub fn requirements(&self) -> Vec<ModelRequirement> {
        let mut steps = Vec::new();
        let mut step =
            |level, name: Name, detail| steps.push(ModelRequirement { level, path: name.row().path, detail });
        if let Steering::Feedback(gains) = self.steering {
            let (level, name, seen) = if gains.x == 0.0 {
                (ModelLevel::Rod, Name::FeedbackTheta, "angle and velocities")
            } else {
                (ModelLevel::RodWithX, Name::FeedbackX, "place, angle and velocities")
            };
            step(level, name, format!("feedback tilts the table by {seen} (α = −K·state), in place of α = κθ"));
        }
        if let Some((name, detail)) = self.error_requirement() {
            step(ModelLevel::RigErrors, name, detail);
        }
        if let Some(detail) = self.turning_detail() {
            step(ModelLevel::Turning, Name::TiltRate, detail);
        }
        if let Some((name, detail)) = self.delay_requirement() {
            step(ModelLevel::Delay, name, detail);
        }
        if let Some((name, detail)) = self.drag_field().zip(self.drag_detail()) {
            step(ModelLevel::Drag, name, detail);
        }
        let (friction, slide) = (self.friction, self.shown(Name::Slide));
        if friction != 0.0 {
            let law = self.shown(Name::Law);
            let detail = format!(
                "friction is {friction}, so the impulse has a part along the table (law `{law}`, slide `{slide}`)"
            );
            step(ModelLevel::Friction, Name::Friction, detail);
        } else if self.slide != Slide::None {
            let detail = format!("slide is `{slide}`, so the table moves along itself, and friction is 0");
            step(ModelLevel::Friction, Name::Slide, detail);
        }
        if let Some((name, detail)) = self.noise_requirement() {
            step(ModelLevel::Noise, name, detail);
        }
        if let Some(vertices) = self.vertices() {
            let detail = format!(
                "the body is a polygon of {} vertices, and each of them is looked at in every flight and at every contact",
                vertices.places().len()
            );
            steps.push(ModelRequirement { level: ModelLevel::Polygon, path: VERTICES, detail });
        }
        steps
    }

    /// A sentence that says why the scene needs its level.
    pub fn level_reason(&self) -> String {
        let e = self.restitution;
        if self.body == BodyShape::Point {
            return "the body is a point: its table follows the angle of its velocity (eq. 3)".to_owned();
        }
        if let Some(requirement) = self.requirements().pop() {
            return requirement.detail;
        }
        if self.steers_energy() {
            return energy_reason(self);
        }
        let assumed = self.assumed_restitution();
        if self.strike == Striking::Still && e < 1.0 {
            format!("the table stands still and restitution is {e}, so every bounce loses energy (eq. 24)")
        } else if assumed != e {
            let way = if assumed > e { "loses" } else { "gains" };
            format!("{}, so every bounce {way} energy", self.belief())
        } else if e == 1.0 {
            "nothing is lost at a bounce (eq. 1), and nothing else was asked for".to_owned()
        } else {
            format!("the table makes up all that restitution {e} loses (eq. 25), so the run is that of restitution 1")
        }
    }
}
