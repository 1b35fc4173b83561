//! Pictures of answers as SVG, from a small chart layer: sheets, panels with axes, marks, legends.
//!
//! A picture is a pure function of its numbers, with the same bytes everywhere. It has its own paper, so that it is readable on light
//! and dark pages, and neither style sheet nor script, so that any CSP allows it.

pub mod draw;
pub mod figures;

pub use crate::charts::draw::number::significant;
pub use crate::charts::draw::pixels::{NoPixels, png};
pub use crate::charts::figures::branches::{Branches, Change, branches};
pub use crate::charts::figures::chart::{Chart, Curve, Look, Plot, Side, chart};
pub use crate::charts::figures::closed_loop::{Loop, closed_loop};
pub use crate::charts::figures::eigenvalues::{Eigenvalues, Spectrum, eigenvalues};
pub use crate::charts::figures::heat_map::{HeatAxis, HeatMap, heat_map};
pub use crate::charts::figures::phase_planes::{PhasePlanes, phase_planes};
pub use crate::charts::figures::speed_accuracy::{CostAndError, SYMBOLS, Series, SpeedAccuracy, speed_accuracy};
pub use crate::charts::figures::survival::{AnglesAt, SurvivalAt, SurvivalCurve, survival_curve};

#[cfg(test)]
mod heat_map_tests;
#[cfg(test)]
mod tests;
