//! Covariance matrix of a few numbers.

/// A symmetric matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Covariance<const S: usize>([[f64; S]; S]);

impl<const S: usize> Covariance<S> {
    /// The matrix of zeros.
    pub(crate) const ZERO: Self = Self([[0.0; S]; S]);

    /// Variance of a number; rounding may leave it below 0.
    #[inline(always)]
    pub(crate) fn variance(&self, index: usize) -> f64 {
        self.0[index][index]
    }

    /// Σv for the first numbers of a row.
    #[inline(always)]
    pub(crate) fn times<const W: usize>(&self, row: &[f64; W]) -> [f64; S] {
        let mut sums = [0.0; S];
        for (factor, column) in row.iter().zip(&self.0) {
            for (sum, entry) in sums.iter_mut().zip(column) {
                *sum += factor * entry;
            }
        }
        sums
    }

    /// JΣJᵀ for rows that begin with those of J.
    #[inline(always)]
    pub(crate) fn carried<'a, const W: usize>(&self, row: impl Fn(usize) -> &'a [f64; W]) -> Self {
        let (mut columns, mut carried) = ([[0.0; S]; S], [[0.0; S]; S]);
        for index in 0..S {
            for (column, entry) in columns.iter_mut().zip(row(index)) {
                column[index] = *entry;
            }
        }
        for (index, sums) in carried.iter_mut().enumerate() {
            for (factor, column) in self.times(row(index)).iter().zip(&columns) {
                for (sum, entry) in sums.iter_mut().zip(column) {
                    *sum += factor * entry;
                }
            }
        }
        Self(carried)
    }

    /// Adds an independent error of one number, of this variance.
    #[inline(always)]
    pub(crate) fn add(&mut self, index: usize, variance: f64) {
        self.0[index][index] += variance;
    }

    /// Adds an error of all numbers at once, one standard deviation of each.
    #[inline(always)]
    pub(crate) fn add_along(&mut self, deviations: &[f64; S]) {
        for (row, one) in self.0.iter_mut().zip(deviations) {
            for (entry, other) in row.iter_mut().zip(deviations) {
                *entry += one * other;
            }
        }
    }
}
