//! Rods bouncing side by side, the common bounce only: plain loops over arrays, with the bits of one rod alone, that the
//! compiler turns into whatever vectors the CPU has ([`crate::numbers::dispatch`]). No fused operations.
//!
//! Not here: runs that end, and bounces that are not common ([`crate::batch::batch_run`]).

mod bounce;
mod number;
mod surface;

pub(crate) use bounce::{Bounced, Moving, Rods, Scratch, bounce};
pub(crate) use number::{Far, Near};
pub(crate) use surface::{Rough, Smooth, Surface};

/// How many rods bounce side by side: two vectors of eight, or four of four, which the CPU overlaps.
pub(crate) const WIDTH: usize = 16;

/// A number for each of them.
pub(crate) type Lanes = [f64; WIDTH];
