//! A run as a value: its scene and its interventions, as a request gives them, and its contacts one after another.
//!
//! Trajectories and live runs both use it. The wall clock of a live run is in `live`.

pub mod caught;
pub mod interventions;
pub mod playback;
pub mod run;
