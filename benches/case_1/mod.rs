//! The rod of the paper's case 1, for benches.

use equipoise_physics::impact::Rod;
use equipoise_physics::map::Rules;

/// The rod.
pub(crate) const ROD: Rod = Rod {
    contact_distance: 0.4 / 3.0,
    radius_of_gyration: 0.094_280_904_158_206_35,
    gravity: 9.81,
    restitution: 1.0,
    tilt_gain: 1.1,
    strike_gain: 2.0,
    strike_gain_per_energy: 0.0,
    target_energy: 0.0,
};

/// When its runs end.
pub(crate) const RULES: Rules =
    Rules { topple_angle: std::f64::consts::FRAC_PI_2, settles: false, holds_energy: true, limits: None };
