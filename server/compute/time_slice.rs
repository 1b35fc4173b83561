//! Time slices: the right of work to compute for a while.
//!
//! A slice ends by the clock, in the middle of the work: the work passes its permit on and waits for another. So other requests
//! wait for a slice, not for the whole work. The clock decides when work is done, and never its result.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::time::Instant;

use tokio::runtime::Handle;

use crate::compute::cancel::{CancelFlag, Cancelled};
use crate::compute::fair_queue::{FairQueue, Permit, Place};
use crate::limits;

/// A time slice. Work asks it about every millisecond whether to continue.
#[derive(Debug)]
pub struct TimeSlice {
    cancel: CancelFlag,
    began: Cell<Instant>,
    placement: Placement,
}

/// The thread and the permit of a time slice.
#[derive(Debug)]
enum Placement {
    /// A thread without a permit.
    Dedicated,
    /// An async thread, for a short time.
    Inline {
        /// True if the time was too short.
        overran: Cell<bool>,
    },
    /// A worker thread with a permit.
    Permitted {
        /// None only after cancellation.
        permit: RefCell<Option<Permit>>,
        queue: Arc<FairQueue>,
        place: Place,
        runtime: Handle,
    },
}

impl TimeSlice {
    /// A slice without end, for work that is wanted in any case.
    pub fn unbounded() -> Self {
        Self::new(CancelFlag::never(), Placement::Dedicated)
    }

    pub(crate) fn inline() -> Self {
        Self::new(CancelFlag::never(), Placement::Inline { overran: Cell::new(false) })
    }

    /// A slice with a permit that was acquired at `place`.
    pub(crate) fn permitted(
        cancel: CancelFlag,
        permit: Permit,
        queue: Arc<FairQueue>,
        place: Place,
        runtime: Handle,
    ) -> Self {
        Self::new(cancel, Placement::Permitted { permit: RefCell::new(Some(permit)), queue, place, runtime })
    }

    fn new(cancel: CancelFlag, placement: Placement) -> Self {
        Self { cancel, began: Cell::new(Instant::now()), placement }
    }

    /// Tells whether to continue; false after cancellation. At the end of a slice it passes the permit on and returns with the next
    /// one. Costs a look at the clock: in a loop of nanoseconds call it every hundred rounds.
    pub fn should_continue(&self) -> bool {
        if self.cancel.is_set() {
            return false;
        }
        match &self.placement {
            Placement::Dedicated => true,
            Placement::Inline { overran } => {
                overran.set(self.began.get().elapsed() >= limits::INLINE_TIME);
                !overran.get()
            }
            Placement::Permitted { permit, queue, place, runtime } => {
                if self.began.get().elapsed() < limits::TURN_TIME {
                    return true;
                }
                if queue.has_others_waiting(place) {
                    // Queued again before the permit is given back, so that the order of the queue is kept.
                    let next = queue.requeue(place.clone());
                    permit.take();
                    let next = runtime.block_on(async {
                        tokio::select! {
                            biased;
                            () = self.cancel.wait() => None,
                            permit = next => Some(permit),
                        }
                    });
                    if next.is_none() {
                        return false;
                    }
                    permit.replace(next);
                }
                self.began.set(Instant::now());
                true
            }
        }
    }

    /// [`TimeSlice::should_continue`] as an error, for `?`.
    ///
    /// # Errors
    /// [`Cancelled`] once the client has gone.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.should_continue() { Ok(()) } else { Err(Cancelled) }
    }

    /// The cancellation flag, for work that must not be interrupted.
    pub fn cancel(&self) -> &CancelFlag {
        &self.cancel
    }

    /// Tells whether the time of an inline slice was too short.
    pub(crate) fn overran(&self) -> bool {
        matches!(&self.placement, Placement::Inline { overran } if overran.get())
    }
}
