//! Chooses the smallest model that is exact for a scene, and says why.

use crate::map::body::Body;
use crate::map::body::{NoContact, Release};
use crate::map::friction::{Friction, Slide};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::map::table::control_law::{Gains, Steering};
use crate::map::table::errors::TableErrors;
use crate::map::table::noise::Noise;
use crate::map::table::pivot::TurningTable;
use crate::map::table::sensing::Prediction;
use crate::numbers::number::Number;
use crate::run::extended::ExtendedOrbit;
use crate::run::orbit::Orbit;
use crate::run::rules::Rules;
use crate::scene::air::air_of;
use crate::scene::{BodyShape, FieldError, GAINS, Name, Scene, Striking, VERTICES};

/// The levels of the model hierarchy, from the simplest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ModelLevel {
    /// A point mass without anything beyond it.
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

names!(
    ModelLevel: Point => "point", Linear => "linear", Rod => "rod", RodWithX => "rod_with_x", RigErrors => "rig_errors",
        Turning => "turning_table", Delay => "delay", Drag => "drag", Friction => "friction", Noise => "noise",
        Polygon => "polygon"
);

impl ModelLevel {
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
    /// The smallest body that is exact for the bounces of this scene.
    ///
    /// The outline of a polygon is not in it: it ends runs and changes no bounce, so that what is derived for one holds. Neither is a turning
    /// of the table that moves its surface and no body.
    pub fn model(&self) -> Body {
        Body { turning: self.acting_turn(), outline: None, ..self.running_model() }
    }

    /// The body of its runs.
    pub fn running_model(&self) -> Body {
        self.body_in()
    }

    /// The body of its runs in any kind of number.
    pub fn body_in<N: Number>(&self) -> Body<N> {
        self.body_by(|_, value| N::from_f64(value))
    }

    /// The body of its runs in any kind of number, which `field` gives for the value of each field that is a number. What follows from fields
    /// is derived in that kind: with dual numbers by its derivatives, with double-doubles to 31 digits.
    pub fn body_by<N: Number>(&self, field: impl Fn(Name, f64) -> N) -> Body<N> {
        let number = N::from_f64;
        let given = |name| self.number(name).map(|value| field(name, value));
        let of = |name| given(name).unwrap_or(number(0.0));
        let off = TableErrors {
            angle_bias: of(Name::AngleBias),
            tilt_offset: of(Name::TiltOffset),
            tilt_gain: of(Name::TiltGainError),
            speed: of(Name::SpeedError),
            offset: of(Name::Offset),
        };
        let is_point = self.body == BodyShape::Point;
        let along = given(Name::ContactDistance);
        let (contact_distance, radius_of_gyration) = match self.body {
            BodyShape::Point => (number(0.0), number(1.0)),
            // Those of a polygon follow from its vertices.
            BodyShape::Rod { contact_distance, radius_of_gyration } => (
                along.map_or(number(contact_distance), |along| off.contact_distance(along)),
                given(Name::RadiusOfGyration).unwrap_or(number(radius_of_gyration)),
            ),
        };
        let steering = match self.steering {
            Steering::TiltGain => Steering::TiltGain,
            Steering::Feedback(_) => {
                let [x, theta, x_dot, theta_dot] = GAINS.map(|name| off.tilting(of(name)));
                Steering::Feedback(Gains { x, theta, x_dot, theta_dot })
            }
        };
        let (tilt_gain, angle_gain) = match &steering {
            Steering::TiltGain => {
                let gain = off.tilting(of(Name::TiltGain));
                (gain, gain)
            }
            Steering::Feedback(gains) => (number(0.0), -gains.theta),
        };
        let lean = along.map_or(number(0.0), |along| off.lean(along));
        let gravity = of(Name::Gravity) * of(Name::Incline).sincos().0;
        let restitution = of(Name::Restitution);
        let one_and_restitution = number(1.0) + restitution;
        let assumed = given(Name::AssumedRestitution);
        let strike_gain = match (self.strike, assumed) {
            (Striking::Still, _) => one_and_restitution,
            // γ = (1 + e)(1 − w/v_nc).
            (Striking::Compensated, _) if !off.speed.is_zero() => {
                one_and_restitution * (number(1.0) + off.make_up(assumed.unwrap_or(restitution)))
            }
            // P = −(1 + e)(v_nc − v_table)/B with the table's velocity by ê.
            (Striking::Compensated, Some(assumed)) if !(assumed - restitution).is_zero() => {
                number(2.0) * one_and_restitution / (number(1.0) + assumed)
            }
            (Striking::Compensated, _) => number(2.0),
        };
        let target_height = given(Name::TargetHeight).filter(|_| self.program.is_none());
        let coefficient = of(Name::Friction);
        Body {
            rod: Rod {
                contact_distance,
                radius_of_gyration,
                gravity,
                restitution,
                tilt_gain,
                strike_gain,
                strike_gain_per_energy: match self.energy_feedback {
                    EnergyFeedback::OneStrike => number(0.5) * off.speed * one_and_restitution,
                    EnergyFeedback::Vertical | EnergyFeedback::Total => {
                        one_and_restitution * off.moving(of(Name::EnergyGain))
                    }
                },
                target_energy: match self.target_height {
                    Some(height) => gravity * target_height.unwrap_or(number(height)),
                    None => gravity * number(0.0),
                },
                energy_feedback: self.energy_feedback,
            },
            is_point,
            steering,
            constant_tilt: off.constant_tilt(angle_gain, lean),
            turning: self.turning.map(|TurningTable { place, is_corrected, .. }| TurningTable {
                place: place.map(|_| of(Name::PivotX)),
                depth: of(Name::PivotDepth),
                is_corrected,
            }),
            program: self.program,
            friction: (self.slide != Slide::None || !coefficient.is_zero()).then_some(Friction {
                coefficient,
                law: self.law,
                slide: self.slide,
            }),
            noise: self.noise,
            lag: match self.prediction {
                Prediction::None => of(Name::Delay),
                Prediction::Flight => number(0.0),
            },
            drag: air_of(of),
            outline: self.outline,
        }
    }

