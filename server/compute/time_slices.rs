//! Long work in blocks of a few milliseconds. Each block waits for its own permit, so that other requests wait for one block, not
//! for the whole work. A longer block passes its permit on in between.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use tokio::runtime::Handle;
use tracing::Span;

use crate::compute::cancel::{CancelFlag, Cancelled};
use crate::compute::fair_queue::{FairQueue, Place};
use crate::compute::time_slice::TimeSlice;

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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::{Overloaded, Pool, Price};
    use crate::limits;
    use crate::limits::Limits;
    use std::sync::atomic::AtomicU64;
    use std::sync::mpsc;

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
}
