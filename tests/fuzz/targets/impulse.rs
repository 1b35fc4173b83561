//! `checks::impulse` for libFuzzer, with mutations of numbers.

#![no_main]

mod change;
#[path = "../checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|data: &[u8]| checks::impulse::check(data));
libfuzzer_sys::fuzz_mutator!(|data: &mut [u8], size: usize, most: usize, seed: u32| {
    change::numbers(data, size, most, seed)
});
