//! Numbers that know how far rounding may have moved them, beside their derivatives.

use crate::numbers::dispatch::{PortableVector, Vector};
use crate::numbers::lanes::row::Row;
use crate::numbers::number::{Arithmetic, Number, apart, operators};
use std::marker::PhantomData;

/// Origin of a number. Where code is inlined it is known when that is compiled, and what it leaves out costs nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// It is exact and moves along no direction.
    Constant,
    /// It is exact.
    Given,
    /// It is this state of a run, exact.
    State(usize),
    /// An operation has given it.
    Computed,
}

impl Origin {
    /// That of the negated number.
    #[inline(always)]
    fn negated(self) -> Self {
        if let Self::State(_) = self { Self::Given } else { self }
    }
}

/// A value, its derivatives in `W` directions, and the variance that rounding in its computation has given it. Roundings count as independent
/// of each other, each of them as the largest that it can be. Derivatives are computed by vectors `V`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Inexact<V, const W: usize> {
    pub(crate) value: f64,
    /// In squares of the share that one rounding is off.
    pub(crate) variance: f64,
    pub(crate) partials: Row<W>,
    pub(crate) origin: Origin,
    vectors: PhantomData<V>,
}

/// The zero that leaves every number as it is in a sum, zeros of either sign too.
const NOTHING: f64 = -0.0;

impl<V: Vector, const W: usize> Inexact<V, W> {
    /// True of numbers with many directions in small vectors, which are those of bodies that are seldom asked for.
    const IS_APART: bool = W > 8 && V::LANES == PortableVector::LANES;

    /// An exact number that moves like this along the directions.
    #[inline(always)]
    pub(crate) fn given(value: f64, partials: Row<W>, origin: Origin) -> Self {
        Self { value, variance: 0.0, partials, origin, vectors: PhantomData }
    }

    #[inline(always)]
    fn computed(value: f64, variance: f64, partials: Row<W>) -> Self {
        Self { value, variance, partials, origin: Origin::Computed, vectors: PhantomData }
    }

    /// The result of an operation whose operands give it this variance.
    #[inline(always)]
    fn rounded(value: f64, variance: f64, partials: Row<W>) -> Self {
        Self::computed(value, variance + value * value, partials)
    }

    #[inline(always)]
    fn is_constant(&self) -> bool {
        self.origin == Origin::Constant
    }

    /// The variance of the number times a square.
    #[inline(always)]
    fn variance_times(&self, square: f64) -> f64 {
        if self.origin == Origin::Computed { self.variance * square } else { NOTHING }
    }

    /// The result of a sum: with 0 it is exact.
    #[inline(always)]
    fn sum(self, other: Self, value: f64, partials: Row<W>) -> Self {
        let is_exact = self.value == 0.0 || other.value == 0.0;
        let variance = self.variance_times(1.0) + other.variance_times(1.0);
        Self::computed(value, variance + if is_exact { 0.0 } else { value * value }, partials)
    }

    #[inline(always)]
    fn composed(self, value: f64, slope: f64) -> Self {
        Self::rounded(value, self.variance_times(slope * slope), self.partials.times::<V>(slope))
    }

    /// A function of it with this value and this slope.
    #[inline(always)]
    pub(crate) fn function(self, value: f64, slope: f64) -> Self {
        if Self::IS_APART {
            apart(move || self.composed(value, slope))
        } else {
            // Not the same closure, since those are not inlined on demand.
            self.composed(value, slope)
        }
    }

    /// Partial derivatives of a function of two numbers with these slopes.
    #[inline(always)]
    fn by_slopes(&self, slope: f64, other: &Self, of_other: f64) -> Row<W> {
        if self.is_constant() {
            other.partials.times::<V>(of_other)
        } else if other.is_constant() {
            self.partials.times::<V>(slope)
        } else {
            self.partials.weighted::<V>(slope, &other.partials, of_other)
        }
    }
}

impl<const W: usize> Inexact<PortableVector, W> {
    /// The same exact number for other vectors.
    #[inline(always)]
    pub(crate) fn in_vectors<V: Vector>(self) -> Inexact<V, W> {
        Inexact::given(self.value, self.partials, Origin::Given)
    }
}

operators! {
    #[inline(always)] [V: Vector, const W: usize] Inexact<V, W>, apart if { Self::IS_APART }:
    Add add(self, other) {
        let partials = if self.is_constant() {
            other.partials
        } else if other.is_constant() {
            self.partials
        } else {
            self.partials.plus::<V>(&other.partials)
        };
        self.sum(other, self.value + other.value, partials)
    }
    Sub sub(self, other) {
        let partials = if self.is_constant() {
            other.partials.negated::<V>()
        } else if other.is_constant() {
            self.partials
        } else {
            self.partials.minus::<V>(&other.partials)
        };
        self.sum(other, self.value - other.value, partials)
    }
    Mul mul(self, other) {
        let (one, two) = (self.value, other.value);
        let variance = self.variance_times(two * two) + other.variance_times(one * one);
        Self::rounded(one * two, variance, self.by_slopes(two, &other, one))
    }
    Div div(self, other) {
        let (quotient, inverse) = (self.value / other.value, 1.0 / other.value);
        let variance = (self.variance_times(1.0) + other.variance_times(quotient * quotient)) * (inverse * inverse);
        Self::rounded(quotient, variance, self.by_slopes(inverse, &other, -quotient * inverse))
    }
    Neg neg(self) { Self { value: -self.value, partials: self.partials.negated::<V>(), origin: self.origin.negated(), ..self } }
}

impl<V: Vector, const W: usize> Arithmetic for Inexact<V, W> {
    type Mask = bool;

    #[inline(always)]
    fn angle_of(y: Self, x: Self) -> Self {
        crate::numbers::number::angle_of(y, x)
    }

    #[inline(always)]
    fn is_less(self, other: Self) -> bool {
        self.value < other.value
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> bool {
        self.value <= other.value
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        // Of one origin, whatever the mask.
        let origin = if yes.origin == no.origin { yes.origin } else { Origin::Computed };
        Self { origin, ..if mask { yes } else { no } }
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.value == 0.0 && self.variance == 0.0 && self.partials == Row::ZERO
    }

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self::given(value, Row::ZERO, Origin::Constant)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.function(root, 0.5 / root)
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sincos();
        (self.function(sin, cos), self.function(cos, -sin))
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        let (sin, versine) = self.value.sin_versine();
        (self.function(sin, 1.0 - versine), self.function(versine, sin))
    }
}

impl<V: Vector, const W: usize> Number for Inexact<V, W> {
    const NEWTON_STEPS: u32 = 1;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.value
    }
}
