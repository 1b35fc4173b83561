//! A preset: a scene with a name, and printed values beside computed ones.

use equipoise_physics::map::polygon::Vertices;
use equipoise_physics::scene::{Draft, Name, Value as FieldValue};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value;
use std::sync::OnceLock;

use crate::api::scene::Derived;
use crate::api::scene::quantity::Quantity;
use crate::api::scene::schema::{PresetName, ScenePatch};
use crate::api::scene::write::{Resolved, nested, value_to_json};
use crate::schema_names;

/// A scene with a name.
#[derive(Debug, Clone)]
pub struct Preset {
    /// Name in requests.
    pub name: &'static str,
    pub(super) title: &'static str,
    pub(super) shows: &'static str,
    pub(super) scene: &'static [(Name, FieldValue)],
    /// Vertices of a polygon, m; `None` for other bodies.
    pub(super) vertices: &'static [[f64; 2]],
    pub(super) printed: &'static [Printed],
    /// The answer, once it has been computed.
    pub(super) shown: OnceLock<Shown>,
}

/// A number as the paper prints it, and why the computed one differs, if it does.
#[derive(Debug, Clone, Copy)]
pub(super) struct Printed {
    pub(super) quantity: Quantity,
    /// None if the paper leaves it out.
    value: Option<f64>,
    place: &'static str,
    why: Option<&'static str>,
    /// Fields that are changed for the computed value.
    pub(super) with: &'static [(Name, FieldValue)],
}

schema_names! {
    pub(super) QuantityName;
}

/// A number of a preset, printed or computed.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Quantity")]
pub(super) struct Quoted {
    #[schemars(with = "QuantityName")]
    quantity: Quantity,
    symbol: &'static str,
    /// "1" for a number without unit.
    unit: &'static str,
    /// Null if the paper leaves it out, or states it in words.
    pub(super) value: Option<f64>,
    /// Printed: table, equation or section. Computed: source of the value.
    r#where: &'static str,
    /// Reason for a difference between computed and printed value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) why: Option<&'static str>,
    /// Changes to the scene for the computed value.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(with = "Option<ScenePatch>")]
    with: Option<Value>,
}

/// A preset as it is answered.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Preset")]
pub struct Shown {
    #[schemars(with = "PresetName")]
    name: &'static str,
    /// A short title.
    title: &'static str,
    /// What the scene demonstrates, in a sentence.
    shows: &'static str,
    #[schemars(with = "Resolved<'static>")]
    scene: Value,
    derived: Derived,
    /// The values that the paper prints.
    pub(super) printed: Vec<Quoted>,
    /// The same quantities, in the same order, as this server computes them.
    pub(super) computed: Vec<Quoted>,
}

impl Shown {
    /// A quantity's printed value, its computed value, and why they differ.
    pub(crate) fn pair(&self, quantity: Quantity) -> Option<(Option<f64>, f64, Option<&'static str>)> {
        let printed = self.printed.iter().find(|quoted| quoted.quantity == quantity)?;
        let computed = self.computed.iter().find(|quoted| quoted.quantity == quantity)?;
        Some((printed.value, computed.value?, computed.why))
    }
}

impl Preset {
    /// The scene, to change and build.
    pub fn draft(&self) -> Draft {
        let mut draft = Draft::default();
        put(&mut draft, self.scene);
        if !self.vertices.is_empty() {
            draft.set_vertices(Vertices::new(self.vertices).ok());
        }
        draft
    }

    /// The answer: the resolved scene, and printed values beside computed ones, some of which are of runs. Computed once. None if
    /// `go_on` says no before it is complete.
    pub fn shown(&self, go_on: &dyn Fn() -> bool) -> Option<&Shown> {
        if self.shown.get().is_none() {
            let shown = self.compute(go_on).filter(|_| go_on())?;
            // Another thread that was faster has set the same.
            let _ = self.shown.set(shown);
        }
        self.shown.get()
    }

    /// Price of the answer, in bounces.
    pub fn price(&self) -> u64 {
        if self.shown.get().is_some() { 0 } else { self.printed.iter().map(|it| it.quantity.price()).sum() }
    }

    fn compute(&self, go_on: &dyn Fn() -> bool) -> Option<Shown> {
        // A test builds every preset.
        let scene = self.draft().build().ok()?;
        Some(Shown {
            name: self.name,
            title: self.title,
            shows: self.shows,
            scene: serde_json::to_value(Resolved(&scene)).ok()?,
            derived: Derived::of(&scene),
            printed: self.printed.iter().map(Printed::quoted).collect(),
            computed: self.printed.iter().filter_map(|it| it.computed(self.draft(), go_on)).collect(),
        })
    }
}

/// Sets fields of a draft. A test builds every scene of a preset, so there is nothing to report.
fn put(draft: &mut Draft, values: &[(Name, FieldValue)]) {
    for &(name, value) in values {
        let _ = draft.set(name, Some(value));
    }
}

impl Printed {
    pub(super) const fn new(quantity: Quantity, value: f64, place: &'static str) -> Self {
        Self { value: Some(value), ..Self::without_value(quantity, place) }
    }

    /// A quantity that the paper uses and does not state.
    pub(super) const fn without_value(quantity: Quantity, place: &'static str) -> Self {
        Self { quantity, value: None, place, why: None, with: &[] }
    }

    pub(super) const fn because(self, why: &'static str) -> Self {
        Self { why: Some(why), ..self }
    }

    pub(super) const fn with(self, with: &'static [(Name, FieldValue)]) -> Self {
        Self { with, ..self }
    }

    fn quoted(&self) -> Quoted {
        let Self { quantity, value, place, .. } = *self;
        let (symbol, unit) = (quantity.symbol(), quantity.unit());
        Quoted { quantity, symbol, unit, value, r#where: place, why: None, with: None }
    }

    fn computed(&self, mut draft: Draft, go_on: &dyn Fn() -> bool) -> Option<Quoted> {
        put(&mut draft, self.with);
        let (value, r#where) = self.quantity.compute(&draft.build().ok()?, go_on)?;
        let changes = self.with.iter().map(|&(name, value)| (name.row().path, as_given(value)));
        let with = (!self.with.is_empty()).then(|| nested(changes));
        Some(Quoted { value: Some(value), r#where, why: self.why, with, ..self.quoted() })
    }
}

/// A value as a person writes it: whole numbers without a decimal point.
fn as_given(value: FieldValue) -> Value {
    match value {
        FieldValue::Number(number) if number.fract() == 0.0 => Value::from(number as i64),
        value => value_to_json(value),
    }
}
