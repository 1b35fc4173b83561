//! `/v1/fits`: fields of a scene from measured impacts.

pub mod request;

use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::fitting::{
    COLUMNS, Estimate, Fit, FitFailure, FitProgress, FitStage, FittedRow, QualityKind, chi_squared_quantile, fit,
};
use equipoise_physics::scene::{Scene, Value};
use prometheus_client::metrics::counter::Counter;
use schemars::{Schema, SchemaGenerator, json_schema};

use crate::api::computed::fits::request::{FitsRequest, MEASURED, measured_values, place};
use crate::api::computed::stability::evidence::Chaos;
use crate::api::computed::stability::request::{DEFAULT_BOUNCES, StabilityRequest};
use crate::api::computed::stability::verdict::VerdictAnswer;
use crate::api::computed::stability::{NonlinearPart, StabilityAnswer};
use crate::api::prelude::*;
use crate::api::shared::margins::{ENERGY_GAIN, Margin, Side, TILT_GAIN};
use crate::api::shared::write::line;
use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot, chart};
use crate::http::request::tree::TableBody;

impl ComputedResource for FitsRequest {
    const NAME: &'static str = "fits";
    const SINGULAR: &'static str = "Fit";
    const POST_ONLY: bool = true;
    const TABLE: Option<&'static TableBody> = Some(&MEASURED);
    type Format = ProgressFormat;
    const WORK: Work<Self, ProgressFormat> =
        Work::InSlices { canonical: FitsRequest::canonical, streamed: &[Format::Progress], compute };

    fn describe(contract: &mut Description<'_>) {
        contract
            .schema("MeasuredValues", measured_values())
            .answer::<FitAnswer>()
            .table(
                "One row for each measured impact: measured less fitted values.",
                COLUMNS_OF_RESIDUALS.iter().map(RowColumn::word),
            )
            .end_of::<FitAnswer>(FitAnswer::END)
            .line::<Line<'static>>()
            .line::<FitProgressEnd>()
            .line::<FitProgressFailure>();
    }
}

fn compute(
    request: &FitsRequest,
    format: ProgressFormat,
    slices: &TimeSlices,
    out: &mut BodyWriter,
    bounces: &Counter,
) -> Result<(), Problem> {
    let tells = format == ProgressFormat::Progress;
    slices.run_one(|slice| {
        let mut tell = |step: Step| {
            if tells {
                out.send(line(&Line { progress: &step }));
            }
        };
        match FitAnswer::compute(request, &mut tell, &mut || slice.should_continue()) {
            Ok(answer) => {
                bounces.inc_by(answer.bounces);
                out.send_whole(format.write(&answer, slice)?, slice)?;
            }
            Err(problem) if tells && !slice.cancel().is_set() => out.send(failure(&problem)),
            Err(problem) => return Err(problem),
        }
        Ok(())
    })?
}

/// A fitted field.
#[derive(Debug, Serialize, JsonSchema)]
struct FitEstimate {
    field: &'static str,
    /// Best value. If the data do not determine it, the value at which the search ended.
    value: f64,
    /// Standard deviation. Null if the data do not determine the value.
    sd: Option<f64>,
    /// The 95 % interval, cut to the range of the field. Null if the data do not determine the value.
    interval: Option<[f64; 2]>,
    unit: &'static str,
    /// True if the data determine the value.
    identifiable: bool,
    /// Reason why the data do not determine the value, or how `sd` and `interval` were adjusted. Null if there is nothing to say.
    detail: Option<String>,
}

