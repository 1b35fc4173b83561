//! Chooses the smallest model that is exact for a scene, and names the fields that ask for it.

use crate::map::body::{Body, NoContact, Release};
use crate::map::flight::AirDrag;
use crate::map::friction::{Friction, Slide};
use crate::map::strike::{EnergyFeedback, Rod, State};
use crate::map::table::actuator_load::ActuatorLimits;
use crate::map::table::control_law::{Gains, Steering};
use crate::map::table::errors::TableErrors;
use crate::map::table::noise::Noise;
use crate::map::table::pivot::TurningTable;
use crate::map::table::sensing::Prediction;
use crate::numbers::number::Number;
use crate::run::orbit::{ExtendedOrbit, Orbit};
use crate::run::rules::Rules;
use crate::scene::fields::{LIMITS, NOISE};
use crate::scene::{AIR, ERRORS, GAINS, Name, Scene, Striking, VERTICES};

/// The levels of the model hierarchy, from the simplest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ModelLevel {
    /// A point mass without anything beyond it.
    Point,
    /// The linearized rod.
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

/// A step of the ladder that a scene asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelRequirement {
    /// The level.
    pub level: ModelLevel,
    /// The field that asked for it.
    pub path: &'static str,
}

impl Scene {
    /// The smallest body that is exact for the bounces of this scene.
    ///
    /// The outline of a polygon is not in it: it ends runs and changes no bounce, so that what is derived for one holds. Neither is a turning
    /// of the table that moves its surface and no body.
    pub fn model(&self) -> Body {
        Body { turning: self.acting_turn(), outline: None, ..self.running_model }
    }

    /// The body of its runs.
    pub fn running_model(&self) -> Body {
        self.running_model
    }

    /// The body of its runs in any kind of number.
    pub fn body_in<N: Number>(&self) -> Body<N> {
        self.body_by(|_, value| N::from_f64(value))
    }

