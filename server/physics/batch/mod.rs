//! Many runs at once, several in the lanes of one vector.

pub mod batch_run;
mod lane_runs;
mod lanes;
mod mask;
pub mod model;
mod programs;