impl From<&Estimate> for FitEstimate {
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
struct FitQuality {
    #[schemars(with = "FitQualityKind")]
    kind: &'static str,
    /// The reason, with numbers.
    detail: String,
}

/// Standard deviations of the columns, as given or as estimated. Null for a column that was not measured.
#[derive(Debug, Clone, Serialize, JsonSchema)]
struct FitDeviations {
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
    estimates: Vec<FitEstimate>,
    /// Correlations of the estimates, in their order. Null for a field that the data do not determine.
    correlation: Vec<Vec<Option<f64>>>,
    #[schemars(with = "FitResiduals")]
    residuals: Table,
    sd: FitDeviations,
    /// Sum of the squares of residuals over standard deviations, outliers left out.
    chi_squared: f64,
    /// Number of values less that of unknowns, initial states of the windows included.
    degrees_of_freedom: f64,
    quality: FitQuality,
    /// Number of windows.
    windows: usize,
    /// Iterations of all stages together.
    iterations: usize,
    /// The scene with the estimates that the data determine, ready to run.
    scene: Resolved,
    stability: RegionAnswer,
    notes: Vec<String>,
    /// Contacts that were computed, about.
    #[serde(skip)]
    pub bounces: u64,
    #[serde(skip)]
    rows: Vec<FittedRow>,
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
        let found = fit(&request.fit, &mut tell_fit, go_on).map_err(|why| problem(request, why))?;
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
            estimates: estimates.iter().map(FitEstimate::from).collect(),
            correlation: (0..count).map(|one| (0..count).map(|other| correlation(one, other)).collect()).collect(),
            residuals: table_of(&COLUMNS_OF_RESIDUALS, &rows),
            sd: FitDeviations { theta, x_dot, y_dot, theta_dot, x, t },
            chi_squared,
            degrees_of_freedom,
            quality: FitQuality { kind: quality.kind.name(), detail: quality.detail },
            windows,
            iterations,
            scene: Resolved(scene),
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
#[rustfmt::skip]
const COLUMNS_OF_RESIDUALS: [RowColumn<FittedRow>; COLUMNS.len() + 4] = [
    RowColumn::new("n", "", "Number of the impact, as given or as found.", Read::Count(|row| row.n)),
    RowColumn::new("row", "", "Row in the data, from 1.", Read::Count(|row| row.row as u64 + 1)),
    RowColumn::new("window", "", "Window of impacts with an initial state of its own, from 1.", Read::Count(|row| row.window as u64 + 1)),
    residual::<0>(),
    residual::<1>(),
    residual::<2>(),
    residual::<3>(),
    residual::<4>(),
    residual::<5>(),
    RowColumn::new("outlier", "", "True if a value of the row was left out.", Read::Flag(|row| Some(row.outliers.contains(&true)))),
];

const fn residual<const COLUMN: usize>() -> RowColumn<FittedRow> {
    let (name, unit) = COLUMNS[COLUMN];
    RowColumn::new(name, unit, "", Read::Sparse(|row| row.residuals[COLUMN]))
}

column_lists! {
    /// Measured less fitted values, a row for each impact that takes part. Columns of one length.
    pub FitResiduals = COLUMNS_OF_RESIDUALS.iter().map(RowColumn::word);
}

impl Tabular for FitAnswer {
    const END: &'static [&'static str] =
        &["estimates", "chi_squared", "degrees_of_freedom", "quality", "scene", "stability", "notes"];

    fn to_table(&self) -> Cow<'_, Table> {
        Cow::Borrowed(&self.residuals)
    }

    fn in_table(&self) -> &'static [&'static str] {
        &["residuals"]
    }
}

/// The verdict on the fitted scene, as of `/v1/stability`, and its linear margins over the 95 % region of the told fields.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FitStability")]
pub struct RegionAnswer {
    verdict: VerdictAnswer,
    nonlinear: NonlinearPart,
    chaos: Option<Chaos>,
    /// Margins of small deviations. Empty without a bounce in place.
    margins: Vec<Margin>,
    /// 1 less the spectral radius. Null where the tilt gain has a range, and without a bounce in place.
    spectral_margin: Option<SpectralMargin>,
    /// True if `least` of each margin is above 0. Null without margins, if `quality` is neither `good` nor `deviations_too_large`, or if a field
    /// is not told.
    holds: Option<bool>,
}

/// 1 less the spectral radius, over the confidence region.
#[derive(Debug, Serialize, JsonSchema)]
struct SpectralMargin {
    value: f64,
    /// Standard deviation, by the derivatives by the fields.
    sd: f64,
    /// Least over the region: at the ends of its axes, and where a margin is least or greatest to first order.
    least: f64,
    /// Greatest there.
    most: f64,
}