    /// The body of its runs in any kind of number, which `field` gives for the value of each field that is a number. What follows from fields
    /// is derived in that kind: with dual numbers by its derivatives, with double-doubles to 31 digits.
    pub fn body_by<N: Number>(&self, field: impl Fn(Name, f64) -> N) -> Body<N> {
        let (draft, parts) = (&self.draft, &self.running_model);
        let number = N::from_f64;
        let given = |name| draft.number(name).map(|value| field(name, value));
        let of = |name| given(name).unwrap_or(number(0.0));
        let off = TableErrors::of(ERRORS.map(of));
        let along = given(Name::ContactDistance);
        let (contact_distance, radius_of_gyration) = if parts.is_point {
            (number(0.0), number(1.0))
        } else {
            // Those of a polygon follow from its vertices.
            (
                along.map_or(number(parts.rod.contact_distance), |along| off.contact_distance(along)),
                given(Name::RadiusOfGyration).unwrap_or(number(parts.rod.radius_of_gyration)),
            )
        };
        let (steering, tilt_gain, angle_gain) = match parts.steering {
            Steering::TiltGain => {
                let gain = off.tilting(of(Name::TiltGain));
                (Steering::TiltGain, gain, gain)
            }
            Steering::Feedback(_) => {
                let [x, theta, x_dot, theta_dot] = GAINS.map(|name| off.tilting(of(name)));
                (Steering::Feedback(Gains { x, theta, x_dot, theta_dot }), number(0.0), -theta)
            }
        };
        let lean = along.map_or(number(0.0), |along| off.lean(along));
        let gravity = of(Name::Gravity) * of(Name::Incline).sincos().0;
        let restitution = of(Name::Restitution);
        let one_and_restitution = number(1.0) + restitution;
        let assumed = given(Name::AssumedRestitution);
        let strike_gain = match (draft.word(Name::Strike), assumed) {
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
        let target_height = given(Name::TargetHeight).or(draft.target(1).map(number));
        let (coefficient, slide) = (of(Name::Friction), draft.word(Name::Slide));
        let [linear, rotational, wind] = AIR.map(of);
        Body {
            rod: Rod {
                contact_distance,
                radius_of_gyration,
                gravity,
                restitution,
                tilt_gain,
                strike_gain,
                strike_gain_per_energy: match parts.rod.energy_feedback {
                    EnergyFeedback::OneStrike => number(0.5) * off.speed * one_and_restitution,
                    EnergyFeedback::Vertical | EnergyFeedback::Total => {
                        one_and_restitution * off.moving(of(Name::EnergyGain))
                    }
                },
                target_energy: gravity * target_height.filter(|_| draft.steers_energy()).unwrap_or(number(0.0)),
                energy_feedback: parts.rod.energy_feedback,
            },
            is_point: parts.is_point,
            steering,
            constant_tilt: off.constant_tilt(angle_gain, lean),
            turning: parts.turning.map(|TurningTable { place, is_corrected, .. }| TurningTable {
                place: place.map(|_| of(Name::PivotX)),
                depth: of(Name::PivotDepth),
                is_corrected,
            }),
            program: parts.program,
            friction: (slide != Slide::None || !coefficient.is_zero()).then_some(Friction {
                coefficient,
                law: draft.word(Name::Law),
                slide,
            }),
            noise: parts.noise,
            lag: match draft.word(Name::Prediction) {
                Prediction::None => of(Name::Delay),
                Prediction::Flight => number(0.0),
            },
            drag: AirDrag { linear, rotational, wind }.unless_zero(),
            outline: parts.outline,
        }
    }

    /// The release of its runs in any kind of number, as [`Scene::body_by`].
    pub fn release_by<N: Number>(&self, field: impl Fn(Name, f64) -> N) -> Release<N> {
        let of = |name| self.number(name).map_or(N::from_f64(0.0), |value| field(name, value));
        Release {
            x: of(Name::X),
            height: of(Name::Height),
            state: State {
                theta: of(Name::Theta),
                x_dot: of(Name::XDot),
                y_dot: of(Name::YDot),
                theta_dot: of(Name::ThetaDot),
            },
        }
    }

    /// The parameters of its strikes and flights.
    pub fn parameters<N: Number>(&self) -> Rod<N> {
        self.body_in().rod
    }

    /// Rules that end its runs.
    pub fn rules(&self) -> Rules {
        let Body { friction, noise, lag, drag, .. } = self.running_model;
        let turns = self.acting_turn().is_some();
        Rules {
            topple_angle: if self.is_point() { f64::INFINITY } else { self.topple_angle() },
            settles: !self.keeps_energy()
                || self.running_model.rough().is_some()
                || turns
                || drag.is_some()
                || self.errs_in_energy(),
            holds_energy: self.keeps_energy()
                && friction.is_none()
                && noise.is_none()
                && !turns
                && drag.is_none()
                && lag == 0.0,
            limits: self.limits(),
            half_length: self.number(Name::TableLength).map_or(f64::INFINITY, |length| 0.5 * length),
        }
    }

    /// |θ| at which a rod counts as toppled, rad.
    pub(crate) fn topple_angle(&self) -> f64 {
        self.number(Name::ToppleAngle).unwrap_or(f64::INFINITY)
    }

    /// Limits of the table, if it has any.
    pub(crate) fn limits(&self) -> Option<ActuatorLimits> {
        let given = LIMITS.map(|name| self.number(name));
        let [tilt, tilt_rate, speed, stroke] = given.map(|limit| limit.unwrap_or(f64::INFINITY));
        given.iter().any(Option::is_some).then_some(ActuatorLimits { tilt, tilt_rate, speed, stroke })
    }

    /// Motion of the table along its normal at a strike.
    pub(super) fn strike(&self) -> Striking {
        self.draft.word(Name::Strike)
    }

    /// κ_E by which the table acts, s²/m².
    pub fn energy_gain(&self) -> f64 {
        self.table_errors().moving(self.number(Name::EnergyGain).unwrap_or(0.0))
    }

    /// Restitution that the table assumes; with an error of its speed, the one by which it acts.
    pub fn assumed_restitution(&self) -> f64 {
        self.table_errors().effective_restitution(self.specified_restitution())
    }

    /// Tells whether bounces lose energy for good.
    pub fn is_lossy(&self) -> bool {
        let restitution = self.running_model.rod.restitution;
        let lost = match self.strike() {
            Striking::Still => restitution < 1.0,
            Striking::Compensated => self.assumed_restitution() > restitution,
        };
        lost && !self.steers_energy()
    }

    /// Tells whether the table takes no energy away. With energy feedback it does where a run has too much, and with a negative gain where it
    /// has too little, down to nothing.
    fn keeps_energy(&self) -> bool {
        !self.is_lossy() && !self.steers_energy()
    }

    /// The turning table, if its turning changes the motion of the body.
    pub fn acting_turn(&self) -> Option<TurningTable> {
        let Body { turning, friction, .. } = &self.running_model;
        turning.filter(|turning| turning.acts(friction.as_ref()))
    }

    /// The requirements of the scene beyond the plain rod or the point mass, from the lowest level.
    pub fn requirements(&self) -> Vec<ModelRequirement> {
        let Body { steering, is_point, turning, lag, friction, .. } = self.running_model;
        let feedback = match steering {
            Steering::Feedback(_) if is_point => None,
            Steering::Feedback(Gains { x: 0.0, .. }) => Some((ModelLevel::Rod, Name::FeedbackTheta)),
            Steering::Feedback(_) => Some((ModelLevel::RodWithX, Name::FeedbackX)),
            Steering::TiltGain => None,
        };
        let rubs = |friction: Friction| if friction.coefficient != 0.0 { Name::Friction } else { Name::Slide };
        let fields = [
            feedback,
            self.first_error().map(|name| (ModelLevel::RigErrors, name)),
            turning.map(|_| (ModelLevel::Turning, Name::TiltRate)),
            (lag != 0.0).then_some((ModelLevel::Delay, Name::Delay)),
            self.drag_field().map(|name| (ModelLevel::Drag, name)),
            friction.map(|friction| (ModelLevel::Friction, rubs(friction))),
            self.noise_field().map(|name| (ModelLevel::Noise, name)),
        ];
        let fields =
            fields.into_iter().flatten().map(|(level, name)| ModelRequirement { level, path: name.row().path });
        let polygon = self.vertices().map(|_| ModelRequirement { level: ModelLevel::Polygon, path: VERTICES });
        fields.chain(polygon).collect()
    }

    /// The requirements that change bounces: errors that only change gains leave the rod a rod, and so does a turning that acts on no body. A
    /// polygon ends runs and changes no bounce.
    fn acting_requirements(&self) -> impl Iterator<Item = ModelRequirement> + use<'_> {
        self.requirements().into_iter().filter(|requirement| match requirement.level {
            ModelLevel::RigErrors => self.running_model.constant_tilt != 0.0,
            ModelLevel::Turning => self.acting_turn().is_some(),
            ModelLevel::Polygon => false,
            _ => true,
        })
    }

