//! Does the work of requests: prices it, admits it, runs it on threads and stops it when nobody waits any more.
//!
//! No HTTP and no physics here: work is a closure with a price, and a refusal is a value.

mod cancel;
mod fan;
mod pool;
mod price;

pub use cancel::{Cancel, Cancelled};
pub use fan::fan_out;
pub use pool::{Counted, Pool, Refused};
pub use price::{Limit, OverBudget, Price};
