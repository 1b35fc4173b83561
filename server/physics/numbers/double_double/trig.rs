//! Numbers of 31 digits in the formulas: their root, and their sine, cosine and versine to 31 digits.
//!
//! The angle is brought within π/64 of a multiple of π/32, whose values stand in a table; the rest is a Taylor series, the
//! terms of which need fewer digits the later they come.

use super::{DoubleDouble, ROUNDING, fast_two_sum, two_product, two_sum};
use crate::numbers::number::{Arithmetic, Number, decided_by_double};

/// 32/π.
const STEPS_PER_ANGLE: f64 = 10.185916357881302;

/// π/32 in three pieces, to 159 bits.
const STEP: [f64; 3] = [0.09817477042468103, 3.827021247335479e-18, -9.358655655369811e-35];

/// sin(kπ/32).
#[rustfmt::skip]
const SINES: [DoubleDouble; 17] = [
    DoubleDouble::of(0.0, 0.0),
    DoubleDouble::of(0.0980171403295606, -1.634582362244256e-18),
    DoubleDouble::of(0.19509032201612828, -7.991079068461731e-18),
    DoubleDouble::of(0.2902846772544624, -1.892797870777425e-17),
    DoubleDouble::of(0.3826834323650898, -1.0050772696461588e-17),
    DoubleDouble::of(0.47139673682599764, 6.516678136069013e-18),
    DoubleDouble::of(0.5555702330196022, 4.709410940561677e-17),
    DoubleDouble::of(0.6343932841636455, 1.0420901929280035e-17),
    DoubleDouble::of(std::f64::consts::FRAC_1_SQRT_2, -4.833646656726457e-17),
    DoubleDouble::of(0.773010453362737, -3.256590703364977e-17),
    DoubleDouble::of(0.8314696123025452, 1.4073856984728024e-18),
    DoubleDouble::of(0.881921264348355, -1.9843248405890562e-17),
    DoubleDouble::of(0.9238795325112867, 1.7645047084336677e-17),
    DoubleDouble::of(0.9569403357322088, 4.05538698618757e-17),
    DoubleDouble::of(0.9807852804032304, 1.8546939997825006e-17),
    DoubleDouble::of(0.9951847266721969, -4.248691367830441e-17),
    DoubleDouble::of(1.0, 0.0),
];

/// 1 − cos(kπ/32).
#[rustfmt::skip]
const VERSINES: [DoubleDouble; 17] = [
    DoubleDouble::of(0.0, 0.0),
    DoubleDouble::of(0.004815273327803114, -1.3811483127365547e-20),
    DoubleDouble::of(0.019214719596769552, -1.1997052380569336e-18),
    DoubleDouble::of(0.043059664267791134, 1.0794935615676714e-18),
    DoubleDouble::of(0.07612046748871325, -3.7672592765222195e-18),
    DoubleDouble::of(0.11807873565164496, 5.965460598076106e-18),
    DoubleDouble::of(0.16853038769745476, -1.4073856984728024e-18),
    DoubleDouble::of(0.22698954663726303, 4.810331418020857e-18),
    DoubleDouble::of(0.2928932188134525, -7.174684663993261e-18),
    DoubleDouble::of(0.3656067158363545, -1.0420901929280035e-17),
    DoubleDouble::of(0.44442976698039777, 8.41704182564106e-18),
    DoubleDouble::of(0.5286032631740023, 4.8994473095188815e-17),
    DoubleDouble::of(0.6173165676349103, -4.546037853479624e-17),
    DoubleDouble::of(0.7097153227455376, 1.892797870777425e-17),
    DoubleDouble::of(0.8049096779838717, 3.574665468409064e-17),
    DoubleDouble::of(0.9019828596704395, -5.387656886901357e-17),
    DoubleDouble::of(1.0, 0.0),
];

/// −1/3!, 1/5!, −1/7!, and to fewer digits 1/9! and so on.
const SINE_SERIES: [DoubleDouble; 3] = [
    DoubleDouble::of(-0.16666666666666666, -9.25185853854297e-18),
    DoubleDouble::of(0.008333333333333333, 1.1564823173178714e-19),
    DoubleDouble::of(-0.0001984126984126984, -1.7209558293420705e-22),
];
const SINE_TAIL: [f64; 4] =
    [2.7557319223985893e-06, -2.505210838544172e-08, 1.6059043836821613e-10, -7.647163731819816e-13];

