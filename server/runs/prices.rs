//! Prices of the parts of a run, in bounces of the plain rod.

use std::f64::consts::PI;

use equipoise_physics::run::lasting_contact::work_of_rest;
use equipoise_physics::run::orbit::Contact;
use equipoise_physics::scene::Scene;

use crate::limits;

/// Price of the search for a throw: with friction a few thousand strikes.
pub const THROW_PRICE: u64 = 20_000;

/// Price of a contact of `hold` s after the bounces of a run of this scene.
pub fn hold_price(scene: &Scene, hold: f64) -> u64 {
    limits::HOLD_SAMPLES * limits::HOLD_SAMPLE_PRICE + limits::CONTACT_WORK_PRICE * work_of_rest(scene, hold)
}

/// One bounce, and one more for each turn of the body in the following flight, up to a limit. The search for the next contact goes
/// turn by turn, but examines only a few turns.
pub fn impact_price(contact: &Contact) -> u64 {
    let spin = contact.strike.map_or(0.0, |strike| strike.after.theta_dot.abs());
    let turns = spin * contact.flight_time.unwrap_or_default() / (2.0 * PI);
    1 + (turns as u64).min(limits::SPINNING_PRICE)
}
