//! The answer of `failures`: a case of the gallery.

use crate::failure_cases::{CASES, FailureCase, MethodClaim};
use equipoise_physics::scene::{FIELDS, Scene};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::scene::{Resolved, value_to_json};
use crate::words;

words! {
    /// Name of a case of the failure gallery.
    FailureName = CASES.map(|case| case.name);
}

/// Answer of `/v1/failures/{name}`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Failure")]
pub struct FailureAnswer {
    #[schemars(with = "FailureName")]
    name: &'static str,
    /// A short title.
    title: &'static str,
    /// The usual method that fails here.
    method: &'static str,
    /// Reason for the failure, in a paragraph.
    why: &'static str,
    #[schemars(with = "Resolved<'static>")]
    scene: serde_json::Value,
    /// Largest number of impacts of the runs.
    impacts: u64,
    /// The verdict of each method, the usual one first.
    says: Vec<VerdictAnswer>,
    truth: TruthAnswer,
    /// A request to this server that shows the truth.
    ask: String,
    /// The picture of the case.
    picture: String,
}

/// Verdict of a method.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FailureVerdict")]
struct VerdictAnswer {
    method: &'static str,
    /// The verdict in a word or two.
    verdict: &'static str,
    /// The number behind the verdict.
    value: Option<f64>,
    /// Unit of the value; null for a pure number and without a value.
    unit: Option<&'static str>,
    /// True if the verdict is the truth.
    right: bool,
    /// Explanation with numbers.
    detail: String,
}

/// The truth.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FailureTruth")]
struct TruthAnswer {
    verdict: &'static str,
    /// Evidence, with numbers.
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
