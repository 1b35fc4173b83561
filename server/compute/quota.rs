//! A quota that no peer can use up.
//!
//! A peer gets one more unit as long as it has fewer than are free (the dynamic threshold of Choudhury and Hahne, 1998): a single
//! peer gets half, two peers get a third each, and there is always a unit for one more.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::compute::peer::Peer;

/// A number of units, shared between peers.
#[derive(Debug, Clone)]
pub struct FairQuota(Arc<Usage>);

#[derive(Debug)]
struct Usage {
    most: usize,
    held: Mutex<BTreeMap<Peer, usize>>,
}

/// Units that a peer has reserved. They are free again when this is dropped.
#[derive(Debug)]
pub struct Reservation {
    quota: FairQuota,
    peer: Peer,
    units: usize,
}

/// The peer has as many units as are free.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct QuotaExceeded {
    /// Units of the peer.
    pub held: usize,
    /// Free units.
    pub free: usize,
}

impl FairQuota {
    /// A quota of `most` units.
    pub fn new(most: usize) -> Self {
        Self(Arc::new(Usage { most, held: Mutex::default() }))
    }

    /// Reserves a unit for `peer`.
    ///
    /// # Errors
    /// The peer has as many units as are free.
    pub fn try_reserve(&self, peer: Peer) -> Result<Reservation, QuotaExceeded> {
        self.try_reserve_units(peer, 1)
    }

    /// Reserves units for `peer`.
    ///
    /// # Errors
    /// The peer has as many units as are free, or fewer are free than it asks for.
    pub fn try_reserve_units(&self, peer: Peer, units: usize) -> Result<Reservation, QuotaExceeded> {
        let mut held = self.held();
        self.room(&held, peer, units)?;
        *held.entry(peer).or_default() += units;
        Ok(Reservation { quota: self.clone(), peer, units })
    }

    /// Checks whether `peer` would get a unit.
    ///
    /// # Errors
    /// The peer has as many units as are free.
    pub fn check(&self, peer: Peer) -> Result<(), QuotaExceeded> {
        self.room(&self.held(), peer, 1)
    }

    /// Reserves units for `peer`, also beyond the quota. They count all the same.
    pub fn charge(&self, peer: Peer, units: usize) -> Reservation {
        *self.held().entry(peer).or_default() += units;
        Reservation { quota: self.clone(), peer, units }
    }

    fn room(&self, held: &BTreeMap<Peer, usize>, peer: Peer, units: usize) -> Result<(), QuotaExceeded> {
        let free = self.0.most.saturating_sub(held.values().sum());
        let held = held.get(&peer).copied().unwrap_or_default();
        if held < free && units <= free { Ok(()) } else { Err(QuotaExceeded { held, free }) }
    }

    fn held(&self) -> MutexGuard<'_, BTreeMap<Peer, usize>> {
        self.0.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        let mut held = self.quota.held();
        if let Some(own) = held.get_mut(&self.peer) {
            *own -= self.units;
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
        let quota = FairQuota::new(16);
        let take = |last| -> Vec<Reservation> { std::iter::from_fn(|| quota.try_reserve(peer(last)).ok()).collect() };
        let first = take(1);
        assert_eq!(first.len(), 8);
        assert_eq!(quota.try_reserve(peer(1)).err(), Some(QuotaExceeded { held: 8, free: 8 }));
        let second = take(2);
        assert_eq!((second.len(), take(3).len()), (4, 2));
        drop(second);
        assert_eq!(quota.try_reserve(peer(1)).err(), Some(QuotaExceeded { held: 8, free: 8 }));
        drop(first);
        assert_eq!(take(1).len(), 8);
    }

    #[test]
    fn what_is_held_counts() {
        let quota = FairQuota::new(100);
        let much = quota.charge(peer(1), 150);
        assert_eq!(quota.check(peer(2)), Err(QuotaExceeded { held: 0, free: 0 }));
        drop(much);
        let half = quota.charge(peer(1), 50);
        assert_eq!(quota.check(peer(1)), Err(QuotaExceeded { held: 50, free: 50 }));
        assert!(quota.check(peer(2)).is_ok());
        drop(half);
        assert!(quota.check(peer(1)).is_ok());
    }

    #[test]
    fn many_units_need_as_many_free_ones() {
        let quota = FairQuota::new(100);
        assert_eq!(quota.try_reserve_units(peer(1), 101).err(), Some(QuotaExceeded { held: 0, free: 100 }));
        let most = quota.try_reserve_units(peer(1), 60).unwrap();
        // A peer with more than is left gets no more, and another one at most the rest.
        assert_eq!(quota.try_reserve_units(peer(1), 1).err(), Some(QuotaExceeded { held: 60, free: 40 }));
        assert_eq!(quota.try_reserve_units(peer(2), 41).err(), Some(QuotaExceeded { held: 0, free: 40 }));
        let rest = quota.try_reserve_units(peer(2), 40).unwrap();
        drop((most, rest));
        assert!(quota.try_reserve_units(peer(1), 100).is_ok());
    }

    #[test]
    fn the_only_place_is_anybodys() {
        let quota = FairQuota::new(1);
        let only = quota.try_reserve(peer(1)).unwrap();
        assert!(quota.try_reserve(peer(2)).is_err());
        drop(only);
        assert!(quota.try_reserve(peer(2)).is_ok());
    }
}
