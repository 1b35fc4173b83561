//! Random scenes of tables that sense with errors.

use crate::support::random::Random;
use crate::support::rig_runs::{random_draft, with};
use equipoise_physics::scene::{Name, Scene, Value};

pub(crate) const FURTHER: [Name; 5] = [Name::XSd, Name::XDotSd, Name::YDotSd, Name::ThetaDotSd, Name::RestitutionSd];

/// With random errors of all kinds but those of timing.
pub(crate) fn random_scene(random: &mut Random) -> Scene {
    let mut draft = random_draft(random);
    draft.set(Name::Seed, Some(Value::Integer(random.between(0.0, 1e9) as u64))).unwrap();
    let mut values = vec![(Name::AngleSd, random.size(1e-4, 0.01).abs())];
    for (name, largest) in FURTHER.into_iter().zip([0.01, 0.03, 0.05, 0.1, 0.05]) {
        if random.between(0.0, 1.0) < 0.7 {
            values.push((name, random.size(1e-4, largest).abs()));
        }
    }
    with(draft, &values)
}
