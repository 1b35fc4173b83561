//! The table of scene fields: path, unit, range, default and meaning of everything a scene may say but the vertices of a
//! polygon, which are no single value.
//!
//! Parsers, query strings, live changes, error texts and forms are derived from these rows; nothing else lists them.
//! The ranges are generous for a lab. The work of one flight does not depend on them ([`crate::bounce::contact_time::MAX_PIECES`]).

use crate::body::polygon::MAX_VERTICES;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt;

/// The name of a field; its number is its row in [`FIELDS`].
#[allow(missing_docs)] // each is described in its row
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(usize)]
pub enum Name {
    ContactDistance,
    RadiusOfGyration,
    PointMass,
    ContactVertex,
    Gravity,
    Incline,
    Restitution,
    Friction,
    Law,
    TiltGain,
    EnergyGain,
    TargetHeight,
    Strike,
    Slide,
    FeedbackX,
    FeedbackTheta,
    FeedbackXDot,
    FeedbackThetaDot,
    AssumedRestitution,
    TiltLimit,
    TiltRateLimit,
    SpeedLimit,
    StrokeLimit,
    Height,
    Theta,
    ThetaDot,
    X,
    XDot,
    YDot,
    ToppleAngle,
    TimingSd,
    AngleSd,
    NoiseModel,
    Seed,
    NoiseRun,
}

/// The value of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// A finite number in the field's unit.
    Number(f64),
    /// A whole number.
    Integer(u64),
    /// One of the field's words.
    Choice(&'static str),
    /// Yes or no.
    Flag(bool),
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => number.fmt(formatter),
            Self::Integer(number) => number.fmt(formatter),
            Self::Choice(word) => word.fmt(formatter),
            Self::Flag(flag) => flag.fmt(formatter),
        }
    }
}

/// What values a field takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
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
    /// true, or nothing said.
    Flag,
}

/// One row of the table.
#[derive(Clone, Copy, Debug)]
pub struct Field {
    /// Its name in code.
    pub name: Name,
    /// Dotted path in a scene.
    pub path: &'static str,
    /// Symbol in formulas.
    pub symbol: &'static str,
    /// Title for forms.
    pub title: &'static str,
    /// What it means.
    pub about: &'static str,
    /// Unit, "1" for a pure number.
    pub unit: &'static str,
    /// Values it takes.
    pub kind: Kind,
    /// Value where a scene says nothing; none means that it must be said where it applies, or stays unsaid.
    pub default: Option<Value>,
    /// Whether a scene has to say it, unless something else takes its place (a point mass, a polygon, a state feedback).
    pub required: bool,
    /// Whether it may be changed while a run is live.
    pub live: bool,
}

impl Field {
    /// The last part of the path.
    pub fn key(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// The first part of the path, under which forms group it; the path itself where there is but one part.
    pub fn group(&self) -> &'static str {
        self.path.split('.').next().unwrap_or(self.path)
    }

    /// The allowed values in words, with the unit: `from 0.001 to 10 m`.
    pub fn limits(&self) -> String {
        let unit = if self.unit == "1" { "(no unit)" } else { self.unit };
        match self.kind {
            Kind::Number { minimum, maximum } => format!("from {minimum} to {maximum} {unit}"),
            Kind::Integer { maximum } => format!("a whole number from 0 to {maximum}"),
            Kind::Choice(words) => format!("one of {}", words.join(", ")),
            Kind::Flag => "true".to_owned(),
        }
    }

    /// Whether a value is of the field's kind and within its range; a number that is not finite never is.
    pub fn admits(&self, value: Value) -> bool {
        match (self.kind, value) {
            (Kind::Number { minimum, maximum }, Value::Number(number)) => (minimum..=maximum).contains(&number),
            (Kind::Integer { maximum }, Value::Integer(number)) => number <= maximum,
            (Kind::Choice(words), Value::Choice(word)) => words.contains(&word),
            (Kind::Flag, Value::Flag(flag)) => flag,
            _ => false,
        }
    }
}

/// The row with this dotted path.
pub fn field(path: &str) -> Option<&'static Field> {
    FIELDS.iter().find(|field| field.path == path)
}

impl Name {
    /// Its row.
    pub fn row(self) -> &'static Field {
        &FIELDS[self as usize]
    }
}

const fn number(minimum: f64, maximum: f64) -> Kind {
    Kind::Number { minimum, maximum }
}

const fn default(value: f64) -> Option<Value> {
    Some(Value::Number(value))
}

const BLANK: Field = Field {
    name: Name::ContactDistance,
    path: "",
    symbol: "",
    title: "",
    about: "",
    unit: "1",
    kind: Kind::Flag,
    default: None,
    required: false,
    live: false,
};

