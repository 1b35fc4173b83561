//! The answer of `fits`: estimates with their intervals, residuals, the fitted scene and its verdict.

use std::borrow::Cow;

use equipoise_physics::fitting::{
    COLUMNS, Estimate, Fit, FitFailure, FitProgress, FittedRow, QualityKind, fit_watched,
};
use schemars::JsonSchema;
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::fits::fault::place;
use crate::api::fits::progress::Step;
use crate::api::fits::region::RegionAnswer;
use crate::api::fits::request::FitsRequest;
use crate::api::formats::Tabular;
use crate::api::scene::{Resolved, scene_to_json};
use crate::api::shared::table::Table;
use crate::api::shared::table::columns::{RowColumn, table_of};
use crate::api::shared::table::gather::Read;
use crate::compute::Cancelled;
use crate::http::Problem;
use crate::{column_lists, words};

/// A fitted field.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FitEstimate")]
pub(super) struct EstimateAnswer {
    pub(super) field: &'static str,
    /// Best value. If the data do not determine it, the value at which the search ended.
    pub(super) value: f64,
    /// Standard deviation. Null if the data do not determine the value.
    pub(super) sd: Option<f64>,
    /// The 95 % interval, cut to the range of the field. Null if the data do not determine the value.
    pub(super) interval: Option<[f64; 2]>,
    pub(super) unit: &'static str,
    /// True if the data determine the value.
    identifiable: bool,
    /// Reason why the data do not determine the value, or how `sd` and `interval` were adjusted. Null if there is nothing to say.
    detail: Option<String>,
}

impl From<&Estimate> for EstimateAnswer {
    fn from(estimate: &Estimate) -> Self {
        let row = estimate.name.row();
        Self {
            field: row.path,
            value: estimate.value,
            sd: estimate.sd,
            interval: estimate.interval.map(|(low, high)| [low, high]),
            unit: row.unit,
            identifiable: estimate.is_identifiable(),
            detail: estimate.detail.clone(),
        }
    }
}

words! {
    /// `good`: residuals are as large as the standard deviations say, and random. `deviations_too_large`: they are smaller. `not_random`:
    /// neighbouring residuals are correlated. `not_followed`: short windows explain the data, longer ones do not. `not_explained`: residuals are
    /// larger than chance allows. `not_converged`: the iterations ran out.
    pub FitQualityKind = QualityKind::ALL.map(QualityKind::name);
}

/// The judgement of a fit.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "FitQuality")]
struct QualityAnswer {
    #[schemars(with = "FitQualityKind")]
    kind: &'static str,
    /// The reason, with numbers.
    detail: String,
}

/// Standard deviations of the columns, as given or as estimated. Null for a column that was not measured.
#[derive(Debug, Clone, Serialize, JsonSchema)]
#[schemars(rename = "FitDeviations")]
struct Deviations {
    /// Standard deviation of the angle, rad.
    theta: Option<f64>,
    /// Standard deviation of the horizontal velocity, m/s.
    x_dot: Option<f64>,
    /// Standard deviation of the vertical velocity, m/s.
    y_dot: Option<f64>,
    /// Standard deviation of the angular velocity, rad/s.
    theta_dot: Option<f64>,
    /// Standard deviation of the place, m.
    x: Option<f64>,
    /// Standard deviation of the time, s.
    t: Option<f64>,
}

/// Answer of `/v1/fits`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Fit")]
pub struct FitAnswer {
    /// In the order of `unknown`.
    pub(super) estimates: Vec<EstimateAnswer>,
    /// Correlations of the estimates, in their order. Null for a field that the data do not determine.
    correlation: Vec<Vec<Option<f64>>>,
    #[schemars(with = "FitResiduals")]
    pub(super) residuals: Table,
    sd: Deviations,
    /// Sum of the squares of residuals over standard deviations, outliers left out.
    pub(super) chi_squared: f64,
    /// Number of values less that of unknowns, initial states of the windows included.
    pub(super) degrees_of_freedom: f64,
    quality: QualityAnswer,
    /// Number of windows.
    windows: usize,
    /// Iterations of all stages together.
    iterations: usize,
    /// The scene with the estimates that the data determine, ready to run.
    #[schemars(with = "Resolved<'static>")]
    scene: Json,
    stability: RegionAnswer,
    notes: Vec<String>,
    /// Contacts that were computed, about.
    #[serde(skip)]
    pub bounces: u64,
    #[serde(skip)]
    pub(super) rows: Vec<FittedRow>,
}

