//! Fields of a scene from measured impacts: multiple shooting (Bock 1987) with windows of impacts whose initial states are unknown too,
//! solved by the method of Levenberg (1944) and Marquardt (1963) with weights of Huber (1964) against outliers.
//!
//! Section 18 of `docs/physics.md` has the method. Not here: reading data, and the verdict on the fitted scene.

mod answer;
mod confidence;
mod elimination;
mod impact_map;
mod measured;
mod report;
mod search;
mod solver;
mod statistics;
mod windows;

pub use answer::{Fit, FitFailure, FitProgress, FitRequest, FitStage, FittedRow, Quality, QualityKind};
pub use confidence::Estimate;
pub use impact_map::MOST_UNKNOWNS;
pub use measured::{COLUMNS, DataError, Measured};
pub use search::{check, fit};
pub use statistics::chi_squared_quantile;