/// Share of a standard deviation by which a margin is differentiated.
const STEP: f64 = 0.05;

/// Normal deviate of the 95 % quantile.
const UPPER: f64 = 1.644_853_627;

/// The margins of a scene.
struct Margins {
    /// By field.
    of_fields: Vec<Margin>,
    /// 1 less the spectral radius, where the tilt gain has no range.
    spectral: Option<f64>,
}

impl Margins {
    /// Those of small deviations; `None` without a bounce in place.
    fn of(scene: &Scene) -> Option<Self> {
        let judged = scene.with_tilt_law();
        // The linear verdict does not see what a turning table does to a swing.
        if judged.acting_turn().is_some() {
            return None;
        }
        let small = small_deviations(&judged).ok()?;
        let steers = judged.steers_energy();
        let mut of_fields = Margin::of_small(&judged, &small);
        of_fields.retain(|margin| steers || margin.field != ENERGY_GAIN);
        let has_range = of_fields.iter().any(|margin| margin.field == TILT_GAIN);
        let spectral = (!has_range).then(|| 1.0 - small.linear.spectral_radius());
        Some(Self { of_fields, spectral })
    }

    /// A margin, if there is one.
    fn value(&self, key: Key) -> Option<f64> {
        match key {
            Key::Spectral => self.spectral,
            Key::FitEnd(field, side) => {
                Some(self.of_fields.iter().find(|margin| margin.field == field)?.end(side)?.margin)
            }
        }
    }

    /// Those that there are.
    fn keys(&self) -> impl Iterator<Item = Key> {
        let end = |margin: &Margin| Side::ALL.map(|side| Key::FitEnd(margin.field, side));
        self.of_fields.iter().flat_map(end).chain([Key::Spectral]).filter(|key| self.value(*key).is_some())
    }
}

/// A margin among those of a scene.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Key {
    FitEnd(&'static str, Side),
    Spectral,
}

/// The fitted scene with its fields moved, within their ranges.
fn moved(fit: &Fit, by: &[f64]) -> Option<Scene> {
    let mut draft = fit.scene.draft();
    for (estimate, by) in fit.estimates.iter().zip(by).filter(|(estimate, _)| estimate.is_identifiable()) {
        let (name, value) = (estimate.name, estimate.value + by);
        let kept = Some(Value::Number(value)).filter(|&value| name.row().admits(value));
        draft.set(name, Some(kept.unwrap_or(Value::Number(estimate.value)))).ok()?;
    }
    draft.build().ok()
}

/// Radius of the 95 % region, in standard deviations.
fn radius(fit: &Fit) -> f64 {
    let told = fit.estimates.iter().filter(|estimate| estimate.is_identifiable()).count();
    chi_squared_quantile(told.max(1) as f64, UPPER).sqrt()
}

/// Changes of the fields at which a margin with these slopes is least and greatest over the 95 % region, to first order.
fn extremes(fit: &Fit, slopes: &[f64]) -> Option<[Vec<f64>; 2]> {
    let product = |row: &Vec<f64>| row.iter().zip(slopes).map(|(covariance, slope)| covariance * slope).sum::<f64>();
    let along: Vec<f64> = fit.covariance.iter().map(product).collect();
    let variance: f64 = along.iter().zip(slopes).map(|(along, slope)| along * slope).sum();
    let scale = Some(radius(fit) / variance.sqrt()).filter(|scale| scale.is_finite())?;
    Some([scale, -scale].map(|scale| along.iter().map(|along| scale * along).collect()))
}

