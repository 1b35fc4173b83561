//! The table: its errors of timing and sensing, and the load that a run puts on its actuators.

pub mod actuator_load;
pub mod control_law;
pub mod noise;
