//! Slots for work on the async threads. One peer has at most half of them at a time, so that the threads keep answering others. A peer
//! that has been the only one for a while has all of them, until another one asks for anything.
//!
//! Work that waits for a slot is not refused, and does not wait behind other peers.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Instant;

use tokio::task::yield_now;

use crate::compute::fair_queue::{Crowd, FairQueue, Permit, Place};
use crate::compute::peer::Peer;
use crate::limits;

/// Slots on the async threads. Clones share them.
#[derive(Debug, Clone)]
pub(crate) struct InlineSlots(Arc<SlotQueues>);

#[derive(Debug)]
struct SlotQueues {
    threads: usize,
    lone: LonePeer,
    state: Mutex<SlotState>,
}

#[derive(Debug)]
struct SlotState {
    /// Slots of one peer.
    most: usize,
    /// The queue of each peer that has a slot or waits for one.
    queues: BTreeMap<Peer, Weak<FairQueue>>,
}

/// The right to compute on an async thread up to the next await.
#[derive(Debug)]
pub struct InlineSlot {
    _permit: Permit,
}

impl InlineSlots {
    /// Slots on so many threads.
    pub(crate) fn new(threads: usize) -> Self {
        Self::new_at(threads, Instant::now())
    }

    fn new_at(threads: usize, now: Instant) -> Self {
        let state = SlotState { most: threads.div_ceil(2), queues: BTreeMap::new() };
        Self(Arc::new(SlotQueues { threads, lone: LonePeer::new(now), state: Mutex::new(state) }))
    }

    /// Notes any request of `peer`.
    pub(crate) fn note(&self, peer: Peer) {
        self.0.lone.note(peer, Instant::now);
    }

    /// Waits for a slot for `peer`.
    pub(crate) async fn acquire(&self, peer: Peer) -> InlineSlot {
        self.acquire_at(peer, Instant::now()).await
    }

    async fn acquire_at(&self, peer: Peer, now: Instant) -> InlineSlot {
        let queue = self.queue(peer, now);
        if let Some(permit) = queue.try_acquire() {
            return InlineSlot { _permit: permit };
        }
        let permit = queue.acquire(Place::short(&Crowd::of(peer))).await;
        // With a single thread, let other tasks run in between.
        yield_now().await;
        InlineSlot { _permit: permit }
    }

    fn queue(&self, peer: Peer, now: Instant) -> Arc<FairQueue> {
        // A live run asks for slots long after its request.
        self.0.lone.note(peer, || now);
        let is_alone = self.0.lone.is_alone(peer, now);
        let mut state = self.0.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.set_most(if is_alone { self.0.threads } else { self.0.threads.div_ceil(2) });
        let SlotState { most, queues, .. } = &mut *state;
        if let Some(queue) = queues.get(&peer).and_then(Weak::upgrade) {
            return queue;
        }
        queues.retain(|_, queue| queue.strong_count() > 0);
        let queue = FairQueue::new(*most);
        queues.insert(peer, Arc::downgrade(&queue));
        queue
    }
}

impl SlotState {
    /// Changes the number of slots of one peer.
    fn set_most(&mut self, most: usize) {
        if self.most != most {
            self.most = most;
            self.queues.values().filter_map(Weak::upgrade).for_each(|queue| queue.set_permits(most));
        }
    }
}

// Knows whether one peer has been the only one for a while. All requests count, those that compute nothing too.

/// The peer of the last request, and since when it has been the only one.
///
/// Two peers that ask at the same moment may be noted in either order; both are then new.
#[derive(Debug)]
pub(crate) struct LonePeer {
    begin: Instant,
    last: AtomicU64,
    /// Time of its first request after those of others, ms after `begin`.
    since_ms: AtomicU64,
}

impl LonePeer {
    pub(crate) fn new(begin: Instant) -> Self {
        Self { begin, last: AtomicU64::new(Peer::NOBODY.key()), since_ms: AtomicU64::new(0) }
    }

