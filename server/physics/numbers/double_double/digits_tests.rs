//! Digits and texts against plain arithmetic with whole numbers of any size, and against the standard library.

use super::DoubleDouble;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

use super::digits::{DIGITS, digits, exponent, in_units, quick_digits};

/// Texts by plain arithmetic with whole numbers of any size.
mod exact {
    use super::super::digits::{DIGITS, parts};
    use super::super::{DoubleDouble, SIGNIFICANT_DIGITS};

    /// A whole number, the least digit of base 2^32 first, without zeros at its end.
    #[derive(Clone, PartialEq)]
    struct Whole(Vec<u32>);

    impl Whole {
        fn of(number: u64) -> Self {
            Self(vec![number as u32, (number >> 32) as u32]).trimmed()
        }

        fn trimmed(mut self) -> Self {
            while self.0.last() == Some(&0) {
                self.0.pop();
            }
            self
        }

        fn times(&self, factor: u32) -> Self {
            let (mut digits, mut carry) = (Vec::new(), 0);
            for &digit in &self.0 {
                let product = u64::from(digit) * u64::from(factor) + carry;
                digits.push(product as u32);
                carry = product >> 32;
            }
            digits.push(carry as u32);
            Self(digits).trimmed()
        }

        fn times_power(&self, base: u32, exponent: i32) -> Self {
            (0..exponent).fold(self.clone(), |product, _| product.times(base))
        }

        fn is_less(&self, other: &Self) -> bool {
            let (one, two) = (self.0.iter().rev(), other.0.iter().rev());
            (self.0.len(), one.collect::<Vec<_>>()) < (other.0.len(), two.collect::<Vec<_>>())
        }

        fn minus(&self, other: &Self) -> Self {
            let (mut digits, mut borrow) = (Vec::new(), 0);
            for (place, &digit) in self.0.iter().enumerate() {
                let rest = i64::from(digit) - i64::from(other.0.get(place).copied().unwrap_or(0)) + borrow;
                digits.push(rest as u32);
                borrow = rest >> 32;
            }
            Self(digits).trimmed()
        }

        /// Quotient, below 2^127, and rest.
        fn divided_by(&self, divisor: &Self) -> (u128, Self) {
            let mut doubles = vec![divisor.clone()];
            while !self.is_less(doubles.last().unwrap()) {
                doubles.push(doubles.last().unwrap().times(2));
            }
            let (mut quotient, mut rest) = (0, self.clone());
            for multiple in doubles.iter().rev() {
                quotient *= 2;
                if !rest.is_less(multiple) {
                    rest = rest.minus(multiple);
                    quotient += 1;
                }
            }
            (quotient, rest)
        }
    }

    /// |value| / 10^unit: its whole part, and that rounded half to even.
    fn scaled(value: f64, unit: i32) -> (u128, u128) {
        let (mantissa, exponent) = parts(value);
        let dividend = Whole::of(mantissa).times_power(2, exponent).times_power(10, -unit);
        let divisor = Whole::of(1).times_power(2, -exponent).times_power(10, unit);
        let (whole, rest) = dividend.divided_by(&divisor);
        let twice = rest.times(2);
        let up = !twice.is_less(&divisor) && (twice != divisor || whole & 1 == 1);
        (whole, whole + u128::from(up))
    }

    pub(super) fn text(number: DoubleDouble) -> String {
        let DoubleDouble { high, low } = number;
        // The first digit is where there are 37 before the unit.
        let near: i32 = format!("{high:e}").split_once('e').unwrap().1.parse().unwrap();
        let first = (near - 2..=near + 2).rfind(|first| scaled(high, first + 1 - DIGITS).0 >= 10u128.pow(36)).unwrap();
        let unit = first + 1 - DIGITS;
        let of_high = scaled(high, unit).1 as i128;
        let of_low = match scaled(low, unit) {
            (0, _) => 0,
            (_, rounded) => rounded as i128,
        };
        let sum = if (high < 0.0) == (low < 0.0) { of_high + of_low } else { of_high - of_low };
        let digits = ((sum + 50_000) / 100_000).to_string();
        let first = first + digits.len() as i32 - SIGNIFICANT_DIGITS as i32;
        let digits = digits.trim_end_matches('0');
        let sign = if high < 0.0 { "-" } else { "" };
        let zeros = |count: i32| "0".repeat(count.max(0) as usize);
        let pointed = |(whole, rest): (&str, &str)| match rest {
            "" => whole.to_owned(),
            _ => format!("{whole}.{rest}"),
        };
        match first {
            -6..0 => format!("{sign}0.{}{digits}", zeros(-1 - first)),
            0..=20 => {
                let padded = format!("{digits}{}", zeros(first + 1 - digits.len() as i32));
                format!("{sign}{}", pointed(padded.split_at(first as usize + 1)))
            }
            _ => format!("{sign}{}e{first}", pointed(digits.split_at(1))),
        }
    }
}

