//! An eigenvalue, as part of answers.

use equipoise_physics::analysis::jacobian;
use nalgebra::Complex;
use schemars::JsonSchema;
use serde::Serialize;

/// An eigenvalue of a linear map.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
pub struct Eigenvalue {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
    /// Modulus.
    pub modulus: f64,
}

impl From<Complex<f64>> for Eigenvalue {
    fn from(value: Complex<f64>) -> Self {
        Self { re: value.re, im: value.im, modulus: jacobian::modulus(value) }
    }
}
