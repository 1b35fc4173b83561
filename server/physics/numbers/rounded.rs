//! Numbers of sentences.

/// The nearest number of four significant digits, for a sentence.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::rounded;

    #[test]
    fn four_digits_are_left() {
        for (value, left) in
            [(-0.021_999_999_999_999_98, "-0.022"), (0.215_855_2, "0.2159"), (0.0, "0"), (12_345.6, "12350")]
        {
            assert_eq!(rounded(value).to_string(), left);
        }
        assert!(rounded(f64::INFINITY).is_infinite() && rounded(f64::NAN).is_nan());
    }
}
