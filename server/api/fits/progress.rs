//! Lines of a fit that tell its progress.

use equipoise_physics::fitting::{FitProgress, FitStage};
use serde::Serialize;

use crate::http::Problem;

/// Name of the stage after the fit.
const VERDICT: &str = "verdict";

/// Progress of the answer.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Step {
    done: u64,
    of: u64,
    stage: &'static str,
    search: usize,
    iterations: usize,
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
        let step = serde_json::to_string(self).expect("numbers and a word");
        format!("{{\"progress\":{step}}}\n").into_bytes()
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
