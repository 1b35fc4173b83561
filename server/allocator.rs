//! Options of the allocator: memory that is freed goes back to the system.

#![allow(unsafe_code)]

use libmimalloc_sys::{mi_option_set, mi_option_t};
use mimalloc::MiMalloc;

/// The C library's allocator holds ever more memory under mixed load, with answers of all sizes from many threads; this one does
/// not. `cargo bench --bench load -- --only soak` shows it.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// `mi_option_arena_purge_mult` of mimalloc 2: the delay after which freed blocks of 32 MiB go back, in delays of the pages in them.
const ARENA_PURGE_MULTIPLIER: mi_option_t = 24;

/// Gives large freed blocks back to the system at once. With a delay they go back only when the allocator is next asked for such a
/// block: after many large answers that is never.
pub(crate) fn give_back_at_once() {
    // SAFETY: it stores a number in a table of the library, under a number that this version has.
    unsafe { mi_option_set(ARENA_PURGE_MULTIPLIER, 0) };
}
