//! Parameters of a rod that are rounded before its first bounce, each by as many roundings as [`Scene::parameters`] makes. They are off by the same
//! at every bounce; a run with 31 digits has them to its own digits.

use super::{Number16, OF_DISTANCE, OF_GAIN, OF_GRAVITY, OF_GYRATION, OF_TILT};
use crate::bounce::rod::Rod;
use crate::scene::Scene;

/// Gives the parameters their errors, in numbers that round by the share `unit`.
pub(super) fn round(scene: &Scene, rod: &mut Rod<Number16>, unit: f64) {
    let sloped = scene.incline != std::f64::consts::FRAC_PI_2;
    rod.gravity.partials[OF_GRAVITY] = if sloped { 2.0 * unit * rod.gravity.value } else { 0.0 };
    rod.radius_of_gyration.partials[OF_GYRATION] = 1.5 * unit * rod.radius_of_gyration.value;
    let off = scene.table_errors();
    if rod.strike_gain.value != 2.0 {
        rod.strike_gain.partials[OF_GAIN] = scene.strike_gain_roundings() * unit * rod.strike_gain.value;
    }
    if off.speed != 0.0 {
        // (1 + e)((1 + ε)κ_E).
        rod.strike_gain_per_energy.partials[OF_GAIN] = 4.0 * unit * rod.strike_gain_per_energy.value;
    }
    if off.tilt_gain != 0.0 {
        // κ(1 + ε): near κ(1 + ε) = 1 the swing has little but this.
        rod.tilt_gain.partials[OF_TILT] = 2.0 * unit * rod.tilt_gain.value;
    }
    if off.offset != 0.0 {
        // √(a² + d²).
        rod.contact_distance.partials[OF_DISTANCE] = 2.0 * unit * rod.contact_distance.value;
    }
}
