//! Who has which connection, and which of them give way when all places are taken.

use std::collections::HashMap;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::Notify;
use tokio::time::timeout;

use crate::compute::Peer;
use crate::limits;

/// The places for connections.
#[derive(Debug)]
pub(crate) struct Places {
    most: usize,
    begin: Instant,
    open: Mutex<HashMap<u64, Arc<Place>>>,
    next: AtomicU64,
    freed: Notify,
}

/// The place of one connection, as far as others may ask for it.
#[derive(Debug)]
pub(crate) struct Place {
    peer: Peer,
    /// When the last byte went over it, ms after the beginning of time.
    moved_ms: AtomicU64,
    /// Whether its client waits for the server, and not the server for its client.
    answers: AtomicBool,
    end: Notify,
    begin: Instant,
}

/// A place that is taken; free again when it is dropped.
#[derive(Debug)]
pub(crate) struct Taken {
    number: u64,
    place: Arc<Place>,
    of: Arc<Places>,
}

impl Places {
    pub(crate) fn new(most: usize) -> Arc<Self> {
        let begin = Instant::now();
        Arc::new(Self { most, begin, open: Mutex::default(), next: AtomicU64::new(0), freed: Notify::new() })
    }

    /// A place for one more. If there is none, those give way whose clients have been waited for longest. Waits where
    /// everybody is being answered.
    pub(crate) async fn take(self: &Arc<Self>, peer: Peer) -> Taken {
        loop {
            let freed = self.freed.notified();
            {
                let mut open = self.open();
                if open.len() < self.most {
                    let number = self.next.fetch_add(1, Ordering::Relaxed);
                    let place = Arc::new(Place::new(peer, self.begin));
                    open.insert(number, place.clone());
                    return Taken { number, place, of: self.clone() };
                }
                for place in giving_way(open.values(), self.most.div_ceil(limits::CONNECTIONS_AT_ONCE)) {
                    place.end.notify_one();
                }
            }
            // Again after a while in any case: one that was being answered may be idle now.
            let _ = timeout(Duration::from_millis(20), freed).await;
        }
    }

    /// Waits until nobody has a place.
    pub(crate) async fn all_free(&self) {
        loop {
            let freed = self.freed.notified();
            if self.open().is_empty() {
                return;
            }
            freed.await;
        }
    }

    fn open(&self) -> MutexGuard<'_, HashMap<u64, Arc<Place>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// So many connections to close, of those whose clients are waited for: where a peer has more than others its own go first, and of
/// one peer's those over which nothing has gone for longest.
fn giving_way<'a>(open: impl Iterator<Item = &'a Arc<Place>>, count: usize) -> Vec<&'a Arc<Place>> {
    let mut peers: HashMap<Peer, Vec<(u64, &Arc<Place>)>> = HashMap::new();
    for place in open {
        let idle_since =
            if place.answers.load(Ordering::Relaxed) { u64::MAX } else { place.moved_ms.load(Ordering::Relaxed) };
        peers.entry(place.peer).or_default().push((idle_since, place));
    }
    let mut ranked = Vec::new();
    for places in peers.values_mut() {
        places.sort_unstable_by_key(|(idle_since, _)| std::cmp::Reverse(*idle_since));
        let idle = places.iter().enumerate().filter(|(_, (idle_since, _))| *idle_since != u64::MAX);
        ranked.extend(idle.map(|(rank, (_, place))| (rank, *place)));
    }
    ranked.sort_unstable_by_key(|(rank, _)| std::cmp::Reverse(*rank));
    ranked.truncate(count);
    ranked.into_iter().map(|(_, place)| place).collect()
}

impl Place {
    fn new(peer: Peer, begin: Instant) -> Self {
        let place =
            Self { peer, moved_ms: AtomicU64::new(0), answers: AtomicBool::new(false), end: Notify::new(), begin };
        place.moved();
        place
    }

    /// Bytes went over it.
    pub(crate) fn moved(&self) {
        let ms = u64::try_from(self.begin.elapsed().as_millis()).unwrap_or(u64::MAX - 1);
        self.moved_ms.store(ms, Ordering::Relaxed);
    }

    /// Whether its client waits for the server, from now on.
    pub(crate) fn answers(&self, answers: bool) {
        self.answers.store(answers, Ordering::Relaxed);
    }
}

impl Taken {
    /// The place.
    pub(crate) fn place(&self) -> &Arc<Place> {
        &self.place
    }

    /// Waits until it has to give way.
    pub(crate) async fn gives_way(&self) {
        self.place.end.notified().await;
    }
}

impl Drop for Taken {
    fn drop(&mut self) {
        self.of.open().remove(&self.number);
        self.of.freed.notify_waiters();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    fn peer(last: u8) -> Peer {
        Peer::at([192, 0, 2, last].into())
    }

    fn place(last: u8, moved_ms: u64, answers: bool) -> Arc<Place> {
        let place = Place::new(peer(last), Instant::now());
        place.moved_ms.store(moved_ms, Ordering::Relaxed);
        place.answers(answers);
        Arc::new(place)
    }

    #[test]
    fn the_longest_idle_of_who_has_most_gives_way_and_nobody_who_is_answered() {
        let open =
            [place(1, 1, false), place(2, 30, false), place(2, 10, true), place(2, 20, false), place(2, 40, false)];
        let chosen = |count| -> Vec<(Peer, u64)> {
            let chosen = giving_way(open.iter(), count);
            chosen.iter().map(|place| (place.peer, place.moved_ms.load(Ordering::Relaxed))).collect()
        };
        assert_eq!(chosen(2), [(peer(2), 20), (peer(2), 30)]);
        let all = chosen(9);
        assert_eq!(all.len(), 4);
        assert!(!all.contains(&(peer(2), 10)));
        assert_eq!(all.last(), Some(&(peer(1), 1)));
    }

    #[tokio::test]
    async fn one_more_waits_until_somebody_is_idle() {
        let places = Places::new(2);
        let (first, second) = (places.take(peer(1)).await, places.take(peer(1)).await);
        for taken in [&first, &second] {
            taken.place().answers(true);
        }
        let mut third = Box::pin(places.take(peer(2)));
        assert!((&mut third).now_or_never().is_none());
        assert!(first.gives_way().now_or_never().is_none());
        first.place().answers(false);
        let gone = async {
            first.gives_way().await;
            drop(first);
        };
        let (third, ()) = tokio::join!(third, gone);
        assert!(second.gives_way().now_or_never().is_none());
        drop((second, third));
        places.all_free().await;
    }
}
