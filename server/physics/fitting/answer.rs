//! A request for a fit, its progress, and the answer.

use super::confidence::Estimate;
use super::impact_map::STATES;
use super::measured::{DataError, Measured};
use crate::scene::{FieldError, Name, Scene};

/// A request for a fit.
#[derive(Clone, Debug, PartialEq)]
pub struct FitRequest {
    /// The scene, with first values of the unknown fields.
    pub scene: Scene,
    /// The data.
    pub measured: Measured,
    /// Unknown fields: 1 to [`super::MOST_UNKNOWNS`].
    pub unknown: Vec<Name>,
    /// Standard deviation of each column of [`COLUMNS`]; `None` where it is estimated from the residuals.
    pub sd: [Option<f64>; STATES],
}

/// Stage of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FitStage {
    /// The numbers of the impacts, if they look missed or doubled: the squares with and without the change.
    Numbers,
    /// Several starts on the first rows.
    Starts,
    /// All rows in short windows, from the best start.
    ShortWindows,
    /// Longer windows.
    LongerWindows,
    /// Outliers left out.
    Outliers,
    /// Values far from the best, which must fit worse.
    Beside,
}

names!(
    FitStage: Numbers => "numbers", Starts => "starts", ShortWindows => "short_windows",
        LongerWindows => "longer_windows", Outliers => "outliers", Beside => "beside"
);

/// Progress of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitProgress {
    /// The stage.
    pub stage: FitStage,
    /// Number of the search within its stage, from 1; 0 before the first.
    pub search: usize,
    /// Iterations of all searches so far.
    pub iterations: usize,
    /// Root mean square of the residuals over their standard deviations, the given ones or else first ones. `None` before the first search, and beside
    /// the minimum.
    pub residual: Option<f64>,
    /// Work done, in iterations: a search that ends early has done all of its own.
    pub done: u64,
    /// The whole work.
    pub of: u64,
}

/// Reason for which there is no fit.
#[derive(Clone, Debug, PartialEq)]
pub enum FitFailure {
    /// A fault of the data.
    Data(DataError),
    /// A field that cannot be unknown, one too many, or none: its index, and a sentence.
    Unknown(usize, String),
    /// The scene contradicts itself where the search came.
    Scene(Vec<FieldError>),
    /// Too few values for so many unknowns.
    TooFew {
        /// Values.
        values: usize,
        /// Unknowns, those of the windows included.
        unknowns: usize,
    },
    /// The run of the model ends among the measured impacts.
    RunEnds,
    /// Work was cancelled.
    Cancelled,
}

/// A measured impact beside the fitted one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedRow {
    /// Number of the impact.
    pub n: u64,
    /// Index of its row in the data.
    pub row: usize,
    /// Index of its window.
    pub window: usize,
    /// Measured minus fitted value of each column; `None` where nothing was measured.
    pub residuals: [Option<f64>; STATES],
    /// True for values that were left out as outliers.
    pub outliers: [bool; STATES],
}

/// A judgement of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QualityKind {
    /// Residuals are as large as the standard deviations say, and random.
    Good,
    /// Residuals are smaller than the standard deviations say.
    DeviationsTooLarge,
    /// Residuals follow a pattern.
    NotRandom,
    /// Short windows explain the data, longer ones do not.
    NotFollowed,
    /// Residuals are larger than the standard deviations allow.
    NotExplained,
    /// The iterations ran out.
    NotConverged,
}

names!(
    QualityKind: Good => "good", DeviationsTooLarge => "deviations_too_large", NotRandom => "not_random",
        NotFollowed => "not_followed", NotExplained => "not_explained", NotConverged => "not_converged"
);

/// A judgement with its reason.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// The judgement.
    pub kind: QualityKind,
    /// Reason, in a sentence with numbers.
    pub detail: String,
}

/// A fit.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The fitted fields.
    pub estimates: Vec<Estimate>,
    /// Covariance of the estimates, in their units; 0 where the data do not tell.
    pub covariance: Vec<Vec<f64>>,
    /// The scene with the fitted fields.
    pub scene: Scene,
    /// Fields that keep their first value in it because the data do not tell them, in words; `None` if there are none.
    pub kept: Option<String>,
    /// The impacts.
    pub rows: Vec<FittedRow>,
    /// Standard deviation of each column, given or estimated; `None` of columns that were not measured.
    pub sd: [Option<f64>; STATES],
    /// Sum of squares over their variances.
    pub chi_squared: f64,
    /// Number of values less that of unknowns.
    pub degrees_of_freedom: f64,
    /// Number of windows.
    pub windows: usize,
    /// Judgement of the fit.
    pub quality: Quality,
    /// Sentences on what was done to the data and found beside the estimates.
    pub notes: Vec<String>,
    /// Iterations of all stages together.
    pub iterations: usize,
}
