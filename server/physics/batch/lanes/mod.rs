//! Rods bouncing side by side, the common bounce only: plain loops over arrays, with the bits of one rod alone, that the
//! compiler turns into whatever vectors the CPU has ([`crate::numbers::dispatch`]). No fused operations.
//!
//! Not here: runs that end, and bounces that are not common ([`crate::batch::batch_run`]).

mod contact;
mod number;
mod state;
mod step;

pub(crate) use contact::{Rough, Smooth, Surface};
pub(crate) use number::{Far, Near};
pub(crate) use state::{Moving, Rods, Scratch, WIDTH};
pub(crate) use step::{Bounced, bounce_lanes};
