//! Bodies bouncing side by side, the common bounce only: plain loops over arrays, with the bits of one body alone, that the
//! compiler turns into whatever vectors the CPU has ([`crate::numbers::dispatch`]). No fused operations.
//!
//! Not here: runs that end, and bounces that are not common ([`crate::batch::batch_run`]).

mod contact;
mod model;
mod noisy;
mod number;
mod outline;
mod point;
mod rod;
mod state;
mod steering;
mod step;

pub(crate) use contact::{Rough, Smooth};
pub(crate) use model::{Bounced, LaneModel};
pub(crate) use noisy::NoisyLanes;
pub(crate) use number::{Far, Near};
pub(crate) use outline::OutlineLanes;
pub(crate) use point::PointLanes;
pub(crate) use rod::RodLanes;
pub(crate) use state::{LaneNumbers, Rods, WIDTH};
pub(crate) use steering::SteeringLanes;
