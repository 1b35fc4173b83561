//! Random numbers from a seed.

use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

/// A source of random numbers.
pub(crate) struct Random(SplitMix64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(SplitMix64::seed_from_u64(seed))
    }

    /// Uniform between two numbers.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }

    /// Uniform in its logarithm, of either sign.
    #[allow(dead_code, reason = "not every test that shares this file draws sizes")]
    pub(crate) fn size(&mut self, low: f64, high: f64) -> f64 {
        let size = self.between(low.ln(), high.ln()).exp();
        if self.0.random() { size } else { -size }
    }
}
