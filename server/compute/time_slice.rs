//! The right to compute for a while, which work asks whether to go on.
//!
//! A turn ends by the clock, in the midst of whatever is computed: who holds a permit passes it on to the next and waits for
//! another. So others wait for a turn and not for the work, whatever a piece of it turns out to take. The clock decides when
//! work is done and never what comes out of it.

use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::time::Instant;

use tokio::runtime::Handle;

use crate::compute::cancel::{CancelFlag, Cancelled};
use crate::compute::fair_queue::{FairQueue, Permit, QueueKey};
use crate::limits;

/// A turn to compute. Work asks it every millisecond or so whether to go on.
#[derive(Debug)]
pub struct TimeSlice {
    cancel: CancelFlag,
    began: Cell<Instant>,
    placement: Placement,
}

/// The place at which a turn is taken.
#[derive(Debug)]
enum Placement {
    /// A thread that nobody else wants.
    Dedicated,
    /// On an async thread, for a short time.
    Inline {
        /// True if that was too short.
        overran: Cell<bool>,
    },
    /// Beside them, with a permit.
    Permitted {
        /// None only after the work was cancelled.
        permit: RefCell<Option<Permit>>,
        queue: Arc<FairQueue>,
        key: QueueKey,
        runtime: Handle,
    },
}

impl TimeSlice {
    /// A turn without end, for work that someone waits for in any case.
    pub fn unbounded() -> Self {
        Self::new(CancelFlag::never(), Placement::Dedicated)
    }

    pub(crate) fn inline() -> Self {
        Self::new(CancelFlag::never(), Placement::Inline { overran: Cell::new(false) })
    }

    /// A turn with a permit that `flow` got in `line`.
    pub(crate) fn permitted(
        cancel: CancelFlag,
        permit: Permit,
        queue: Arc<FairQueue>,
        key: QueueKey,
        runtime: Handle,
    ) -> Self {
        Self::new(cancel, Placement::Permitted { permit: RefCell::new(Some(permit)), queue, key, runtime })
    }

    fn new(cancel: CancelFlag, placement: Placement) -> Self {
        Self { cancel, began: Cell::new(Instant::now()), placement }
    }

    /// Tells whether to go on: not where nobody waits for the result any more. Passes the permit on where it is time to, and then
    /// comes back with the next one. Costs a look at the clock; in a loop of nanoseconds ask every hundred rounds.
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
            Placement::Permitted { permit, queue, key, runtime } => {
                if self.began.get().elapsed() < limits::TURN_TIME {
                    return true;
                }
                if queue.has_others_waiting(*key) {
                    // Back in the line before the permit is passed on, so that the order of the line is kept.
                    let next = queue.requeue(*key);
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
    /// [`Cancelled`] once nobody waits for the result.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.should_continue() { Ok(()) } else { Err(Cancelled) }
    }

    /// The flag that says whether anybody still waits, for work that is not to be interrupted.
    pub fn cancel(&self) -> &CancelFlag {
        &self.cancel
    }

    /// Tells whether an inline turn was too short for the work.
    pub(crate) fn overran(&self) -> bool {
        matches!(&self.placement, Placement::Inline { overran } if overran.get())
    }
}
