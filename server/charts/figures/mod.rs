//! Figures: one file for each kind of picture.

pub mod branches;
pub mod chart;
pub mod closed_loop;
pub mod eigenvalues;
pub mod heat_map;
pub mod phase_planes;
pub mod speed_accuracy;
pub mod survival;