/// Ends of the axes of the 95 % region, as changes of the fields: those of the columns of a Cholesky factor of the covariance, which lie on its edge.
fn ends(fit: &Fit) -> Vec<Vec<f64>> {
    let (radius, count) = (radius(fit), fit.covariance.len());
    let mut factor = vec![vec![0.0; count]; count];
    for row in 0..count {
        for column in 0..=row {
            let known: f64 = (0..column).map(|k| factor[row][k] * factor[column][k]).sum();
            let left = fit.covariance[row][column] - known;
            factor[row][column] = if row == column {
                left.max(0.0).sqrt()
            } else if factor[column][column] > 0.0 {
                left / factor[column][column]
            } else {
                0.0
            };
        }
    }
    let axis = |column: usize, sign: f64| (0..count).map(|row| sign * radius * factor[row][column]).collect();
    (0..count).flat_map(|column| [axis(column, 1.0), axis(column, -1.0)]).collect()
}

impl RegionAnswer {
    /// Judges the fitted scene, and looks at the region.
    ///
    /// # Errors
    /// Cancelled work.
    fn compute(fit: &Fit, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Refusal> {
        let request = StabilityRequest {
            scene: fit.scene,
            bounces: DEFAULT_BOUNCES,
            basin: false,
            budget: false,
            release_margins: false,
            tolerances: None,
        };
        let judged = StabilityAnswer::compute(&request, &mut *go_on).ok_or(Cancelled)?;
        let StabilityAnswer { mut verdict, nonlinear, chaos, .. } = judged;
        // The verdict is on a scene that the data tell in part only.
        if let Some(kept) = &fit.kept {
            verdict.reason = format!("with {kept}: {}", verdict.reason);
        }
        let is_trusted = matches!(fit.quality.kind, QualityKind::Good | QualityKind::DeviationsTooLarge);
        let has_region = is_trusted && fit.estimates.iter().all(Estimate::is_identifiable);
        let (margins, spectral_margin, holds) = match Self::margins(fit) {
            Some((margins, spectral, holds)) => (margins, spectral, Some(holds)),
            None => (Vec::new(), None, None),
        };
        Ok(Self { verdict, nonlinear, chaos, margins, spectral_margin, holds: holds.filter(|_| has_region) })
    }

    fn margins(fit: &Fit) -> Option<(Vec<Margin>, Option<SpectralMargin>, bool)> {
        let here = Margins::of(&fit.scene)?;
        let keys: Vec<Key> = here.keys().collect();
        let count = fit.estimates.len();
        // Changes of all margins by a step of each field, over the step.
        let mut slopes = vec![vec![0.0; count]; keys.len()];
        for (field, estimate) in fit.estimates.iter().enumerate() {
            let Some(sd) = estimate.sd.filter(|sd| *sd > 0.0) else { continue };
            let at = |share: f64| {
                let by: Vec<f64> = (0..count).map(|other| if other == field { share * sd } else { 0.0 }).collect();
                let found = moved(fit, &by).and_then(|scene| Margins::of(&scene))?;
                keys.iter().map(|key| found.value(*key)).collect::<Option<Vec<f64>>>()
            };
            let (high, low) = (at(STEP)?, at(-STEP)?);
            for (slopes, (high, low)) in slopes.iter_mut().zip(high.iter().zip(&low)) {
                slopes[field] = (high - low) / (2.0 * STEP * sd);
            }
        }
        let extremes = slopes.iter().filter_map(|slopes| extremes(fit, slopes)).flatten();
        let judged: Vec<_> = ends(fit).into_iter().chain(extremes).map(|by| Margins::of(&moved(fit, &by)?)).collect();
        // An end without a bounce in place has no margins, so nothing holds there.
        let has_all = |found: &Margins| keys.iter().all(|key| found.value(*key).is_some());
        let all_judged = judged.iter().all(|found| found.as_ref().is_some_and(has_all));
        let ends: Vec<Margins> = judged.into_iter().flatten().collect();
        let region = |key: Key| {
            let (place, value) = (keys.iter().position(|other| *other == key)?, here.value(key)?);
            let variance: f64 = (0..count * count)
                .map(|pair| (pair / count, pair % count))
                .map(|(one, other)| slopes[place][one] * fit.covariance[one][other] * slopes[place][other])
                .sum();
            let values = ends.iter().filter_map(|end| end.value(key));
            let (least, most) = values.fold((value, value), |(least, most), end| (least.min(end), most.max(end)));
            Some(SpectralMargin { value, sd: variance.max(0.0).sqrt(), least, most })
        };
        let holds = all_judged
            && !keys.is_empty()
            && keys.iter().all(|key| region(*key).is_some_and(|margin| margin.least > 0.0));
        let spectral = region(Key::Spectral);
        let mut found = here.of_fields.clone();
        for margin in &mut found {
            let field = margin.field;
            for (side, end) in [(Side::Below, &mut margin.below), (Side::Above, &mut margin.above)] {
                if let (Some(end), Some(SpectralMargin { sd, least, most, .. })) =
                    (end, region(Key::FitEnd(field, side)))
                {
                    (end.sd, end.least, end.most) = (Some(sd), Some(least), Some(most));
                }
            }
        }
        Some((found, spectral, holds))
    }
}

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
struct Line<'a> {
    progress: &'a Step,
}

