//! Does the work of requests: prices it, admits it, runs it on threads and stops it when nobody waits any more.
//!
//! No HTTP and no physics here: work is a closure with a price, and a refusal is a value.

mod cancel;
mod pool;
mod price;
pub mod stopwatch;
mod turns;

pub use cancel::{Cancel, Cancelled};
pub use pool::{Counted, Pool, Refused};
pub use price::{Limit, OverBudget, Price};
pub use turns::Turns;
