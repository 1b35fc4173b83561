//! The scenes that everybody starts from: the paper's cases and those beside them, with what the paper prints and what
//! holds.

use equipoise_physics::scene::Draft;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::sync::{LazyLock, OnceLock};

use crate::api::scene::merge::apply;
use crate::api::scene::paper::Quantity;
use crate::api::scene::write::Resolved;
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
    /// As answered, once somebody has asked for it.
    #[serde(skip)]
    shown: OnceLock<Shown>,
}

/// A number as the paper prints it, and why it is another where it is.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Printed {
    quantity: Quantity,
    /// None where the paper leaves it out.
    value: Option<f64>,
    r#where: String,
    #[serde(default)]
    why: Option<String>,
    /// What of the scene is changed for the computed value.
    #[serde(default)]
    with: Option<Value>,
}

/// A number of a preset, printed or computed.
#[derive(Debug, Clone, Serialize)]
pub struct Quoted {
    quantity: Quantity,
    symbol: &'static str,
    unit: &'static str,
    value: Option<f64>,
    r#where: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    why: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    with: Option<Value>,
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
        let _ = apply(&mut draft, Some(&self.scene), "", Source::Json, &mut Errors::default());
        draft
    }

    /// Itself with its scene resolved and the printed values beside those that hold, some of which are of runs: computed once. None
    /// where `go_on` says no before it is.
    pub fn shown(&self, go_on: &dyn Fn() -> bool) -> Option<&Shown> {
        if self.shown.get().is_none() {
            let shown = self.compute(go_on).filter(|_| go_on())?;
            // Another thread that was faster has set the same.
            let _ = self.shown.set(shown);
        }
        self.shown.get()
    }

    /// What it costs to show, in bounces.
    pub fn price(&self) -> u64 {
        if self.shown.get().is_some() { 0 } else { self.printed.iter().map(|it| it.quantity.price()).sum() }
    }

    fn compute(&self, go_on: &dyn Fn() -> bool) -> Option<Shown> {
        // A test builds every preset.
        let scene = self.draft().build().ok()?;
        Some(Shown {
            name: self.name.clone(),
            title: self.title.clone(),
            shows: self.shows.clone(),
            scene: serde_json::to_value(Resolved(&scene)).ok()?,
            printed: self.printed.iter().map(Printed::quoted).collect(),
            computed: self.printed.iter().filter_map(|it| it.computed(self.draft(), go_on)).collect(),
        })
    }
}

impl Printed {
    fn quoted(&self) -> Quoted {
        let (symbol, unit) = self.quantity.symbol_and_unit();
        let Self { quantity, value, .. } = *self;
        Quoted { quantity, symbol, unit, value, r#where: self.r#where.clone(), why: None, with: None }
    }

    fn computed(&self, mut draft: Draft, go_on: &dyn Fn() -> bool) -> Option<Quoted> {
        let scene = apply(&mut draft, self.with.as_ref(), "", Source::Json, &mut Errors::default())?;
        let (value, source) = self.quantity.compute(&scene, go_on)?;
        let (value, r#where) = (Some(value), source.to_owned());
        Some(Quoted { value, r#where, why: self.why.clone(), with: self.with.clone(), ..self.quoted() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(preset: &Preset) -> &Shown {
        preset.shown(&|| true).unwrap()
    }

    #[test]
    fn every_preset_builds_and_computes_what_it_quotes() {
        for preset in all() {
            let mut errors = Errors::default();
            let built = apply(&mut Draft::default(), Some(&preset.scene), "", Source::Json, &mut errors);
            assert!(built.is_some(), "{}: {errors:?}", preset.name);
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
