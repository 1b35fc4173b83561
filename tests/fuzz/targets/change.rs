//! Mutates inputs of lines `name number` as numbers: to the next double, another size, a special value, or the number of another line.
//! Mutations of single bytes would hardly ever come near a grazing contact.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

const SPECIAL: [f64; 10] = [0.0, 1.0, 2.0, 0.5, PI, FRAC_PI_2, TAU, 1e-9, 1e-3, 1e3];

/// A libFuzzer mutator: changes `data[..size]` and returns its new size, at most `most`.
pub fn numbers(data: &mut [u8], size: usize, most: usize, seed: u32) -> usize {
    let mut random = Random(u64::from(seed));
    let text = std::str::from_utf8(&data[..size]).unwrap_or_default();
    let mut lines: Vec<(String, f64)> = text
        .lines()
        .filter_map(|line| line.split_once(' '))
        .filter_map(|(name, number)| Some((name.to_owned(), number.trim().parse().ok()?)))
        .collect();
    if lines.is_empty() || random.below(8) == 0 {
        return libfuzzer_sys::fuzzer_mutate(data, size, most);
    }
    for _ in 0..=random.below(3) {
        let (line, other) = (random.below(lines.len()), random.below(lines.len()));
        let number = lines[line].1;
        lines[line].1 = match random.below(10) {
            0 => number.next_up(),
            1 => number.next_down(),
            2 => -number,
            3 => number * 2.0_f64.powi(random.below(21) as i32 - 10),
            4 => number * (1.0 + 1e-6 * random.between(-1.0, 1.0)),
            5 => number * random.between(0.5, 2.0),
            6 => SPECIAL[random.below(SPECIAL.len())],
            7 => lines[other].1,
            8 => 10.0_f64.powf(random.between(-9.0, 4.0)) * random.between(-1.0, 1.0).signum(),
            _ => number + random.between(-1.0, 1.0),
        };
    }
    let text: String = lines.iter().map(|(name, number)| format!("{name} {number:?}\n")).collect();
    if text.len() > most {
        return libfuzzer_sys::fuzzer_mutate(data, size, most);
    }
    data[..text.len()].copy_from_slice(text.as_bytes());
    text.len()
}

/// Random numbers from a seed (splitmix64, Steele and others, 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit as u64) as usize
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
