//! Time slices: the right of work to compute for a while.
//!
//! A slice ends by the clock, in the middle of the work: the work passes its permit on and waits for another. So other requests
//! wait for a slice, not for the whole work. The clock decides when work is done, and never its result.

use std::cell::{Cell, RefCell};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use tokio::runtime::Handle;
use tokio::sync::Notify;
use tracing::Span;

use crate::compute::fair_queue::{FairQueue, Permit, Place};
use crate::limits;

/// A time slice. Work asks it about every millisecond whether to continue.
#[derive(Debug)]
pub struct TimeSlice {
    cancel: CancelFlag,
    began: Cell<Instant>,
    placement: Placement,
}

/// The thread and the permit of a time slice.
#[derive(Debug)]
enum Placement {
    /// A thread without a permit.
    Dedicated,
    /// An async thread, for a short time.
    Inline {
        /// True if the time was too short.
        overran: Cell<bool>,
    },
    /// A worker thread with a permit.
    Permitted {
        /// None only after cancellation.
        permit: RefCell<Option<Permit>>,
        queue: Arc<FairQueue>,
        place: Place,
        runtime: Handle,
    },
}

impl TimeSlice {
    /// A slice without end, for work that is wanted in any case.
    pub fn unbounded() -> Self {
        Self::new(CancelFlag::never(), Placement::Dedicated)
    }

    pub(crate) fn inline() -> Self {
        Self::new(CancelFlag::never(), Placement::Inline { overran: Cell::new(false) })
    }

    /// A slice with a permit that was acquired at `place`.
    pub(crate) fn permitted(
        cancel: CancelFlag,
        permit: Permit,
        queue: Arc<FairQueue>,
        place: Place,
        runtime: Handle,
    ) -> Self {
        Self::new(cancel, Placement::Permitted { permit: RefCell::new(Some(permit)), queue, place, runtime })
    }

    fn new(cancel: CancelFlag, placement: Placement) -> Self {
        Self { cancel, began: Cell::new(Instant::now()), placement }
    }

    /// Tells whether to continue; false after cancellation. At the end of a slice it passes the permit on and returns with the next
    /// one. Costs a look at the clock: in a loop of nanoseconds call it every hundred rounds.
    pub fn should_continue(&self) -> bool {
        if self.cancel.is_set() {
            return false;
        }
        match &self.placement {
            Placement::Dedicated => true,
            Placement::Inline { overran } => {
                overran.set(self.began.get().elapsed() >= limits::INLINE_TIME);
                !overran.get()
            }
            Placement::Permitted { permit, queue, place, runtime } => {
                if self.began.get().elapsed() < limits::TURN_TIME {
                    return true;
                }
                if queue.has_others_waiting(place) {
                    // Queued again before the permit is given back, so that the order of the queue is kept.
                    let next = queue.requeue(place.clone());
                    permit.take();
                    let next = runtime.block_on(async {
                        tokio::select! {
                            biased;
                            () = self.cancel.wait() => None,
                            permit = next => Some(permit),
                        }
                    });
                    if next.is_none() {
                        return false;
                    }
                    permit.replace(next);
                }
                self.began.set(Instant::now());
                true
            }
        }
    }

    /// [`TimeSlice::should_continue`] as an error, for `?`.
    ///
    /// # Errors
    /// [`Cancelled`] once the client has gone.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.should_continue() { Ok(()) } else { Err(Cancelled) }
    }

    /// The cancellation flag, for work that must not be interrupted.
    pub fn cancel(&self) -> &CancelFlag {
        &self.cancel
    }

    /// Tells whether the time of an inline slice was too short.
    pub(crate) fn overran(&self) -> bool {
        matches!(&self.placement, Placement::Inline { overran } if overran.get())
    }
}

// Long work in blocks of a few milliseconds. Each block waits for its own permit, so that other requests wait for one block, not
// for the whole work. A longer block passes its permit on in between.

/// The time slices of one piece of long work.
#[derive(Debug)]
pub struct TimeSlices {
    pub(crate) cancel: CancelFlag,
    /// The pool's permits.
    pub(crate) queue: Arc<FairQueue>,
    /// Blocks of long work have a key of their own: a request waits for at most one block of each peer, whatever the number of blocks.
    pub(crate) place: Place,
    pub(crate) threads: usize,
    pub(crate) runtime: Handle,
}

impl TimeSlices {
    /// Runs `work` in one time slice.
    pub fn run_one<T>(&self, work: impl FnOnce(&TimeSlice) -> T) -> Result<T, Cancelled> {
        let slice = self.next_slice().ok_or(Cancelled)?;
        Ok(work(&slice))
    }

