//! An item of the paper: the printed formula, number or figure, and its checks against this server's computations.

use equipoise_physics::scene::{Name, Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::scene::presets;
use crate::api::scene::quantity::Quantity;
use crate::api::scene::{Resolved, value_to_json};

/// Kind of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[schemars(rename = "PaperItemKind")]
#[serde(rename_all = "snake_case")]
pub(super) enum Kind {
    Equation,
    Table,
    Figure,
    Claim,
}

/// An item of the paper.
pub(super) struct Item {
    /// Short name, unique.
    pub(super) id: &'static str,
    pub(super) kind: Kind,
    /// Numbers of the equations, tables or figures, or the section.
    pub(super) place: &'static str,
    pub(super) title: &'static str,
    /// The formula or statement as printed.
    pub(super) printed: &'static str,
    /// Preset that the checks run, and changes to it.
    pub(super) scene: (&'static str, &'static [(Name, Value)]),
    /// Resource and further parameters of a request that shows the computed values.
    pub(super) ask: (&'static str, &'static str),
    /// True if the request has a picture that shows what the item prints.
    pub(super) picture: bool,
    /// The printed formula evaluated, beside the values of the return map.
    pub(super) checks: fn(&Scene) -> Option<Vec<Check>>,
    /// Printed values that stand with presets: preset and quantity.
    pub(super) quoted: &'static [(&'static str, Quantity)],
    /// Reason for a difference, or a remark.
    pub(super) why: Option<&'static str>,
}

/// An item without scene, checks and reason.
pub(super) const PLAIN: Item = Item {
    id: "",
    kind: Kind::Equation,
    place: "",
    title: "",
    printed: "",
    scene: ("case-1", &[]),
    ask: ("trajectories", "bounces=100"),
    picture: false,
    checks: |_| Some(Vec::new()),
    quoted: &[],
    why: None,
};

/// Largest relative difference of two evaluations of the same formula.
const ROUNDING: f64 = 1e-9;

/// A printed value beside the computed one.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "PaperCheck")]
pub(super) struct Check {
    quantity: &'static str,
    symbol: &'static str,
    /// "1" for a number without unit.
    unit: &'static str,
    /// The printed number, or the printed formula evaluated. Null if the paper states it in words or leaves it out.
    printed: Option<f64>,
    /// The value of this server.
    pub(super) computed: f64,
    /// True if both are the same: to rounding for a formula, to the printed digits for a number.
    pub(super) agrees: bool,
    /// Reason for a difference.
    pub(super) why: Option<&'static str>,
}

impl Check {
    /// The printed formula, evaluated, beside the computed value. They agree up to rounding.
    pub(super) fn formula([quantity, symbol, unit]: [&'static str; 3], printed: f64, computed: f64) -> Self {
        Self::within([quantity, symbol, unit], printed, computed, ROUNDING * (printed.abs() + computed.abs()) + 1e-12)
    }

    /// A printed number beside the computed one. They agree up to `tolerance`, half a unit of the last printed digit or an
    /// approximation's error.
    pub(super) fn within(
        [quantity, symbol, unit]: [&'static str; 3],
        printed: f64,
        computed: f64,
        tolerance: f64,
    ) -> Self {
        let agrees = (printed - computed).abs() <= tolerance;
        Self { quantity, symbol, unit, printed: Some(printed), computed, agrees, why: None }
    }
}

/// An item with its computed values.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct PaperItem {
    /// Short name, unique.
    id: &'static str,
    kind: Kind,
    /// Section of the paper, with its number.
    section: &'static str,
    /// Numbers of the equations, tables and figures, or the section.
    place: &'static str,
    /// A short title.
    title: &'static str,
    /// The formula or statement as printed.
    printed: &'static str,
    /// True if all checks agree.
    agrees: bool,
    /// Printed values beside computed ones; empty if the item is only drawn.
    pub(super) checks: Vec<Check>,
    /// Reason for a difference, or a remark.
    why: Option<&'static str>,
    scene: Resolved,
    /// A request to this server that shows the computed values.
    ask: String,
    /// The picture of that request.
    pub(super) picture: Option<String>,
}

impl Item {
    /// An item of the scene of case 1 without checks.
    pub(super) const fn new(
        kind: Kind,
        id: &'static str,
        place: &'static str,
        title: &'static str,
        printed: &'static str,
    ) -> Self {
        Self { id, kind, place, title, printed, ..PLAIN }
    }

    pub(super) const fn of(self, preset: &'static str) -> Self {
        Self { scene: (preset, &[]), ..self }
    }

    pub(super) const fn with(self, changes: &'static [(Name, Value)]) -> Self {
        Self { scene: (self.scene.0, changes), ..self }
    }

    pub(super) const fn ask(self, resource: &'static str, rest: &'static str) -> Self {
        Self { ask: (resource, rest), ..self }
    }

    pub(super) const fn drawn(self) -> Self {
        Self { picture: true, ..self }
    }

    pub(super) const fn checked(self, checks: fn(&Scene) -> Option<Vec<Check>>) -> Self {
        Self { checks, ..self }
    }

    pub(super) const fn quoting(self, quoted: &'static [(&'static str, Quantity)]) -> Self {
        Self { quoted, ..self }
    }

    pub(super) const fn because(self, why: &'static str) -> Self {
        Self { why: Some(why), ..self }
    }

    /// The item with its computed values. None if `go_on` says no before they are complete.
    pub(super) fn answer(&self, section: &'static str, go_on: &dyn Fn() -> bool) -> Option<PaperItem> {
        let (name, changes) = self.scene;
        let mut draft = presets::find(name)?.draft();
        for &(field, value) in changes {
            draft.set(field, Some(value)).ok()?;
        }
        // A test builds every scene.
        let scene = draft.build().ok()?;
        let mut checks = (self.checks)(&scene)?;
        for &(preset, quantity) in self.quoted {
            let (printed, computed, why) = presets::find(preset)?.shown(go_on)?.pair(quantity)?;
            let agrees = why.is_none() && printed.is_some_and(|printed| agrees_in_print(printed, computed));
            let [name, symbol, unit] = [quantity.name(), quantity.symbol(), quantity.unit()];
            checks.push(Check { quantity: name, symbol, unit, printed, computed, agrees, why });
        }
        let (resource, rest) = self.ask;
        let changed = changes.iter().map(|&(field, value)| {
            let value = value_to_json(value);
            format!("&scene.{}={}", field.row().path, value.as_str().map_or_else(|| value.to_string(), str::to_owned))
        });
        let ask = format!("/v1/{resource}?preset={name}{}&{rest}", changed.collect::<String>());
        Some(PaperItem {
            id: self.id,
            kind: self.kind,
            section,
            place: self.place,
            title: self.title,
            printed: self.printed,
            agrees: checks.iter().all(|check| check.agrees),
            checks,
            why: self.why,
            scene: Resolved(scene),
            picture: self.picture.then(|| format!("{ask}&format=svg")),
            ask,
        })
    }
}

/// True if a computed value rounds to the printed one, to the digits in which that is printed.
fn agrees_in_print(printed: f64, computed: f64) -> bool {
    let text = printed.to_string();
    let decimals = text.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let unit = (0..decimals).fold(1.0, |unit, _| unit / 10.0);
    (printed - computed).abs() <= 0.500_000_1 * unit
}
