//! Runs CPU-bound work off the async threads: at most one job per core and a bounded queue; refuses work beyond that. Short work
//! runs on the async threads, for a bounded time.

use std::sync::Arc;
use std::time::Duration;

use prometheus_client::metrics::gauge::Gauge;
use tokio::runtime::Handle;
use tokio::task::spawn_blocking;
use tokio::time::{sleep, timeout};
use tracing::Span;

use crate::compute::admission::{FairQuota, Overloaded, Price, Reservation, lower_priority};
use crate::compute::fair_queue::{Crowd, FairQueue, Member, Permit, Place};
use crate::compute::inline_slots::{InlineSlot, InlineSlots};
use crate::compute::peer::Peer;
use crate::compute::time_slices::{CancelFlag, CancelOnDrop, TimeSlice, TimeSlices};
use crate::limits;
use crate::limits::Limits;

/// Admits work and runs it. Cheap to clone; clones share their permits.
#[derive(Debug, Clone)]
pub struct Pool {
    shared: Arc<SharedPool>,
    /// The client that the work counts for.
    peer: Peer,
    /// The clients that wait for the work, if they may be several.
    crowd: Option<Crowd>,
    /// Most memory of the work, bytes.
    memory: usize,
}

#[derive(Debug)]
struct SharedPool {
    /// Quota of jobs that run or wait.
    admission: FairQuota,
    /// Permits to run.
    queue: Arc<FairQueue>,
    /// Slots on the async threads.
    inline: InlineSlots,
    /// Quotas of bytes, of running jobs and of unsent answers.
    computing: FairQuota,
    results: FairQuota,
    count: usize,
    queue_time: Duration,
    running: Gauge,
    queued: Gauge,
}

impl Pool {
    /// A pool that runs `permits` jobs at a time.
    pub fn new(permits: usize, limits: &Limits) -> Self {
        let shared = SharedPool {
            admission: FairQuota::new(permits * (1 + limits.queue)),
            queue: FairQueue::new(permits),
            inline: InlineSlots::new(permits),
            computing: FairQuota::new(limits.compute_bytes),
            results: FairQuota::new(limits.held_bytes),
            count: permits,
            queue_time: limits.queue_time,
            running: Gauge::default(),
            queued: Gauge::default(),
        };
        Self { shared: Arc::new(shared), peer: Peer::NOBODY, crowd: None, memory: limits::WORK_BYTES }
    }

    /// The same pool, for the work of this peer.
    pub fn for_peer(&self, peer: Peer) -> Self {
        Self { peer, crowd: None, ..self.clone() }
    }

    /// The same pool, for work that all of a crowd wait for.
    pub(crate) fn for_crowd(&self, crowd: &Crowd) -> Self {
        Self { crowd: Some(crowd.clone()), ..self.clone() }
    }

    /// The same pool, for work that takes at most so many bytes of memory.
    pub(crate) fn with_memory(&self, bytes: u64) -> Self {
        Self { memory: usize::try_from(bytes).unwrap_or(usize::MAX), ..self.clone() }
    }

    /// Adds a request of a peer to those that wait for some work.
    pub(crate) fn join(&self, crowd: &Crowd, peer: Peer) -> Member {
        self.shared.queue.join(crowd, peer)
    }

    fn crowd(&self) -> Crowd {
        self.crowd.clone().unwrap_or_else(|| Crowd::of(self.peer))
    }

    /// Notes a request of `peer`, even if it needs no work: the threads are no longer for another one alone.
    pub fn note_request(&self, peer: Peer) {
        self.shared.inline.note(peer);
    }

    /// Accounts an answer to the peer until it is dropped.
    pub fn hold<T: AsRef<[u8]>>(&self, result: T) -> HeldBytes<T> {
        HeldBytes { _reservation: self.shared.results.charge(self.peer, result.as_ref().len()), result }
    }

    /// Number of running jobs.
    pub fn running(&self) -> &Gauge {
        &self.shared.running
    }

    /// Number of waiting jobs.
    pub fn queued(&self) -> &Gauge {
        &self.shared.queued
    }

    /// Runs `work`: at once on this thread if its price is low, else on a worker thread. Work that takes longer than its price says
    /// starts again on a worker thread. Dropping the future cancels the work, or removes it from the queue. A panic in `work` is
    /// resumed here.
    pub async fn run<T, E>(
        &self,
        price: Price,
        work: impl FnOnce(&TimeSlice) -> Result<T, E> + Clone + Send + 'static,
    ) -> Result<T, E>
    where
        T: Send + 'static,
        E: From<Overloaded> + Send + 'static,
    {
        if price.as_bounces() <= limits::INLINE_BOUNCES
            && let Some(result) = self.run_inline(work.clone()).await
        {
            return result;
        }
        self.run_on_worker(work).await
    }

