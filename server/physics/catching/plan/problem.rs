//! Problem of a plan: the body, the strikes, and the limits of both.

use super::bounce::BouncingRod;
use crate::body::polygon::Outline;
use crate::table::actuator_load::ActuatorLimits;

/// Strikes of equal height ratio, and a stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanProblem {
    /// The body as the table believes it to be.
    pub body: BouncingRod,
    /// Number N of strikes before the stop.
    pub strikes: u32,
    /// Height ratio of each of them, > 0.
    pub ratio: f64,
}

/// Limits beside the bounces themselves.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanLimits<'a> {
    /// Limits of the table.
    pub table: Option<ActuatorLimits>,
    /// Outline of a polygon, of which no other vertex may touch the table.
    pub outline: Option<&'a Outline>,
}

/// End of a plan.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Goal {
    /// x = θ = ẋ = θ̇ = 0, with the least Σα².
    Rest,
    /// As near to that as changes of the tilts are worth: Σ(α − α₀)² + w(x²/l² + θ² + ẋ²/(Gl) + θ̇²l/G) is least, w = [`END_WEIGHT`]. The
    /// last strikes of a plan are too few for all four.
    NearRest {
        /// Tilts α₀ of the plan so far, rad.
        tilts: Vec<f64>,
    },
}

impl Goal {
    /// Tilt of a strike, from 0, that costs nothing, rad.
    pub(super) fn free_tilt(&self, strike: usize) -> f64 {
        match self {
            Self::Rest => 0.0,
            Self::NearRest { tilts } => tilts.get(strike).copied().unwrap_or(0.0),
        }
    }
}

/// Weight w of the end in [`Goal::NearRest`], rad².
pub(super) const END_WEIGHT: f64 = 100.0;
