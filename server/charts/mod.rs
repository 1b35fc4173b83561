//! Pictures of answers as SVG, from a small chart layer: sheets, panels with axes, marks, legends.
//!
//! A picture is a pure function of its numbers, with the same bytes everywhere. It has its own paper, so that it is readable on light
//! and dark pages, and neither style sheet nor script, so that any CSP allows it.

pub mod draw;
pub mod figures;

pub use crate::charts::draw::pixels::{NoPixels, png};
pub use crate::charts::draw::scale::significant;
pub use crate::charts::figures::*;

#[cfg(test)]
mod tests;