    /// Path of the first field that takes the bounces of the scene beyond those of the plain rod or the point mass.
    pub fn first_beyond_rod(&self) -> Option<&'static str> {
        self.acting_requirements().next().map(|requirement| requirement.path)
    }

    /// Tells whether nothing but these levels takes the bounces of the scene beyond those of the plain rod or the point mass.
    pub fn needs_at_most(&self, levels: &[ModelLevel]) -> bool {
        self.acting_requirements().all(|requirement| levels.contains(&requirement.level))
    }

    /// The run of the scene from its release.
    pub fn orbit(&self) -> Result<Orbit, NoContact> {
        Orbit::new(self.running_model, self.rules(), &self.release)
    }

    /// The run of the scene from its release with 31 digits.
    pub fn extended_orbit(&self) -> Result<ExtendedOrbit, NoContact> {
        Orbit::new(self.body_in(), self.rules(), &self.release)
    }

    /// Run `run` of the scene's ensemble, whichever the scene itself is; all are the same without noise.
    pub fn orbit_of(&self, run: u64) -> Result<Orbit, NoContact> {
        let noise = self.running_model.noise.map(|noise| Noise { run, ..noise });
        Orbit::new(Body { noise, ..self.running_model }, self.rules(), &self.release)
    }

    /// The level of the ladder that the scene needs.
    pub fn model_level(&self) -> ModelLevel {
        let least = if self.is_point() { ModelLevel::Point } else { ModelLevel::Rod };
        self.requirements().last().map_or(least, |requirement| requirement.level)
    }

    /// The field by which the air drags the body, if it does.
    pub fn drag_field(&self) -> Option<Name> {
        self.running_model.drag.and_then(|_| self.draft.first_set(&AIR))
    }

    /// Tells whether something errs at random.
    pub fn has_noise(&self) -> bool {
        self.running_model.noise.is_some()
    }

    /// The field that stands for the noise, if something errs at random.
    pub fn noise_field(&self) -> Option<Name> {
        self.running_model.noise.and_then(|_| self.draft.first_set(&NOISE))
    }

    fn table_moves(&self) -> bool {
        self.steers_energy() || (self.strike() == Striking::Compensated && self.assumed_restitution() != 1.0)
    }

    /// Tells whether the table moves by velocities that it has sensed some time before the strike.
    pub fn moves_late(&self) -> bool {
        self.running_model.lag != 0.0 && self.table_moves()
    }

    /// Tells whether a strike may take energy away by an error of the restitution, or of the speed of a table that moves.
    fn errs_in_energy(&self) -> bool {
        let errs = |noise: Noise| noise.restitution_sd != 0.0 || (noise.errs_in_velocity() && self.table_moves());
        self.moves_late() || self.running_model.noise.is_some_and(errs)
    }

    /// The constant errors of the rig.
    pub fn table_errors(&self) -> TableErrors {
        self.draft.table_errors()
    }

    /// The same, with the lean of the axis in the bias of the angle.
    pub fn leaning_errors(&self) -> TableErrors {
        let errors = self.table_errors();
        let lean = self.number(Name::ContactDistance).map_or(0.0, |along| errors.lean(along));
        TableErrors { angle_bias: errors.angle_bias + lean, ..errors }
    }

    /// 1 + ε_α: the table tilts by so many times its law.
    pub fn tilt_factor(&self) -> f64 {
        1.0 + self.table_errors().tilt_gain
    }

    /// 1 + ε_w: the table moves at so many times its law.
    pub fn speed_factor(&self) -> f64 {
        1.0 + self.table_errors().speed
    }

    /// True if a constant error changes the tilt gain, the table's speed or the contact distance of a body with an angle. These are then products
    /// and roots that doubles round, once for all bounces.
    pub fn rounds_parameters(&self) -> bool {
        let TableErrors { tilt_gain, speed, offset, .. } = self.table_errors();
        !self.is_point() && [tilt_gain, speed, offset].iter().any(|error| *error != 0.0)
    }

    /// Restitution that the table is told, whatever the error of its speed.
    pub(crate) fn specified_restitution(&self) -> f64 {
        self.number(Name::AssumedRestitution).unwrap_or(self.running_model.rod.restitution)
    }

    /// The first field of a constant error that is not 0.
    pub(crate) fn first_error(&self) -> Option<Name> {
        self.draft.first_set(&ERRORS)
    }
}