    /// Runs `work` on this thread as soon as the peer has a slot. Returns None if it takes too long.
    pub async fn run_inline<T>(&self, work: impl FnOnce(&TimeSlice) -> T) -> Option<T> {
        let _slot = self.inline_slot().await;
        let _running = GaugeGuard::new(&self.shared.running);
        let slice = TimeSlice::inline();
        let result = work(&slice);
        (!slice.overran()).then_some(result)
    }

    /// Waits for the right to work on this thread, up to the next await.
    pub async fn inline_slot(&self) -> InlineSlot {
        self.shared.inline.acquire(self.peer).await
    }

    /// Runs `work` on a worker thread, in time slices. All else is as in [`Pool::run`].
    pub async fn run_on_worker<T, E>(
        &self,
        work: impl FnOnce(&TimeSlice) -> Result<T, E> + Send + 'static,
    ) -> Result<T, E>
    where
        T: Send + 'static,
        E: From<Overloaded> + Send + 'static,
    {
        let place = Place::short(&self.crowd());
        let (held, permit) = self.admit(&place).await?;
        let (queue, runtime) = (self.shared.queue.clone(), Handle::current());
        // The worker frees the permit when the work ends, not when the future is dropped.
        let work =
            move |cancel: &CancelFlag| work(&TimeSlice::permitted(cancel.clone(), permit, queue, place, runtime));
        self.spawn_worker(held, work).await
    }

    /// Runs long `work` on a worker thread. It computes in time slices, on as many threads as there are permits; between two slices
    /// it holds no permit. Cancellation and panics are as in [`Pool::run`].
    pub async fn run_in_slices<T, E>(
        &self,
        work: impl FnOnce(&TimeSlices) -> Result<T, E> + Send + 'static,
    ) -> Result<T, E>
    where
        T: Send + 'static,
        E: From<Overloaded> + Send + 'static,
    {
        let crowd = self.crowd();
        let (held, _) = self.admit(&Place::short(&crowd)).await?;
        let (queue, place, threads, runtime) =
            (self.shared.queue.clone(), Place::long(&crowd), self.shared.count, Handle::current());
        let work =
            move |cancel: &CancelFlag| work(&TimeSlices { cancel: cancel.clone(), queue, place, threads, runtime });
        self.spawn_worker(held, work).await
    }

    /// Runs `work` on a worker thread, which keeps `held` until it ends.
    async fn spawn_worker<T, E>(
        &self,
        held: impl Send + 'static,
        work: impl FnOnce(&CancelFlag) -> Result<T, E> + Send + 'static,
    ) -> Result<T, E>
    where
        T: Send + 'static,
        E: Send + 'static,
    {
        let waiting = CancelOnDrop(CancelFlag::default());
        let cancel = waiting.0.clone();
        let running = GaugeGuard::new(&self.shared.running);
        let span = Span::current();
        let task = spawn_blocking(move || {
            let _held = (held, running);
            lower_priority();
            span.in_scope(|| work(&cancel))
        });
        task.await.unwrap_or_else(|error| match error.try_into_panic() {
            Ok(panic) => std::panic::resume_unwind(panic),
            Err(_) => unreachable!("only a shutdown of the runtime aborts work, and then nobody is here"),
        })
    }

    /// A place among the jobs, the memory of the work, and the permit to begin it.
    async fn admit(&self, place: &Place) -> Result<([Reservation; 2], Permit), Overloaded> {
        self.shared.results.check(self.peer).map_err(Overloaded::UnreadAnswers)?;
        let job = self.shared.admission.try_reserve(self.peer).map_err(Overloaded::QueueFull)?;
        if let Some(permit) = self.shared.queue.try_acquire()
            && let Ok(memory) = self.reserve_memory()
        {
            return Ok(([job, memory], permit));
        }
        let _queued = GaugeGuard::new(&self.shared.queued);
        let mut refused = None;
        let admitted = async {
            loop {
                let permit = self.shared.queue.acquire(place.clone()).await;
                match self.reserve_memory() {
                    Ok(memory) => return (memory, permit),
                    // Work under way or a reader gives some back.
                    Err(overloaded) => refused = Some(overloaded),
                }
                drop(permit);
                sleep(limits::MEMORY_WAIT_TIME).await;
            }
        };
        let admitted = timeout(self.shared.queue_time, admitted).await;
        let waited_s = self.shared.queue_time.as_secs();
        let (memory, permit) = admitted.map_err(|_| refused.unwrap_or(Overloaded::QueueTimeout { waited_s }))?;
        Ok(([job, memory], permit))
    }

