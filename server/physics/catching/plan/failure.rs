//! Reasons for which there is no plan that catches a body, in words with numbers and units.

use crate::body::Touch;
use crate::table::actuator_load::LimitViolation;
use std::fmt;

/// Fewest strikes before the stop: four numbers are to vanish, and each strike has one tilt.
pub const FEWEST_STRIKES: u32 = 4;

/// Most strikes before the stop.
pub const MOST_STRIKES: u32 = 40;

/// Reason for which a bounce of a plan cannot be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Obstacle {
    /// The contact point does not come down to the table.
    Rising,
    /// The table would have to pull.
    CannotPush,
    /// The flight after the strike meets no table.
    ContactLost,
    /// Another vertex touches the table: at the strike (t = 0), or in the flight after it.
    OtherVertex(Touch),
    /// The strike needs more of the table than its limits allow.
    BeyondLimits(LimitViolation),
}

/// Reason for which there is no plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanFailure {
    /// Fewer strikes than [`super::FEWEST_STRIKES`], or more than [`super::MOST_STRIKES`]: how many.
    Strikes(u32),
    /// The tilts did not converge.
    NotConverged {
        /// Number of strikes before the stop.
        strikes: u32,
        /// Steps that were made.
        iterations: u32,
        /// Largest error that is left, in m, rad, m/s and rad/s.
        residual: f64,
    },
    /// A strike of the plan cannot be.
    Blocked {
        /// Number of the strike, from 1 at the contact where the plan begins.
        strike: u32,
        /// The reason.
        obstacle: Obstacle,
    },
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rising => write!(f, "the contact point does not come down to the table"),
            Self::CannotPush => write!(f, "the table would have to pull"),
            Self::ContactLost => write!(f, "the flight after it meets no table"),
            Self::OtherVertex(Touch { vertex, t: 0.0 }) => write!(f, "vertex {vertex} is below the tilted table"),
            Self::OtherVertex(Touch { vertex, t }) => {
                write!(f, "vertex {vertex} comes down to the table {t} s after it")
            }
            Self::BeyondLimits(LimitViolation { quantity, value, limit, unit }) => {
                write!(f, "it needs a {quantity} of {value} {unit}; the table's limit is {limit} {unit}")
            }
        }
    }
}

impl fmt::Display for PlanFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Strikes(strikes) => {
                write!(f, "a plan has from {FEWEST_STRIKES} to {MOST_STRIKES} strikes before its stop, not {strikes}")
            }
            Self::NotConverged { strikes, iterations, residual } => write!(
                f,
                "the tilts of {strikes} strikes did not converge in {iterations} steps: an error of {residual} (m, rad, m/s or rad/s) is left"
            ),
            Self::Blocked { strike, obstacle } => write!(f, "strike {strike} of the plan cannot be: {obstacle}"),
        }
    }
}
