//! The verdict on a fitted scene, and its margins over the confidence region of the fitted fields.

use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::fitting::{Estimate, Fit, QualityKind, chi_squared_quantile};
use equipoise_physics::scene::{Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::refusal::Refusal;
use crate::api::stability::answer::{Judgement, StabilityAnswer};
use crate::api::stability::linear::LinearPart;
use crate::api::stability::request::{DEFAULT_IMPACTS, StabilityRequest};
use crate::compute::Cancelled;
use crate::words;

words! {
    /// Name of a margin. `spectral_radius`: 1 less that of the closed loop.
    pub FitMarginName = ["tilt_gain_below", "tilt_gain_above", "spectral_radius", "energy_gain"];
}

/// The verdict on the fitted scene, as of `/v1/stability`, and its linear margins over the 95 % region of the told fields.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FitStability")]
pub struct RegionAnswer {
    #[serde(flatten)]
    judgement: Judgement,
    /// Distances from the ends of the linear verdict, above 0 where it is stable. Empty without a bounce in place.
    margins: Vec<Margin>,
    /// True if `least` of each margin is above 0. Null without margins, if `quality` is neither `good` nor `deviations_too_large`, or if a field
    /// is not told.
    holds: Option<bool>,
}

/// A margin over the confidence region.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "FitMargin")]
struct Margin {
    #[schemars(with = "FitMarginName")]
    name: &'static str,
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

/// Margins of a scene by its linear verdict; `None` without a bounce in place.
fn margins(scene: &Scene) -> Option<Vec<(&'static str, f64)>> {
    let judged = scene.with_tilt_law();
    // The linear verdict does not see what a turning table does to a swing.
    if judged.acting_turn().is_some() {
        return None;
    }
    let linear = LinearPart::new(&judged, &small_deviations(&judged).ok()?.linear);
    let steers = judged.steers_energy();
    Some(linear.margins().into_iter().filter(|(name, _)| steers || *name != "energy_gain").collect())
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
    pub(super) fn compute(fit: &Fit, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Refusal> {
        let request = StabilityRequest {
            scene: fit.scene,
            impacts: DEFAULT_IMPACTS,
            basin: false,
            budget: false,
            dial: false,
            gain_margins: false,
            tolerances: None,
        };
        let mut judgement = StabilityAnswer::compute(&request, &mut *go_on).ok_or(Cancelled)?.judgement();
        // The verdict is on a scene that the data tell in part only.
        if let Some(kept) = &fit.kept {
            judgement.reason = format!("with {kept}: {}", judgement.reason);
        }
        let is_trusted = matches!(fit.quality.kind, QualityKind::Good | QualityKind::DeviationsTooLarge);
        let has_region = is_trusted && fit.estimates.iter().all(Estimate::is_identifiable);
        let (found, holds) = Self::margins(fit).map_or((Vec::new(), None), |(found, holds)| (found, Some(holds)));
        Ok(Self { judgement, margins: found, holds: holds.filter(|_| has_region) })
    }

    fn margins(fit: &Fit) -> Option<(Vec<Margin>, bool)> {
        let here = margins(&fit.scene)?;
        let count = fit.estimates.len();
        // Changes of all margins by a step of each field, over the step.
        let mut slopes = vec![vec![0.0; count]; here.len()];
        for (field, estimate) in fit.estimates.iter().enumerate() {
            let Some(sd) = estimate.sd.filter(|sd| *sd > 0.0) else { continue };
            let at = |share: f64| {
                let by: Vec<f64> = (0..count).map(|other| if other == field { share * sd } else { 0.0 }).collect();
                moved(fit, &by).and_then(|scene| margins(&scene)).filter(|found| found.len() == here.len())
            };
            let (high, low) = (at(STEP)?, at(-STEP)?);
            for (slopes, (high, low)) in slopes.iter_mut().zip(high.iter().zip(&low)) {
                slopes[field] = (high.1 - low.1) / (2.0 * STEP * sd);
            }
        }
        let extremes = slopes.iter().filter_map(|slopes| extremes(fit, slopes)).flatten();
        let judged: Vec<_> = ends(fit).into_iter().chain(extremes).map(|by| margins(&moved(fit, &by)?)).collect();
        // An end without a bounce in place has no margins, so nothing holds there.
        let all_judged = judged.iter().all(|found| found.as_ref().is_some_and(|found| found.len() == here.len()));
        let ends: Vec<_> = judged.into_iter().flatten().collect();
        let of_margin = |(place, (name, value)): (usize, &(&'static str, f64))| {
            let variance: f64 = (0..count * count)
                .map(|pair| (pair / count, pair % count))
                .map(|(one, other)| slopes[place][one] * fit.covariance[one][other] * slopes[place][other])
                .sum();
            let values = ends.iter().filter_map(|end| end.get(place)).map(|end| end.1);
            let (least, most) = values.fold((*value, *value), |(least, most), end| (least.min(end), most.max(end)));
            Margin { name, value: *value, sd: variance.max(0.0).sqrt(), least, most }
        };
        let found: Vec<Margin> = here.iter().enumerate().map(of_margin).collect();
        let holds = all_judged && !found.is_empty() && found.iter().all(|margin| margin.least > 0.0);
        Some((found, holds))
    }
}
