//! Many numbers side by side in vectors: a number kind whose every lane has the bits of `f64`.

pub(crate) mod row;
pub(crate) mod vector;

use crate::numbers::lanes::vector::{Kernel, Vector, lanes, lanes_mut, run_apart};
use crate::numbers::number::{Arithmetic, Mask, operators};
use crate::numbers::trig;

/// Vectors of one number. A bounce is one long chain of operations, each waiting for the last, and the CPU overlaps those of four.
const VECTORS: usize = 4;

/// Most lanes of a number.
pub(crate) const MOST_LANES: usize = 32;

/// Numbers side by side.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub(crate) struct Packs<V>([V; VECTORS]);

/// Answers for each of them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PackMask<V: Vector>([V::Mask; VECTORS]);

/// An operation of vectors on each vector of some numbers.
macro_rules! each {
    ($operation:ident($($pack:expr),+)) => {
        [
            V::$operation($($pack.0[0]),+),
            V::$operation($($pack.0[1]),+),
            V::$operation($($pack.0[2]),+),
            V::$operation($($pack.0[3]),+),
        ]
    };
}

operators! {
    #[inline(always)] [V: Vector] Packs<V>:
    Add add(self, other) { Self(each!(add(self, other))) }
    Sub sub(self, other) { Self(each!(sub(self, other))) }
    Mul mul(self, other) { Self(each!(mul(self, other))) }
    Div div(self, other) { Self(each!(div(self, other))) }
    Neg neg(self) { Self(each!(negated(self))) }
}

operators! {
    #[inline(always)] [V: Vector] PackMask<V>:
    BitAnd bitand(self, other) { Self(each!(both(self, other))) }
    BitOr bitor(self, other) { Self(each!(either(self, other))) }
    Not not(self) { Self(each!(not(self))) }
}

impl<V: Vector> Mask for PackMask<V> {
    #[inline(always)]
    fn any(self) -> bool {
        let Self([a, b, c, d]) = self;
        V::bits(V::either(V::either(a, b), V::either(c, d))) != 0
    }

    #[inline(always)]
    fn all(self) -> bool {
        let Self([a, b, c, d]) = self;
        V::bits(V::both(V::both(a, b), V::both(c, d))) == (1 << V::LANES) - 1
    }
}

impl<V: Vector> PackMask<V> {
    /// The answers as bits, that of the first lane lowest.
    #[inline(always)]
    pub(crate) fn bits(self) -> u32 {
        let Self([a, b, c, d]) = self;
        V::bits(a) | V::bits(b) << V::LANES | V::bits(c) << (2 * V::LANES) | V::bits(d) << (3 * V::LANES)
    }
}

impl<V: Vector> Packs<V> {
    /// Number of lanes.
    pub(crate) const LANES: usize = VECTORS * V::LANES;

    /// The number in a lane.
    #[inline(always)]
    pub(crate) fn lane(&self, lane: usize) -> f64 {
        lanes(&self.0)[lane]
    }

    /// The numbers of all lanes.
    #[inline(always)]
    pub(crate) fn lanes_mut(&mut self) -> &mut [f64] {
        lanes_mut(&mut self.0)
    }

    /// Puts a number into a lane.
    #[inline(always)]
    pub(crate) fn put(&mut self, lane: usize, value: f64) {
        lanes_mut(&mut self.0)[lane] = value;
    }

    #[inline(always)]
    fn are_all_within(self, most: f64) -> bool {
        self.magnitude().is_at_most(Self::from_f64(most)).all()
    }
}

impl<V: Vector> Arithmetic for Packs<V> {
    type Mask = PackMask<V>;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self([V::splat(value); VECTORS])
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(each!(sqrt(self)))
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        if self.are_all_within(trig::SMALL) {
            (trig::sin_small(self), trig::cos_small(self))
        } else {
            run_apart::<V, _>(FarSines::<V, false>(self))
        }
    }

    #[inline(never)]
    fn angle_of(mut y: Self, mut x: Self) -> Self {
        for (y, x) in y.lanes_mut().iter_mut().zip(x.lanes_mut()) {
            *y = f64::angle_of(*y, *x);
        }
        y
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        if self.are_all_within(trig::SMALL) {
            (trig::sin_small(self), trig::versine_small(self))
        } else {
            run_apart::<V, _>(FarSines::<V, true>(self))
        }
    }

    #[inline(always)]
    fn is_less(self, other: Self) -> PackMask<V> {
        PackMask(each!(is_less(self, other)))
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> PackMask<V> {
        PackMask(each!(is_at_most(self, other)))
    }

    #[inline(always)]
    fn select(mask: PackMask<V>, yes: Self, no: Self) -> Self {
        Self(each!(select(mask, yes, no)))
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        Self(each!(magnitude(self)))
    }
}

/// Sines of angles that need a reduction, with cosines or with 1 less the cosines.
struct FarSines<V, const VERSINES: bool>(Packs<V>);

impl<V: Vector, const VERSINES: bool> Kernel for FarSines<V, VERSINES> {
    type Output = (Packs<V>, Packs<V>);

    #[inline(always)]
    fn call<P: Vector>(self) -> Self::Output {
        let Self(mut angles) = self;
        if angles.are_all_within(trig::REDUCIBLE) {
            return if VERSINES { trig::sin_versine_reducible(angles) } else { trig::sin_cos_reducible(angles) };
        }
        let mut others = angles;
        for (angle, other) in angles.lanes_mut().iter_mut().zip(others.lanes_mut()) {
            (*angle, *other) = if VERSINES { trig::sin_versine(*angle) } else { trig::sin_cos(*angle) };
        }
        (angles, others)
    }
}
