//! Places of which nobody can take so many that none is left for others.
//!
//! One more is given to whoever has fewer than are free (the dynamic threshold of Choudhury and Hahne, 1998): a peer alone gets
//! half of all, two get a third each, and one more always finds a place.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::compute::peer::Peer;

/// A number of places.
#[derive(Debug, Clone)]
pub struct Shares(Arc<Book>);

#[derive(Debug)]
struct Book {
    most: usize,
    held: Mutex<BTreeMap<Peer, usize>>,
}

/// A place, or several; free again when it is dropped.
#[derive(Debug)]
pub struct Share {
    of: Shares,
    peer: Peer,
    places: usize,
}

/// There is no place for a peer that has its share.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NoShare {
    /// How many it has.
    pub held: usize,
    /// How many are left for others.
    pub free: usize,
}

impl Shares {
    /// So many places.
    pub fn new(most: usize) -> Self {
        Self(Arc::new(Book { most, held: Mutex::default() }))
    }

    /// One of them, for `peer`.
    ///
    /// # Errors
    /// Where it has as many as are left.
    pub fn take(&self, peer: Peer) -> Result<Share, NoShare> {
        let mut held = self.held();
        self.room(&held, peer)?;
        *held.entry(peer).or_default() += 1;
        Ok(Share { of: self.clone(), peer, places: 1 })
    }

    /// Whether `peer` would get one.
    ///
    /// # Errors
    /// Where it has as many as are left.
    pub fn has_room(&self, peer: Peer) -> Result<(), NoShare> {
        self.room(&self.held(), peer)
    }

    /// So many places for `peer`, be they there or not: what is held is held, and counts.
    pub fn hold(&self, peer: Peer, places: usize) -> Share {
        *self.held().entry(peer).or_default() += places;
        Share { of: self.clone(), peer, places }
    }

    fn room(&self, held: &BTreeMap<Peer, usize>, peer: Peer) -> Result<(), NoShare> {
        let free = self.0.most.saturating_sub(held.values().sum());
        let held = held.get(&peer).copied().unwrap_or_default();
        if held < free { Ok(()) } else { Err(NoShare { held, free }) }
    }

    fn held(&self) -> MutexGuard<'_, BTreeMap<Peer, usize>> {
        self.0.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        let mut held = self.of.held();
        if let Some(own) = held.get_mut(&self.peer) {
            *own -= self.places;
            if *own == 0 {
                held.remove(&self.peer);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn peer(last: u8) -> Peer {
        Peer::at([192, 0, 2, last].into())
    }

    #[test]
    fn one_gets_half_and_the_next_still_gets_some() {
        let shares = Shares::new(16);
        let take = |last| -> Vec<Share> { std::iter::from_fn(|| shares.take(peer(last)).ok()).collect() };
        let first = take(1);
        assert_eq!(first.len(), 8);
        assert_eq!(shares.take(peer(1)).err(), Some(NoShare { held: 8, free: 8 }));
        let second = take(2);
        assert_eq!((second.len(), take(3).len()), (4, 2));
        drop(second);
        assert_eq!(shares.take(peer(1)).err(), Some(NoShare { held: 8, free: 8 }));
        drop(first);
        assert_eq!(take(1).len(), 8);
    }

    #[test]
    fn what_is_held_counts() {
        let shares = Shares::new(100);
        let much = shares.hold(peer(1), 150);
        assert_eq!(shares.has_room(peer(2)), Err(NoShare { held: 0, free: 0 }));
        drop(much);
        let half = shares.hold(peer(1), 50);
        assert_eq!(shares.has_room(peer(1)), Err(NoShare { held: 50, free: 50 }));
        assert!(shares.has_room(peer(2)).is_ok());
        drop(half);
        assert!(shares.has_room(peer(1)).is_ok());
    }

    #[test]
    fn the_only_place_is_anybodys() {
        let shares = Shares::new(1);
        let only = shares.take(peer(1)).unwrap();
        assert!(shares.take(peer(2)).is_err());
        drop(only);
        assert!(shares.take(peer(2)).is_ok());
    }
}