impl FitAnswer {
    /// Fits the scene of a request. Calls `tell` as the fit goes on.
    ///
    /// # Errors
    /// The field for which there is no fit, or cancelled work.
    pub fn compute(
        request: &FitsRequest,
        tell: &mut dyn FnMut(Step),
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Self, Problem> {
        let mut of = 0;
        let mut tell_fit = |now: &FitProgress| {
            of = now.of;
            tell(now.into());
        };
        let found = fit_watched(&request.fit, &mut tell_fit, go_on).map_err(|why| problem(request, why))?;
        tell(Step::to_verdict(found.iterations, of));
        let stability = RegionAnswer::compute(&found, go_on)?;
        let Fit {
            estimates,
            covariance,
            scene,
            kept: _,
            rows,
            sd,
            chi_squared,
            degrees_of_freedom,
            windows,
            quality,
            notes,
            iterations,
        } = found;
        let [theta, x_dot, y_dot, theta_dot, x, t] = sd;
        let count = estimates.len();
        let correlation = |one: usize, other: usize| {
            let scale = (covariance[one][one] * covariance[other][other]).sqrt();
            (scale > 0.0).then(|| covariance[one][other] / scale)
        };
        Ok(Self {
            estimates: estimates.iter().map(EstimateAnswer::from).collect(),
            correlation: (0..count).map(|one| (0..count).map(|other| correlation(one, other)).collect()).collect(),
            residuals: table_of(&COLUMNS_OF_RESIDUALS, &rows),
            sd: Deviations { theta, x_dot, y_dot, theta_dot, x, t },
            chi_squared,
            degrees_of_freedom,
            quality: QualityAnswer { kind: quality.kind.name(), detail: quality.detail },
            windows,
            iterations,
            scene: scene_to_json(&scene),
            stability,
            notes,
            bounces: (iterations * rows.len()) as u64,
            rows,
        })
    }
}

/// The problem of a request that has no fit.
fn problem(request: &FitsRequest, why: FitFailure) -> Problem {
    place(&request.fit, why).map_or_else(|| Cancelled.into(), |(pointer, detail)| Problem::invalid_at(pointer, detail))
}

/// Columns of the residuals.
pub(super) const COLUMNS_OF_RESIDUALS: [RowColumn<FittedRow>; COLUMNS.len() + 4] = [
    RowColumn::new("n", "", "Number of the impact, as given or as found.", Read::Count(|row| row.n)),
    RowColumn::new("row", "", "Row in the data, from 1.", Read::Count(|row| row.row as u64 + 1)),
    RowColumn::new(
        "window",
        "",
        "Window of impacts with an initial state of its own, from 1.",
        Read::Count(|row| row.window as u64 + 1),
    ),
    residual::<0>(),
    residual::<1>(),
    residual::<2>(),
    residual::<3>(),
    residual::<4>(),
    residual::<5>(),
    RowColumn::new(
        "outlier",
        "",
        "True if a value of the row was left out.",
        Read::Flag(|row| Some(row.outliers.contains(&true))),
    ),
];

const fn residual<const COLUMN: usize>() -> RowColumn<FittedRow> {
    let (name, unit) = COLUMNS[COLUMN];
    RowColumn::new(name, unit, "", Read::Sparse(|row| row.residuals[COLUMN]))
}

column_lists! {
    /// Measured less fitted values, a row for each impact that takes part. Columns of one length.
    pub FitResiduals = COLUMNS_OF_RESIDUALS.iter().map(RowColumn::word);
}

/// The last line of NDJSON.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FitEnd")]
pub(super) struct End<'a> {
    estimates: &'a [EstimateAnswer],
    chi_squared: f64,
    degrees_of_freedom: f64,
    quality: &'a QualityAnswer,
    #[schemars(with = "Resolved<'static>")]
    scene: &'a Json,
    stability: &'a RegionAnswer,
    notes: &'a [String],
}

impl Tabular for FitAnswer {
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Borrowed(&self.residuals)
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["residuals"]
    }

    fn end(&self) -> impl Serialize {
        End {
            estimates: &self.estimates,
            chi_squared: self.chi_squared,
            degrees_of_freedom: self.degrees_of_freedom,
            quality: &self.quality,
            scene: &self.scene,
            stability: &self.stability,
            notes: &self.notes,
        }
    }
}
