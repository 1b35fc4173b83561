//! Numbers of 31 digits: their arithmetic, sine and cosine against decimals of more digits, and their decimals against the standard library.

use crate::support::decimals::{exponent, in_units, number};
use equipoise_physics::numbers::double_double::{DoubleDouble, SIGNIFICANT_DIGITS};
use equipoise_physics::numbers::number::Arithmetic;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::SplitMix64;

/// The sum of two doubles.
fn sum(high: f64, low: f64) -> DoubleDouble {
    DoubleDouble::from(high) + DoubleDouble::from(low)
}

/// Relative error of a number.
fn off(ours: DoubleDouble, exact: &str) -> f64 {
    let exact = number(exact);
    ((ours - exact) / exact).to_f64().abs()
}

#[test]
fn arithmetic_holds_31_digits() {
    let [one, three, seven] = [1.0, 3.0, 7.0].map(DoubleDouble::from);
    for (ours, exact, allowed) in [
        (one / three, "0.333333333333333333333333333333333333", 1e-32),
        (one / three * seven, "2.333333333333333333333333333333333333", 1e-31),
        (one / seven - one / three, "-0.190476190476190476190476190476190476", 1e-31),
        (Arithmetic::sqrt(seven + seven), "3.74165738677394138558374873231654930176", 1e-31),
        (one / seven * (one / seven), "0.0204081632653061224489795918367346938775", 1e-31),
    ] {
        assert!(off(ours, exact) <= allowed, "{ours} is not {exact}");
    }
    // Remainder of a subtraction of nearly equal numbers.
    assert_eq!(one + number("1e-25") - one, DoubleDouble::from(1e-25));
}

/// Sine, cosine and versine.
fn sin_cos_versine(angle: DoubleDouble) -> (DoubleDouble, DoubleDouble, DoubleDouble) {
    let ((sin, cos), (same, versine)) = (angle.sincos(), angle.sin_versine());
    assert_eq!(sin, same);
    (sin, cos, versine)
}

/// Angles as doubles, their sine, cosine and versine from mpmath with 60 digits.
#[test]
fn agrees_with_many_digits() {
    #[rustfmt::skip]
    let table = [
        ("1e-30", "1.00000000000000008333642060758598535e-30", "1.0", "5.00000000000000083336420607585988823e-61"),
        ("1e-09", "0.00000000100000000000000006211492479111318972", "0.999999999999999999499999999999999938", "5.00000000000000062239924791113191681e-19"),
        ("0.01", "0.0099998333341666648906988471321966042", "0.999950000416665277778176300275330552", "0.0000499995833347222218236997246694477209"),
        ("0.049", "0.0489803941871591799691441278362816133", "0.998799740180818480780273803391847294", "0.00120025981918151921972619660815270597"),
        ("0.05", "0.0499791692706783315669538381976456346", "0.998750260394966246424150749966658158", "0.00124973960503375357584925003334184209"),
        ("0.3", "0.295520206661339564498955080766944501", "0.955336489125606022923243604342087409", "0.0446635108743939770767563956579125908"),
        ("0.7", "0.644217687237691019706798090282512161", "0.764842187284488454864872359873962916", "0.235157812715511545135127640126037084"),
        ("-1.1", "-0.891207360061435380239231208859244057", "0.45359612142557730861625558333610002", "0.54640387857442269138374441666389998"),
        ("2.5", "0.598472144103956494051854702186162272", "-0.801143615546933714833502790467351664", "1.80114361554693371483350279046735166"),
        ("3.141592653589793", "1.224646799147353177226065932274998e-16", "-0.999999999999999999999999999999992501", "1.9999999999999999999999999999999925"),
        ("1.5707963267948966", "0.999999999999999999999999999999998125", "6.12323399573676588613032966137500146e-17", "0.999999999999999938767660042632341139"),
        ("-100.3", "0.228916922445206724859253336654508305", "0.973445962865024783387288210958500319", "0.0265540371349752166127117890414996813"),
        ("6283.185307179586", "-6.42833291855126739533042732025252769e-13", "0.999999999999999999999999793382679441", "2.06617320558649277061746554348989064e-25"),
        ("9999.7", "-0.010583426105890019145522202244707321", "-0.999943993977593309903291848346580116", "1.99994399397759330990329184834658012"),
        ("12345.678901", "-0.703441210511212646551447235790148595", "0.710753447655739348805270581293114642", "0.289246552344260651194729418706885358"),
    ];
    for (angle, sin, cos, versine) in table {
        let ours = sin_cos_versine(DoubleDouble::from(angle.parse::<f64>().unwrap()));
        assert!(off(ours.0, sin) <= 1e-31, "sin {angle}: {} for {sin}", ours.0);
        assert!(off(ours.1, cos) <= 1e-31, "cos {angle}: {} for {cos}", ours.1);
        let size = ours.2.to_f64();
        assert!(
            off(ours.2, versine) * size <= if size < 0.05 && angle.len() < 5 { 2e-31 * size } else { 4e-32 },
            "versine {angle}: {}",
            ours.2
        );
    }
}

