//! The scenes that everybody starts from: the paper's cases and those beside them, with what the paper prints and what
//! holds.

use equipoise_physics::scene::{Draft, Scene};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::sync::LazyLock;

use super::scene::{self, Resolved};
use crate::http::{Errors, Source};

static PRESETS: LazyLock<Vec<Preset>> =
    LazyLock::new(|| serde_json::from_str(include_str!("presets.json")).expect("a test reads it"));

/// A scene with a name.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// Its name in requests.
    pub name: String,
    title: String,
    shows: String,
    scene: Value,
    #[serde(default)]
    printed: Vec<Printed>,
}

/// A number as the paper prints it, and why it is another where it is.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Printed {
    quantity: Quantity,
    value: f64,
    r#where: String,
    #[serde(default)]
    why: Option<String>,
}

/// What printed and computed values are of.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
enum Quantity {
    #[serde(rename = "tilt_gain.critical")]
    CriticalTiltGain,
    #[serde(rename = "fixed_point.y_dot")]
    FixedPointSpeed,
    #[serde(rename = "energy_gain.upper")]
    UpperEnergyGain,
    #[serde(rename = "energy.target")]
    TargetEnergy,
    #[serde(rename = "body.radius_of_gyration")]
    RadiusOfGyration,
    #[serde(rename = "angle_eigenvalue.critical")]
    CriticalEigenvalue,
}

/// A number of a preset, printed or computed.
#[derive(Debug, Clone, Serialize)]
pub struct Quoted {
    quantity: Quantity,
    symbol: &'static str,
    unit: &'static str,
    value: f64,
    r#where: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
}

/// A preset as it is answered.
#[derive(Debug, Clone, Serialize)]
pub struct Shown {
    name: String,
    title: String,
    shows: String,
    scene: Value,
    printed: Vec<Quoted>,
    computed: Vec<Quoted>,
}

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
    PRESETS.iter().map(|preset| preset.name.as_str()).collect()
}

impl Preset {
    /// Its scene, to change and build.
    pub fn draft(&self) -> Draft {
        let mut draft = Draft::default();
        // A test builds every preset, so there is nothing to report.
        let _ = scene::apply(&mut draft, Some(&self.scene), "", Source::Json, &mut Errors::default());
        draft
    }

    /// Itself with its scene resolved and the printed values beside those that hold. None for a scene that does not build,
    /// of which there is none.
    pub fn shown(&self) -> Option<Shown> {
        let scene = self.draft().build().ok()?;
        let quoted = |printed: &Printed, value, r#where, why| {
            let (symbol, unit) = printed.quantity.symbol_and_unit();
            Quoted { quantity: printed.quantity, symbol, unit, value, r#where, why }
        };
        Some(Shown {
            name: self.name.clone(),
            title: self.title.clone(),
            shows: self.shows.clone(),
            scene: serde_json::to_value(Resolved(&scene)).ok()?,
            printed: self.printed.iter().map(|it| quoted(it, it.value, it.r#where.clone(), None)).collect(),
            computed: self
                .printed
                .iter()
                .filter_map(|it| {
                    let (value, source) = it.quantity.compute(&scene)?;
                    Some(quoted(it, value, source.to_owned(), it.why.clone()))
                })
                .collect(),
        })
    }
}

impl Quantity {
    fn symbol_and_unit(self) -> (&'static str, &'static str) {
        match self {
            Self::CriticalTiltGain => ("κ_c", "1"),
            Self::FixedPointSpeed => ("ẏ*", "m/s"),
            Self::UpperEnergyGain => ("κ_E,max", "s²/m²"),
            Self::TargetEnergy => ("E", "m²/s²"),
            Self::RadiusOfGyration => ("ρ", "m"),
            Self::CriticalEigenvalue => ("λ at κ_c", "1"),
        }
    }

    fn compute(self, scene: &Scene) -> Option<(f64, &'static str)> {
        let fixed_point = scene.fixed_point().ok()?;
        let linear = scene.linear(&fixed_point);
        Some(match self {
            Self::CriticalTiltGain => {
                (linear.critical_tilt_gain, "eq. (18), with V on the energy surface of the fixed point")
            }
            Self::FixedPointSpeed => (-fixed_point.speed, "the fixed point"),
            Self::UpperEnergyGain => (linear.upper_energy_gain, "2/((1 + e)V²)"),
            // E = ½V² + Gl = G y*, from the top of the bounce.
            Self::TargetEnergy => (scene.gravity() * fixed_point.apex_height, "G y*"),
            Self::RadiusOfGyration => match scene.outline() {
                Some(outline) => (outline.radius_of_gyration(), "the vertices"),
                None => {
                    // Isosceles triangle of base b and height h: ρ² = b²/24 + h²/18.
                    ((0.1_f64 * 0.1 / 24.0 + 0.2 * 0.2 / 18.0).sqrt(), "b²/24 + h²/18 = ρ², base 0.1 m, height 0.2 m")
                }
            },
            Self::CriticalEigenvalue => (-1.0, "R = 1: period doubling, with one Jordan block"),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_preset_builds_and_computes_what_it_quotes() {
        for preset in all() {
            let mut errors = Errors::default();
            let built = scene::apply(&mut Draft::default(), Some(&preset.scene), "", Source::Json, &mut errors);
            assert!(built.is_some(), "{}: {errors:?}", preset.name);
            let shown = preset.shown().unwrap();
            assert_eq!(shown.printed.len(), shown.computed.len(), "{}", preset.name);
        }
    }

    #[test]
    fn a_value_that_differs_from_the_printed_one_says_why() {
        for preset in all() {
            let shown = preset.shown().unwrap();
            for (printed, computed) in shown.printed.iter().zip(&shown.computed) {
                let same = (printed.value - computed.value).abs() <= 0.004 * printed.value.abs();
                assert!(same || computed.why.is_some(), "{}: {printed:?} {computed:?}", preset.name);
            }
        }
    }
}
