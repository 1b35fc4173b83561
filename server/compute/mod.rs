//! Does the work of requests: prices it, admits it, runs it on threads and stops it when nobody waits any more.
//!
//! No HTTP and no physics here: work is a closure with a price, and a refusal is a value.

mod fair_queue;
mod quota;
mod time_slices;

mod cancel;
mod gate;
mod peer;
mod pool;
mod price;
pub mod stopwatch;
mod turn;

pub use crate::compute::quota::{NoShare, Share, Shares};
pub use crate::compute::time_slices::Turns;
pub use cancel::{Cancel, Cancelled};
pub use gate::Slot;
pub use peer::{Network, Peer};
pub use pool::{Counted, Held, Pool, Refused};
pub use price::{Limit, OverBudget, Price};
pub use turn::Turn;