    /// Calls `work` for each block from 0 to `blocks` on all threads, each in its own time slice. `done` gets the results in the
    /// order of the blocks, each as soon as it and all before it are there. Ends early if `work` returns None or the client has
    /// gone.
    pub fn parallel_map<T: Send>(
        &self,
        blocks: usize,
        work: impl Fn(usize, &TimeSlice) -> Option<T> + Sync,
        done: impl FnMut(T) + Send,
    ) -> Result<(), Cancelled> {
        let next = AtomicUsize::new(0);
        let order = Mutex::new(InOrder { next: 0, waiting: BTreeMap::new(), done });
        let take = || {
            while next.load(Ordering::Relaxed) < blocks {
                let Some(slice) = self.next_slice() else { return };
                let block = next.fetch_add(1, Ordering::Relaxed);
                if block >= blocks {
                    return;
                }
                let Some(result) = work(block, &slice) else {
                    next.store(blocks, Ordering::Relaxed);
                    return;
                };
                // Writing the result is work too, so it stays within the slice. A panic on another thread ends all of it anyway.
                order.lock().unwrap_or_else(PoisonError::into_inner).add(block, result);
            }
        };
        let span = Span::current();
        std::thread::scope(|scope| {
            for _ in 1..self.threads.min(blocks) {
                scope.spawn(|| span.in_scope(take));
            }
            take();
        });
        let order = order.into_inner().unwrap_or_else(PoisonError::into_inner);
        if order.next == blocks { Ok(()) } else { Err(Cancelled) }
    }

    /// Waits on this thread for the next slice. Returns None after cancellation.
    fn next_slice(&self) -> Option<TimeSlice> {
        let permit = self.runtime.block_on(async {
            tokio::select! {
                biased;
                () = self.cancel.wait() => None,
                permit = self.queue.acquire(self.place.clone()) => Some(permit),
            }
        })?;
        Some(TimeSlice::permitted(
            self.cancel.clone(),
            permit,
            self.queue.clone(),
            self.place.clone(),
            self.runtime.clone(),
        ))
    }
}

/// Puts results into the order of their blocks.
struct InOrder<T, Done> {
    next: usize,
    waiting: BTreeMap<usize, T>,
    done: Done,
}

impl<T, Done: FnMut(T)> InOrder<T, Done> {
    fn add(&mut self, block: usize, result: T) {
        self.waiting.insert(block, result);
        while let Some(result) = self.waiting.remove(&self.next) {
            self.next += 1;
            (self.done)(result);
        }
    }
}

// A flag that is set when the client of some work has gone. Long loops check it every few milliseconds.

/// A flag shared by the client's side, which sets it, and the work, which checks it.
#[derive(Debug, Clone, Default)]
pub struct CancelFlag(Arc<Flag>);

#[derive(Debug, Default)]
struct Flag {
    is_set: AtomicBool,
    changed: Notify,
}

impl CancelFlag {
    /// A flag that is never set, for work that is wanted in any case.
    pub fn never() -> Self {
        Self::default()
    }

    /// Cancels the work.
    pub fn set(&self) {
        self.0.is_set.store(true, Ordering::SeqCst);
        self.0.changed.notify_waiters();
    }

    /// Tells whether the work is cancelled. Costs one load; in a loop of nanoseconds check it every thousand rounds.
    pub fn is_set(&self) -> bool {
        self.0.is_set.load(Ordering::Relaxed)
    }

    /// [`CancelFlag::is_set`] as an error, for `?`.
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_set() { Err(Cancelled) } else { Ok(()) }
    }

    /// The flag as an atomic, for code that knows only the standard library.
    pub fn flag(&self) -> &AtomicBool {
        &self.0.is_set
    }

    /// Waits until the flag is set.
    pub(crate) async fn wait(&self) {
        let changed = self.0.changed.notified();
        // `notified` counts from its creation on, so a flag set after this check wakes the wait.
        if !self.0.is_set.load(Ordering::SeqCst) {
            changed.await;
        }
    }
}

/// Sets a flag when it is dropped. The client's side holds it.
#[derive(Debug)]
pub(crate) struct CancelOnDrop(pub(crate) CancelFlag);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.set();
    }
}

/// The work was cancelled because its client has gone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cancelled;

impl fmt::Display for Cancelled {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("given up, since nobody waits for the result")
    }
}

impl std::error::Error for Cancelled {}