#[test]
fn holds_the_addition_theorem_everywhere() {
    let mut angle = sum(1e-5, 3e-22);
    let turn = sum(0.37, 1.1e-17);
    let (sin_turn, cos_turn, _) = sin_cos_versine(turn);
    while angle.to_f64() < 2e4 {
        for angle in [angle, -angle] {
            let (sin, cos, versine) = sin_cos_versine(angle);
            let (sin_sum, cos_sum, _) = sin_cos_versine(angle + turn);
            // The sum of the angles is itself rounded.
            let allowed = 3e-32 * angle.to_f64().abs().max(4.0);
            assert!((sin * cos_turn + cos * sin_turn - sin_sum).to_f64().abs() <= allowed, "{angle}");
            assert!((cos * cos_turn - sin * sin_turn - cos_sum).to_f64().abs() <= allowed, "{angle}");
            assert!((versine * (DoubleDouble::from(1.0) + cos) - sin * sin).to_f64().abs() <= 1e-31, "{angle}");
        }
        angle = angle * sum(1.003, 1e-17);
    }
}

/// The text of a number by the digits of the standard library.
fn text(number: DoubleDouble) -> String {
    const DIGITS: i32 = 37;
    let high = number.to_f64();
    let low = (number - DoubleDouble::from(high)).to_f64();
    let first = exponent(high);
    let unit = first + 1 - DIGITS;
    let digits = (((in_units(high, unit) + in_units(low, unit)).abs() + 50_000) / 100_000).to_string();
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
        Some(sum(high, if bits & 1 << 9 == 0 { low } else { -low }))
    })
    .filter(|number| number.to_f64().is_finite() && number.to_f64() != 0.0)
    .take(count)
}

#[test]
fn texts_are_those_of_the_standard_library() {
    for number in numbers(20_000) {
        assert_eq!(number.to_string(), text(number));
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
        assert_eq!(sum(high, low).to_string(), text(sum(high, low)), "{high:e} + {low:e}");
    }
    for (value, text) in [(0.0, "0"), (-0.0, "-0"), (f64::NAN, "NaN"), (f64::INFINITY, "inf"), (-f64::INFINITY, "-inf")]
    {
        assert_eq!(DoubleDouble::from(value).to_string(), text);
    }
}

#[test]
fn what_is_read_is_written() {
    for text in [
        "0.1",
        "-0.3",
        "1",
        "1024",
        "12.5",
        "3.0752150681369518503095291234567",
        "-0.0030752150681369518503095291234567",
        "9999.999999999999999999999999999",
        "1.0000000000000000000000000000001",
        "123456789012345678901.23456789",
        "1e-7",
        "-2.5e300",
        "4.656612873077392578125e-10",
    ] {
        assert_eq!(number(text).to_string(), text);
    }
}

#[test]
fn what_is_written_is_read_back() {
    let mut value = DoubleDouble::from(1.0);
    let factor = DoubleDouble::from(-1.25) / DoubleDouble::from(1.1);
    for _ in 0..3000 {
        value = value * factor;
        assert!(off(value, &value.to_string()) <= 6e-32, "{value}");
    }
}

#[test]
fn every_double_is_itself() {
    let mut value = 1e-250_f64 / 3.0;
    while value < 1e250 {
        assert_eq!(DoubleDouble::from(value).to_string().parse(), Ok(value));
        value *= 1.7e3;
    }
}