    /// Reserves the memory of the work before it is taken. Answers that have been computed since the request came count too.
    fn reserve_memory(&self) -> Result<Reservation, Overloaded> {
        self.shared.results.check(self.peer).map_err(Overloaded::UnreadAnswers)?;
        self.shared.computing.try_reserve_units(self.peer, self.memory).map_err(Overloaded::Memory)
    }
}

/// Bytes of an unsent answer, accounted to its client.
#[derive(Debug)]
pub struct HeldBytes<T> {
    result: T,
    _reservation: Reservation,
}

impl<T: AsRef<[u8]>> AsRef<[u8]> for HeldBytes<T> {
    fn as_ref(&self) -> &[u8] {
        self.result.as_ref()
    }
}

/// Counts one in a gauge while it lives.
#[derive(Debug)]
pub struct GaugeGuard(Gauge);

impl GaugeGuard {
    /// Adds one to the gauge.
    pub fn new(gauge: &Gauge) -> Self {
        gauge.inc();
        Self(gauge.clone())
    }
}

impl Drop for GaugeGuard {
    fn drop(&mut self) {
        self.0.dec();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::admission::QuotaExceeded;
    use std::sync::mpsc;
    use std::time::{Duration, Instant};

    /// Queue of a pool, of which one peer gets half: one job runs and eight wait.
    const QUEUE: usize = 8;

    fn dear() -> Price {
        Price::bounces(limits::INLINE_BOUNCES + 1)
    }

    #[tokio::test]
    async fn cheap_work_stays_on_its_thread_and_dear_work_leaves_it() {
        let pool = Pool::new(1, &Limits::default());
        let here = std::thread::current().id();
        let thread = |_: &TimeSlice| Ok::<_, Overloaded>(std::thread::current().id());
        assert_eq!(pool.run(Price::bounces(1), thread).await, Ok(here));
        assert_ne!(pool.run(dear(), thread).await, Ok(here));
    }

    #[tokio::test]
    async fn work_that_turns_out_dear_is_done_elsewhere() {
        let pool = Pool::new(1, &Limits::default());
        let here = std::thread::current().id();
        let dear = move |slice: &TimeSlice| {
            let begin = Instant::now();
            while begin.elapsed() < 3 * limits::INLINE_TIME {
                if !slice.should_continue() {
                    assert_eq!(std::thread::current().id(), here);
                    return Err(Overloaded::QueueTimeout { waited_s: 0 });
                }
            }
            Ok(std::thread::current().id())
        };
        assert_ne!(pool.run(Price::bounces(1), dear).await.unwrap(), here);
        assert_eq!((pool.running().get(), pool.queued().get()), (0, 0));
    }

    /// Two endless jobs of one peer, each of which reports its start, and a third of another peer.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn a_turn_ends_in_the_midst_of_work() {
        let pool = Pool::new(1, &Limits::default());
        let [one, other] = [1, 2].map(|last| pool.for_peer(Peer::at([192, 0, 2, last].into())));
        let endless = |pool: Pool| {
            let (begun, begin) = tokio::sync::oneshot::channel();
            let work = move |slice: &TimeSlice| {
                let _ = begun.send(());
                while slice.should_continue() {}
                Ok::<_, Overloaded>(())
            };
            (tokio::spawn(async move { pool.run_on_worker(work).await }), begin)
        };
        let (first, begun) = endless(one.clone());
        begun.await.unwrap();
        // The second job of the same peer waits for the first, which does not end.
        let (second, mut begun) = endless(one);
        let done = other.run_on_worker(|slice| Ok::<_, Overloaded>(slice.should_continue()));
        assert_eq!(timeout(Duration::from_secs(5), done).await.expect("a turn"), Ok(true));
        assert!(begun.try_recv().is_err());
        // Cancelling a job in the middle of its work or between two slices frees the permit.
        first.abort();
        timeout(Duration::from_secs(5), begun).await.expect("a turn").unwrap();
        second.abort();
        assert_eq!(
            timeout(Duration::from_secs(5), other.run_on_worker(|_| Ok::<_, Overloaded>(7))).await.expect("a turn"),
            Ok(7)
        );
    }

