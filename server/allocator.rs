//! The allocator, with options by which memory that is freed goes back to the system.

#![allow(unsafe_code)]

use libmimalloc_sys::{mi_option_set, mi_option_t};
use mimalloc::MiMalloc;

/// The C library's allocator holds ever more memory under mixed load, with answers of all sizes from many threads; this one does
/// not. `cargo bench --bench load -- --only soak` shows it.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// `mi_option_arena_purge_mult` of mimalloc 2: the delay after which freed blocks of 32 MiB go back, in delays of the pages in them. With
/// a delay they go back only when the next such block is asked for: after many large answers that is never.
const ARENA_PURGE_MULTIPLIER: mi_option_t = 24;

/// `mi_option_abandoned_reclaim_on_free` of mimalloc 2: 1 if a thread that frees memory of an ended thread takes it over. Otherwise the
/// memory stays until some thread looks for more.
const RECLAIM_ON_FREE: mi_option_t = 26;

/// Gives freed memory back to the system at once.
pub(crate) fn give_back_at_once() {
    for (option, value) in [(ARENA_PURGE_MULTIPLIER, 0), (RECLAIM_ON_FREE, 1)] {
        // SAFETY: it stores a number in a table of the library, under a number that this version has.
        unsafe { mi_option_set(option, value) };
    }
}
