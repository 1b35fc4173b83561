//! A queue for permits that serves its keys in turns, however many entries one of them has. An entry of several keys is served at the
//! first turn of any of them.

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
    /// Waiting entries. Those of one key are in the order in which they are served.
    entries: VecDeque<Entry>,
    /// All keys of waiting entries, each once; the next is at the front.
    turns: VecDeque<QueueKey>,
}

#[derive(Debug)]
struct Entry {
    place: Place,
    sender: oneshot::Sender<Permit>,
}

/// Entries of one key are served in their order; different keys are served in turns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum QueueKey {
    /// Requests of a peer.
    Short(Peer),
    /// Blocks of long work of a peer.
    Long(Peer),
}

/// The place of some work in the queue: the keys of all peers that wait for it.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    of: fn(Peer) -> QueueKey,
    crowd: Crowd,
}

/// The peers that wait for some work, each as often as it has requests for it.
#[derive(Debug, Clone)]
pub(crate) struct Crowd(Arc<Mutex<Vec<Peer>>>);

/// A request among those that wait for some work. When it is dropped, the work has no place of that peer any more.
#[derive(Debug)]
pub(crate) struct Member {
    crowd: Crowd,
    peer: Peer,
}

/// The right to compute. When it is dropped, the next entry gets it.
#[derive(Debug)]
pub(crate) struct Permit(Option<Arc<FairQueue>>);

impl Crowd {
    /// The work of one peer.
    pub(crate) fn of(peer: Peer) -> Self {
        Self(Arc::new(Mutex::new(vec![peer])))
    }

    /// The work of one peer, with its request.
    pub(crate) fn begin(peer: Peer) -> (Self, Member) {
        let crowd = Self::of(peer);
        (crowd.clone(), Member { crowd, peer })
    }

    fn peers(&self) -> MutexGuard<'_, Vec<Peer>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Drop for Member {
    fn drop(&mut self) {
        let mut peers = self.crowd.peers();
        if let Some(index) = peers.iter().position(|peer| *peer == self.peer) {
            peers.swap_remove(index);
        }
    }
}

impl Place {
    /// The place of requests.
    pub(crate) fn short(crowd: &Crowd) -> Self {
        Self { of: QueueKey::Short, crowd: crowd.clone() }
    }

    /// The place of blocks of long work.
    pub(crate) fn long(crowd: &Crowd) -> Self {
        Self { of: QueueKey::Long, crowd: crowd.clone() }
    }

    fn has(&self, key: QueueKey) -> bool {
        self.crowd.peers().iter().any(|peer| (self.of)(*peer) == key)
    }

    fn keys(&self) -> Vec<QueueKey> {
        self.crowd.peers().iter().map(|peer| (self.of)(*peer)).collect()
    }
}

impl FairQueue {
    pub(crate) fn new(permits: usize) -> Arc<Self> {
        Arc::new(Self(Mutex::new(QueueState { permits, held: 0, entries: VecDeque::new(), turns: VecDeque::new() })))
    }

    /// Takes a permit if one is free.
    pub(crate) fn try_acquire(self: &Arc<Self>) -> Option<Permit> {
        self.state().take().then(|| Permit(Some(self.clone())))
    }

    /// Changes the number of permits. New ones go to the entries that wait. Of those that are taken away, held ones end when they are
    /// dropped.
    pub(crate) fn set_permits(self: &Arc<Self>, permits: usize) {
        self.state().permits = permits;
        self.give_free_permits();
    }

    /// Adds a request of a peer to those that wait for some work, also while the work is in the queue.
    pub(crate) fn join(self: &Arc<Self>, crowd: &Crowd, peer: Peer) -> Member {
        {
            let mut state = self.state();
            crowd.peers().push(peer);
            let of_crowd = state.entries.iter().filter(|entry| entry.place.crowd.is(crowd));
            let keys: Vec<_> = of_crowd.map(|entry| (entry.place.of)(peer)).collect();
            for key in keys {
                state.add_turn(key);
            }
        }
        // Work that everybody had left has no turn, even if a permit is free.
        self.give_free_permits();
        Member { crowd: crowd.clone(), peer }
    }

    /// Waits for a permit. Dropping the future leaves the queue.
    pub(crate) async fn acquire(self: &Arc<Self>, place: Place) -> Permit {
        let receiver = {
            let mut state = self.state();
            if state.take() {
                return Permit(Some(self.clone()));
            }
            let (sender, receiver) = oneshot::channel();
            state.add_turns(&place);
            state.entries.push_back(Entry { place, sender });
            receiver
        };
        receiver.await.expect("senders are dropped by their receivers alone")
    }

    /// Queues work that is about to give its permit back in the middle: it goes before all other entries of its keys, so that the
    /// work of a peer ends in the order in which it began.
    pub(crate) fn requeue(self: &Arc<Self>, place: Place) -> impl Future<Output = Permit> + use<> {
        let (sender, receiver) = oneshot::channel();
        let mut state = self.state();
        state.add_turns(&place);
        state.entries.push_front(Entry { place, sender });
        async { receiver.await.expect("senders are dropped by their receivers alone") }
    }

    /// Tells whether entries wait under a key that is not of this place.
    pub(crate) fn has_others_waiting(&self, place: &Place) -> bool {
        let own = place.keys();
        self.state().entries.iter().any(|entry| entry.place.keys().iter().any(|key| !own.contains(key)))
    }