    #[tokio::test]
    async fn dropping_the_future_cancels_the_work_and_frees_the_permit() {
        let pool = Pool::new(1, &Limits::default());
        let (ended, end) = mpsc::channel();
        let work = pool.run(dear(), move |slice| {
            while slice.should_continue() {
                std::thread::yield_now();
            }
            ended.send(Instant::now()).unwrap();
            Ok::<_, Overloaded>(())
        });
        assert!(timeout(Duration::from_millis(20), work).await.is_err());
        let dropped = Instant::now();
        let ended = end.recv_timeout(Duration::from_secs(5)).expect("the work should have been cancelled");
        // It takes some ms on an idle machine; the work itself would never end.
        assert!(ended.saturating_duration_since(dropped) < Duration::from_secs(1));
        assert_eq!(pool.run(dear(), |_| Ok::<_, Overloaded>(7)).await, Ok(7));
    }

    #[tokio::test]
    async fn beyond_the_queue_is_a_refusal() {
        let pool = Pool::new(1, &Limits::default());
        let (release, gate) = mpsc::channel::<()>();
        let busy = tokio::spawn({
            let pool = pool.clone();
            async move { pool.run_on_worker(move |_| Ok::<_, Overloaded>(gate.recv().is_err())).await }
        });
        let waiting: Vec<_> = (0..QUEUE)
            .map(|_| {
                let pool = pool.clone();
                tokio::spawn(async move { pool.run(dear(), |_| Ok::<_, Overloaded>(())).await })
            })
            .collect();
        while pool.queued().get() < QUEUE as i64 {
            tokio::task::yield_now().await;
        }
        assert_eq!(pool.running().get(), 1);
        let refused = pool.run(dear(), |_| Ok::<_, Overloaded>(())).await;
        assert_eq!(refused, Err(Overloaded::QueueFull(QuotaExceeded { held: 1 + QUEUE, free: QUEUE })));
        // A request of another peer still has a place.
        let other = tokio::spawn({
            let pool = pool.for_peer(Peer::at([192, 0, 2, 1].into()));
            async move { pool.run(dear(), |_| Ok::<_, Overloaded>(())).await }
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
            async move { pool.run(dear(), |_| -> Result<(), Overloaded> { panic!("on purpose") }).await }
        });
        assert!(panicking.await.unwrap_err().is_panic());
        assert_eq!(pool.run(dear(), |_| Ok::<_, Overloaded>(1)).await, Ok(1));
        assert_eq!(pool.running().get(), 0);
    }

    /// Work of 60 of 100 bytes runs, so that more of it waits, and is refused if nothing is given back in time.
    #[tokio::test]
    async fn memory_is_counted_before_it_is_taken() {
        let limits = Limits { compute_bytes: 100, queue_time: Duration::from_millis(200), ..Limits::default() };
        let pool = Pool::new(4, &limits).with_memory(60);
        let [one, other] = [1, 2].map(|last| pool.for_peer(Peer::at([192, 0, 2, last].into())));
        let (release, gate) = mpsc::channel::<()>();
        let (begun, begin) = tokio::sync::oneshot::channel();
        let busy = tokio::spawn({
            let one = one.clone();
            let work = move |_: &TimeSlice| {
                let _ = begun.send(());
                Ok::<_, Overloaded>(gate.recv().is_err())
            };
            async move { one.run_on_worker(work).await }
        });
        begin.await.unwrap();
        for (pool, held) in [(&one, 60), (&other, 0)] {
            let refused = pool.run_on_worker(|_| Ok::<_, Overloaded>(())).await;
            assert_eq!(refused, Err(Overloaded::Memory(QuotaExceeded { held, free: 40 })));
        }
        assert_eq!(other.with_memory(40).run_on_worker(|_| Ok::<_, Overloaded>(7)).await, Ok(7));
        // Work that waits begins when memory is given back.
        let waiting = tokio::spawn(async move { other.run_on_worker(|_| Ok::<_, Overloaded>(8)).await });
        while pool.queued().get() == 0 {
            tokio::task::yield_now().await;
        }
        drop(release);
        assert_eq!((busy.await.unwrap(), waiting.await.unwrap()), (Ok(true), Ok(8)));
        assert_eq!((pool.running().get(), pool.queued().get()), (0, 0));
    }
}
