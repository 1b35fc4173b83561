//! Parts that answers of several resources share.

pub mod nearest_vertex;
pub mod outcome;
pub mod progress;
pub mod table;
pub mod tile;
pub mod write;
