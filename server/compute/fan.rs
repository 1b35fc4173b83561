//! Spreads one piece of work over threads, block by block, with results in the order of the blocks.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Calls `work` for each block from 0 to `blocks`, on up to `threads` threads. None as soon as one call gave none: the
/// others are not begun.
pub fn fan_out<T: Send>(threads: usize, blocks: usize, work: impl Fn(usize) -> Option<T> + Sync) -> Option<Vec<T>> {
    let next = AtomicUsize::new(0);
    let done = Mutex::new((0..blocks).map(|_| None).collect::<Vec<Option<T>>>());
    let take = || {
        loop {
            let block = next.fetch_add(1, Ordering::Relaxed);
            if block >= blocks {
                return;
            }
            let result = work(block);
            if result.is_none() {
                next.store(blocks, Ordering::Relaxed);
            }
            // Held for a move only; a panic elsewhere does not make the results wrong.
            done.lock().unwrap_or_else(std::sync::PoisonError::into_inner)[block] = result;
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.min(blocks) {
            scope.spawn(take);
        }
        take();
    });
    done.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_whatever_the_threads() {
        for threads in [1, 2, 3, 8] {
            assert_eq!(fan_out(threads, 100, |block| Some(block * block)), Some((0..100).map(|n| n * n).collect()));
        }
        assert_eq!(fan_out(4, 0, |_| Some(0)), Some(vec![]));
    }

    #[test]
    fn a_block_that_gives_up_stops_the_others() {
        let begun = AtomicUsize::new(0);
        let result: Option<Vec<usize>> = fan_out(2, 10_000, |block| {
            begun.fetch_add(1, Ordering::Relaxed);
            (block != 3).then_some(block)
        });
        assert_eq!(result, None);
        assert!(begun.load(Ordering::Relaxed) < 10_000);
    }
}
