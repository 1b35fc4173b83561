//! Slots for connections, and which connections are closed when all slots are taken.

use std::collections::HashMap;
use std::pin::Pin;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use axum::body::{Bytes, HttpBody};
use http_body::{Frame, SizeHint};
use hyper::body::Incoming;
use tokio::sync::Notify;
use tokio::time::timeout;

use crate::compute::Peer;
use crate::limits;

/// The slots for connections.
#[derive(Debug)]
pub(crate) struct ConnectionSlots {
    most: usize,
    begin: Instant,
    open: Mutex<HashMap<u64, Arc<ConnectionSlot>>>,
    next: AtomicU64,
    freed: Notify,
}

/// The slot of one connection.
#[derive(Debug)]
pub(crate) struct ConnectionSlot {
    peer: Peer,
    /// Time of the last byte, ms after the start of the server.
    moved_ms: AtomicU64,
    /// True while the client waits for the server; false while the server waits for the client.
    is_answering: AtomicBool,
    end: Notify,
    begin: Instant,
}

/// A taken slot, free again when it is dropped.
#[derive(Debug)]
pub(crate) struct SlotGuard {
    number: u64,
    slot: Arc<ConnectionSlot>,
    of: Arc<ConnectionSlots>,
}

impl ConnectionSlots {
    pub(crate) fn new(most: usize) -> Arc<Self> {
        let begin = Instant::now();
        Arc::new(Self { most, begin, open: Mutex::default(), next: AtomicU64::new(0), freed: Notify::new() })
    }

    /// Takes a slot. If none is free, the longest idle connections are closed. Waits while all connections are being answered.
    pub(crate) async fn acquire(self: &Arc<Self>, peer: Peer) -> SlotGuard {
        loop {
            let freed = self.freed.notified();
            {
                let mut open = self.open();
                if open.len() < self.most {
                    let number = self.next.fetch_add(1, Ordering::Relaxed);
                    let slot = Arc::new(ConnectionSlot::new(peer, self.begin));
                    open.insert(number, slot.clone());
                    return SlotGuard { number, slot, of: self.clone() };
                }
                for slot in eviction_candidates(open.values(), self.most.div_ceil(limits::CONNECTIONS_AT_ONCE)) {
                    slot.end.notify_one();
                }
            }
            // Checked again after a while: a connection that was being answered may be idle now.
            let _ = timeout(Duration::from_millis(20), freed).await;
        }
    }

    /// Waits until all slots are free.
    pub(crate) async fn all_free(&self) {
        loop {
            let freed = self.freed.notified();
            if self.open().is_empty() {
                return;
            }
            freed.await;
        }
    }

    fn open(&self) -> MutexGuard<'_, HashMap<u64, Arc<ConnectionSlot>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Chooses so many idle connections to close: first those of the peer with the most connections, and of each peer the longest idle.
fn eviction_candidates<'a>(
    open: impl Iterator<Item = &'a Arc<ConnectionSlot>>,
    count: usize,
) -> Vec<&'a Arc<ConnectionSlot>> {
    let mut peers: HashMap<Peer, Vec<(u64, &Arc<ConnectionSlot>)>> = HashMap::new();
    for slot in open {
        let idle_since =
            if slot.is_answering.load(Ordering::Relaxed) { u64::MAX } else { slot.moved_ms.load(Ordering::Relaxed) };
        peers.entry(slot.peer).or_default().push((idle_since, slot));
    }
    let mut ranked = Vec::new();
    for slots in peers.values_mut() {
        slots.sort_unstable_by_key(|(idle_since, _)| std::cmp::Reverse(*idle_since));
        let idle = slots.iter().enumerate().filter(|(_, (idle_since, _))| *idle_since != u64::MAX);
        ranked.extend(idle.map(|(rank, (_, slot))| (rank, *slot)));
    }
    ranked.sort_unstable_by_key(|(rank, _)| std::cmp::Reverse(*rank));
    ranked.truncate(count);
    ranked.into_iter().map(|(_, slot)| slot).collect()
}

