//! Mutates inputs of lines `name number` as numbers: to the next double, another size, a special value, or the number of another line.
//! Mutations of single bytes would hardly ever come near a grazing contact.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

const SPECIAL: [f64; 10] = [0.0, 1.0, 2.0, 0.5, PI, FRAC_PI_2, TAU, 1e-9, 1e-3, 1e3];

/// A libFuzzer mutator: changes `data[..size]` and returns its new size, at most `most`.
pub fn numbers(data: &mut [u8], size: usize, most: usize, seed: u32) -> usize {
    let mut random = SplitMix64::seed_from_u64(u64::from(seed));
    let text = std::str::from_utf8(&data[..size]).unwrap_or_default();
    let mut lines: Vec<(String, f64)> = text
        .lines()
        .filter_map(|line| line.split_once(' '))
        .filter_map(|(name, number)| Some((name.to_owned(), number.trim().parse().ok()?)))
        .collect();
    if lines.is_empty() || random.random_range(..8_u32) == 0 {
        return libfuzzer_sys::fuzzer_mutate(data, size, most);
    }
    for _ in 0..=random.random_range(..3_u32) {
        let (line, other) = (random.random_range(..lines.len()), random.random_range(..lines.len()));
        let number = lines[line].1;
        lines[line].1 = match random.random_range(..10_u32) {
            0 => number.next_up(),
            1 => number.next_down(),
            2 => -number,
            3 => number * 2.0_f64.powi(random.random_range(-10..=10)),
            4 => number * (1.0 + 1e-6 * random.random_range(-1.0..1.0)),
            5 => number * random.random_range(0.5..2.0),
            6 => SPECIAL[random.random_range(..SPECIAL.len())],
            7 => lines[other].1,
            8 => 10.0_f64.powf(random.random_range(-9.0..4.0)) * f64::signum(random.random_range(-1.0..1.0)),
            _ => number + random.random_range(-1.0..1.0),
        };
    }
    let text: String = lines.iter().map(|(name, number)| format!("{name} {number:?}\n")).collect();
    if text.len() > most {
        return libfuzzer_sys::fuzzer_mutate(data, size, most);
    }
    data[..text.len()].copy_from_slice(text.as_bytes());
    text.len()
}
