//! Random numbers from a seed.

/// A generator of the splitmix family (G. L. Steele, D. Lea and C. H. Flood, 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform between two numbers.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Uniform in its logarithm, of either sign.
    pub(crate) fn size(&mut self, low: f64, high: f64) -> f64 {
        let size = self.between(low.ln(), high.ln()).exp();
        if self.next() & 1 == 0 { size } else { -size }
    }
}