/// Numbers of all sizes, subnormal and largest ones too, many of them beside powers of ten and half-way between two digits.
fn numbers(count: usize) -> impl Iterator<Item = DoubleDouble> {
    let mut source = SplitMix64::seed_from_u64(1);
    let mut random = move || source.random::<u64>();
    let size = |bits: u64| match bits % 4 {
        // Any double; one near 1; a power of ten and its neighbours; one of few bits.
        0 => f64::from_bits(bits),
        1 => f64::from_bits((bits >> 12) | (1003 + (bits >> 3) % 40) << 52),
        2 => {
            let near: f64 = format!("1e{}", (bits >> 20) as i32 % 309).parse().unwrap();
            f64::from_bits(near.to_bits() + (bits >> 8) % 5 - 2)
        }
        _ => f64::from_bits(bits & 0xffff_f000_0000_0000),
    };
    std::iter::from_fn(move || {
        let high = size(random());
        // Half a unit in the last place and all below it; often of few bits, so that ties come up.
        let ulp = high.abs().next_up() - high.abs();
        let bits = random();
        let share = match bits % 4 {
            0 => 0.0,
            1 => 0.5,
            2 => ((bits >> 11) % 16) as f64 / 32.0,
            _ => (bits >> 12) as f64 / (1u64 << 53) as f64,
        };
        let low = share * ulp / (1u64 << ((bits >> 2) % 64 * (bits >> 8 & 1))) as f64;
        Some(DoubleDouble::of(high, if bits & 1 << 9 == 0 { low } else { -low }))
    })
    .filter(|number| number.high.is_finite() && number.high != 0.0 && number.low.is_finite())
    .take(count)
}

#[test]
fn texts_are_those_of_exact_arithmetic() {
    for number in numbers(20_000) {
        assert_eq!(number.to_string(), exact::text(number), "{:e} + {:e}", number.high, number.low);
    }
    for (high, low) in [
        (5e-324, 0.0),
        (-5e-324, 0.0),
        (f64::MIN_POSITIVE, 5e-324),
        (f64::MAX, f64::MAX / (1u64 << 54) as f64),
        (f64::MAX, -5e-324),
        (1.0, -1e-20),
        (1.0, -5e-324),
        (1e22, -1e-10),
        (1e23, 8_388_607.0),
        // Half a unit, and one and two and a half.
        (3e37, 5.0),
        (3e37, 15.0),
        (3e37, -25.0),
    ] {
        let number = DoubleDouble::of(high, low);
        assert_eq!(number.to_string(), exact::text(number), "{high:e} + {low:e}");
    }
    for (value, text) in [(0.0, "0"), (-0.0, "-0"), (f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-f64::INFINITY, "-inf")]
    {
        assert_eq!(DoubleDouble::of(value, 0.0).to_string(), text);
    }
}

#[test]
fn tables_of_powers_give_the_digits_of_the_standard_library() {
    let mut quick = 0;
    for number @ DoubleDouble { high, low } in numbers(200_000) {
        let exponent = exponent(high);
        let unit = exponent + 1 - DIGITS;
        let slow = (in_units(high, unit) + in_units(low, unit), exponent);
        assert_eq!(digits(&number), slow, "{high:e} + {low:e}");
        quick += usize::from(quick_digits(high, low).is_some());
    }
    // Only what is half-way between two units is left, of a number so large that its unit's power is cut.
    assert!(quick > 195_000, "{quick}");
}
