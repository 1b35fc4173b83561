//! Runs the work of requests: prices it, admits it, computes it on worker threads, and stops it when its client has gone.
//!
//! This folder knows neither HTTP nor physics: work is a closure with a price, and a refusal is a value.

mod fair_queue;
mod quota;
mod time_slices;

mod cancel;
mod inline_slots;
mod lone_peer;
mod overloaded;
mod peer;
mod pool;
mod price;
mod priority;
pub mod stopwatch;
mod time_slice;

pub(crate) use crate::compute::fair_queue::Crowd;
pub use crate::compute::quota::{FairQuota, QuotaExceeded, Reservation};
pub use crate::compute::time_slices::TimeSlices;
pub use cancel::{CancelFlag, Cancelled};
pub use inline_slots::InlineSlot;
pub use overloaded::Overloaded;
pub use peer::{Network, Peer};
pub use pool::{GaugeGuard, HeldBytes, Pool};
pub use price::{OverBudget, Price};
pub use time_slice::TimeSlice;
