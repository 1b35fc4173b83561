//! The gate to the async threads: one peer's work stands on at most half of them at a time, so that they answer others.
//!
//! Work that waits here is not refused, and waits in no queue that others wait in.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError, Weak};

use tokio::task::yield_now;

use crate::compute::fair_queue::{Flow, Line, Permit};
use crate::compute::peer::Peer;

/// Who works on the async threads. Clones share it.
#[derive(Debug, Clone)]
pub(crate) struct Gate(Arc<Book>);

#[derive(Debug)]
struct Book {
    /// How many works of one peer there may be at a time.
    most: usize,
    /// A line for each peer that has some, or waits.
    lines: Mutex<BTreeMap<Peer, Weak<Line>>>,
}

/// The right to work on an async thread, up to the next await.
#[derive(Debug)]
pub struct Slot {
    _permit: Permit,
}

impl Gate {
    /// A gate to so many threads.
    pub(crate) fn new(threads: usize) -> Self {
        Self(Arc::new(Book { most: threads.div_ceil(2), lines: Mutex::default() }))
    }

    /// A slot for `peer`, when it is free.
    pub(crate) async fn enter(&self, peer: Peer) -> Slot {
        let line = self.line(peer);
        if let Some(permit) = line.try_take() {
            return Slot { _permit: permit };
        }
        let permit = line.take(Flow::Short(peer)).await;
        // With one thread for all, others are looked at in between.
        yield_now().await;
        Slot { _permit: permit }
    }

    fn line(&self, peer: Peer) -> Arc<Line> {
        let mut lines = self.0.lines.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(line) = lines.get(&peer).and_then(Weak::upgrade) {
            return line;
        }
        lines.retain(|_, line| line.strong_count() > 0);
        let line = Line::new(self.0.most);
        lines.insert(peer, Arc::downgrade(&line));
        line
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use futures_util::FutureExt;

    #[test]
    fn one_peer_has_half_of_the_threads_and_others_have_theirs() {
        let (gate, [one, other]) = (Gate::new(4), [1, 2].map(|last| Peer::at([192, 0, 2, last].into())));
        let enter = |peer| gate.enter(peer).now_or_never();
        let held = [enter(one), enter(one)];
        assert!(held.iter().all(Option::is_some) && enter(one).is_none());
        assert!(enter(other).is_some());
        let mut waiting = Box::pin(gate.enter(one));
        assert!((&mut waiting).now_or_never().is_none());
        drop(held);
        assert_eq!(gate.0.lines.lock().unwrap().len(), 2);
    }

    #[tokio::test]
    async fn who_waits_gets_its_slot_and_who_has_gone_is_forgotten() {
        let (gate, peer) = (Gate::new(1), Peer::NOBODY);
        let held = gate.enter(peer).await;
        let next = tokio::spawn({
            let gate = gate.clone();
            async move { drop(gate.enter(peer).await) }
        });
        tokio::task::yield_now().await;
        assert!(!next.is_finished());
        drop(held);
        next.await.unwrap();
        let other = gate.enter(Peer::at([192, 0, 2, 1].into())).await;
        assert_eq!(gate.0.lines.lock().unwrap().len(), 1, "the line of {peer:?} is kept");
        drop(other);
    }
}
