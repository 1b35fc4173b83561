//! The answer of `fits`: estimates with their intervals, residuals, the fitted scene and its verdict.

use std::borrow::Cow;

use equipoise_physics::fitting::{COLUMNS, Estimate, Fit, FitFailure, FitProgress, FittedRow, fit_watched};
use serde::Serialize;
use serde_json::Value as Json;

use crate::api::fits::fault::place;
use crate::api::fits::progress::Step;
use crate::api::fits::region::RegionAnswer;
use crate::api::fits::request::FitsRequest;
use crate::api::formats::Tabular;
use crate::api::scene::scene_to_json;
use crate::api::shared::table::{Cells, Column, Table};
use crate::compute::Cancelled;
use crate::http::Problem;

/// A fitted field.
#[derive(Debug, Serialize)]
pub(super) struct EstimateAnswer {
    pub(super) path: &'static str,
    pub(super) value: f64,
    pub(super) sd: Option<f64>,
    pub(super) interval: Option<[f64; 2]>,
    pub(super) unit: &'static str,
    identifiable: bool,
    detail: Option<String>,
}

impl From<&Estimate> for EstimateAnswer {
    fn from(estimate: &Estimate) -> Self {
        let row = estimate.name.row();
        Self {
            path: row.path,
            value: estimate.value,
            sd: estimate.sd,
            interval: estimate.interval.map(|(low, high)| [low, high]),
            unit: row.unit,
            identifiable: estimate.is_identifiable(),
            detail: estimate.detail.clone(),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
struct QualityAnswer {
    kind: &'static str,
    detail: String,
}

/// Standard deviation of each column, given or estimated.
#[derive(Debug, Clone, Serialize)]
struct Deviations {
    theta: Option<f64>,
    x_dot: Option<f64>,
    y_dot: Option<f64>,
    theta_dot: Option<f64>,
    x: Option<f64>,
    t: Option<f64>,
}

/// Answer of `/v1/fits`.
#[derive(Debug, Serialize)]
pub struct FitAnswer {
    pub(super) estimates: Vec<EstimateAnswer>,
    /// `None` of fields that the data do not tell.
    correlation: Vec<Vec<Option<f64>>>,
    pub(super) residuals: Table,
    sd: Deviations,
    pub(super) chi_squared: f64,
    pub(super) degrees_of_freedom: f64,
    quality: QualityAnswer,
    windows: usize,
    iterations: usize,
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
            residuals: residuals(&rows),
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

/// The residuals as columns.
fn residuals(rows: &[FittedRow]) -> Table {
    let counts = |name, read: fn(&FittedRow) -> u64| Column {
        name,
        unit: "",
        cells: Cells::Counts(rows.iter().map(read).collect()),
    };
    let head = [
        counts("n", |row| row.n),
        counts("row", |row| row.row as u64 + 1),
        counts("window", |row| row.window as u64 + 1),
    ];
    let measured = COLUMNS.iter().enumerate().map(|(column, &(name, unit))| Column {
        name,
        unit,
        cells: Cells::Sparse(rows.iter().map(|row| row.residuals[column]).collect()),
    });
    let outlier = Column {
        name: "outlier",
        unit: "",
        cells: Cells::Flags(rows.iter().map(|row| Some(row.outliers.contains(&true))).collect()),
    };
    Table(head.into_iter().chain(measured).chain([outlier]).collect())
}

impl Tabular for FitAnswer {
    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Borrowed(&self.residuals)
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["residuals"]
    }

    fn end(&self) -> impl Serialize {
        #[derive(Serialize)]
        struct End<'a> {
            estimates: &'a [EstimateAnswer],
            chi_squared: f64,
            degrees_of_freedom: f64,
            quality: &'a QualityAnswer,
            scene: &'a Json,
            stability: &'a RegionAnswer,
            notes: &'a [String],
        }
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
