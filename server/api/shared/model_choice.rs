//! The model that a scene is computed with, as part of answers.

use equipoise_physics::analysis::method::RunMethod;
use equipoise_physics::scene::Scene;
use equipoise_physics::scene::model::{ModelLevel, ModelRequirement};
use serde::Serialize;

/// The model of a run, and the reason for it.
#[derive(Debug, Clone, Serialize)]
pub struct ModelChoice {
    /// Name of the model.
    pub name: &'static str,
    /// The reason, in a sentence.
    pub reason: String,
    /// Fields of the scene that require levels above the rod.
    pub forced: Vec<RequirementAnswer>,
}

/// A field that requires a level of the model hierarchy.
#[derive(Debug, Clone, Serialize)]
pub struct RequirementAnswer {
    rung: &'static str,
    field: &'static str,
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
