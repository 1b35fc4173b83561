//! Runs work beside the async threads, as much at a time as there are cores, with a short queue and a no beyond it. Work that is
//! hardly worth the way there is done on them, for a short time.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use prometheus_client::metrics::gauge::Gauge;
use tokio::runtime::Handle;
use tokio::task::spawn_blocking;
use tokio::time::timeout;

use crate::compute::cancel::{Cancel, OnDrop};
use crate::compute::fair_queue::{Flow, Line, Permit};
use crate::compute::gate::{Gate, Slot};
use crate::compute::peer::Peer;
use crate::compute::price::Price;
use crate::compute::quota::{NoShare, Share, Shares};
use crate::compute::time_slices::Turns;
use crate::compute::turn::Turn;
use crate::limits;
use crate::limits::Limits;

/// Admits work and runs it. Cheap to clone; clones share their permits.
#[derive(Debug, Clone)]
pub struct Pool {
    /// Places to run or to wait in.
    places: Shares,
    /// Permits to run.
    line: Arc<Line>,
    /// Slots on the async threads.
    gate: Gate,
    /// Bytes of results that are still to be taken.
    results: Shares,
    count: usize,
    queue_time: Duration,
    /// Whose work it is.
    peer: Peer,
    running: Gauge,
    queued: Gauge,
}

/// Work that was not done because there is too much of it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refused {
    /// No place to wait in.
    Full(NoShare),
    /// Too many bytes of earlier results are still to be taken.
    Untaken(NoShare),
    /// A place, but no turn in good time.
    Late {
        /// Seconds it waited.
        waited_s: u64,
    },
}

impl fmt::Display for Refused {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Refused::Full(NoShare { held, free }) => {
                write!(formatter, "{held} requests from this address are computed or waiting, and ")?;
                match free {
                    0 => formatter.write_str("no place is left"),
                    free => write!(formatter, "the last {free} places are for others"),
                }
            }
            Refused::Untaken(NoShare { held, free }) => {
                write!(formatter, "{held} bytes of answers are still to be read from this address, and ")?;
                write!(formatter, "the last {free} bytes of memory for answers are for others")
            }
            Refused::Late { waited_s } => write!(formatter, "the request waited {waited_s} s for its turn, the limit"),
        }
    }
}

impl std::error::Error for Refused {}

impl Pool {
    /// A pool that does `permits` pieces of work at a time.
    pub fn new(permits: usize, limits: &Limits) -> Self {
        Self {
            places: Shares::new(permits * (1 + limits.queue)),
            line: Line::new(permits),
            gate: Gate::new(permits),
            results: Shares::new(limits.held_bytes),
            count: permits,
            queue_time: limits.queue_time,
            peer: Peer::NOBODY,
            running: Gauge::default(),
            queued: Gauge::default(),
        }
    }

    /// The same pool for the work of this peer.
    pub fn of(&self, peer: Peer) -> Self {
        Self { peer, ..self.clone() }
    }

    /// A result of work, which counts as memory of the peer's until it is dropped.
    pub fn hold(&self, result: Vec<u8>) -> Held {
        Held { _share: self.results.hold(self.peer, result.len()), result }
    }

    /// How much runs at the moment.
    pub fn running(&self) -> &Gauge {
        &self.running
    }

    /// How much waits at the moment.
    pub fn queued(&self) -> &Gauge {
        &self.queued
    }

    /// Does `work`: at once if it is cheap, else on another thread when it is its turn. Work that is cheap by its price and not
    /// by the clock is begun anew on another thread. If the future is dropped, the flag that `work` is given is set, and work
    /// that waits is never begun. A panic in `work` goes on here.
    pub async fn run<T, E>(
        &self,
        price: Price,
        work: impl FnOnce(&Turn) -> Result<T, E> + Clone + Send + 'static,
    ) -> Result<T, E>
    where
        T: Send + 'static,
        E: From<Refused> + Send + 'static,
    {
        if price.as_bounces() <= limits::INLINE_BOUNCES
            && let Some(result) = self.run_inline(work.clone()).await
        {
            return result;
        }
        self.run_apart(work).await
    }

    /// Does `work` on this thread, when one more work of the peer's may be; none where it takes too long.
    pub async fn run_inline<T>(&self, work: impl FnOnce(&Turn) -> T) -> Option<T> {
        let _slot = self.slot().await;
        let _running = Counted::one(&self.running);
        let turn = Turn::inline();
        let result = work(&turn);
        (!turn.overran()).then_some(result)
    }

    /// The right to work on this thread, which ends with the next await.
    pub async fn slot(&self) -> Slot {
        self.gate.enter(self.peer).await
    }

