//! Settings of a catch: the strategy, and the numbers of each.

use crate::control::lqr::{DEFAULT_INPUT_WEIGHT, DEFAULT_STATE_WEIGHTS};
use std::ops::RangeInclusive;

/// Contact speed after a strike, m/s, below which the table stays with the body if nothing else is asked for: the lasting contact begins.
pub const HOLD_SPEED: f64 = 5e-3;

/// Height ratios that may be asked for. Below, one strike stops the body and no flight is left to steer in; above, the strikes do not end.
pub const RATIOS: RangeInclusive<f64> = 0.05..=0.98;

/// Height ratios of a plan; at 1 all strikes but the last keep the height.
pub const PLAN_RATIOS: RangeInclusive<f64> = 0.05..=1.0;

/// Height ratio of [`Strategy::BounceDown`] if none is asked for.
pub const DEFAULT_RATIO: f64 = 0.5;

/// Strikes of a plan before its stop, if no number is asked for and none was chosen: there is no plan.
pub const DEFAULT_STRIKES: u32 = 8;

/// Height ratio of a plan if none is asked for.
pub const DEFAULT_PLAN_RATIO: f64 = 0.8;

/// Largest tilt of a strike of a plan that is made again, rad. A plan that asks for more is given up: beyond, a table turns a body more than it
/// lifts it.
pub const MOST_PLANNED_TILT: f64 = 1.2;

/// Most strikes of a catch. From 44 m/s down to [`HOLD_SPEED`] the largest of [`RATIOS`] takes 450.
pub const MOST_STRIKES: u64 = 1000;

/// Decelerations of the table, m/s², that may be asked for.
pub const BRAKES: RangeInclusive<f64> = 0.01..=1e4;

/// Time in contact that is followed, s, if none is asked for.
pub const DEFAULT_HOLD: f64 = 6.0;

/// Strategy of a catch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// Strikes that take a share of the speed each, tilted by a gain that is scheduled on the contact speed.
    BounceDown,
    /// Strikes with the least tilts that bring the body to rest, and a stop.
    Plan,
    /// No strike: the table meets the body at its own speed and brakes.
    Brake,
}

names!(Strategy: BounceDown => "bounce_down", Plan => "plan", Brake => "brake");

/// Settings of a catch; `None` leaves the choice to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatchSettings {
    /// Strategy; `None` compares them all.
    pub strategy: Option<Strategy>,
    /// Height ratio ẏ_c⁺/|ẏ_c| of a strike, in [`RATIOS`], of a plan in [`PLAN_RATIOS`].
    pub ratio: Option<f64>,
    /// Strikes of a plan before its stop.
    pub strikes: Option<u32>,
    /// Deceleration of the table in contact, m/s², in [`BRAKES`]; by default G.
    pub brake: Option<f64>,
    /// Weights on (x, θ, ẋ, θ̇), as for state feedback.
    pub state_weights: [f64; 4],
    /// Weight on the tilt.
    pub input_weight: f64,
    /// Contact speed after a strike, m/s, below which the lasting contact begins.
    pub hold_speed: f64,
    /// Time in contact that is followed, s.
    pub hold: f64,
}

impl Default for CatchSettings {
    fn default() -> Self {
        Self {
            strategy: None,
            ratio: None,
            strikes: None,
            brake: None,
            state_weights: DEFAULT_STATE_WEIGHTS,
            input_weight: DEFAULT_INPUT_WEIGHT,
            hold_speed: HOLD_SPEED,
            hold: DEFAULT_HOLD,
        }
    }
}

/// A strategy with its numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Approach {
    /// [`Strategy::BounceDown`] with this height ratio.
    BounceDown(f64),
    /// [`Strategy::Plan`].
    Plan {
        /// Strikes before the stop.
        strikes: u32,
        /// Height ratio of these strikes.
        ratio: f64,
    },
    /// [`Strategy::Brake`] with this deceleration of the table, m/s².
    Brake(f64),
}

impl Approach {
    /// The strategy.
    pub fn strategy(&self) -> Strategy {
        match self {
            Self::BounceDown(_) => Strategy::BounceDown,
            Self::Plan { .. } => Strategy::Plan,
            Self::Brake(_) => Strategy::Brake,
        }
    }
}

impl CatchSettings {
    /// The numbers of a strategy under gravity G (m/s²).
    pub fn approach(&self, strategy: Strategy, gravity: f64) -> Approach {
        match strategy {
            Strategy::BounceDown => Approach::BounceDown(self.ratio.unwrap_or(DEFAULT_RATIO)),
            Strategy::Plan => Approach::Plan {
                strikes: self.strikes.unwrap_or(DEFAULT_STRIKES),
                ratio: self.ratio.unwrap_or(DEFAULT_PLAN_RATIO),
            },
            Strategy::Brake => Approach::Brake(self.brake.unwrap_or(gravity)),
        }
    }
}
