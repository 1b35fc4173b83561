//! Powers of ten with 192 bits, worked out by the compiler: by them a double is scaled to a whole number of decimal units.

/// Least power in the table: it scales the largest double to 37 digits.
pub(super) const LEAST: i32 = -272;

/// Largest power in the table: it scales the smallest subnormal double to 37 digits.
pub(super) const MOST: i32 = 360;

/// Words of the whole numbers that powers are cut from. 5^360 has 836 bits; 2^895/5^272 has 264.
const WORDS: usize = 14;

/// A power of ten as `significand · 2^exponent`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Power {
    /// 192 bits, the least word first and the highest bit set; cut, not rounded.
    pub(super) significand: [u64; 3],
    /// Exponent of the significand's last bit.
    pub(super) exponent: i32,
    /// True if nothing was cut.
    pub(super) is_exact: bool,
}

/// 10^[`LEAST`] to 10^[`MOST`].
static POWERS: [Power; (MOST - LEAST + 1) as usize] = powers();

impl Power {
    /// 10^power, which is from [`LEAST`] to [`MOST`].
    pub(super) fn of_ten(power: i32) -> &'static Self {
        &POWERS[(power - LEAST) as usize]
    }

    /// `whole · 2^exponent`.
    const fn cut(whole: &[u64; WORDS], exponent: i32) -> Self {
        let mut top = WORDS - 1;
        while whole[top] == 0 {
            top -= 1;
        }
        let lead = whole[top].leading_zeros();
        let mut significand = [0; 3];
        let (mut place, mut is_exact) = (0, true);
        while place < 3 {
            // Three words from the highest bit down; words below the last one are zeros.
            let upper = if top >= place { whole[top - place] } else { 0 };
            let lower = if top > place { whole[top - place - 1] } else { 0 };
            significand[2 - place] = if lead == 0 { upper } else { (upper << lead) | (lower >> (64 - lead)) };
            place += 1;
        }
        // The significand has the top `lead` bits of the fourth word. It is exact if the rest is zero.
        if top >= 3 {
            is_exact = whole[top - 3] << lead == 0;
            let mut below = 3;
            while below < top {
                below += 1;
                is_exact = is_exact && whole[top - below] == 0;
            }
        }
        let last = 64 * (top as i32 - 2) - lead as i32;
        Self { significand, exponent: exponent + last, is_exact }
    }
}

const fn powers() -> [Power; (MOST - LEAST + 1) as usize] {
    let mut powers = [Power { significand: [0; 3], exponent: 0, is_exact: false }; (MOST - LEAST + 1) as usize];
    // 10^p = 5^p 2^p.
    let mut five = [0; WORDS];
    five[0] = 1;
    let mut power = 0;
    while power <= MOST {
        powers[(power - LEAST) as usize] = Power::cut(&five, power);
        five = times_five(five);
        power += 1;
    }
    // 10^−p = (2^895 / 5^p) 2^(−p − 895). A quotient cut at every division by 5 is that by 5^p, cut.
    let mut fifth = [0; WORDS];
    fifth[WORDS - 1] = 1 << 63;
    let mut power = 0;
    while power > LEAST {
        fifth = over_five(fifth);
        power -= 1;
        let mut cut = Power::cut(&fifth, power - (64 * WORDS as i32 - 1));
        cut.is_exact = false;
        powers[(power - LEAST) as usize] = cut;
    }
    powers
}

const fn times_five(mut whole: [u64; WORDS]) -> [u64; WORDS] {
    let (mut place, mut carry) = (0, 0);
    while place < WORDS {
        let product = whole[place] as u128 * 5 + carry;
        whole[place] = product as u64;
        carry = product >> 64;
        place += 1;
    }
    whole
}

const fn over_five(mut whole: [u64; WORDS]) -> [u64; WORDS] {
    let (mut place, mut rest) = (WORDS, 0);
    while place > 0 {
        place -= 1;
        let dividend = (rest << 64) | whole[place] as u128;
        whole[place] = (dividend / 5) as u64;
        rest = dividend % 5;
    }
    whole
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_cut_and_follow_each_other() {
        for power in LEAST..=MOST {
            let Power { significand, is_exact, .. } = Power::of_ten(power);
            assert!(significand[2] >> 63 == 1, "10^{power} does not begin with a one");
            // 5^82 is the last that has 192 bits.
            assert_eq!(*is_exact, (0..=82).contains(&power), "10^{power}");
        }
        assert_eq!((Power::of_ten(0).significand, Power::of_ten(0).exponent), ([0, 0, 1 << 63], -191));
        assert_eq!((Power::of_ten(2).significand, Power::of_ten(2).exponent), ([0, 0, 100 << 57], -185));
        // 0.1 is 0x1.9999…p−4.
        assert_eq!((Power::of_ten(-1).significand, Power::of_ten(-1).exponent), ([0xcccc_cccc_cccc_cccc; 3], -4 - 191));
    }
}
