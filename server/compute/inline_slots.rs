//! Slots for work on the async threads. One peer has at most half of them at a time, so that the threads keep answering others.
//!
//! Work that waits for a slot is not refused, and does not wait behind other peers.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use tokio::task::yield_now;

use crate::compute::fair_queue::{FairQueue, Permit, QueueKey};
use crate::compute::peer::Peer;

/// Slots on the async threads. Clones share them.
#[derive(Debug, Clone)]
pub(crate) struct InlineSlots(Arc<SlotQueues>);

#[derive(Debug)]
struct SlotQueues {
    /// Slots of one peer.
    most: usize,
    /// The queue of each peer that has a slot or waits for one.
    queues: Mutex<BTreeMap<Peer, Weak<FairQueue>>>,
}

/// The right to compute on an async thread up to the next await.
#[derive(Debug)]
pub struct InlineSlot {
    _permit: Permit,
}

impl InlineSlots {
    /// Slots on so many threads.
    pub(crate) fn new(threads: usize) -> Self {
        Self(Arc::new(SlotQueues { most: threads.div_ceil(2), queues: Mutex::default() }))
    }

    /// Waits for a slot for `peer`.
    pub(crate) async fn acquire(&self, peer: Peer) -> InlineSlot {
        let queue = self.queue(peer);
        if let Some(permit) = queue.try_acquire() {
            return InlineSlot { _permit: permit };
        }
        let permit = queue.acquire(QueueKey::Short(peer)).await;
        // With a single thread, let other tasks run in between.
        yield_now().await;
        InlineSlot { _permit: permit }
    }

    fn queue(&self, peer: Peer) -> Arc<FairQueue> {
        let mut queues = self.0.queues.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(queue) = queues.get(&peer).and_then(Weak::upgrade) {
            return queue;
        }
        queues.retain(|_, queue| queue.strong_count() > 0);
        let queue = FairQueue::new(self.0.most);
        queues.insert(peer, Arc::downgrade(&queue));
        queue
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    #[test]
    fn one_peer_has_half_of_the_threads_and_others_have_theirs() {
        let (slots, [one, other]) = (InlineSlots::new(4), [1, 2].map(|last| Peer::at([192, 0, 2, last].into())));
        let acquire = |peer| slots.acquire(peer).now_or_never();
        let held = [acquire(one), acquire(one)];
        assert!(held.iter().all(Option::is_some) && acquire(one).is_none());
        assert!(acquire(other).is_some());
        let mut waiting = Box::pin(slots.acquire(one));
        assert!((&mut waiting).now_or_never().is_none());
        drop(held);
        assert_eq!(slots.0.queues.lock().unwrap().len(), 2);
    }

    #[tokio::test]
    async fn who_waits_gets_its_slot_and_who_has_gone_is_forgotten() {
        let (slots, peer) = (InlineSlots::new(1), Peer::NOBODY);
        let held = slots.acquire(peer).await;
        let next = tokio::spawn({
            let slots = slots.clone();
            async move { drop(slots.acquire(peer).await) }
        });
        tokio::task::yield_now().await;
        assert!(!next.is_finished());
        drop(held);
        next.await.unwrap();
        let other = slots.acquire(Peer::at([192, 0, 2, 1].into())).await;
        assert_eq!(slots.0.queues.lock().unwrap().len(), 1, "the line of {peer:?} is kept");
        drop(other);
    }
}
