//! Kinds of numbers that the formulas of a bounce run on, sine and cosine with the same bits everywhere, and the choice of
//! instructions.

pub(crate) mod compensated_sum;
pub(crate) mod covariance;
pub mod dispatch;
pub mod double_double;
pub mod dual;
pub(crate) mod lanes;
pub(crate) mod logarithm;
pub mod number;
pub mod rounded;
pub mod trig;
