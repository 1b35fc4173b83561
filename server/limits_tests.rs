//! Unit tests of the limits.

use super::*;

#[test]
fn answers_are_held_in_a_share_of_the_memory_there_is() {
    for (allowed, held) in
        [(None, 1 << 30), (Some(64 << 30), 1 << 30), (Some(512 << 20), 128 << 20), (Some(0), 1 << 20)]
    {
        assert_eq!(share(allowed, HELD_BYTES_SHARE, HELD_BYTES_LEAST..=HELD_BYTES_MOST), held, "{allowed:?}");
    }
    for (allowed, computing) in [(None, 1 << 44), (Some(600 << 20), 200 << 20), (Some(0), 32 << 20)] {
        let range = COMPUTE_BYTES_LEAST..=COMPUTE_BYTES_MOST;
        assert_eq!(share(allowed, COMPUTE_BYTES_SHARE, range), computing, "{allowed:?}");
    }
    let Limits { held_bytes, answer_cache, .. } = Limits::default();
    assert!(held_bytes as u64 <= HELD_BYTES_MOST && answer_cache as u64 <= ANSWER_CACHE_MOST);
}
