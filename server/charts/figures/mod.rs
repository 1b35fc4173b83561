//! Figures: one file for each kind of picture, and the names that callers use.

pub mod branches;
pub mod card;
pub mod chart;
pub mod closed_loop;
pub mod eigenvalues;
pub mod heat_map;
pub mod phase_planes;
pub mod speed_accuracy;
pub mod survival;

pub use branches::{Branches, StabilityChange, branches};
pub use card::{CARD_SIZE, Card, CardPlane, FirstContact, PlacedBody, card};
pub use chart::{Chart, ChartAxis, Curve, CurveStyle, PanelNames, Plot, chart, readable_chart};
pub use closed_loop::{Loop, closed_loop};
pub use eigenvalues::{Eigenvalues, Spectrum, eigenvalues};
pub use heat_map::{HeatAxis, HeatMap, heat_map};
pub use phase_planes::{PhasePlanes, phase_planes};
pub use speed_accuracy::{CostAndError, SYMBOLS, Series, SpeedAccuracy, Symbol, speed_accuracy};
pub use survival::{AnglesAt, SurvivalAt, SurvivalCurve, survival_curve};
