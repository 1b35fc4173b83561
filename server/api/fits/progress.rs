//! Lines of a fit that tell its progress.

use equipoise_physics::fitting::{FitProgress, FitStage};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;

use crate::http::Problem;
use crate::words;

words! {
    /// `numbers`: impacts that look missed or doubled are numbered anew, if that explains the data better. `starts`: several first values, on the
    /// first rows. `short_windows`: all rows, in short windows. `longer_windows`: windows are joined. `outliers`: they are left out, and the fit
    /// becomes fine. `beside`: values far from the best must fit worse. `verdict`: that on the fitted scene, and its margins. A better fit that is
    /// met beside the best leads back to `outliers`.
    pub FitStageName = stages();
}

/// A line on the progress of a fit.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FitProgress")]
pub(super) struct Line<'a> {
    progress: &'a Step,
}

/// The last line with progress, if there is no fit. Without progress this is the answer, with the status of its `status`.
#[derive(JsonSchema)]
#[schemars(rename = "FitProgressFailure")]
#[expect(dead_code, reason = "a schema alone")]
pub(super) struct LineOfFailure {
    #[schemars(schema_with = "problem_schema")]
    problem: (),
}

fn problem_schema(_: &mut SchemaGenerator) -> Schema {
    json_schema!({"$ref": "#/components/schemas/Problem"})
}

/// Name of the stage after the fit.
const VERDICT: &str = "verdict";

/// Progress of the answer.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "FitStep")]
pub struct Step {
    /// Work done, in iterations. A search that ends early has done all of its own, so it may leap.
    done: u64,
    /// The whole work.
    of: u64,
    #[schemars(with = "FitStageName")]
    stage: &'static str,
    /// Number of the search within its stage, from 1. 0 before the first, and for the verdict.
    search: usize,
    /// Iterations of all searches so far.
    iterations: usize,
    /// Root mean square of the residuals over their standard deviations: the given ones, or else 5 mrad, 0.02 m/s, 0.1 rad/s, 2 mm and 2 ms. It
    /// may rise where a search begins, and where windows become longer. Null before the first search, beside the best, and for the verdict.
    residual: Option<f64>,
}

impl From<&FitProgress> for Step {
    fn from(now: &FitProgress) -> Self {
        let FitProgress { stage, search, iterations, residual, done, of } = *now;
        Self { done, of, stage: stage.name(), search, iterations, residual }
    }
}

impl Step {
    /// Step after the fit, to the verdict on its scene.
    pub(super) fn to_verdict(iterations: usize, of: u64) -> Self {
        Self { done: of, of, stage: VERDICT, search: 0, iterations, residual: None }
    }

    /// Line of the answer.
    pub(super) fn line(&self) -> Vec<u8> {
        let line = serde_json::to_vec(&Line { progress: self }).expect("numbers and a word");
        [line.as_slice(), b"\n"].concat()
    }
}

/// The last line of a fit that failed, because the status has been sent.
pub(super) fn failure(problem: &Problem) -> Vec<u8> {
    [b"{\"problem\":", problem.to_json().as_slice(), b"}\n"].concat()
}

/// Names of all stages, in their order.
pub fn stages() -> Vec<&'static str> {
    FitStage::ALL.into_iter().map(FitStage::name).chain([VERDICT]).collect()
}
