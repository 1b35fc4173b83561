//! A run as a value: its scene, clock and interventions, the URL that says them, and its playback.
//!
//! Trajectories and live runs both stand on it.

pub mod clock;
pub mod playback;
pub mod run;
pub mod run_url;
