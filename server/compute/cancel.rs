//! A flag that is set when the client of some work has gone. Long loops check it every few milliseconds.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use tokio::sync::Notify;

/// A flag shared by the client's side, which sets it, and the work, which checks it.
#[derive(Debug, Clone, Default)]
pub struct CancelFlag(Arc<Flag>);

#[derive(Debug, Default)]
struct Flag {
    is_set: AtomicBool,
    changed: Notify,
}

impl CancelFlag {
    /// A flag that is never set, for work that is wanted in any case.
    pub fn never() -> Self {
        Self::default()
    }

    /// Cancels the work.
    pub fn set(&self) {
        self.0.is_set.store(true, Ordering::SeqCst);
        self.0.changed.notify_waiters();
    }

    /// Tells whether the work is cancelled. Costs one load; in a loop of nanoseconds check it every thousand rounds.
    pub fn is_set(&self) -> bool {
        self.0.is_set.load(Ordering::Relaxed)
    }

    /// [`CancelFlag::is_set`] as an error, for `?`.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_set() { Err(Cancelled) } else { Ok(()) }
    }

    /// The flag as an atomic, for code that knows only the standard library.
    pub fn flag(&self) -> &AtomicBool {
        &self.0.is_set
    }

    /// Waits until the flag is set.
    pub(crate) async fn wait(&self) {
        let changed = self.0.changed.notified();
        // `notified` counts from its creation on, so a flag set after this check wakes the wait.
        if !self.0.is_set.load(Ordering::SeqCst) {
            changed.await;
        }
    }
}

/// Sets a flag when it is dropped. The client's side holds it.
#[derive(Debug)]
pub(crate) struct CancelOnDrop(pub(crate) CancelFlag);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.set();
    }
}

/// The work was cancelled because its client has gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cancelled;

impl fmt::Display for Cancelled {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("given up, since nobody waits for the result")
    }
}

impl std::error::Error for Cancelled {}