/// Every field of a scene.
#[rustfmt::skip]
pub const FIELDS: [Field; 35] = [
    Field { name: Name::ContactDistance, path: "body.contact_distance", symbol: "l", title: "Contact distance",
        about: "Centre of gravity to contact point", unit: "m", kind: number(1e-3, 10.0), required: true, ..BLANK },
    Field { name: Name::RadiusOfGyration, path: "body.radius_of_gyration", symbol: "ρ", title: "Radius of gyration",
        about: "Radius of gyration about the centre of gravity", unit: "m", kind: number(1e-3, 10.0), required: true, ..BLANK },
    Field { name: Name::PointMass, path: "body.point", title: "Point mass",
        about: "A body without an angle; its table tilts by κ times the angle of its velocity", ..BLANK },
    Field { name: Name::ContactVertex, path: "body.contact_vertex", title: "Contact vertex",
        about: "Which vertex of a polygon bounces, counted from 0; the lowest, if it is not said",
        kind: Kind::Integer { maximum: MAX_VERTICES as u64 - 1 }, ..BLANK },
    Field { name: Name::Gravity, path: "gravity", symbol: "g", title: "Gravity", about: "Acceleration of gravity",
        unit: "m/s²", kind: number(0.1, 100.0), default: default(9.81), ..BLANK },
    Field { name: Name::Incline, path: "incline", symbol: "φ", title: "Incline",
        about: "Angle of the plane of motion from horizontal; gravity in the plane is G = g sin φ",
        unit: "rad", kind: number(0.01, FRAC_PI_2), default: default(FRAC_PI_2), ..BLANK },
    Field { name: Name::Restitution, path: "contact.restitution", symbol: "e", title: "Restitution",
        about: "Coefficient of restitution", kind: number(0.0, 1.0), default: default(1.0), live: true, ..BLANK },
    Field { name: Name::Friction, path: "contact.friction", symbol: "μ", title: "Friction",
        about: "Coefficient of Coulomb friction", kind: number(0.0, 10.0), default: default(0.0), live: true, ..BLANK },
    Field { name: Name::Law, path: "contact.law", title: "Restitution law",
        about: "Law of restitution; they differ only with friction",
        kind: Kind::Choice(&["poisson", "newton", "stronge"]), default: Some(Value::Choice("poisson")), live: true, ..BLANK },
    Field { name: Name::TiltGain, path: "table.tilt_gain", symbol: "κ", title: "Tilt gain",
        about: "The table tilts by α = κθ", kind: number(-100.0, 100.0), live: true, required: true, ..BLANK },
    Field { name: Name::EnergyGain, path: "table.energy_gain", symbol: "κ_E", title: "Energy gain",
        about: "Feedback of the missing energy on the table's speed", unit: "s²/m²", kind: number(-100.0, 100.0),
        default: default(0.0), live: true, ..BLANK },
    Field { name: Name::TargetHeight, path: "table.target_height", symbol: "y*", title: "Target height",
        about: "Height of the centre of gravity at the top of the wanted bounce; needed with an energy gain",
        unit: "m", kind: number(1e-3, 100.0), live: true, ..BLANK },
    Field { name: Name::Strike, path: "table.strike", title: "Strike",
        about: "Whether the table makes up the loss of a bounce or stands still",
        kind: Kind::Choice(&["compensated", "still"]), default: Some(Value::Choice("compensated")), live: true, ..BLANK },
    Field { name: Name::Slide, path: "table.slide", title: "Slide",
        about: "Whether the table also moves along itself with the contact point",
        kind: Kind::Choice(&["none", "matched"]), default: Some(Value::Choice("none")), live: true, ..BLANK },
    Field { name: Name::FeedbackX, path: "table.feedback.x", symbol: "K_x", title: "Gain of x",
        about: "State feedback α = −K·(x, θ, ẋ, θ̇) in place of the tilt gain", unit: "rad/m", kind: number(-1e4, 1e4), live: true, ..BLANK },
    Field { name: Name::FeedbackTheta, path: "table.feedback.theta", symbol: "K_θ", title: "Gain of θ",
        about: "State feedback on the angle", unit: "1", kind: number(-1e4, 1e4), live: true, ..BLANK },
    Field { name: Name::FeedbackXDot, path: "table.feedback.x_dot", symbol: "K_ẋ", title: "Gain of ẋ",
        about: "State feedback on the horizontal velocity", unit: "rad·s/m", kind: number(-1e4, 1e4), live: true, ..BLANK },
    Field { name: Name::FeedbackThetaDot, path: "table.feedback.theta_dot", symbol: "K_θ̇", title: "Gain of θ̇",
        about: "State feedback on the angular velocity", unit: "s", kind: number(-1e4, 1e4), live: true, ..BLANK },
    Field { name: Name::AssumedRestitution, path: "table.assumed_restitution", symbol: "ê", title: "Assumed restitution",
        about: "What the table believes the restitution to be", kind: number(0.0, 1.0), live: true, ..BLANK },
    Field { name: Name::TiltLimit, path: "table.limits.tilt", symbol: "α_max", title: "Tilt limit",
        about: "Largest tilt that the table can take; a strike that asks for more ends the run", unit: "rad",
        kind: number(0.0, PI), live: true, ..BLANK },
    Field { name: Name::TiltRateLimit, path: "table.limits.tilt_rate", symbol: "α̇_max", title: "Tilt rate limit",
        about: "Largest mean tilt rate from strike to strike", unit: "rad/s", kind: number(0.0, 1e6), live: true, ..BLANK },
    Field { name: Name::SpeedLimit, path: "table.limits.speed", symbol: "v_max", title: "Speed limit",
        about: "Largest speed of the table at a strike", unit: "m/s", kind: number(0.0, 1e6), live: true, ..BLANK },
    Field { name: Name::StrokeLimit, path: "table.limits.stroke", symbol: "s_max", title: "Stroke limit",
        about: "Longest vertical way of the table from strike to strike, along the cubic between their velocities",
        unit: "m", kind: number(0.0, 1e3), live: true, ..BLANK },
    Field { name: Name::Height, path: "release.height", symbol: "y₀", title: "Height",
        about: "Height of the centre of gravity at release", unit: "m", kind: number(0.0, 100.0), required: true, ..BLANK },
    Field { name: Name::Theta, path: "release.theta", symbol: "θ₀", title: "Angle", about: "Angle from upright at release",
        unit: "rad", kind: number(-PI, PI), default: default(0.0), ..BLANK },
    Field { name: Name::ThetaDot, path: "release.theta_dot", symbol: "θ̇₀", title: "Spin",
        about: "Angular velocity at release", unit: "rad/s", kind: number(-200.0, 200.0), default: default(0.0), ..BLANK },
    Field { name: Name::X, path: "release.x", symbol: "x₀", title: "Place",
        about: "Horizontal place of the centre of gravity at release", unit: "m", kind: number(-1000.0, 1000.0),
        default: default(0.0), ..BLANK },
    Field { name: Name::XDot, path: "release.x_dot", symbol: "ẋ₀", title: "Horizontal velocity",
        about: "Horizontal velocity at release", unit: "m/s", kind: number(-100.0, 100.0), default: default(0.0), ..BLANK },
    Field { name: Name::YDot, path: "release.y_dot", symbol: "ẏ₀", title: "Vertical velocity",
        about: "Vertical velocity at release, upwards", unit: "m/s", kind: number(-100.0, 100.0),
        default: default(0.0), ..BLANK },
    Field { name: Name::ToppleAngle, path: "topple_angle", symbol: "θ_max", title: "Topple angle",
        about: "A contact at this angle or more has toppled", unit: "rad", kind: number(0.01, PI),
        default: default(FRAC_PI_2), live: true, ..BLANK },
    Field { name: Name::TimingSd, path: "noise.timing_sd", symbol: "σ_t", title: "Timing noise",
        about: "Standard deviation of the impact time on which the table acts", unit: "s", kind: number(0.0, 1.0),
        ..BLANK },
    Field { name: Name::AngleSd, path: "noise.angle_sd", symbol: "σ_θ", title: "Angle noise",
        about: "Standard deviation of the angle that the table senses", unit: "rad", kind: number(0.0, 1.0), ..BLANK },
    Field { name: Name::NoiseModel, path: "noise.model", title: "Noise model",
        about: "Whether the table meets the object early or late, or carries out a plan made for another time",
        kind: Kind::Choice(&["strike", "plan"]), ..BLANK },
    Field { name: Name::Seed, path: "noise.seed", title: "Seed", about: "Seed of the noise",
        kind: Kind::Integer { maximum: (1 << 53) - 1 }, ..BLANK },
    Field { name: Name::NoiseRun, path: "noise.run", title: "Run", about: "Which run of an ensemble with this seed",
        kind: Kind::Integer { maximum: (1 << 53) - 1 }, ..BLANK },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_stand_where_their_names_say() {
        for (index, row) in FIELDS.iter().enumerate() {
            assert_eq!(row.name as usize, index, "{}", row.path);
            assert_eq!(field(row.path).map(|found| found.name), Some(row.name));
            assert!(row.default.is_none_or(|value| row.admits(value)), "{}", row.path);
        }
    }

    #[test]
    fn what_is_not_finite_is_not_admitted() {
        for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(!Name::TiltGain.row().admits(Value::Number(number)));
        }
    }
}
