//! Numbers of sentences.

/// The nearest number of four significant digits, for a sentence.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
