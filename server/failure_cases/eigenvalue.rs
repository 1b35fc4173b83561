//! The claim of the eigenvalues of a computed Jacobian at the upright bounce.

use crate::failure_cases::case::MethodClaim;
use equipoise_physics::analysis::fixed_point::FixedPoint;
use equipoise_physics::analysis::jacobian;
use equipoise_physics::analysis::jacobian::modulus;
use equipoise_physics::analysis::linear_verdict::PARABOLIC;
use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::scene::Scene;

/// Verdict by the largest modulus of the computed Jacobian's eigenvalues at the fixed point, and the eigenvalue of the angle
/// farthest from 1: (re, im).
fn spectral_radius(scene: &Scene, fixed_point: &FixedPoint) -> (&'static str, f64, (f64, f64)) {
    let matrix = jacobian::jacobian(&scene.model(), &fixed_point.state(), 1).map(|linearization| linearization.matrix);
    let values = matrix.ok().and_then(|matrix| jacobian::eigenvalues(&matrix)).unwrap_or_default();
    let radius = values.iter().copied().map(modulus).fold(0.0, f64::max);
    let verdict = match radius {
        radius if radius > 1.0 + PARABOLIC => "unstable",
        radius if radius < 1.0 - PARABOLIC => "stable",
        _ => "neutral",
    };
    let least = values.iter().min_by(|a, b| a.re.total_cmp(&b.re)).map_or((0.0, 0.0), |value| (value.re, value.im));
    (verdict, radius, least)
}

/// The upright bounce, which every scene of this gallery has.
pub(crate) fn upright(scene: &Scene) -> FixedPoint {
    small_deviations(scene).expect("a test builds every case").fixed_point
}

/// The claim of the eigenvalues of a computed Jacobian.
pub(crate) fn eigenvalue(method: &'static str, scene: &Scene, fixed_point: &FixedPoint) -> MethodClaim {
    let (verdict, radius, (re, im)) = spectral_radius(scene, fixed_point);
    let exact = small_deviations(scene).map_or(f64::NAN, |small| small.linear.spectral_radius());
    let imaginary = if im == 0.0 { String::new() } else { format!(" ± {:.2e}i", im.abs()) };
    let excess = match radius - 1.0 {
        0.0 => String::new(),
        excess => format!(" {} {:.2e}", if excess < 0.0 { '−' } else { '+' }, excess.abs()),
    };
    let detail = format!(
        "the largest modulus comes out as 1{excess} (exactly: {exact:.6}), the angle's eigenvalue as {re:.9}{imaginary}"
    );
    MethodClaim { method, verdict, value: Some(radius), unit: None, detail }
}
