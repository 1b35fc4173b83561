//! Random rods, and their runs alone, to hold lanes against.

use equipoise_physics::map::strike::{EnergyFeedback, Rod};
use equipoise_physics::numbers::dispatch::InstructionSet;
use equipoise_physics::run::lanes::batch_run::LaneRunEnd;
use equipoise_physics::run::orbit::{Orbit, run};
use proptest::prelude::*;

prop_compose! {
    /// Rods on tables of all kinds, with a target energy of at least so much, in that of the rod at rest upright.
    pub(crate) fn rods(least_energy: f64)(
        length in 0.02..2.0_f64, ratio in 0.2..1.5, tilt_gain in -0.5..2.5, energy_gain in prop_oneof![Just(0.0), -0.2..0.3],
        restitution in 0.2..1.0, above in least_energy..3.0, still in prop::bool::weighted(0.2),
    ) -> Rod {
        let energy_gain = if still { 0.0 } else { energy_gain };
        Rod {
            contact_distance: length,
            radius_of_gyration: length * ratio,
            gravity: 9.81,
            restitution,
            tilt_gain,
            strike_gain: if still { 1.0 + restitution } else { 2.0 },
            strike_gain_per_energy: (1.0 + restitution) * energy_gain,
            target_energy: 9.81 * length * above,
            energy_feedback: EnergyFeedback::Vertical,
        }
    }
}

/// True if the table changes the energy, so that a run can settle.
pub(crate) fn changes_energy(rod: &Rod) -> bool {
    rod.strike_gain < 2.0 || rod.strike_gain_per_energy != 0.0
}

/// End of a run outside lanes.
pub(crate) fn alone(mut orbit: Orbit, impacts: u64) -> LaneRunEnd {
    let mut max_theta: f64 = 0.0;
    let ending = run(&mut orbit, impacts, |contact| {
        max_theta = max_theta.max(contact.state.theta.abs());
        true
    });
    LaneRunEnd { impacts: orbit.contacts(), outcome: ending.unwrap().into(), max_theta }
}

/// Kinds of instructions that this CPU has.
pub(crate) fn paths() -> impl Iterator<Item = InstructionSet> {
    InstructionSet::ALL.into_iter().filter(|path| path.is_there())
}
