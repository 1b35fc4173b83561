//! A few numbers in a row, which vectors take several of at a time: the partial derivatives of a number, or a row of a matrix.

use crate::numbers::lanes::vector::{Vector, read, write};

/// Numbers in a row, a multiple of the lanes of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(crate) struct Row<const W: usize>(pub(crate) [f64; W]);

/// The row of an expression of vectors `V`, which are those of rows; 0 beyond the vectors that have one of the first `$count` numbers. Not a
/// function of a closure, since those are not inlined on demand.
macro_rules! each {
    ($($numbers:ident = $row:expr),+ => $result:expr) => { each!(W; $($numbers = $row),+ => $result) };
    ($count:expr; $($numbers:ident = $row:expr),+ => $result:expr) => {{
        const { assert!(W % V::LANES == 0) };
        let mut result = Self::ZERO;
        let mut at = 0;
        while at < $count {
            $(let $numbers: V = read(&$row.0[at..]);)+
            write($result, &mut result.0[at..]);
            at += V::LANES;
        }
        result
    }};
}

impl<const W: usize> Row<W> {
    /// Zeros.
    pub(crate) const ZERO: Self = Self([0.0; W]);

    /// 0 but for a 1 at this index.
    #[inline(always)]
    pub(crate) fn unit(index: usize) -> Self {
        let mut unit = Self::ZERO;
        unit.0[index] = 1.0;
        unit
    }

    #[inline(always)]
    pub(crate) fn plus<V: Vector>(&self, other: &Self) -> Self {
        each!(one = self, two = other => V::add(one, two))
    }

    #[inline(always)]
    pub(crate) fn minus<V: Vector>(&self, other: &Self) -> Self {
        each!(one = self, two = other => V::sub(one, two))
    }

    #[inline(always)]
    pub(crate) fn negated<V: Vector>(&self) -> Self {
        each!(numbers = self => V::negated(numbers))
    }

    #[inline(always)]
    pub(crate) fn times<V: Vector>(&self, factor: f64) -> Self {
        let factor = V::splat(factor);
        each!(numbers = self => V::mul(numbers, factor))
    }

    /// Products of numbers at the same place.
    #[inline(always)]
    pub(crate) fn product<V: Vector>(&self, other: &Self) -> Self {
        each!(one = self, two = other => V::mul(one, two))
    }

    /// Scalar product of the first numbers.
    #[inline(always)]
    pub(crate) fn dot<V: Vector, const S: usize>(&self, other: &Self) -> f64 {
        let products = each!(S; one = self, two = other => V::mul(one, two));
        let mut sum = products.0[0];
        for product in &products.0[1..S] {
            sum += product;
        }
        sum
    }

    /// The sum of two rows, each with a factor.
    #[inline(always)]
    pub(crate) fn weighted<V: Vector>(&self, factor: f64, other: &Self, of_other: f64) -> Self {
        let (factor, of_other) = (V::splat(factor), V::splat(of_other));
        each!(one = self, two = other => V::add(V::mul(factor, one), V::mul(of_other, two)))
    }

    /// The sum of rows of `S` numbers, each with its factor.
    #[inline(always)]
    pub(crate) fn combined<V: Vector, const S: usize>(factors: &Self, rows: &[Self; S]) -> Self {
        let factor = V::splat(factors.0[0]);
        let mut sum = each!(S; numbers = rows[0] => V::mul(factor, numbers));
        let mut index = 1;
        while index < S {
            let factor = V::splat(factors.0[index]);
            sum = each!(S; sum = sum, numbers = rows[index] => V::add(sum, V::mul(factor, numbers)));
            index += 1;
        }
        sum
    }
}
