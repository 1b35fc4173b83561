//! The model that a scene is computed with, as part of answers.

use equipoise_physics::analysis::method::RunMethod;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::model::{ModelLevel, ModelRequirement};
use schemars::JsonSchema;
use serde::Serialize;

use crate::words;

words! {
    /// A rung of the ladder of models: a point mass; the angle block of a rod in closed form (`linear`, if that method was chosen); the rod;
    /// the rod on a table that also reacts to its position; with constant errors of the rig; a turning table; a delay; drag; with friction or a
    /// table that moves along itself; with noise; with the outline of a polygon.
    pub Rung = ModelLevel::ALL.map(ModelLevel::name);
}

/// The simplest model that is exact for the scene.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Model")]
pub struct ModelChoice {
    /// Name of the model.
    #[schemars(with = "Rung")]
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
    /// The fields that require the rungs above the rod, from the lowest.
    pub forced: Vec<RequirementAnswer>,
}

/// A field that requires a rung.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "Forced")]
pub struct RequirementAnswer {
    #[schemars(with = "Rung")]
    rung: &'static str,
    /// Dotted path in a scene.
    field: &'static str,
    /// The reason, in a sentence.
    detail: String,
}

impl RequirementAnswer {
    /// Path of the field.
    pub fn field(&self) -> &'static str {
        self.field
    }
}

impl From<ModelRequirement> for RequirementAnswer {
    fn from(ModelRequirement { level, path, detail }: ModelRequirement) -> Self {
        Self { rung: level.name(), field: path, detail }
    }
}

impl ModelChoice {
    /// The model of a scene.
    pub fn of(scene: &Scene) -> Self {
        let forced = scene.requirements().into_iter().map(RequirementAnswer::from).collect();
        Self { name: scene.model_level().name(), reason: scene.level_reason(), forced }
    }

    /// The model that a run method computes a scene with.
    pub(crate) fn by_method(scene: &Scene, method: RunMethod) -> Self {
        if method != RunMethod::Linear {
            return Self::of(scene);
        }
        let reason = "the linear solution is accurate enough here, or was asked for: the angle block in closed form";
        Self { name: ModelLevel::Linear.name(), reason: reason.to_owned(), forced: Vec::new() }
    }
}
