//! Dual numbers: a value with its partial derivatives, carried through a formula exactly (forward differentiation).

use crate::numbers::number::{Arithmetic, Number, decided_by_double, operators};

/// A value and its derivatives in `K` directions. Over dual numbers in place of doubles it has second derivatives too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const K: usize, N = f64> {
    /// The value itself.
    pub value: N,
    /// Derivatives, one for each direction.
    pub partials: [N; K],
}

/// A value with its first and second derivatives in `K` directions.
pub type SecondOrder<const K: usize> = Dual<K, Dual<K>>;

/// A value with its derivatives up to the third in `K` directions.
pub type ThirdOrder<const K: usize> = Dual<K, SecondOrder<K>>;

impl SecondOrder<2> {
    /// `value` + `x`·X + `y`·Y.
    pub fn linear(value: f64, [x, y]: [f64; 2]) -> Self {
        Self { value: Dual { value, partials: [x, y] }, partials: [x, y].map(Dual::from_f64) }
    }

    /// Coefficients of X², XY and Y².
    pub fn second(&self) -> [f64; 3] {
        let [[xx, xy], [_, yy]] = self.partials.map(|first| first.partials);
        [0.5 * xx, xy, 0.5 * yy]
    }
}

impl ThirdOrder<2> {
    /// `value` + `x`·X + `y`·Y.
    pub fn linear(value: f64, [x, y]: [f64; 2]) -> Self {
        Self { value: SecondOrder::linear(value, [x, y]), partials: [x, y].map(SecondOrder::from_f64) }
    }

    /// The same with `xx` X² + `xy` XY + `yy` Y² added.
    #[must_use]
    pub fn plus_quadratic(mut self, [xx, xy, yy]: [f64; 3]) -> Self {
        for (one, other, more) in [(0, 0, 2.0 * xx), (0, 1, xy), (1, 0, xy), (1, 1, 2.0 * yy)] {
            self.value.partials[one].partials[other] += more;
            self.partials[one].value.partials[other] += more;
            self.partials[one].partials[other].value += more;
        }
        self
    }

    /// Coefficients of X and Y.
    pub fn first(&self) -> [f64; 2] {
        self.value.value.partials
    }

    /// Coefficients of X³, X²Y, XY² and Y³.
    pub fn third(&self) -> [f64; 4] {
        let [[[xxx, xxy], [_, xyy]], [_, [_, yyy]]] =
            self.partials.map(|first| first.partials.map(|second| second.partials));
        [xxx / 6.0, 0.5 * xxy, 0.5 * xyy, yyy / 6.0]
    }
}

impl<const K: usize, N: Number> Dual<K, N> {
    /// A value that moves by `rate` along `direction`, and along no other. Panics if `direction >= K`.
    pub fn along(value: N, direction: usize, rate: f64) -> Self {
        let mut partials = [N::from_f64(0.0); K];
        partials[direction] = N::from_f64(rate);
        Self { value, partials }
    }

    /// A function of it with this value and this slope.
    #[inline(always)]
    pub(crate) fn chain(self, value: N, slope: N) -> Self {
        let mut partials = self.partials;
        for partial in &mut partials {
            *partial = *partial * slope;
        }
        Self { value, partials }
    }

    /// This value with the derivatives of both numbers joined.
    #[inline(always)]
    fn joined(self, other: Self, value: N, join: impl Fn(N, N) -> N) -> Self {
        let mut partials = self.partials;
        for (partial, other) in partials.iter_mut().zip(other.partials) {
            *partial = join(*partial, other);
        }
        Self { value, partials }
    }
}

operators! {
    #[inline(always)] [const K: usize, N: Number] Dual<K, N>, apart if { size_of::<Self>() > 100 }:
    Add add(self, other) { self.joined(other, self.value + other.value, |left, right| left + right) }
    Sub sub(self, other) { self.joined(other, self.value - other.value, |left, right| left - right) }
    Mul mul(self, other) { self.joined(other, self.value * other.value, |left, right| other.value * left + self.value * right) }
    Div div(self, other) {
        let quotient = self.value / other.value;
        let (inverse, slope) = (N::from_f64(1.0) / other.value, -quotient / other.value);
        self.joined(other, quotient, |left, right| inverse * left + slope * right)
    }
    Neg neg(self) {
        let mut partials = self.partials;
        for partial in &mut partials {
            *partial = -*partial;
        }
        Self { value: -self.value, partials }
    }
}

impl<const K: usize, N: Number> Arithmetic for Dual<K, N> {
    type Mask = bool;

    decided_by_double!();

    #[inline(always)]
    fn is_zero(self) -> bool {
        self.value.is_zero() && self.partials.into_iter().all(N::is_zero)
    }

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self { value: N::from_f64(value), partials: [N::from_f64(0.0); K] }
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.chain(root, N::from_f64(0.5) / root)
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sincos();
        (self.chain(sin, cos), self.chain(cos, -sin))
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        let (sin, versine) = self.value.sin_versine();
        (self.chain(sin, N::from_f64(1.0) - versine), self.chain(versine, sin))
    }
}

impl<const K: usize, N: Number> Number for Dual<K, N> {
    const NEWTON_STEPS: u32 = 1 + N::NEWTON_STEPS;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.value.to_f64()
    }
}
