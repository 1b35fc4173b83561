//! Pictures of answers as SVG, drawn by a small chart layer of our own: sheets, panels with axes, marks, legends.
//!
//! A picture is a function of its numbers: the same bytes everywhere, whatever the numbers are. It stands on its own paper,
//! so that it reads in light and dark pages alike, and carries no style sheet and no script, so that any CSP takes it.
//! Not here: HTTP, and computing what is drawn.

mod boundary;
mod branches;
mod cells;
mod chart;
mod cividis;
mod closed_loop;
mod colour;
mod eigenvalues;
mod heat_map;
mod legend;
mod marks;
mod number;
mod panel;
mod phase_planes;
mod pixels;
mod scale;
mod sheet;
mod speed_accuracy;
mod survival;
mod svg;
mod text;
mod trail;

pub use branches::{Branches, Change, branches};
pub use chart::{Chart, Curve, Look, Plot, Side, chart};
pub use closed_loop::{Loop, closed_loop};
pub use eigenvalues::{Eigenvalues, Spectrum, eigenvalues};
pub use heat_map::{HeatAxis, HeatMap, heat_map};
pub use number::significant;
pub use phase_planes::{PhasePlanes, phase_planes};
pub use pixels::{NoPixels, png};
pub use speed_accuracy::{Series, SpeedAccuracy, speed_accuracy};
pub use survival::{AnglesAt, SurvivalAt, SurvivalCurve, survival_curve};

#[cfg(test)]
mod heat_map_tests;
#[cfg(test)]
mod tests;
