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
    bounces: u64,
    /// The claim of each method, the usual one first.
    says: Vec<ClaimAnswer>,
    truth: TruthAnswer,
    /// A request to this server that shows the truth.
    ask: String,
    /// The picture of the case.
    picture: String,
}

/// Claim of a method.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FailureClaim")]
struct ClaimAnswer {
    method: &'static str,
    /// The claim in a word or two.
    text: &'static str,
    /// The number behind the claim.
    value: Option<f64>,
    /// Unit of the value; null for a pure number and without a value.
    unit: Option<&'static str>,
    /// True if the claim is the truth.
    right: bool,
    /// Explanation with numbers.
    detail: String,
}

/// The truth.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FailureTruth")]
struct TruthAnswer {
    text: &'static str,
    /// Evidence, with numbers.
    detail: String,
}

impl FailureAnswer {
    /// Computes the claims of a case.
    pub fn compute(case: &FailureCase) -> Self {
        let (scene, seen) = (case.scene(), case.findings());
        let said = |MethodClaim { method, verdict: text, value, unit, detail }| {
            let value = value.filter(|value| value.is_finite());
            ClaimAnswer { method, text, value, unit, right: text == seen.truth, detail }
        };
        Self {
            name: case.name,
            title: case.title,
            method: case.method,
            why: case.why,
            scene: serde_json::to_value(Resolved(&scene)).unwrap_or_default(),
            bounces: case.impacts,
            says: seen.says.into_iter().map(said).collect(),
            truth: TruthAnswer { text: seen.truth, detail: seen.detail },
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
