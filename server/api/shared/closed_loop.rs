//! The picture of a state feedback: its closed loop on the unit circle.

use equipoise_physics::control::bounce_model::{BounceModel, ClosedLoop};

use crate::charts::{Loop, closed_loop, significant};

/// Number of factors on the gain at which the eigenvalues' path is drawn.
const FACTORS: usize = 160;

/// The eigenvalues of a law's closed loop on the unit circle, and their path as the gain is scaled, as SVG.
pub(crate) fn draw_closed_loop(title: &str, caption: &str, model: &BounceModel, gain: [f64; 4]) -> String {
    let states = model.fed_back(gain);
    let eigenvalues = |factor: f64| -> Vec<(f64, f64)> {
        let closed = model.closed_loop_of(gain.map(|gain| gain * factor), states);
        closed.iter().flat_map(|closed| &closed.eigenvalues).map(|value| (value.re, value.im)).collect()
    };
    let closed = model.closed_loop_of(gain, states);
    let is_stable = closed.as_ref().is_some_and(ClosedLoop::is_stable);
    let margin = model.stable_factors(gain, states).filter(|_| is_stable);
    let lower = margin.map(|it| it.lower).filter(|lower| *lower > 0.0);
    let upper = margin.map(|it| it.upper).filter(|upper| upper.is_finite());
    let high = upper.map_or(2.0, |upper| 1.0 + 1.4 * (upper - 1.0)).min(10.0);
    let low = lower.map_or(0.0, |lower| 1.0 - 1.4 * (1.0 - lower)).max(0.0);
    let way = (0..=FACTORS).map(|step| {
        let factor = low + (high - low) * step as f64 / FACTORS as f64;
        (factor, eigenvalues(factor))
    });
    let number = |value: f64| significant(value, 4);
    let [x, theta, x_dot, theta_dot] = gain.map(number);
    let subtitle = format!(
        "α = −K·(x, θ, ẋ, θ̇) with K = ({x}, {theta}, {x_dot}, {theta_dot}); largest |λ| = {}",
        number(closed.map_or(f64::NAN, |closed| closed.spectral_radius))
    );
    closed_loop(&Loop {
        title,
        subtitle: &subtitle,
        caption,
        closed: &eigenvalues(1.0),
        open: &eigenvalues(0.0),
        way: &way.collect::<Vec<_>>(),
        margin: (lower, upper),
    })
}
