//! The answer of `failures`: a case of the gallery.

use crate::failure_cases::{FailureCase, MethodClaim};
use equipoise_physics::scene::{FIELDS, Scene};
use serde::Serialize;

use crate::api::scene::{Resolved, value_to_json};

/// Answer of `/v1/failures/{name}`.
#[derive(Debug, Serialize)]
pub struct FailureAnswer {
    name: &'static str,
    title: &'static str,
    method: &'static str,
    why: &'static str,
    scene: serde_json::Value,
    impacts: u64,
    says: Vec<VerdictAnswer>,
    truth: TruthAnswer,
    ask: String,
    picture: String,
}

#[derive(Debug, Serialize)]
struct VerdictAnswer {
    method: &'static str,
    verdict: &'static str,
    value: Option<f64>,
    unit: Option<&'static str>,
    right: bool,
    detail: String,
}

#[derive(Debug, Serialize)]
struct TruthAnswer {
    verdict: &'static str,
    detail: String,
}

impl FailureAnswer {
    /// Computes the verdicts of a case.
    pub fn compute(case: &FailureCase) -> Self {
        let (scene, seen) = (case.scene(), case.findings());
        let said = |MethodClaim { method, verdict, value, unit, detail }| {
            let value = value.filter(|value| value.is_finite());
            VerdictAnswer { method, verdict, value, unit, right: verdict == seen.truth, detail }
        };
        Self {
            name: case.name,
            title: case.title,
            method: case.method,
            why: case.why,
            scene: serde_json::to_value(Resolved(&scene)).unwrap_or_default(),
            impacts: case.impacts,
            says: seen.says.into_iter().map(said).collect(),
            truth: TruthAnswer { verdict: seen.truth, detail: seen.detail },
            ask: ask(&scene, case.ask),
            picture: format!("/v1/failures/{}?format=svg", case.name),
        }
    }
}

/// Path and query of a request to this server, with the fields of the scene that differ from the defaults.
fn ask(scene: &Scene, (resource, rest): (&str, &str)) -> String {
    let said = FIELDS.iter().filter_map(|row| {
        let value = scene.value(row.name).filter(|value| Some(*value) != row.default)?;
        let value = value_to_json(value);
        Some(format!("scene.{}={}&", row.path, value.as_str().map_or_else(|| value.to_string(), str::to_owned)))
    });
    format!("/v1/{resource}?{}{rest}", said.collect::<String>())
}
