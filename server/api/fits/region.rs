//! The verdict on a fitted scene, and its margins over the confidence region of the fitted fields.

use equipoise_physics::analysis::small_deviations::small_deviations;
use equipoise_physics::fitting::{Estimate, Fit, QualityKind, chi_squared_quantile};
use equipoise_physics::scene::{Scene, Value};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::shared::margins::{ENERGY_GAIN, Margin, Side, TILT_GAIN};
use crate::api::shared::refusal::Refusal;
use crate::api::stability::answer::{NonlinearPart, StabilityAnswer};
use crate::api::stability::evidence::Chaos;
use crate::api::stability::request::{DEFAULT_BOUNCES, StabilityRequest};
use crate::api::stability::verdict_name::VerdictAnswer;
use crate::compute::Cancelled;

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
            Key::End(field, side) => {
                Some(self.of_fields.iter().find(|margin| margin.field == field)?.end(side)?.margin)
            }
        }
    }

    /// Those that there are.
    fn keys(&self) -> impl Iterator<Item = Key> {
        let end = |margin: &Margin| Side::ALL.map(|side| Key::End(margin.field, side));
        self.of_fields.iter().flat_map(end).chain([Key::Spectral]).filter(|key| self.value(*key).is_some())
    }
}

/// A margin among those of a scene.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Key {
    End(&'static str, Side),
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
    pub(super) fn compute(fit: &Fit, go_on: &mut dyn FnMut() -> bool) -> Result<Self, Refusal> {
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
                if let (Some(end), Some(SpectralMargin { sd, least, most, .. })) = (end, region(Key::End(field, side)))
                {
                    (end.sd, end.least, end.most) = (Some(sd), Some(least), Some(most));
                }
            }
        }
        Some((found, spectral, holds))
    }
}