impl ConnectionSlot {
    fn new(peer: Peer, begin: Instant) -> Self {
        let slot =
            Self { peer, moved_ms: AtomicU64::new(0), is_answering: AtomicBool::new(false), end: Notify::new(), begin };
        slot.touch();
        slot
    }

    /// Notes that bytes have been sent or received.
    pub(crate) fn touch(&self) {
        let ms = u64::try_from(self.begin.elapsed().as_millis()).unwrap_or(u64::MAX - 1);
        self.moved_ms.store(ms, Ordering::Relaxed);
    }

    /// Sets whether the client waits for the server.
    pub(crate) fn set_answering(&self, answers: bool) {
        self.is_answering.store(answers, Ordering::Relaxed);
    }
}

impl SlotGuard {
    /// The slot.
    pub(crate) fn slot(&self) -> &Arc<ConnectionSlot> {
        &self.slot
    }

    /// Waits until the connection must be closed.
    pub(crate) async fn evicted(&self) {
        self.slot.end.notified().await;
    }
}

impl Drop for SlotGuard {
    fn drop(&mut self) {
        self.of.open().remove(&self.number);
        self.of.freed.notify_waiters();
    }
}

/// A body that arrives over the connection of this slot.
pub(crate) struct RequestBody {
    body: Incoming,
    slot: Arc<ConnectionSlot>,
}

impl RequestBody {
    pub(crate) fn new(body: Incoming, slot: Arc<ConnectionSlot>) -> Self {
        Self { body, slot }
    }
}

impl HttpBody for RequestBody {
    type Data = Bytes;
    type Error = hyper::Error;

    fn poll_frame(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<Option<hyper::Result<Frame<Bytes>>>> {
        let polled = Pin::new(&mut self.body).poll_frame(context);
        self.slot.set_answering(polled.is_ready());
        polled
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;

    fn peer(last: u8) -> Peer {
        Peer::at([192, 0, 2, last].into())
    }

    fn slot(last: u8, moved_ms: u64, answers: bool) -> Arc<ConnectionSlot> {
        let slot = ConnectionSlot::new(peer(last), Instant::now());
        slot.moved_ms.store(moved_ms, Ordering::Relaxed);
        slot.set_answering(answers);
        Arc::new(slot)
    }

    #[test]
    fn the_longest_idle_of_who_has_most_evicted_and_nobody_who_is_answered() {
        let open = [slot(1, 1, false), slot(2, 30, false), slot(2, 10, true), slot(2, 20, false), slot(2, 40, false)];
        let chosen = |count| -> Vec<(Peer, u64)> {
            let chosen = eviction_candidates(open.iter(), count);
            chosen.iter().map(|slot| (slot.peer, slot.moved_ms.load(Ordering::Relaxed))).collect()
        };
        assert_eq!(chosen(2), [(peer(2), 20), (peer(2), 30)]);
        let all = chosen(9);
        assert_eq!(all.len(), 4);
        assert!(!all.contains(&(peer(2), 10)));
        assert_eq!(all.last(), Some(&(peer(1), 1)));
    }

    #[tokio::test]
    async fn one_more_waits_until_somebody_is_idle() {
        let slots = ConnectionSlots::new(2);
        let (first, second) = (slots.acquire(peer(1)).await, slots.acquire(peer(1)).await);
        for guard in [&first, &second] {
            guard.slot().set_answering(true);
        }
        let mut third = Box::pin(slots.acquire(peer(2)));
        assert!((&mut third).now_or_never().is_none());
        assert!(first.evicted().now_or_never().is_none());
        first.slot().set_answering(false);
        let gone = async {
            first.evicted().await;
            drop(first);
        };
        let (third, ()) = tokio::join!(third, gone);
        assert!(second.evicted().now_or_never().is_none());
        drop((second, third));
        slots.all_free().await;
    }
}
