//! The rod of the paper's case 1, for benches.

use equipoise_physics::map::strike::Rod;
use equipoise_physics::run::rules::Rules;

/// The rod.
pub(crate) const ROD: Rod = Rod::lossless(0.4 / 3.0, 0.094_280_904_158_206_35, 1.1);

/// Rules that end its runs.
pub(crate) const RULES: Rules = Rules {
    topple_angle: std::f64::consts::FRAC_PI_2,
    settles: false,
    holds_energy: true,
    limits: None,
    half_length: f64::INFINITY,
};
