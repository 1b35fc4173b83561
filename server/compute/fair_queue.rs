//! A line in which everybody who waits is served in turns, whatever the number of those that one client has put into it.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

use crate::compute::peer::Peer;

/// Permits, and those who wait for one.
#[derive(Debug)]
pub(crate) struct FairQueue(Mutex<QueueState>);

#[derive(Debug)]
struct QueueState {
    /// More than none only where nobody waits.
    free: usize,
    /// Who waits, the next at the front.
    keys: VecDeque<(QueueKey, VecDeque<oneshot::Sender<Permit>>)>,
}

/// What is served in the order in which it came, and in turns with others: a peer's requests, and the blocks of its long work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum QueueKey {
    /// Requests.
    Short(Peer),
    /// Blocks of long work.
    Long(Peer),
}

/// The right to compute; the next one's when dropped.
#[derive(Debug)]
pub(crate) struct Permit(Option<Arc<FairQueue>>);

impl FairQueue {
    pub(crate) fn new(permits: usize) -> Arc<Self> {
        Arc::new(Self(Mutex::new(QueueState { free: permits, keys: VecDeque::new() })))
    }

    /// A permit, if one is free.
    pub(crate) fn try_acquire(self: &Arc<Self>) -> Option<Permit> {
        let mut state = self.state();
        state.free = state.free.checked_sub(1)?;
        Some(Permit(Some(self.clone())))
    }

    /// A permit when it is the turn of `flow`. Whoever drops the future has left the line.
    pub(crate) async fn acquire(self: &Arc<Self>, key: QueueKey) -> Permit {
        let receiver = {
            let mut state = self.state();
            if state.free > 0 {
                state.free -= 1;
                return Permit(Some(self.clone()));
            }
            let (sender, receiver) = oneshot::channel();
            state.waiting(key).push_back(sender);
            receiver
        };
        receiver.await.expect("senders are dropped by their receivers alone")
    }

    /// The same for who is about to give a permit back in the midst of its work: it waits from now on, before all else of its
    /// flow, so that a peer's work is ended in the order in which it was begun.
    pub(crate) fn requeue(self: &Arc<Self>, key: QueueKey) -> impl Future<Output = Permit> + use<> {
        let (sender, receiver) = oneshot::channel();
        self.state().waiting(key).push_front(sender);
        async { receiver.await.expect("senders are dropped by their receivers alone") }
    }

    /// Tells whether another than `flow` waits.
    pub(crate) fn has_others_waiting(&self, key: QueueKey) -> bool {
        self.state().keys.iter().any(|(other, _)| *other != key)
    }

    /// Gives a permit that somebody had to the next, if anybody waits.
    fn hand_over(self: &Arc<Self>) {
        loop {
            let Some(next) = self.state().next() else { return };
            match next.send(Permit(Some(self.clone()))) {
                Ok(()) => return,
                // Gone in between; the permit is still to be given.
                Err(mut permit) => drop(permit.0.take()),
            }
        }
    }

    fn state(&self) -> MutexGuard<'_, QueueState> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl QueueState {
    /// Those of a flow who wait.
    fn waiting(&mut self, key: QueueKey) -> &mut VecDeque<oneshot::Sender<Permit>> {
        let place = self.keys.iter().position(|(known, _)| *known == key).unwrap_or_else(|| {
            self.keys.push_back((key, VecDeque::new()));
            self.keys.len() - 1
        });
        &mut self.keys[place].1
    }

    /// Who is next. If nobody is, one more permit is free.
    fn next(&mut self) -> Option<oneshot::Sender<Permit>> {
        while let Some((key, mut waiting)) = self.keys.pop_front() {
            let next = std::iter::from_fn(|| waiting.pop_front()).find(|next| !next.is_closed());
            if !waiting.is_empty() {
                self.keys.push_back((key, waiting));
            }
            if next.is_some() {
                return next;
            }
        }
        self.free += 1;
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
            // The permit is dropped at once, and so passed on.
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
        // Its flow is the next in any case, and then the other's.
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
    fn who_leaves_the_line_costs_no_permit() {
        let queue = FairQueue::new(1);
        let only = queue.try_acquire().unwrap();
        let mut gone = Box::pin(queue.acquire(QueueKey::Short(peer(1))));
        let mut given = Box::pin(queue.acquire(QueueKey::Short(peer(1))));
        let mut last = Box::pin(queue.acquire(QueueKey::Short(peer(1))));
        assert!([&mut gone, &mut given, &mut last].into_iter().all(|permit| permit.now_or_never().is_none()));
        drop(gone);
        drop(only);
        // It has its permit, and leaves without looking.
        drop(given);
        assert!(last.now_or_never().is_some());
        assert!(queue.try_acquire().is_some());
    }
}
