//! Catching a falling body with the table, and throwing it: tables that choose the motion of each strike.

pub mod aim;
pub mod throw;
