//! The table of scene fields: path, unit, range and default of all but polygon vertices, which are no single value.
//!
//! Parsers, query strings, live changes, error messages, forms and the contract are derived from these rows.
//! The ranges are generous for a lab. The work of one flight does not depend on them ([`crate::map::contact_time::MAX_PIECES`]).

use crate::map::friction::{RestitutionLaw, Slide};
use crate::map::polygon::MAX_VERTICES;
use crate::map::strike::{EnergyLaw, EnergyMeasure};
use crate::map::table::noise::NoiseModel;
use crate::map::table::pivot::TiltRate;
use crate::map::table::program::{HeightProgram, MOST_HEIGHTS};
use crate::map::table::sensing::Prediction;
use crate::scene::Striking;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// Declares [`Name`] and [`FIELDS`] together, so that every name has one row, in the same order.
macro_rules! fields {
    ($($name:ident => $row:expr,)+) => {
        /// Name of a field; its number is its row in [`FIELDS`].
        #[allow(missing_docs)] // the row has the path
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr(usize)]
        pub enum Name {
            $($name,)+
        }

        /// Every field of a scene.
        pub const FIELDS: [Field; [$(Name::$name),+].len()] = [$(Field { name: Name::$name, ..$row }),+];
    };
}

/// The value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A finite number in the field's unit.
    Number(f64),
    /// A whole number.
    Integer(u64),
    /// One of the words of the field.
    Choice(&'static str),
    /// Yes or no.
    Flag(bool),
    /// Finite numbers in the field's unit, at least one.
    Numbers(HeightProgram),
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(formatter),
            Self::Integer(number) => number.fmt(formatter),
            Self::Choice(word) => word.fmt(formatter),
            Self::Flag(flag) => flag.fmt(formatter),
            Self::Numbers(list) => write!(formatter, "{:?}", list.heights()),
        }
    }
}

/// Values that a field takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FieldKind {
    /// A finite number from `minimum` to `maximum`, both included.
    Number {
        /// Least value.
        minimum: f64,
        /// Greatest value.
        maximum: f64,
    },
    /// A whole number from 0 to `maximum`.
    Integer {
        /// Greatest value.
        maximum: u64,
    },
    /// One of these words.
    Choice(&'static [&'static str]),
    /// true, or absent.
    Flag,
    /// From 1 to `most` finite numbers from `minimum` to `maximum`, both included.
    Numbers {
        /// Least value.
        minimum: f64,
        /// Greatest value.
        maximum: f64,
        /// Greatest number of values.
        most: usize,
    },
}

/// Gains of a state feedback, in the order of the state (x, θ, ẋ, θ̇).
pub const GAINS: [Name; 4] = [Name::FeedbackX, Name::FeedbackTheta, Name::FeedbackXDot, Name::FeedbackThetaDot];

pub(crate) const TURNING: [Name; 3] = [Name::TiltRate, Name::PivotX, Name::PivotDepth];

/// Fields of the air. They have lines in the budget of a scene that names one of them.
pub(crate) const AIR: [Name; 3] = [Name::Drag, Name::RotationDrag, Name::Wind];

/// Limits of the table, in the order of [`crate::map::table::actuator_load::ActuatorLoad`].
pub(crate) const LIMITS: [Name; 4] = [Name::TiltLimit, Name::TiltRateLimit, Name::SpeedLimit, Name::StrokeLimit];

/// Standard deviations, in the order of [`crate::map::table::noise::Noise`]. The first that is not 0 stands for the noise.
pub(crate) const NOISE: [Name; 7] =
    [Name::TimingSd, Name::AngleSd, Name::XSd, Name::XDotSd, Name::YDotSd, Name::ThetaDotSd, Name::RestitutionSd];

/// Fields of the constant errors, in the order of [`crate::map::table::errors::TableErrors`], which are 0 in a scene that leaves them out.
pub(crate) const ERRORS: [Name; 5] =
    [Name::AngleBias, Name::TiltOffset, Name::TiltGainError, Name::SpeedError, Name::Offset];

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Name in code.
    pub name: Name,
    /// Dotted path in a scene.
    pub path: &'static str,
    /// Unit, "1" for a pure number.
    pub unit: &'static str,
    /// Values it takes.
    pub kind: FieldKind,
    /// Value in a scene that does not say the field. None: the field stays absent, or is required.
    pub default: Option<Value>,
    /// Tells whether a scene has to say the field, unless something else takes its place (a point mass, a polygon, state feedback).
    pub required: bool,
    /// Tells whether the field may be changed during a live run.
    pub live: bool,
}

impl Field {
    const fn new(path: &'static str, unit: &'static str, kind: FieldKind) -> Self {
        Self { name: FIRST, path, unit, kind, default: None, required: false, live: false }
    }

