//! Reasons for which no strike throws a body to a target, in words with numbers, limits and units.

use crate::body::Touch;
use crate::scene::Name;
use crate::table::actuator_load::LimitViolation;
use std::fmt;

/// Largest tilt of a throw, rad: 80°. A steeper table throws to the side what it should lift, and no rig tilts so far.
pub const STEEPEST: f64 = 1.4;

/// Reason for which no strike throws a body to a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThrowFailure {
    /// A point mass has no angle to be thrown to.
    PointMass,
    /// The rig has a constant error, or a table with ends, by this field.
    Rig(Name),
    /// The centre of gravity is not above the contact point.
    Lying {
        /// θ, rad.
        theta: f64,
    },
    /// The target is not above the body.
    TooLow {
        /// Height of the target, m.
        height: f64,
        /// Height of the centre of gravity at the strike, m.
        least: f64,
    },
    /// The table would have to pull.
    CannotPush {
        /// ẏ before the strike, m/s.
        y_dot: f64,
        /// ẏ that the throw needs after it, m/s.
        rise: f64,
    },
    /// No tilt of a table with friction turns the body to the angle.
    AngleOutOfReach {
        /// Angle of the target, rad.
        theta: f64,
        /// μ.
        friction: f64,
        /// Least and largest angle at the apex, rad, that tilts below a quarter turn reach; `None` if no tilt reaches the height.
        reach: Option<(f64, f64)>,
    },
    /// The table would have to tilt beyond [`STEEPEST`].
    TooSteep {
        /// α, rad.
        alpha: f64,
    },
    /// The strike needs more of the table than its limits allow.
    BeyondLimits(LimitViolation),
    /// Another vertex touches the table at the strike (t = 0) or on the way up.
    OtherVertex(Touch),
    /// The contact point does not rise from the strike.
    ContactSinks {
        /// ẏ_c⁺, m/s.
        contact_rise: f64,
    },
    /// The contact point comes down to the table before the apex.
    ContactReturns {
        /// Time of the contact since the strike, s.
        t: f64,
        /// Time of the apex, s.
        apex: f64,
    },
    /// The tilt that the throw needs moves on as fast as the table, while the body falls.
    OutrunsTable {
        /// Rate of the table, rad/s.
        rate: f64,
        /// Time after which it is not there, s.
        time: f64,
    },
    /// A speed of the throw is beyond [`crate::run::rules::SPEED_LIMIT`].
    TooFast {
        /// The speed, m/s.
        speed: f64,
    },
}

impl fmt::Display for ThrowFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PointMass => write!(f, "a point mass has no angle to be thrown to"),
            Self::Rig(name) => {
                write!(f, "a throw is for an ideal rig without ends; leave {} out", name.row().path)
            }
            Self::Lying { theta } => {
                write!(f, "the body lies at theta {theta} rad; a throw needs an angle within a quarter turn of upright")
            }
            Self::TooLow { height, least } => {
                write!(
                    f,
                    "the apex at {height} m is not above the centre of gravity, which is at {least} m at the strike"
                )
            }
            Self::CannotPush { y_dot, rise } => write!(
                f,
                "the table would have to pull: the body rises at {y_dot} m/s before the strike and the throw needs {rise} m/s after it"
            ),
            Self::AngleOutOfReach { theta, friction, reach: None } => write!(
                f,
                "with friction {friction} no tilt below a quarter turn reaches the height of the apex with theta {theta} rad"
            ),
            Self::AngleOutOfReach { theta, friction, reach: Some((least, most)) } => write!(
                f,
                "theta {theta} rad at the apex is out of reach with friction {friction}: tilts below a quarter turn reach {least} to \
                 {most} rad"
            ),
            Self::TooSteep { alpha } => {
                write!(f, "the strike needs a tilt of {alpha} rad; no throw tilts the table beyond {STEEPEST} rad")
            }
            Self::BeyondLimits(LimitViolation { quantity, value, limit, unit }) => {
                write!(f, "the strike needs a {quantity} of {value} {unit}; the table's limit is {limit} {unit}")
            }
            Self::OtherVertex(Touch { vertex, t: 0.0 }) => {
                write!(f, "vertex {vertex} is below the tilted table at the strike")
            }
            Self::OtherVertex(Touch { vertex, t }) => {
                write!(f, "vertex {vertex} comes down to the table {t} s after the strike, before the apex")
            }
            Self::ContactSinks { contact_rise } => {
                write!(
                    f,
                    "the contact point does not rise from the strike: its vertical velocity is {contact_rise} m/s"
                )
            }
            Self::ContactReturns { t, apex } => {
                write!(
                    f,
                    "the contact point comes down to the table {t} s after the strike, before the apex at {apex} s"
                )
            }
            Self::OutrunsTable { rate, time } => {
                write!(
                    f,
                    "{time} s after giving way the table is not at the tilt of the throw; it tilts at {rate} rad/s"
                )
            }
            Self::TooFast { speed } => write!(f, "the throw needs a speed of {speed} m/s"),
        }
    }
}