    /// Does `work` on another thread when it is its turn, which ends and comes again while it goes on. Otherwise as `run`.
    pub async fn run_apart<T, E>(&self, work: impl FnOnce(&Turn) -> Result<T, E> + Send + 'static) -> Result<T, E>
    where
        T: Send + 'static,
        E: From<Refused> + Send + 'static,
    {
        let (place, permit) = self.turn().await?;
        let (line, flow, runtime) = (self.line.clone(), Flow::Short(self.peer), Handle::current());
        // The permit goes along: it is free again when the work has ended, not when its result is no longer wanted.
        let work = move |cancel: &Cancel| work(&Turn::permitted(cancel.clone(), permit, line, flow, runtime));
        self.apart(place, work).await
    }

    /// Does long `work` on another thread when it is its turn. It computes in turns only, on as many threads as there are
    /// permits, and keeps no more than its place in between. Otherwise as `run`.
    pub async fn run_in_turns<T, E>(&self, work: impl FnOnce(&Turns) -> Result<T, E> + Send + 'static) -> Result<T, E>
    where
        T: Send + 'static,
        E: From<Refused> + Send + 'static,
    {
        let (place, _) = self.turn().await?;
        let (line, peer, threads, runtime) = (self.line.clone(), self.peer, self.count, Handle::current());
        let work = move |cancel: &Cancel| work(&Turns { cancel: cancel.clone(), line, peer, threads, runtime });
        self.apart(place, work).await
    }

    /// Does `work` on another thread, which holds on to `held` until it has ended.
    async fn apart<T, E>(
        &self,
        held: impl Send + 'static,
        work: impl FnOnce(&Cancel) -> Result<T, E> + Send + 'static,
    ) -> Result<T, E>
    where
        T: Send + 'static,
        E: Send + 'static,
    {
        let waiting = OnDrop(Cancel::default());
        let cancel = waiting.0.clone();
        let running = Counted::one(&self.running);
        let task = spawn_blocking(move || {
            let _held = (held, running);
            stand_back();
            work(&cancel)
        });
        let done = task.await;
        done.unwrap_or_else(|error| match error.try_into_panic() {
            Ok(panic) => std::panic::resume_unwind(panic),
            Err(_) => unreachable!("only a shutdown of the runtime aborts work, and then nobody is here"),
        })
    }

    async fn turn(&self) -> Result<(Share, Permit), Refused> {
        self.results.has_room(self.peer).map_err(Refused::Untaken)?;
        let place = self.places.take(self.peer).map_err(Refused::Full)?;
        if let Some(permit) = self.line.try_take() {
            return Ok((place, permit));
        }
        let _queued = Counted::one(&self.queued);
        match timeout(self.queue_time, self.line.take(Flow::Short(self.peer))).await {
            Ok(permit) => Ok((place, permit)),
            Err(_) => Err(Refused::Late { waited_s: self.queue_time.as_secs() }),
        }
    }
}

/// A result that is still to be taken.
#[derive(Debug)]
pub struct Held {
    result: Vec<u8>,
    _share: Share,
}

impl AsRef<[u8]> for Held {
    fn as_ref(&self) -> &[u8] {
        &self.result
    }
}

/// Lets this thread, and those that it starts, stand back where more threads than there are cores want one: what takes
/// microseconds is answered first. Linux has that for single threads.
fn stand_back() {
    #[cfg(target_os = "linux")]
    {
        thread_local!(static STANDS: std::cell::Cell<bool> = const { std::cell::Cell::new(false) });
        if !STANDS.replace(true) {
            // Where it may not, it is as fast and only others are later.
            let _ = rustix::process::nice(limits::COMPUTE_NICENESS);
        }
    }
}

/// Counts one in a gauge for as long as it lives.
#[derive(Debug)]
pub struct Counted(Gauge);

impl Counted {
    /// One more.
    pub fn one(gauge: &Gauge) -> Self {
        gauge.inc();
        Self(gauge.clone())
    }
}

impl Drop for Counted {
    fn drop(&mut self) {
        self.0.dec();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc;
    use std::time::{Duration, Instant};

    /// Places of which one peer gets half: one to run in and eight to wait in.
    const QUEUE: usize = 8;

    fn dear() -> Price {
        Price::bounces(limits::INLINE_BOUNCES + 1)
    }

    #[tokio::test]
    async fn cheap_work_stays_on_its_thread_and_dear_work_leaves_it() {
        let pool = Pool::new(1, &Limits::default());
        let here = std::thread::current().id();
        let thread = |_: &Turn| Ok::<_, Refused>(std::thread::current().id());
        assert_eq!(pool.run(Price::bounces(1), thread).await, Ok(here));
        assert_ne!(pool.run(dear(), thread).await, Ok(here));
    }

    #[tokio::test]
    async fn work_that_turns_out_dear_is_done_elsewhere() {
        let pool = Pool::new(1, &Limits::default());
        let here = std::thread::current().id();
        let dear = move |turn: &Turn| {
            let begin = Instant::now();
            while begin.elapsed() < 3 * limits::INLINE_TIME {
                if !turn.go_on() {
                    assert_eq!(std::thread::current().id(), here);
                    return Err(Refused::Late { waited_s: 0 });
                }
            }
            Ok(std::thread::current().id())
        };
        assert_ne!(pool.run(Price::bounces(1), dear).await.unwrap(), here);
        assert_eq!((pool.running().get(), pool.queued().get()), (0, 0));
    }

    /// Two endless works of one peer, each of which says when it computes, and a third of another peer's.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn a_turn_ends_in_the_midst_of_work() {
        let pool = Pool::new(1, &Limits::default());
        let [one, other] = [1, 2].map(|last| pool.of(Peer::at([192, 0, 2, last].into())));
        let endless = |pool: Pool| {
            let (begun, begin) = tokio::sync::oneshot::channel();
            let work = move |turn: &Turn| {
                let _ = begun.send(());
                while turn.go_on() {}
                Ok::<_, Refused>(())
            };
            (tokio::spawn(async move { pool.run_apart(work).await }), begin)
        };
        let (first, begun) = endless(one.clone());
        begun.await.unwrap();
        // Of the same peer: it waits for the first, which does not end.
        let (second, mut begun) = endless(one);
        let done = other.run_apart(|turn| Ok::<_, Refused>(turn.go_on()));
        assert_eq!(timeout(Duration::from_secs(5), done).await.expect("a turn"), Ok(true));
        assert!(begun.try_recv().is_err());
        // Whoever goes away in the midst of its work or between two turns frees the permit.
        first.abort();
        timeout(Duration::from_secs(5), begun).await.expect("a turn").unwrap();
        second.abort();
        assert_eq!(
            timeout(Duration::from_secs(5), other.run_apart(|_| Ok::<_, Refused>(7))).await.expect("a turn"),
            Ok(7)
        );
    }

    #[tokio::test]
    async fn dropping_the_future_cancels_the_work_and_frees_the_permit() {
        let pool = Pool::new(1, &Limits::default());
        let (ended, end) = mpsc::channel();
        let work = pool.run(dear(), move |turn| {
            while turn.go_on() {
                std::thread::yield_now();
            }
            ended.send(Instant::now()).unwrap();
            Ok::<_, Refused>(())
        });
        assert!(timeout(Duration::from_millis(20), work).await.is_err());
        let dropped = Instant::now();
        let ended = end.recv_timeout(Duration::from_secs(5)).expect("the work should have been cancelled");
        // Some ms on a machine that is not busy; the work would never end.
        assert!(ended.saturating_duration_since(dropped) < Duration::from_secs(1));
        assert_eq!(pool.run(dear(), |_| Ok::<_, Refused>(7)).await, Ok(7));
    }

    #[tokio::test]
    async fn beyond_the_queue_is_a_refusal() {
        let pool = Pool::new(1, &Limits::default());
        let (release, gate) = mpsc::channel::<()>();
        let busy = tokio::spawn({
            let pool = pool.clone();
            async move { pool.run_apart(move |_| Ok::<_, Refused>(gate.recv().is_err())).await }
        });
        let waiting: Vec<_> = (0..QUEUE)
            .map(|_| {
                let pool = pool.clone();
                tokio::spawn(async move { pool.run(dear(), |_| Ok::<_, Refused>(())).await })
            })
            .collect();
        while pool.queued().get() < QUEUE as i64 {
            tokio::task::yield_now().await;
        }
        assert_eq!(pool.running().get(), 1);
        let refused = pool.run(dear(), |_| Ok::<_, Refused>(())).await;
        assert_eq!(refused, Err(Refused::Full(NoShare { held: 1 + QUEUE, free: QUEUE })));
        // Another's request still has a place.
        let other = tokio::spawn({
            let pool = pool.of(Peer::at([192, 0, 2, 1].into()));
            async move { pool.run(dear(), |_| Ok::<_, Refused>(())).await }
        });
        while pool.queued().get() == QUEUE as i64 {
            tokio::task::yield_now().await;
        }
        drop(release);
        assert_eq!(other.await.unwrap(), Ok(()));
        assert_eq!(busy.await.unwrap(), Ok(true));
        for waiting in waiting {
            assert_eq!(waiting.await.unwrap(), Ok(()));
        }
        assert_eq!((pool.running().get(), pool.queued().get()), (0, 0));
    }

    #[tokio::test]
    async fn a_panic_comes_through_and_costs_no_permit() {
        let pool = Pool::new(1, &Limits::default());
        let panicking = tokio::spawn({
            let pool = pool.clone();
            async move { pool.run(dear(), |_| -> Result<(), Refused> { panic!("on purpose") }).await }
        });
        assert!(panicking.await.unwrap_err().is_panic());
        assert_eq!(pool.run(dear(), |_| Ok::<_, Refused>(1)).await, Ok(1));
        assert_eq!(pool.running().get(), 0);
    }
}