    const fn number(path: &'static str, unit: &'static str, minimum: f64, maximum: f64) -> Self {
        Self::new(path, unit, FieldKind::Number { minimum, maximum })
    }

    const fn integer(path: &'static str, maximum: u64) -> Self {
        Self::new(path, "1", FieldKind::Integer { maximum })
    }

    const fn choice(path: &'static str, words: &'static [&'static str]) -> Self {
        Self::new(path, "1", FieldKind::Choice(words))
    }

    const fn default(self, number: f64) -> Self {
        Self { default: Some(Value::Number(number)), ..self }
    }

    const fn default_word(self, word: &'static str) -> Self {
        Self { default: Some(Value::Choice(word)), ..self }
    }

    const fn required(self) -> Self {
        Self { required: true, ..self }
    }

    const fn live(self) -> Self {
        Self { live: true, ..self }
    }

    /// Last part of the path.
    pub fn key(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// Range of a field that is a number; nothing beside 0 of any other.
    pub fn range(&self) -> (f64, f64) {
        match self.kind {
            FieldKind::Number { minimum, maximum } => (minimum, maximum),
            _ => (0.0, 0.0),
        }
    }

    /// The value of its range that is nearest to a number.
    pub(crate) fn clamped(&self, number: f64) -> f64 {
        let (minimum, maximum) = self.range();
        number.clamp(minimum, maximum)
    }

    /// First part of the path, by which forms group fields.
    pub fn group(&self) -> &'static str {
        self.path.split('.').next().unwrap_or(self.path)
    }

    /// Allowed values in words, with the unit: `from 0.001 to 10 m`.
    pub fn limits(&self) -> String {
        let unit = if self.unit == "1" { "(no unit)" } else { self.unit };
        match self.kind {
            FieldKind::Number { minimum, maximum } => format!("from {minimum} to {maximum} {unit}"),
            FieldKind::Integer { maximum } => format!("a whole number from 0 to {maximum}"),
            FieldKind::Choice(words) => format!("one of {}", words.join(", ")),
            FieldKind::Flag => "true".to_owned(),
            FieldKind::Numbers { minimum, maximum, most } => {
                format!("an array of 1 to {most} numbers from {minimum} to {maximum} {unit}")
            }
        }
    }

    /// Tells whether a value is of the field's kind and within its range. A number that is not finite never is.
    pub fn admits(&self, value: Value) -> bool {
        match (self.kind, value) {
            (FieldKind::Number { minimum, maximum }, Value::Number(number)) => (minimum..=maximum).contains(&number),
            (FieldKind::Integer { maximum }, Value::Integer(number)) => number <= maximum,
            (FieldKind::Choice(words), Value::Choice(word)) => words.contains(&word),
            (FieldKind::Flag, Value::Flag(flag)) => flag,
            (FieldKind::Numbers { minimum, maximum, most }, Value::Numbers(list)) => {
                let numbers = list.heights();
                numbers.len() <= most && numbers.iter().all(|number| (minimum..=maximum).contains(number))
            }
            _ => false,
        }
    }
}

/// Names of the fields of a group.
pub(crate) fn names_of(group: &str) -> Vec<Name> {
    FIELDS.iter().filter(|field| field.group() == group).map(|field| field.name).collect()
}

/// Row with this dotted path.
pub fn field(path: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.path == path)
}

impl Name {
    /// The field that says the same in another way, if there is one: a scene has at most one of them.
    pub fn other_way(self) -> Option<Self> {
        let pair = [Self::TargetHeight, Self::Program];
        let place = pair.iter().position(|name| *name == self)?;
        Some(pair[1 - place])
    }

    /// Row of the field.
    pub fn row(self) -> &'static Field {
        &FIELDS[self as usize]
    }
}

/// Stands in for the name of a row until the table sets it.
const FIRST: Name = Name::ContactDistance;

/// Largest integer that every JSON parser keeps exact.
const LARGEST_EXACT: u64 = (1 << 53) - 1;

/// Heights of a program: each in the range of a target height.
const PROGRAM: FieldKind = FieldKind::Numbers { minimum: 1e-3, maximum: 100.0, most: MOST_HEIGHTS };

