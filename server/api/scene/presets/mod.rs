//! The scenes that everybody starts from: the paper's cases and those beside them.

mod cases;
mod preset;

pub use preset::{Preset, Shown};

use serde_json::{Value, json};

use cases::PRESETS;

/// All presets.
pub fn all() -> &'static [Preset] {
    &PRESETS
}

/// The preset of this name.
pub fn find(name: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|preset| preset.name == name)
}

/// The names of all presets.
pub fn names() -> Vec<&'static str> {
    PRESETS.iter().map(|preset| preset.name).collect()
}

/// Meaning of the names of quantities, in the contract.
const QUANTITIES: &str = "A quantity: as in `stability` (`tilt_gain.critical`, `fixed_point.y_dot`, `energy_gain.upper`, `energy_gain.eigenvalue`); as in \
    the scene (`body.radius_of_gyration`, `release.theta_dot`); gravity · sin(incline) (`gravity.in_plane`); the largest tilt gain, \
    and angle at the release, up to which runs stay bounded (`tilt_gain.bounded`, `theta.bounded`); the swing late in a long run \
    over that at its start (`theta.growth`); the energy of the bounce in place (`energy.target`); means of the energy, and of η = \
    ½ẏ² + Gl cos θ, over late contacts (`energy.settled`, `vertical_energy.settled`); the friction up to which a larger energy gain \
    gives a run more contacts (`friction.helped`); the angular velocity at the end of the bounces (`settled.theta_dot`); of the \
    angle block, the imaginary part of an eigenvalue, the eigenvalue at κ_c, and there the factor of c₄V₃ in the second bounce of \
    eq. (38) (`angle_eigenvalue.im`, `angle_eigenvalue.critical`, `angle_eigenvector.second`); or the determinant from the first \
    contact to the second (`jacobian.determinant`).";

/// Schema of the names of all quantities that presets quote.
pub fn quantity_names() -> Value {
    json!({"type": "string", "enum": quantities(), "description": QUANTITIES})
}

/// Names of all quantities that presets quote.
fn quantities() -> Vec<&'static str> {
    let mut names = Vec::new();
    for printed in PRESETS.iter().flat_map(|preset| preset.printed) {
        if !names.contains(&printed.quantity.name()) {
            names.push(printed.quantity.name());
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use equipoise_physics::scene::Draft;
    use std::sync::OnceLock;

    fn shown(preset: &Preset) -> &Shown {
        preset.shown(&|| true).unwrap()
    }

    #[test]
    fn every_preset_builds_and_computes_what_it_quotes() {
        for preset in all() {
            let built = preset.draft().build();
            assert!(built.is_ok(), "{}: {built:?}", preset.name);
            let mut draft = Draft::default();
            let all = preset.scene.iter().chain(preset.printed.iter().flat_map(|printed| printed.with));
            assert!(all.into_iter().all(|&(name, value)| draft.set(name, Some(value)).is_ok()), "{}", preset.name);
            assert_eq!(preset.draft().vertices().is_some(), !preset.vertices.is_empty(), "{}", preset.name);
            let shown = shown(preset);
            assert_eq!(shown.printed.len(), shown.computed.len(), "{}", preset.name);
            assert!(shown.computed.iter().all(|it| it.value.is_some_and(f64::is_finite)), "{}", preset.name);
        }
    }

    #[test]
    fn a_value_that_differs_from_the_printed_one_says_why() {
        for preset in all() {
            let shown = shown(preset);
            for (printed, computed) in shown.printed.iter().zip(&shown.computed) {
                let (Some(print), Some(value)) = (printed.value, computed.value) else {
                    assert!(computed.why.is_some(), "{}: {printed:?} {computed:?}", preset.name);
                    continue;
                };
                let same = (print - value).abs() <= 0.004 * print.abs();
                assert!(same || computed.why.is_some(), "{}: {printed:?} {computed:?}", preset.name);
            }
        }
    }

    #[test]
    fn whoever_leaves_ends_the_work_and_leaves_nothing_half_done() {
        let preset = find("case-1").unwrap().clone();
        let fresh = Preset { shown: OnceLock::new(), ..preset };
        assert!(fresh.price() > 100_000);
        let asked = std::cell::Cell::new(0);
        let leave = || {
            asked.set(asked.get() + 1);
            asked.get() < 3
        };
        assert!(fresh.shown(&leave).is_none());
        assert!(asked.get() < 100, "asked {} times after the client had gone", asked.get());
        assert_eq!(fresh.shown(&|| true).unwrap().computed.len(), fresh.printed.len());
        assert_eq!(fresh.price(), 0);
    }
}