/// −1/4!, 1/6!, −1/8!, and to fewer digits 1/10! and so on.
const VERSINE_SERIES: [DoubleDouble; 3] = [
    DoubleDouble::of(-0.041666666666666664, -2.3129646346357427e-18),
    DoubleDouble::of(0.001388888888888889, -5.300543954373577e-20),
    DoubleDouble::of(-2.48015873015873e-05, -2.1511947866775882e-23),
];
const VERSINE_TAIL: [f64; 4] =
    [2.755731922398589e-07, -2.08767569878681e-09, 1.1470745597729725e-11, -4.779477332387385e-14];

/// sin x, cos x and 1 − cos x of an angle in rad. The first two have an absolute error below 1e-31, and near their zeros a
/// relative one; so has the third near x = 0. Beyond some 1e15 rad the angle itself has no digits left for it.
#[inline(always)]
fn sin_cos_versine(angle: DoubleDouble) -> (DoubleDouble, DoubleDouble, DoubleDouble) {
    let one = DoubleDouble::of(1.0, 0.0);
    let size = angle.magnitude();
    let step = (size.high * STEPS_PER_ANGLE + 0.5) as i64;
    let (sin, cos, versine) = if step == 0 {
        let (sin, versine) = series(size);
        (sin, one - versine, versine)
    } else {
        let (sin_rest, versine_rest) = series(reduce(size, step as f64));
        let index = (step & 15) as usize;
        let (sin_step, cos_step) = (SINES[index], SINES[16 - index]);
        // cos of the step less cos of the whole, within the first quadrant.
        let fall = cos_step * versine_rest + sin_step * sin_rest;
        let (sin, cos) = (sin_step + (cos_step * sin_rest - sin_step * versine_rest), cos_step - fall);
        match (step >> 4) & 3 {
            0 => (sin, cos, VERSINES[index] + fall),
            1 => (cos, -sin, one + sin),
            2 => (-sin, -cos, one + cos),
            _ => (-cos, sin, one - sin),
        }
    };
    (if angle.high < 0.0 { -sin } else { sin }, cos, versine)
}

/// `angle` less that many steps.
#[inline(always)]
fn reduce(angle: DoubleDouble, steps: f64) -> DoubleDouble {
    let (first, first_lost) = two_product(steps, STEP[0]);
    let (second, second_lost) = two_product(steps, STEP[1]);
    let rest = DoubleDouble::normalized(two_sum(angle.high, -first));
    let rest = rest + DoubleDouble::normalized(two_sum(angle.low, -first_lost));
    rest + DoubleDouble::normalized(fast_two_sum(-second, -second_lost - steps * STEP[2]))
}

/// sin x and 1 − cos x where |x| ≤ π/64.
#[inline(always)]
fn series(x: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let square = x.squared();
    let z = square.high;
    let of = |coefficients: &[DoubleDouble; 3], tail: &[f64; 4]| {
        let tail = tail[0] + z * (tail[1] + z * (tail[2] + z * tail[3]));
        let [first, second, third] = *coefficients;
        square * (first + square * (second + square * (third + square.scaled(tail))))
    };
    let sin = x + x * of(&SINE_SERIES, &SINE_TAIL);
    let half = DoubleDouble::of(0.5 * square.high, 0.5 * square.low);
    (sin, half + square * of(&VERSINE_SERIES, &VERSINE_TAIL))
}

impl Arithmetic for DoubleDouble {
    type Mask = bool;

    const UNIT: f64 = ROUNDING;
    const SERIES_TERMS: u32 = 22;

    decided_by_double!();

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }

    /// One step of Newton from the root of the leading double, which doubles its digits.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let near = self.high.sqrt();
        if near == 0.0 {
            return Self::from_f64(near);
        }
        let rest = self - Self::from_f64(near).squared();
        Self::normalized(fast_two_sum(near, rest.high / (2.0 * near)))
    }

    #[inline(always)]
    fn sincos(self) -> (Self, Self) {
        let (sin, cos, _) = sin_cos_versine(self);
        (sin, cos)
    }

    #[inline(always)]
    fn sin_versine(self) -> (Self, Self) {
        let (sin, _, versine) = sin_cos_versine(self);
        (sin, versine)
    }
}

impl Number for DoubleDouble {
    const NEWTON_STEPS: u32 = 1;

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.high
    }
}
