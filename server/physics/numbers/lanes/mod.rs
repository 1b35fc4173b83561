//! Many numbers side by side in vectors: a number kind whose every lane has the bits of `f64`.

pub(super) mod vector;

use crate::numbers::arctangent;
use crate::numbers::lanes::vector::{Kernel, Vector, lanes, lanes_mut, run_apart};
use crate::numbers::number::{Arithmetic, Mask};
use crate::numbers::trig;
use crate::numbers::trig::Quadrants;
use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

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

macro_rules! operators {
    ($($trait:ident $method:ident,)*) => {
        $(impl<V: Vector> $trait for Packs<V> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
                Self([V::$method(a, e), V::$method(b, f), V::$method(c, g), V::$method(d, h)])
            }
        })*
    };
}

operators! { Add add, Sub sub, Mul mul, Div div, }

impl<V: Vector> Neg for Packs<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([V::negated(a), V::negated(b), V::negated(c), V::negated(d)])
    }
}

impl<V: Vector> BitAnd for PackMask<V> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
        Self([V::both(a, e), V::both(b, f), V::both(c, g), V::both(d, h)])
    }
}

impl<V: Vector> BitOr for PackMask<V> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
        Self([V::either(a, e), V::either(b, f), V::either(c, g), V::either(d, h)])
    }
}

impl<V: Vector> Not for PackMask<V> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([V::not(a), V::not(b), V::not(c), V::not(d)])
    }
}

impl<V: Vector> Mask for PackMask<V> {
    #[inline(always)]
    fn all_are(answer: bool) -> Self {
        Self([V::mask(answer); VECTORS])
    }

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

    /// Arctangent, rad, of numbers from 0 to [`arctangent::REDUCIBLE`].
    #[inline(always)]
    pub(crate) fn arctangent(self) -> Self {
        if self.are_all_within(arctangent::SMALL) {
            arctangent::arctangent_small(self)
        } else {
            arctangent::arctangent_reducible(self)
        }
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
        let Self([a, b, c, d]) = self;
        Self([V::sqrt(a), V::sqrt(b), V::sqrt(c), V::sqrt(d)])
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
            *y = trig::angle_of(*y, *x);
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
        let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
        PackMask([V::is_less(a, e), V::is_less(b, f), V::is_less(c, g), V::is_less(d, h)])
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> PackMask<V> {
        let (Self([a, b, c, d]), Self([e, f, g, h])) = (self, other);
        PackMask([V::is_at_most(a, e), V::is_at_most(b, f), V::is_at_most(c, g), V::is_at_most(d, h)])
    }

    #[inline(always)]
    fn select(mask: PackMask<V>, yes: Self, no: Self) -> Self {
        let (PackMask([m, n, o, p]), Self([a, b, c, d]), Self([e, f, g, h])) = (mask, yes, no);
        Self([V::select(m, a, e), V::select(n, b, f), V::select(o, c, g), V::select(p, d, h)])
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        let Self([a, b, c, d]) = self;
        Self([V::magnitude(a), V::magnitude(b), V::magnitude(c), V::magnitude(d)])
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

impl<V: Vector> Quadrants for Packs<V> {
    #[inline(always)]
    fn in_quadrant(rounded: Self, sin: Self, cos: Self) -> (Self, Self) {
        let (Self([r, s, t, u]), Self([a, b, c, d]), Self([e, f, g, h])) = (rounded, sin, cos);
        let ((a, e), (b, f), (c, g), (d, h)) =
            (V::in_quadrant(r, a, e), V::in_quadrant(s, b, f), V::in_quadrant(t, c, g), V::in_quadrant(u, d, h));
        (Self([a, b, c, d]), Self([e, f, g, h]))
    }
}
