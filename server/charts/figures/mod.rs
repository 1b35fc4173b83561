//! Figures: one file for each kind of picture, and the names that callers use.

pub mod card;
pub mod chart;
pub mod eigenvalues;
pub mod heat_map;
pub mod phase_planes;
pub mod speed_accuracy;

pub use crate::charts::figures::chart::{
    AnglesAt, Branches, StabilityChange, SurvivalAt, SurvivalCurve, branches, survival_curve,
};
pub use crate::charts::figures::eigenvalues::{Loop, closed_loop};
pub use card::{CARD_SIZE, Card, CardPlane, FirstContact, PlacedBody, card};
pub use chart::{Chart, ChartAxis, Curve, CurveStyle, PanelNames, Plot, chart, readable_chart};
pub use eigenvalues::{Eigenvalues, Spectrum, eigenvalues};
pub use heat_map::{HeatAxis, HeatMap, heat_map};
pub use phase_planes::{PhasePlanes, phase_planes};
pub use speed_accuracy::{CostAndError, SYMBOLS, Series, SpeedAccuracy, Symbol, speed_accuracy};
