//! Quantiles of the normal, Student's and the χ² distribution, by series that are accurate to 0.2 %; Huber's loss (1964), and robust estimates of
//! the spread of residuals.

/// 97.5 % quantile of the normal distribution: the half width of a 95 % interval in standard deviations.
pub(super) const NORMAL_975: f64 = 1.959_963_984_540_054;

/// 97.5 % quantile of Student's t with `freedom` ≥ 3 degrees of freedom (Abramowitz and Stegun 26.7.5).
pub(super) fn student_quantile(freedom: f64) -> f64 {
    let x = NORMAL_975;
    let (x3, x5) = (x * x * x, x * x * x * x * x);
    let (x7, x9) = (x5 * x * x, x5 * x * x * x * x);
    let terms = [
        (x3 + x) / 4.0,
        (5.0 * x5 + 16.0 * x3 + 3.0 * x) / 96.0,
        (3.0 * x7 + 19.0 * x5 + 17.0 * x3 - 15.0 * x) / 384.0,
        (79.0 * x9 + 776.0 * x7 + 1482.0 * x5 - 1920.0 * x3 - 945.0 * x) / 92_160.0,
    ];
    terms.iter().rev().fold(0.0, |sum, term| (sum + term) / freedom) + x
}

/// Quantile of χ² with `freedom` degrees of freedom at `z` standard deviations of a normal deviate (Wilson and Hilferty 1931).
pub fn chi_squared_quantile(freedom: f64, z: f64) -> f64 {
    let width = 2.0 / (9.0 * freedom);
    let root = 1.0 - width + z * width.sqrt();
    freedom * root * root * root
}

/// The normal deviate at which χ² has this value: the inverse of [`chi_squared_quantile`].
pub(super) fn chi_squared_deviate(chi_squared: f64, freedom: f64) -> f64 {
    let width = 2.0 / (9.0 * freedom);
    (libm::cbrt(chi_squared / freedom) - (1.0 - width)) / width.sqrt()
}

/// Residual, in standard deviations, up to which the loss is a square: 95 % efficiency for normal errors.
pub(super) const HUBER: f64 = 1.345;

/// Residual, in standard deviations, beyond which a value is an outlier. One of 1.7 million normal deviates is.
pub(super) const OUTLIER: f64 = 5.0;

/// Huber's loss of a residual, equal to its square where that is small.
pub(super) fn loss(residual: f64) -> f64 {
    let size = residual.abs();
    if size <= HUBER { size * size } else { HUBER * (2.0 * size - HUBER) }
}

/// Weight of a residual in its iteration.
pub(super) fn weight(residual: f64) -> f64 {
    let size = residual.abs();
    if size <= HUBER { 1.0 } else { HUBER / size }
}

pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        odd if odd % 2 == 1 => Some(values[middle]),
        _ => Some(0.5 * (values[middle - 1] + values[middle])),
    }
}

/// Standard deviation of normal residuals by the median of their sizes, which outliers hardly change.
pub(super) fn spread(residuals: Vec<f64>) -> Option<f64> {
    median(residuals.into_iter().map(f64::abs).collect()).map(|middle| 1.482_602_2 * middle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (freedom, quantile) in [(3.0, 3.1824), (5.0, 2.5706), (10.0, 2.2281), (30.0, 2.0423), (100.0, 1.9840)] {
            assert!((student_quantile(freedom) / quantile - 1.0).abs() < 2e-3, "{freedom}");
        }
        for (freedom, quantile) in [(2.0, 5.9915), (10.0, 18.307), (100.0, 124.342)] {
            let found = chi_squared_quantile(freedom, 1.644_853_6);
            assert!((found / quantile - 1.0).abs() < 1e-2, "{freedom}: {found}");
            assert!((chi_squared_deviate(found, freedom) - 1.644_853_6).abs() < 1e-9);
        }
    }
}
