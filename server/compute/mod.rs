//! Runs the work of requests: prices it, admits it, computes it on worker threads, and stops it when its client has gone.
//!
//! This folder knows neither HTTP nor physics: work is a closure with a price, and a refusal is a value.

mod admission;
mod fair_queue;
pub mod time_slices;

mod inline_slots;
mod peer;
mod pool;

pub use crate::compute::admission::{FairQuota, OverBudget, Overloaded, Price, QuotaExceeded, Reservation};
pub(crate) use crate::compute::fair_queue::Crowd;
pub use crate::compute::time_slices::{CancelFlag, Cancelled, TimeSlice, TimeSlices};
pub use inline_slots::InlineSlot;
pub use peer::{Network, Peer};
pub use pool::{GaugeGuard, HeldBytes, Pool};