    fn give_free_permits(self: &Arc<Self>) {
        while self.state().take_for_waiting() {
            self.hand_over();
        }
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

    /// Takes a permit if one is free and there are keys.
    fn take_for_waiting(&mut self) -> bool {
        !self.turns.is_empty() && self.take()
    }

    fn add_turns(&mut self, place: &Place) {
        for key in place.keys() {
            self.add_turn(key);
        }
    }

    fn add_turn(&mut self, key: QueueKey) {
        if !self.turns.contains(&key) {
            self.turns.push_back(key);
        }
    }

    /// Takes the next entry for a held permit. If there is none, or the permit was taken away, it is held no more.
    fn next(&mut self) -> Option<oneshot::Sender<Permit>> {
        while self.held <= self.permits
            && let Some(key) = self.turns.pop_front()
        {
            self.entries.retain(|entry| !entry.sender.is_closed());
            if let Some(next) = self.entries.iter().position(|entry| entry.place.has(key)) {
                let entry = self.entries.remove(next)?;
                if self.entries.iter().any(|entry| entry.place.has(key)) {
                    self.turns.push_back(key);
                }
                return Some(entry.sender);
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

    fn short(last: u8) -> Place {
        Place::short(&Crowd::of(peer(last)))
    }

    #[test]
    fn peers_take_turns_whatever_the_length_of_their_lines() {
        let queue = FairQueue::new(1);
        let only = queue.try_acquire().unwrap();
        let keys = [short(1), short(2), Place::long(&Crowd::of(peer(1)))];
        let mut waiting: Vec<_> =
            [0, 0, 0, 0, 1, 2, 2].map(|key| (key, Box::pin(queue.acquire(keys[key].clone())))).into();
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
        let keys = [short(1), short(2)];
        let mut held = queue.try_acquire();
        assert!(!queue.has_others_waiting(&keys[0]));
        let mut own = Box::pin(queue.acquire(keys[0].clone()));
        assert!((&mut own).now_or_never().is_none() && !queue.has_others_waiting(&keys[0]));
        let mut other = Box::pin(queue.acquire(keys[1].clone()));
        assert!((&mut other).now_or_never().is_none() && queue.has_others_waiting(&keys[0]));
        // The next turn is of its own key, and the one after it of the other key.
        let mut again = Box::pin(queue.requeue(keys[0].clone()));
        drop(held.take());
        held = (&mut again).now_or_never();
        assert!(held.is_some() && (&mut own).now_or_never().is_none());
        let mut again = Box::pin(queue.requeue(keys[0].clone()));
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
        let mut waiting = [1, 2, 3].map(|last| Box::pin(queue.acquire(short(last))));
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
        let mut gone = Box::pin(queue.acquire(short(1)));
        let mut given = Box::pin(queue.acquire(short(1)));
        let mut last = Box::pin(queue.acquire(short(1)));
        assert!([&mut gone, &mut given, &mut last].into_iter().all(|permit| permit.now_or_never().is_none()));
        drop(gone);
        drop(only);
        // It has got its permit, and leaves without taking it.
        drop(given);
        assert!(last.now_or_never().is_some());
        assert!(queue.try_acquire().is_some());
    }

    #[test]
    fn work_of_several_peers_has_the_best_place_of_all() {
        let queue = FairQueue::new(1);
        let mut held = queue.try_acquire();
        let pending = |place: &Place| {
            let mut waiting = Box::pin(queue.acquire(place.clone()));
            assert!((&mut waiting).now_or_never().is_none());
            waiting
        };
        // The work is the third of its first peer, and the first of a second one that joins while it waits.
        let crowd = Crowd::of(peer(1));
        let joined = Place::long(&crowd);
        let others = [(); 2].map(|()| pending(&Place::long(&Crowd::of(peer(1)))));
        let mut waiting = pending(&joined);
        let second = queue.join(&crowd, peer(2));
        assert_eq!(queue.state().turns, [QueueKey::Long(peer(1)), QueueKey::Long(peer(2))]);
        let [mut first_of_one, mut second_of_one] = others;
        drop(held.take());
        held = (&mut first_of_one).now_or_never();
        assert!(held.is_some() && (&mut waiting).now_or_never().is_none());
        drop(held.take());
        held = (&mut waiting).now_or_never();
        assert!(held.is_some() && (&mut second_of_one).now_or_never().is_none());
        // In the middle of the work both keep their places. Entries of its own peers are no reason to pass the permit on.
        assert!(!queue.has_others_waiting(&joined));
        let third = pending(&short(3));
        assert!(queue.has_others_waiting(&joined));
        let mut again = Box::pin(queue.requeue(joined.clone()));
        drop(held.take());
        let mut held = (&mut again).now_or_never();
        assert!(held.is_some(), "it is before the other entries of its first peer");
        // Without the second peer the work has the place of the first alone.
        drop(second);
        let mut waiting = vec![("third", third), ("first", second_of_one), ("joined", pending(&joined))];
        let mut order = Vec::new();
        while !waiting.is_empty() {
            drop(held.take());
            let next = waiting.iter_mut().position(|(_, permit)| {
                held = permit.now_or_never();
                held.is_some()
            });
            order.push(waiting.remove(next.expect("somebody's turn")).0);
        }
        assert_eq!(order, ["third", "first", "joined"]);
        drop(held);
        assert!(queue.try_acquire().is_some());
    }

    #[test]
    fn work_that_all_have_left_holds_up_nobody() {
        let queue = FairQueue::new(1);
        let only = queue.try_acquire();
        let (crowd, member) = Crowd::begin(peer(1));
        let mut left = Box::pin(queue.acquire(Place::short(&crowd)));
        let mut other = Box::pin(queue.acquire(short(2)));
        assert!((&mut left).now_or_never().is_none() && (&mut other).now_or_never().is_none());
        drop(member);
        queue.set_permits(2);
        assert!(other.now_or_never().is_some() && (&mut left).now_or_never().is_none());
        // A request for it comes before it is cancelled.
        let _member = queue.join(&crowd, peer(3));
        assert!(left.now_or_never().is_some());
        drop(only);
    }
}
