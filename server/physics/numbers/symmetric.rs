//! Symmetric matrix of order 4, kept as its upper half.

/// A symmetric matrix, each row from the diagonal on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Symmetric {
    pub(crate) first: [f64; 4],
    pub(crate) second: [f64; 3],
    pub(crate) third: [f64; 2],
    pub(crate) fourth: f64,
}

impl Symmetric {
    /// The matrix of zeros.
    pub(crate) const ZERO: Self = Self { first: [0.0; 4], second: [0.0; 3], third: [0.0; 2], fourth: 0.0 };

    /// The whole rows.
    #[inline(always)]
    pub(crate) fn rows(&self) -> [[f64; 4]; 4] {
        let Self { first: [a, b, c, d], second: [e, f, g], third: [h, i], fourth: j } = *self;
        [[a, b, c, d], [b, e, f, g], [c, f, h, i], [d, g, i, j]]
    }

    /// The product with a vector.
    #[inline(always)]
    pub(crate) fn times(&self, vector: &[f64; 4]) -> [f64; 4] {
        self.rows().map(|row| product(&row, vector))
    }
}

/// The scalar product of two vectors.
#[inline(always)]
pub(crate) fn product([a, b, c, d]: &[f64; 4], [p, q, r, s]: &[f64; 4]) -> f64 {
    (a * p + b * q) + (c * r + d * s)
}