    /// Notes a request of `peer`. The clock is read only if another one asked before.
    pub(crate) fn note(&self, peer: Peer, now: impl FnOnce() -> Instant) {
        if self.last.load(Ordering::Relaxed) != peer.key() {
            self.since_ms.store(self.ms(now()), Ordering::Relaxed);
            self.last.store(peer.key(), Ordering::Relaxed);
        }
    }

    /// Tells whether no other peer has asked for a while.
    pub(crate) fn is_alone(&self, peer: Peer, now: Instant) -> bool {
        let since = self.since_ms.load(Ordering::Relaxed);
        let alone_ms = limits::ALONE_TIME.as_millis() as u64;
        self.last.load(Ordering::Relaxed) == peer.key() && self.ms(now).saturating_sub(since) >= alone_ms
    }

    fn ms(&self, time: Instant) -> u64 {
        time.saturating_duration_since(self.begin).as_millis() as u64
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use futures_util::FutureExt;

    use super::*;
    use crate::limits;

    #[test]
    fn one_peer_has_half_of_the_threads_and_others_have_theirs() {
        let (slots, [one, other]) = (InlineSlots::new(4), [1, 2].map(|last| Peer::at([192, 0, 2, last].into())));
        let now = Instant::now();
        let acquire = |peer| slots.acquire_at(peer, now).now_or_never();
        let held = [acquire(one), acquire(one)];
        assert!(held.iter().all(Option::is_some) && acquire(one).is_none());
        assert!(acquire(other).is_some());
        let mut waiting = Box::pin(slots.acquire_at(one, now));
        assert!((&mut waiting).now_or_never().is_none());
        drop(held);
        assert_eq!(slots.0.state.lock().unwrap().queues.len(), 2);
    }

    #[test]
    fn a_peer_alone_has_all_threads_until_another_one_asks() {
        let now = Instant::now();
        let (slots, [one, other]) =
            (InlineSlots::new_at(4, now), [1, 2].map(|last| Peer::at([192, 0, 2, last].into())));
        let acquire = |peer, now| slots.acquire_at(peer, now).now_or_never();
        let mut held = vec![acquire(one, now), acquire(one, now)];
        assert!(held.iter().all(Option::is_some) && acquire(one, now).is_none());
        let later = now + limits::ALONE_TIME;
        held.extend([acquire(one, later), acquire(one, later)]);
        assert!(held.iter().all(Option::is_some) && acquire(one, later).is_none());
        held.truncate(2);
        // It asks for something that needs no slot.
        slots.0.lone.note(other, || later);
        assert!(acquire(one, later).is_none(), "the other one has just asked");
        assert!(acquire(one, later + limits::ALONE_TIME).is_some());
        assert!(acquire(other, later).is_some());
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
        assert_eq!(slots.0.state.lock().unwrap().queues.len(), 1, "the line of {peer:?} is kept");
        drop(other);
    }

    #[test]
    fn a_peer_is_alone_some_time_after_the_last_request_of_another_one() {
        let (begin, [one, other]) = (Instant::now(), [1, 2].map(|last| Peer::at([192, 0, 2, last].into())));
        let lone = LonePeer::new(begin);
        let at = |ms| begin + Duration::from_millis(ms);
        let note = |peer, ms| lone.note(peer, || at(ms));
        let alone_ms = limits::ALONE_TIME.as_millis() as u64;
        note(one, 10);
        note(one, 20);
        assert!(!lone.is_alone(one, at(9 + alone_ms)) && lone.is_alone(one, at(10 + alone_ms)));
        note(other, 5000);
        assert!(!lone.is_alone(one, at(5000)) && !lone.is_alone(other, at(5001)));
        note(one, 5002);
        assert!(!lone.is_alone(one, at(5001 + alone_ms)) && lone.is_alone(one, at(5002 + alone_ms)));
    }
}
