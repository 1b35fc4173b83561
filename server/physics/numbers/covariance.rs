//! Covariance matrix of a few numbers.

use crate::numbers::dispatch::Vector;
use crate::numbers::lanes::row::Row;

/// A symmetric matrix of `S` numbers, its rows filled up with zeros.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Covariance<const S: usize, const W: usize>([Row<W>; S]);

impl<const S: usize, const W: usize> Covariance<S, W> {
    /// The matrix of zeros.
    pub(crate) const ZERO: Self = Self([Row::ZERO; S]);

    /// Variance of a number; rounding may leave it below 0.
    #[inline(always)]
    pub(crate) fn variance(&self, index: usize) -> f64 {
        self.0[index].0[index]
    }

    /// Σv for the first numbers of a row.
    #[inline(always)]
    pub(crate) fn times<V: Vector>(&self, row: &Row<W>) -> Row<W> {
        Row::combined::<V, S>(row, &self.0)
    }

    /// Carries it over a step to numbers of which those that `change` have these rows of derivatives, and the others stay as they are. Then it
    /// adds independent errors of these variances, and an error of all numbers at once, one standard deviation of each, if there is one.
    #[inline(always)]
    pub(crate) fn carry<V: Vector>(
        &mut self,
        rows: &[Row<W>; S],
        change: &[bool; S],
        variances: &[f64; S],
        together: Option<&Row<W>>,
    ) {
        let (mut sums, mut entries) = ([Row::ZERO; S], [[0.0; S]; S]);
        for index in 0..S {
            if change[index] {
                sums[index] = self.times::<V>(&rows[index]);
            }
        }
        for index in 0..S {
            for other in 0..S {
                if change[index] && (other >= index || !change[other]) {
                    let entry =
                        if change[other] { sums[index].dot::<V, S>(&rows[other]) } else { sums[index].0[other] };
                    (entries[index][other], entries[other][index]) = (entry, entry);
                }
            }
        }
        for index in 0..S {
            let mut row = self.0[index];
            for other in 0..S {
                if change[index] || change[other] {
                    row.0[other] = entries[index][other];
                }
            }
            // Whole rows are written, so that whole rows can be read soon.
            row = row.plus::<V>(&Row::unit(index).times::<V>(variances[index]));
            if let Some(together) = together {
                row = row.plus::<V>(&together.times::<V>(together.0[index]));
            }
            self.0[index] = row;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::dispatch::{Kernel, dispatch, portable};

    const SIZE: usize = 3;

    /// A step over which the second number stays, and derivatives by parameters stand behind those by the numbers.
    struct Step(Covariance<SIZE, 8>);

    const ROWS: [[f64; SIZE]; SIZE] = [[0.5, -2.0, 1.0], [0.0, 1.0, 0.0], [3.0, 0.25, -1.5]];
    const TOGETHER: [f64; SIZE] = [0.1, 0.0, -0.3];
    const VARIANCES: [f64; SIZE] = [0.01, 0.0, 0.02];

    fn row(numbers: [f64; SIZE], after: f64) -> Row<8> {
        let mut row = Row([after; 8]);
        row.0[..SIZE].copy_from_slice(&numbers);
        row
    }

    impl Kernel for Step {
        type Output = Covariance<SIZE, 8>;

        #[inline(always)]
        fn call<V: Vector>(mut self) -> Self::Output {
            let change = [true, false, true];
            self.0.carry::<V>(&ROWS.map(|numbers| row(numbers, 7.0)), &change, &VARIANCES, Some(&row(TOGETHER, 0.0)));
            self.0
        }
    }

    #[test]
    fn it_is_carried_as_a_product_of_matrices() {
        let start = [[2.0, 0.5, -0.25], [0.5, 1.0, 0.125], [-0.25, 0.125, 4.0]];
        let covariance = Covariance(start.map(|numbers| row(numbers, 0.0)));
        let (slow, fast) = (portable(Step(covariance)), dispatch(Step(covariance)));
        for (one, two) in [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)] {
            let mut exact = TOGETHER[one] * TOGETHER[two] + if one == two { VARIANCES[one] } else { 0.0 };
            for (from, column) in ROWS[one].iter().zip(start) {
                for (to, entry) in ROWS[two].iter().zip(column) {
                    exact += from * to * entry;
                }
            }
            let entries = [slow.0[one].0[two], slow.0[two].0[one], fast.0[one].0[two], fast.0[two].0[one]];
            assert!(entries.iter().all(|entry| (entry - exact).abs() < 1e-14), "{one} {two}: {entries:?} {exact}");
            assert_eq!(entries[0].to_bits(), entries[2].to_bits());
        }
        assert!(slow.0.iter().all(|row| row.0[SIZE..] == [0.0; 5]));
    }
}