fields! {
    ContactDistance => Field::number("body.contact_distance", "m", 1e-3, 10.0).required(),
    RadiusOfGyration => Field::number("body.radius_of_gyration", "m", 1e-3, 10.0).required(),
    PointMass => Field::new("body.point", "1", FieldKind::Flag),
    Offset => Field::number("body.offset", "m", -1.0, 1.0),
    ContactVertex => Field::integer("body.contact_vertex", MAX_VERTICES as u64 - 1),
    Gravity => Field::number("gravity", "m/s²", 0.1, 100.0).default(9.81),
    Incline => Field::number("incline", "rad", 0.01, FRAC_PI_2).default(FRAC_PI_2),
    Drag => Field::number("air.drag", "1/s", 0.0, 10.0),
    RotationDrag => Field::number("air.rotation_drag", "1/s", 0.0, 10.0),
    Wind => Field::number("air.wind", "m/s", -100.0, 100.0),
    Restitution => Field::number("contact.restitution", "1", 0.0, 1.0).default(1.0).live(),
    Friction => Field::number("contact.friction", "1", 0.0, 10.0).default(0.0).live(),
    Law => Field::choice("contact.law", RestitutionLaw::NAMES).default_word(RestitutionLaw::Poisson.name()).live(),
    TiltGain => Field::number("table.tilt_gain", "1", -100.0, 100.0).required().live(),
    EnergyGain => Field::number("table.energy_gain", "s²/m²", -100.0, 100.0).default(0.0).live(),
    TargetHeight => Field::number("table.target_height", "m", 1e-3, 100.0).live(),
    EnergyMeasure => Field::choice("table.energy_measure", EnergyMeasure::NAMES).live(),
    EnergyLaw => Field::choice("table.energy_law", EnergyLaw::NAMES).live(),
    Program => Field::new("table.program", "m", PROGRAM).live(),
    Strike => Field::choice("table.strike", Striking::NAMES).default_word(Striking::Compensated.name()).live(),
    Slide => Field::choice("table.slide", Slide::NAMES).default_word(Slide::None.name()).live(),
    FeedbackX => Field::number("table.feedback.x", "rad/m", -1e4, 1e4).live(),
    FeedbackTheta => Field::number("table.feedback.theta", "1", -1e4, 1e4).live(),
    FeedbackXDot => Field::number("table.feedback.x_dot", "rad·s/m", -1e4, 1e4).live(),
    FeedbackThetaDot => Field::number("table.feedback.theta_dot", "s", -1e4, 1e4).live(),
    AssumedRestitution => Field::number("table.assumed_restitution", "1", 0.0, 1.0).live(),
    AngleBias => Field::number("table.errors.angle_bias", "rad", -1.0, 1.0).live(),
    TiltOffset => Field::number("table.errors.tilt_offset", "rad", -1.0, 1.0).live(),
    TiltGainError => Field::number("table.errors.tilt_gain", "1", -0.9, 1.0).live(),
    SpeedError => Field::number("table.errors.speed", "1", -0.9, 1.0).live(),
    TiltRate => Field::choice("table.tilt_rate", TiltRate::NAMES).live(),
    PivotX => Field::number("table.pivot.x", "m", -1000.0, 1000.0).live(),
    PivotDepth => Field::number("table.pivot.depth", "m", -10.0, 10.0).live(),
    Delay => Field::number("table.delay", "s", 0.0, 1.0).live(),
    Prediction => Field::choice("table.prediction", Prediction::NAMES).live(),
    TableLength => Field::number("table.length", "m", 1e-3, 1e4).live(),
    TiltLimit => Field::number("table.limits.tilt", "rad", 0.0, PI).live(),
    TiltRateLimit => Field::number("table.limits.tilt_rate", "rad/s", 0.0, 1e6).live(),
    SpeedLimit => Field::number("table.limits.speed", "m/s", 0.0, 1e6).live(),
    StrokeLimit => Field::number("table.limits.stroke", "m", 0.0, 1e3).live(),
    Height => Field::number("release.height", "m", 0.0, 100.0).required(),
    Theta => Field::number("release.theta", "rad", -PI, PI).default(0.0),
    ThetaDot => Field::number("release.theta_dot", "rad/s", -200.0, 200.0).default(0.0),
    X => Field::number("release.x", "m", -1000.0, 1000.0).default(0.0),
    XDot => Field::number("release.x_dot", "m/s", -100.0, 100.0).default(0.0),
    YDot => Field::number("release.y_dot", "m/s", -100.0, 100.0).default(0.0),
    ToppleAngle => Field::number("topple_angle", "rad", 0.01, PI).default(FRAC_PI_2).live(),
    TimingSd => Field::number("noise.timing_sd", "s", 0.0, 1.0),
    AngleSd => Field::number("noise.angle_sd", "rad", 0.0, 1.0),
    XSd => Field::number("noise.x_sd", "m", 0.0, 1.0),
    XDotSd => Field::number("noise.x_dot_sd", "m/s", 0.0, 10.0),
    YDotSd => Field::number("noise.y_dot_sd", "m/s", 0.0, 10.0),
    ThetaDotSd => Field::number("noise.theta_dot_sd", "rad/s", 0.0, 100.0),
    RestitutionSd => Field::number("noise.restitution_sd", "1", 0.0, 1.0),
    NoiseModel => Field::choice("noise.model", NoiseModel::NAMES),
    Seed => Field::integer("noise.seed", LARGEST_EXACT),
    NoiseRun => Field::integer("noise.run", LARGEST_EXACT),
}