// Measures the time of several pieces of work: many short samples in turns, so that other load on the machine falls on all of them
// alike, and the median of each.
//
// The result differs from one measurement to the next; only `precision` may use it.

/// The measured time of one piece of work.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Time of one execution, s: quartile, median, quartile of all samples.
    pub quartiles_s: [f64; 3],
    /// Number of samples.
    pub repeats: usize,
}

/// Bounds of a measurement.
#[derive(Debug, Clone, Copy)]
pub struct TimingBudget {
    /// Time for each piece of work. Long work gets three samples or three times this time, whichever is less.
    pub time: Duration,
    /// Least time of one sample. Shorter work is repeated within it, because of the resolution of the clock.
    pub sample: Duration,
    /// Most samples of one piece of work.
    pub repeats: usize,
}

/// A piece of work to measure. It may return early when it is cancelled.
pub type TimedWork<'a> = Box<dyn FnMut(&CancelFlag) + 'a>;

struct TimedSeries<'w, 'a> {
    work: &'w mut TimedWork<'a>,
    /// Executions in one sample.
    times: u32,
    spent: Duration,
    samples_s: Vec<f64>,
}

/// Measures all pieces of work in turns, and calls `timed` for each that is done. Other jobs may run between two samples.
pub fn time(
    works: &mut [TimedWork<'_>],
    budget: TimingBudget,
    timed: &mut dyn FnMut(),
    slice: &TimeSlice,
) -> Result<Vec<Timing>, Cancelled> {
    let goes_on = |series: &TimedSeries<'_, '_>| {
        let samples = series.samples_s.len();
        let few = samples < 3 && series.spent < 3 * budget.time;
        samples == 0 || few || (series.spent < budget.time && samples < budget.repeats)
    };
    let mut all_series = Vec::with_capacity(works.len());
    for work in works {
        let first = sample(work, 1, slice)?;
        let times = (budget.sample.as_secs_f64() / first.as_secs_f64().max(1e-9)).ceil().clamp(1.0, 1e6) as u32;
        let mut series = TimedSeries { work, times, spent: first, samples_s: Vec::new() };
        // The first sample finds cold caches, which does not matter for long work.
        if times == 1 {
            series.samples_s.push(first.as_secs_f64());
        }
        if !goes_on(&series) {
            timed();
        }
        all_series.push(series);
    }
    while all_series.iter().any(goes_on) {
        for series in all_series.iter_mut().filter(|series| goes_on(series)) {
            let taken = sample(series.work, series.times, slice)?;
            series.spent += taken;
            series.samples_s.push(taken.as_secs_f64() / f64::from(series.times));
            if !goes_on(series) {
                timed();
            }
        }
    }
    Ok(all_series.into_iter().map(|series| timing(series.samples_s)).collect())
}

fn sample(work: &mut TimedWork<'_>, times: u32, slice: &TimeSlice) -> Result<Duration, Cancelled> {
    let start = Instant::now();
    for _ in 0..times {
        work(slice.cancel());
    }
    let taken = start.elapsed();
    slice.check().map(|()| taken)
}

fn timing(mut samples_s: Vec<f64>) -> Timing {
    samples_s.sort_by(f64::total_cmp);
    // For an even number, the lower of the two in the middle: disturbances only make samples longer.
    let at = |share: f64| samples_s[((samples_s.len() - 1) as f64 * share).floor() as usize];
    Timing { quartiles_s: [at(0.25), at(0.5), at(0.75)], repeats: samples_s.len() }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::atomic::AtomicU64;
    use std::sync::mpsc;

    use super::*;
    use crate::compute::{Overloaded, Pool, Price};
    use crate::limits;
    use crate::limits::Limits;

    #[derive(Debug, PartialEq)]
    struct Failed;

    impl From<Overloaded> for Failed {
        fn from(_: Overloaded) -> Self {
            Failed
        }
    }

    impl From<Cancelled> for Failed {
        fn from(_: Cancelled) -> Self {
            Failed
        }
    }

    fn squares(slices: &TimeSlices, blocks: usize) -> Result<Vec<usize>, Failed> {
        let mut squares = Vec::new();
        slices.parallel_map(blocks, |block, _| Some(block * block), |square| squares.push(square))?;
        Ok(squares)
    }

    #[tokio::test]
    async fn results_are_in_order_whatever_the_threads() {
        for threads in [1, 2, 3, 8] {
            let pool = Pool::new(threads, &Limits::default());
            for blocks in [0, 1, 100] {
                let expected: Vec<_> = (0..blocks).map(|block| block * block).collect();
                assert_eq!(pool.run_in_slices(move |slices| squares(slices, blocks)).await, Ok(expected));
            }
        }
    }

    #[tokio::test]
    async fn a_block_that_gives_up_stops_the_others() {
        let begun = Arc::new(AtomicU64::new(0));
        let count = begun.clone();
        let work = move |slices: &TimeSlices| {
            let work = |block, _: &TimeSlice| {
                count.fetch_add(1, Ordering::Relaxed);
                (block != 3).then_some(())
            };
            Ok::<_, Failed>(slices.parallel_map(10_000, work, |()| {})?)
        };
        assert_eq!(Pool::new(2, &Limits::default()).run_in_slices(work).await, Err(Failed));
        assert!(begun.load(Ordering::Relaxed) < 10_000);
    }

    /// Two endless pieces of long work share one permit; short work is done after one or two of their blocks.
    #[tokio::test(flavor = "multi_thread", worker_threads = 2)]
    async fn short_work_waits_for_a_block_and_not_for_the_whole() {
        let pool = Pool::new(1, &Limits::default());
        let blocks_done = Arc::new(AtomicU64::new(0));
        let (begun, mut begin) = tokio::sync::mpsc::unbounded_channel();
        let (step, steps) = mpsc::channel::<()>();
        let steps = Arc::new(Mutex::new(steps));
        let mut long = Vec::new();
        for _ in 0..2 {
            let (pool, count, begun, steps) = (pool.clone(), blocks_done.clone(), begun.clone(), steps.clone());
            long.push(tokio::spawn(async move {
                let work = move |slices: &TimeSlices| {
                    let block = |_, _: &TimeSlice| {
                        let _ = begun.send(());
                        // A block lasts until the test ends it.
                        steps.lock().unwrap().recv().ok()?;
                        count.fetch_add(1, Ordering::Relaxed);
                        Some(())
                    };
                    Ok::<_, Failed>(slices.parallel_map(usize::MAX, block, |()| {})?)
                };
                pool.run_in_slices(work).await
            }));
        }
        // One computes; the other waits for a slice, or to be admitted.
        begin.recv().await.unwrap();
        while pool.running().get() + pool.queued().get() < 2 {
            tokio::task::yield_now().await;
        }
        let before = pool.queued().get();
        let short = tokio::spawn({
            let (pool, count) = (pool.clone(), blocks_done.clone());
            let dear = Price::bounces(limits::INLINE_BOUNCES + 1);
            async move { pool.run(dear, move |_| Ok::<_, Failed>(count.load(Ordering::Relaxed))).await }
        });
        while pool.queued().get() <= before {
            tokio::task::yield_now().await;
        }
        // Each ends one block: the current one, and at most one that was queued before the short work.
        for _ in 0..2 {
            step.send(()).unwrap();
        }
        let done_before = short.await.unwrap().unwrap();
        assert!(done_before <= 2, "{done_before} blocks were done before the short work");
        drop(step);
        for task in long {
            assert_eq!(task.await.unwrap(), Err(Failed));
        }
        assert_eq!((pool.running().get(), pool.queued().get()), (0, 0));
    }

    const BUDGET: TimingBudget =
        TimingBudget { time: Duration::from_millis(40), sample: Duration::from_millis(2), repeats: 5 };

    #[test]
    fn short_work_is_repeated_and_long_work_is_done_once() {
        let (short, long) = (Cell::new(0), Cell::new(0));
        let mut works: Vec<TimedWork<'_>> = vec![
            Box::new(|_| short.set(short.get() + 1)),
            Box::new(|_| {
                long.set(long.get() + 1);
                std::thread::sleep(3 * BUDGET.time);
            }),
        ];
        let mut timed = Vec::new();
        let timings = time(&mut works, BUDGET, &mut || timed.push(long.get()), &TimeSlice::unbounded()).unwrap();
        drop(works);
        assert_eq!((timings[0].repeats, timings[1].repeats, long.get()), (5, 1, 1));
        assert_eq!(timed, [1, 1], "each is said once");
        assert!(short.get() > 100, "{} times", short.get());
        assert!(timings[0].quartiles_s[1] < 1e-4 && timings[1].quartiles_s[1] >= 0.12, "{timings:?}");
    }

    #[test]
    fn what_nobody_waits_for_is_given_up() {
        let mut works: Vec<TimedWork<'_>> = vec![Box::new(|cancel| cancel.set())];
        assert_eq!(time(&mut works, BUDGET, &mut || {}, &TimeSlice::unbounded()), Err(Cancelled));
    }
}
