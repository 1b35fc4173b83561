//! The tilt of the table at a strike, with the sines and cosines that the strike needs.

use crate::numbers::number::Arithmetic;

/// Tilt of the table with the sines and cosines of a strike.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tilt<N> {
    /// α, table tilt, rad.
    pub(crate) alpha: N,
    /// sin θ.
    pub(crate) sin_theta: N,
    /// 1 − cos θ.
    pub(crate) versine_theta: N,
    /// sin α.
    pub(crate) sin_alpha: N,
    /// cos α.
    pub(crate) cos_alpha: N,
    /// sin β of β = θ − α, the rod's angle from the table's normal.
    pub(crate) sin_beta: N,
}

impl<N: Arithmetic> Tilt<N> {
    /// Tilt for a rod at θ = `theta` over a table at α = `alpha`, `beta` apart.
    #[inline(always)]
    pub(crate) fn new(theta: N, alpha: N, beta: N) -> Self {
        let (sin_theta, versine_theta) = theta.sin_versine();
        let (sin_alpha, cos_alpha) = alpha.sincos();
        let (sin_beta, _) = beta.sincos();
        Self { alpha, sin_theta, versine_theta, sin_alpha, cos_alpha, sin_beta }
    }

    /// cos β. Unlike the sine it loses nothing to a difference of angles.
    #[inline(always)]
    pub(crate) fn cos_beta(&self) -> N {
        self.cos_alpha * (N::from_f64(1.0) - self.versine_theta) + self.sin_alpha * self.sin_theta
    }
}
