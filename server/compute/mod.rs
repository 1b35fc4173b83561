//! Does the work of requests: prices it, admits it, runs it on threads and stops it when nobody waits any more.
//!
//! No HTTP and no physics here: work is a closure with a price, and a refusal is a value.

mod cancel;
mod gate;
mod line;
mod peer;
mod pool;
mod price;
mod shares;
pub mod stopwatch;
mod turn;
mod turns;

pub use cancel::{Cancel, Cancelled};
pub use gate::Slot;
pub use peer::{Network, Peer};
pub use pool::{Counted, Held, Pool, Refused};
pub use price::{Limit, OverBudget, Price};
pub use shares::{NoShare, Share, Shares};
pub use turn::Turn;
pub use turns::Turns;
