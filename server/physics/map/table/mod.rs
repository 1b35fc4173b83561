//! The table: its control law, its target heights, its pivot, its errors of timing and sensing, and the load that a run puts on its actuators.

pub mod actuator_load;
pub mod control_law;
pub mod errors;
pub mod noise;
pub mod pivot;
pub mod program;
pub mod sensing;
