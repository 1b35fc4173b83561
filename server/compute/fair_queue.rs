//! A queue for permits that serves its keys in turns, however many entries one of them has.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

use crate::compute::peer::Peer;

/// A number of permits and the queue for them.
#[derive(Debug)]
pub(crate) struct FairQueue(Mutex<QueueState>);

#[derive(Debug)]
struct QueueState {
    /// Number of permits.
    permits: usize,
    /// Permits that are held. More than there are only after some were taken away; fewer only while nobody waits.
    held: usize,
    /// Waiting entries by key; the next key is at the front.
    keys: VecDeque<(QueueKey, VecDeque<oneshot::Sender<Permit>>)>,
}

/// Entries of one key are served in their order; different keys are served in turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum QueueKey {
    /// Requests of a peer.
    Short(Peer),
    /// Blocks of long work of a peer.
    Long(Peer),
}

/// The right to compute. When it is dropped, the next entry gets it.
#[derive(Debug)]
pub(crate) struct Permit(Option<Arc<FairQueue>>);

impl FairQueue {
    pub(crate) fn new(permits: usize) -> Arc<Self> {
        Arc::new(Self(Mutex::new(QueueState { permits, held: 0, keys: VecDeque::new() })))
    }

    /// Takes a permit if one is free.
    pub(crate) fn try_acquire(self: &Arc<Self>) -> Option<Permit> {
        self.state().take().then(|| Permit(Some(self.clone())))
    }

    /// Changes the number of permits. New ones go to the entries that wait. Of those that are taken away, held ones end when they are
    /// dropped.
    pub(crate) fn set_permits(self: &Arc<Self>, permits: usize) {
        self.state().permits = permits;
        while self.state().take_for_waiting() {
            self.hand_over();
        }
    }

    /// Waits for a permit. Dropping the future leaves the queue.
    pub(crate) async fn acquire(self: &Arc<Self>, key: QueueKey) -> Permit {
        let receiver = {
            let mut state = self.state();
            if state.take() {
                return Permit(Some(self.clone()));
            }
            let (sender, receiver) = oneshot::channel();
            state.waiting(key).push_back(sender);
            receiver
        };
        receiver.await.expect("senders are dropped by their receivers alone")
    }

    /// Queues work that is about to give its permit back in the middle: it goes before all other entries of its key, so that the
    /// work of a peer ends in the order in which it began.
    pub(crate) fn requeue(self: &Arc<Self>, key: QueueKey) -> impl Future<Output = Permit> + use<> {
        let (sender, receiver) = oneshot::channel();
        self.state().waiting(key).push_front(sender);
        async { receiver.await.expect("senders are dropped by their receivers alone") }
    }

    /// Tells whether entries of another key wait.
    pub(crate) fn has_others_waiting(&self, key: QueueKey) -> bool {
        self.state().keys.iter().any(|(other, _)| *other != key)
    }

    /// Gives a permit to the next entry, if there is one.
    fn hand_over(self: &Arc<Self>) {
        loop {
            let Some(next) = self.state().next() else { return };
            match next.send(Permit(Some(self.clone()))) {
                Ok(()) => return,
                // The receiver has gone in the meantime; the permit is still to be given.
                Err(mut permit) => drop(permit.0.take()),
            }
        }
    }

    fn state(&self) -> MutexGuard<'_, QueueState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl QueueState {
    /// Takes a permit if one is free.
    fn take(&mut self) -> bool {
        let is_free = self.held < self.permits;
        self.held += usize::from(is_free);
        is_free
    }

    /// Takes a permit if one is free and there are entries.
    fn take_for_waiting(&mut self) -> bool {
        !self.keys.is_empty() && self.take()
    }