/// The last line with progress, if there is no fit. Without progress this is the answer, with the status of its `status`.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "a schema alone")]
struct FitProgressFailure {
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
    fn to_verdict(iterations: usize, of: u64) -> Self {
        Self { done: of, of, stage: VERDICT, search: 0, iterations, residual: None }
    }
}

/// The last line of a fit that failed, because the status has been sent.
fn failure(problem: &Problem) -> Vec<u8> {
    [b"{\"problem\":", problem.to_json().as_slice(), b"}\n"].concat()
}

/// Names of all stages, in their order.
pub fn stages() -> Vec<&'static str> {
    FitStage::ALL.into_iter().map(FitStage::name).chain([VERDICT]).collect()
}

/// Symbols of the columns.
const SYMBOLS: [&str; COLUMNS.len()] = ["δθ", "δẋ", "δẏ", "δθ̇", "δx", "δt"];

impl Pictured for FitAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let plots = (0..COLUMNS.len())
            .filter(|&column| self.rows.iter().any(|row| row.residuals[column].is_some()))
            .enumerate()
            .map(|(place, column)| {
                let points = |is_outlier: bool| {
                    let taken = self.rows.iter().filter(move |row| row.outliers[column] == is_outlier);
                    taken.filter_map(move |row: &FittedRow| Some((row.n as f64, row.residuals[column]?))).collect()
                };
                let (name, unit) = COLUMNS[column];
                // The first panel has the labels of all.
                let label = |label| if place == 0 { label } else { "" };
                Plot::new(ChartAxis::new("impact", "n", ""), ChartAxis::new(name, SYMBOLS[column], unit)).with(vec![
                    Curve::new(label("residual"), CurveStyle::TruthDots, points(false)),
                    Curve::new(label("outlier"), CurveStyle::WrongRings, points(true)),
                ])
            })
            .collect();
        let told = self.estimates.iter().map(|estimate| {
            let value = significant(estimate.value, 6);
            let unit = if estimate.unit == "1" { "" } else { estimate.unit };
            estimate.sd.map_or_else(
                || format!("{} is not told", estimate.field),
                |sd| format!("{} = {value} ± {} {unit}", estimate.field, significant(sd, 2)),
            )
        });
        Ok(chart(&Chart {
            title: "Measured less fitted impacts",
            subtitle: told.collect::<Vec<_>>().join(", "),
            caption: format!(
                "χ² is {} at {} degrees of freedom.",
                significant(self.chi_squared, 4),
                self.degrees_of_freedom
            ),
            plots,
        }))
    }
}

impl Watched for FitAnswer {
    fn to_pictures(&self) -> Result<Vec<(&'static str, String)>, Problem> {
        Ok(vec![("residuals", self.to_picture()?)])
    }
}

/// The last line of a fit with progress. Without it or a problem the answer is incomplete.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "a schema alone")]
struct FitProgressEnd {
    end: FitAnswer,
    pictures: FitPictures,
}

/// Pictures as SVG, the same bytes as with `format=svg`.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "a schema alone")]
struct FitPictures {
    residuals: String,
}
