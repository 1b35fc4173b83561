//! Admission of work: its price, known before it is done and checked against a limit; quotas; refusals because of overload; the priority of the
//! threads that compute.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::compute::peer::Peer;
use crate::limits;
use crate::limits::Limit;

/// The cost of one piece of work.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Price {
    bounces: u64,
    /// Most memory besides that of any work, bytes.
    bytes: u64,
}

impl Limit {
    /// Checks an amount.
    ///
    /// # Errors
    /// The amount is over the limit.
    pub fn admit(&self, amount: u64) -> Result<(), OverBudget> {
        if amount <= self.most { Ok(()) } else { Err(OverBudget { amount, limit: *self }) }
    }
}

impl Price {
    /// Price of so many bounces of the plain rod, the unit of all prices. Other bounces cost a multiple of it.
    pub fn bounces(bounces: u64) -> Self {
        Self { bounces, bytes: 0 }
    }

    /// The same price, of work that takes so many bytes of memory besides those of any work.
    pub fn taking(self, bytes: u64) -> Self {
        Self { bytes, ..self }
    }

    /// Price of the same work `factor` times. It saturates, so that an overflow passes every limit.
    pub fn times(self, factor: u64) -> Self {
        Self { bounces: self.bounces.saturating_mul(factor), bytes: self.bytes.saturating_mul(factor) }
    }

    /// Sum of two prices. It saturates too.
    pub fn and(self, other: Self) -> Self {
        Self { bounces: self.bounces.saturating_add(other.bounces), bytes: self.bytes.saturating_add(other.bytes) }
    }

    /// The price in bounces of the plain rod.
    pub fn as_bounces(self) -> u64 {
        self.bounces
    }

    /// Most memory of the work, bytes.
    pub fn as_bytes(self) -> u64 {
        self.bytes.saturating_add(limits::WORK_BYTES as u64)
    }

    /// Returns the price if it is within the limit.
    ///
    /// # Errors
    /// The price is over the limit.
    pub fn within(self, limit: &Limit) -> Result<Self, OverBudget> {
        limit.admit(self.bounces).map(|()| self)
    }
}

/// An amount over its limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct OverBudget {
    /// The amount.
    pub amount: u64,
    /// The limit.
    pub limit: Limit,
}

impl fmt::Display for OverBudget {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        let Limit { name, most, unit } = self.limit;
        write!(formatter, "the {name} would be {} {unit}; the limit is {most} {unit}", self.amount)
    }
}

impl std::error::Error for OverBudget {}

// A quota that no peer can use up.
//
// A peer gets one more unit as long as it has fewer than are free (the dynamic threshold of Choudhury and Hahne, 1998): a single
// peer gets half, two peers get a third each, and there is always a unit for one more.

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

/// Work was refused because of overload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Overloaded {
    /// The queue is full.
    QueueFull(QuotaExceeded),
    /// The client has too many unread answers.
    UnreadAnswers(QuotaExceeded),
    /// The work would take more memory than is left for the client.
    Memory(QuotaExceeded),
    /// No permit became free in time.
    QueueTimeout {
        /// Time in the queue, s.
        waited_s: u64,
    },
}

impl fmt::Display for Overloaded {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Overloaded::QueueFull(QuotaExceeded { held, free }) => {
                write!(formatter, "{held} requests from this address are computed or waiting, and ")?;
                match free {
                    0 => formatter.write_str("no place is left"),
                    free => write!(formatter, "the last {free} places are for others"),
                }
            }
            Overloaded::UnreadAnswers(QuotaExceeded { held, free }) => {
                write!(formatter, "{held} bytes of answers are still to be read from this address, and ")?;
                write!(formatter, "the last {free} bytes of memory for answers are for others")
            }
            Overloaded::Memory(QuotaExceeded { held, free }) => {
                write!(
                    formatter,
                    "answers for this address are computed in {held} bytes of memory, and {free} bytes are free, "
                )?;
                formatter.write_str("too few for one more")
            }
            Overloaded::QueueTimeout { waited_s } => {
                write!(formatter, "the request waited {waited_s} s for its turn, the limit")
            }
        }
    }
}

impl std::error::Error for Overloaded {}

/// Lowers the priority of this thread and of those that it starts, so that short requests are answered first when there are more
/// threads than cores. Only Linux has priorities of threads.
pub(crate) fn lower_priority() {
    #[cfg(target_os = "linux")]
    {
        thread_local!(static STANDS: std::cell::Cell<bool> = const { std::cell::Cell::new(false) });
        if !STANDS.replace(true) {
            // If it is not permitted, only other requests get slower.
            let _ = rustix::process::nice(limits::COMPUTE_NICENESS);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WORK: Limit = Limit { name: "work of this request", most: 100, unit: "bounces" };

    #[test]
    fn the_error_names_price_and_limit() {
        assert_eq!(Price::bounces(50).times(2).within(&WORK), Ok(Price::bounces(100)));
        let over = Price::bounces(50).times(2).and(Price::bounces(1)).within(&WORK).unwrap_err();
        assert_eq!(over.to_string(), "the work of this request would be 101 bounces; the limit is 100 bounces");
    }

    #[test]
    fn an_absurd_price_does_not_wrap() {
        assert!(Price::bounces(u64::MAX).times(2).within(&WORK).is_err());
        assert!(Price::bounces(u64::MAX).and(Price::bounces(2)).within(&WORK).is_err());
    }

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