    /// Waiting entries of a key.
    fn waiting(&mut self, key: QueueKey) -> &mut VecDeque<oneshot::Sender<Permit>> {
        let place = self.keys.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            self.keys.push_back((key, VecDeque::new()));
            self.keys.len() - 1
        });
        &mut self.keys[place].1
    }

    /// Takes the next entry for a held permit. If there is none, or the permit was taken away, it is held no more.
    fn next(&mut self) -> Option<oneshot::Sender<Permit>> {
        while self.held <= self.permits
            && let Some((key, mut waiting)) = self.keys.pop_front()
        {
            let next = std::iter::from_fn(|| waiting.pop_front()).find(|next| !next.is_closed());
            if !waiting.is_empty() {
                self.keys.push_back((key, waiting));
            }
            if next.is_some() {
                return next;
            }
        }
        self.held -= 1;
        None
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        if let Some(queue) = self.0.take() {
            queue.hand_over();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    fn peer(last: u8) -> Peer {
        Peer::at([192, 0, 2, last].into())
    }

    #[test]
    fn peers_take_turns_whatever_the_length_of_their_lines() {
        let queue = FairQueue::new(1);
        let only = queue.try_acquire().unwrap();
        let keys = [QueueKey::Short(peer(1)), QueueKey::Short(peer(2)), QueueKey::Long(peer(1))];
        let mut waiting: Vec<_> = [0, 0, 0, 0, 1, 2, 2].map(|key| (key, Box::pin(queue.acquire(keys[key])))).into();
        for (_, permit) in &mut waiting {
            assert!(permit.now_or_never().is_none());
        }
        drop(only);
        let mut order = Vec::new();
        while !waiting.is_empty() {
            let next = waiting.iter_mut().position(|(_, permit)| permit.now_or_never().is_some());
            // The permit is dropped at once and so handed over.
            order.push(waiting.remove(next.expect("somebody's turn")).0);
        }
        assert_eq!(order, [0, 1, 2, 0, 2, 0, 0]);
        assert!(queue.try_acquire().is_some());
    }

    #[test]
    fn who_comes_back_is_before_its_own_and_after_others() {
        let queue = FairQueue::new(1);
        let keys = [QueueKey::Short(peer(1)), QueueKey::Short(peer(2))];
        let mut held = queue.try_acquire();
        assert!(!queue.has_others_waiting(keys[0]));
        let mut own = Box::pin(queue.acquire(keys[0]));
        assert!((&mut own).now_or_never().is_none() && !queue.has_others_waiting(keys[0]));
        let mut other = Box::pin(queue.acquire(keys[1]));
        assert!((&mut other).now_or_never().is_none() && queue.has_others_waiting(keys[0]));
        // The next turn is of its own key, and the one after it of the other key.
        let mut again = Box::pin(queue.requeue(keys[0]));
        drop(held.take());
        held = (&mut again).now_or_never();
        assert!(held.is_some() && (&mut own).now_or_never().is_none());
        let mut again = Box::pin(queue.requeue(keys[0]));
        drop(held.take());
        let others = (&mut other).now_or_never();
        assert!(others.is_some() && (&mut again).now_or_never().is_none());
        drop(others);
        held = (&mut again).now_or_never();
        assert!(held.is_some() && (&mut own).now_or_never().is_none());
        drop(held);
        assert!(own.now_or_never().is_some());
    }

    #[test]
    fn permits_come_and_go() {
        let queue = FairQueue::new(1);
        let only = queue.try_acquire().unwrap();
        let mut waiting = [1, 2, 3].map(|last| Box::pin(queue.acquire(QueueKey::Short(peer(last)))));
        assert!(waiting.iter_mut().all(|permit| permit.now_or_never().is_none()));
        queue.set_permits(3);
        let given = waiting.each_mut().map(|permit| permit.now_or_never());
        assert_eq!(given.each_ref().map(Option::is_some), [true, true, false]);
        queue.set_permits(1);
        drop((only, given));
        let last = (&mut waiting[2]).now_or_never();
        assert!(last.is_some() && queue.try_acquire().is_none());
        drop(last);
        let one = queue.try_acquire();
        assert!(one.is_some() && queue.try_acquire().is_none());
    }

    #[test]
    fn who_leaves_the_line_costs_no_permit() {
        let queue = FairQueue::new(1);
        let only = queue.try_acquire().unwrap();
        let mut gone = Box::pin(queue.acquire(QueueKey::Short(peer(1))));
        let mut given = Box::pin(queue.acquire(QueueKey::Short(peer(1))));
        let mut last = Box::pin(queue.acquire(QueueKey::Short(peer(1))));
        assert!([&mut gone, &mut given, &mut last].into_iter().all(|permit| permit.now_or_never().is_none()));
        drop(gone);
        drop(only);
        // It has got its permit, and leaves without taking it.
        drop(given);
        assert!(last.now_or_never().is_some());
        assert!(queue.try_acquire().is_some());
    }
}
