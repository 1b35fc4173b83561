//! Doubles as numbers of the formulas.

use crate::numbers::number::{Arithmetic, Number, decided_by_double};
use crate::numbers::trig;
use crate::numbers::trig::Quadrants;

impl Arithmetic for f64 {
    type Mask = bool;

    decided_by_double!(trig::angle_of);

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        trig::sin_cos(self)
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        trig::sin_versine(self)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
}

impl Number for f64 {
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }
}

impl Quadrants for f64 {
    #[inline(always)]
    fn in_quadrant(rounded: Self, sin: Self, cos: Self) -> (Self, Self) {
        let quadrant = rounded.to_bits();
        let (first, second) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, sin) };
        // sin changes its sign in quadrants 2 and 3, cos in 1 and 2.
        let flip = |value: f64, flips: u64| f64::from_bits(value.to_bits() ^ ((flips & 2) << 62));
        (flip(first, quadrant), flip(second, quadrant + 1))
    }
}
