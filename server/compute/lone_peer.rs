//! Knows whether one peer has been the only one for a while. All requests count, those that compute nothing too.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use crate::compute::peer::Peer;
use crate::limits;

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
    use super::*;
    use std::time::Duration;

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
