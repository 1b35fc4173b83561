//! A flag that says nobody waits for a result any more. Long loops look at it every few milliseconds.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use tokio::sync::Notify;

/// Shared between the one who waits and the one who works.
#[derive(Debug, Clone, Default)]
pub struct CancelFlag(Arc<Flag>);

#[derive(Debug, Default)]
struct Flag {
    is_set: AtomicBool,
    changed: Notify,
}

impl CancelFlag {
    /// One that nobody will set, for work that someone waits for in any case.
    pub fn never() -> Self {
        Self::default()
    }

    /// Says that nobody waits any more.
    pub fn set(&self) {
        self.0.is_set.store(true, Ordering::SeqCst);
        self.0.changed.notify_waiters();
    }

    /// Whether nobody waits any more. Costs a load; still, in a loop of nanoseconds look every thousand turns.
    pub fn is_set(&self) -> bool {
        self.0.is_set.load(Ordering::Relaxed)
    }

    /// `is_set` as an error, for `?`.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_set() { Err(Cancelled) } else { Ok(()) }
    }

    /// The flag itself, for code that knows only the standard library.
    pub fn flag(&self) -> &AtomicBool {
        &self.0.is_set
    }

    /// Waits until it is set.
    pub(crate) async fn wait(&self) {
        let changed = self.0.changed.notified();
        // Set before the wait began, or it wakes the wait: `notified` counts from its making on.
        if !self.0.is_set.load(Ordering::SeqCst) {
            changed.await;
        }
    }
}

/// Sets a flag when it is dropped: held by whoever waits.
#[derive(Debug)]
pub(crate) struct CancelOnDrop(pub(crate) CancelFlag);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.set();
    }
}

/// Work was given up because nobody waits for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cancelled;

impl fmt::Display for Cancelled {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("given up, since nobody waits for the result")
    }
}

impl std::error::Error for Cancelled {}