    /// The release of its runs in any kind of number, as [`Scene::body_by`].
    pub fn release_by<N: Number>(&self, field: impl Fn(Name, f64) -> N) -> Release<N> {
        let of = |name, value| if self.number(name).is_some() { field(name, value) } else { N::from_f64(value) };
        let Release { x, height, state: State { theta, x_dot, y_dot, theta_dot } } = self.release;
        Release {
            x: of(Name::X, x),
            height: of(Name::Height, height),
            state: State {
                theta: of(Name::Theta, theta),
                x_dot: of(Name::XDot, x_dot),
                y_dot: of(Name::YDot, y_dot),
                theta_dot: of(Name::ThetaDot, theta_dot),
            },
        }
    }

    /// The parameters of its strikes and flights.
    pub fn parameters<N: Number>(&self) -> Rod<N> {
        self.body_in().rod
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

    /// The turning table, if its turning changes the motion of the body.
    pub fn acting_turn(&self) -> Option<TurningTable> {
        self.turning.filter(|turning| turning.acts(self.contact_friction().as_ref()))
    }

    /// A sentence on a table that turns as it strikes.
    fn turning_detail(&self) -> Option<String> {
        let turning = self.turning?;
        let TurningTable { place, depth, is_corrected } = turning;
        let about = match place {
            Some(place) => format!("at x = {place} m and {depth} m below its surface"),
            None => format!("{depth} m below the contact"),
        };
        let law = if is_corrected { ", which its law corrects its speed for" } else { "" };
        let friction = self.contact_friction();
        let effect = match (turning.strikes(), turning.drags(friction.as_ref())) {
            (true, true) => "its surface strikes and drags the contact point besides",
            (true, false) => "its surface strikes the contact point besides",
            (false, true) => "its surface drags the contact point along",
            (false, false) => "its surface moves along itself at most, which changes no bounce here",
        };
        Some(format!("the table turns as it strikes, about a pivot {about}{law}: {effect}"))
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

    /// The run of the scene from its release with 31 digits.
    ///
    /// # Errors
    /// The reason for which there is no first contact.
    pub fn extended_orbit(&self) -> Result<ExtendedOrbit, NoContact> {
        Orbit::new(self.body_in(), self.rules(), &self.release)
    }

    /// Run `run` of the scene's ensemble, whichever the scene itself is; all are the same without noise.
    ///
    /// # Errors
    /// Same as [`Scene::orbit`].
    pub fn orbit_of(&self, run: u64) -> Result<Orbit, NoContact> {
        let noise = self.noise.map(|noise| Noise { run, ..noise });
        Orbit::new(Body { noise, ..self.running_model() }, self.rules(), &self.release)
    }

    /// The level of the ladder that the scene needs.
    pub fn model_level(&self) -> ModelLevel {
        let least = match self.body {
            BodyShape::Point => ModelLevel::Point,
            BodyShape::Rod { .. } => ModelLevel::Rod,
        };
        self.requirements().last().map_or(least, |requirement| requirement.level)
    }

    /// The requirements of the scene beyond the plain rod or the point mass, from the lowest level.
    pub fn requirements(&self) -> Vec<ModelRequirement> {
        let mut steps = Vec::new();
        let mut step =
            |level, name: Name, detail| steps.push(ModelRequirement { level, path: name.row().path, detail });
        if let Steering::Feedback(gains) = self.steering
            && self.body != BodyShape::Point
        {
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
        if let Some(requirement) = self.requirements().pop() {
            return requirement.detail;
        }
        if self.body == BodyShape::Point {
            return "the body is a point: its table follows the angle of its velocity (eq. 3)".to_owned();
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

/// A sentence that says why the strikes of a scene depend on the energy.
fn energy_reason(scene: &Scene) -> String {
    let gain = scene.energy_gain;
    match scene.energy_feedback {
        EnergyFeedback::Vertical => {
            format!("energy_gain is {gain} s²/m², so the table's speed depends on the energy (eq. 28)")
        }
        EnergyFeedback::Total => format!(
            "energy_gain is {gain} s²/m² and energy_measure `total`, so the table's speed depends on the energy, sideways motion and \
             spin included"
        ),
        EnergyFeedback::OneStrike => {
            "energy_law is `one_strike`, so the table's speed depends on the energy, and each strike brings it to the target".to_owned()
        }
    }
}
