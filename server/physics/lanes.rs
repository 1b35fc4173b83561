//! Eight numbers that go through the same formula side by side, with the same bits as one alone.
//!
//! Plain arrays: the compiler turns them into whatever vectors the CPU has ([`crate::dispatch`]). No fused operations.

use crate::number::{Number, Real};
use crate::trig;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// How many lanes there are.
pub const WIDTH: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub struct Lanes(pub [f64; WIDTH]);

impl Lanes {
    #[inline(always)]
    fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let mut out = self.0;
        for lane in &mut out {
            *lane = function(*lane);
        }
        Self(out)
    }

    #[inline(always)]
    fn zip(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        let mut out = self.0;
        for (lane, other) in out.iter_mut().zip(other.0) {
            *lane = function(*lane, other);
        }
        Self(out)
    }

    #[inline(always)]
    fn pairs(self, function: impl Fn(f64) -> (f64, f64)) -> (Self, Self) {
        let (mut first, mut second) = (self.0, self.0);
        for ((first, second), angle) in first.iter_mut().zip(&mut second).zip(self.0) {
            (*first, *second) = function(angle);
        }
        (Self(first), Self(second))
    }

    /// Whether all lanes are at most `limit` in size; not if one is not a number.
    #[inline(always)]
    fn within(self, limit: f64) -> bool {
        let mut inside = true;
        for lane in self.0 {
            inside &= lane.abs() <= limit;
        }
        inside
    }
}

impl Add for Lanes {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl Sub for Lanes {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl Mul for Lanes {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b)
    }
}

impl Div for Lanes {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b)
    }
}

impl Neg for Lanes {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|a| -a)
    }
}

impl Number for Lanes {
    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self([value; WIDTH])
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        if self.within(trig::SMALL) {
            (self.map(trig::sin_small), self.map(trig::cos_small))
        } else if self.within(trig::REDUCIBLE) {
            self.pairs(trig::sin_cos_reducible)
        } else {
            one_by_one(self, trig::sin_cos)
        }
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        if self.within(trig::SMALL) {
            (self.map(trig::sin_small), self.map(trig::versine_small))
        } else if self.within(trig::REDUCIBLE) {
            self.pairs(trig::sin_versine_reducible)
        } else {
            one_by_one(self, trig::sin_versine)
        }
    }
}

impl Real for Lanes {
    #[inline(always)]
    fn magnitude(self) -> Self {
        self.map(f64::abs)
    }
}

/// By value: a reference to a cold path costs the hot one a factor of two.
#[cold]
#[inline(never)]
fn one_by_one(angles: Lanes, function: fn(f64) -> (f64, f64)) -> (Lanes, Lanes) {
    angles.pairs(function)
}
