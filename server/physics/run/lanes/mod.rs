//! Many runs at once, several in the lanes of one number.

pub mod batch_run;
mod bounce;
mod lane_runs;
pub mod model;
