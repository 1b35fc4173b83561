//! The end of a fit: outliers left out, values far from the best looked at, intervals, residuals and the judgement.

use super::answer::{Fit, FitFailure, FitStage, FittedRow, Quality, QualityKind};
use super::confidence::{Estimate, Information, acts};
use super::elimination::reduce;
use super::impact_map::{STATES, Vector};
use super::measured::{COLUMNS, MeasuredRow};
use super::search::{BESIDE, FAR, FAR_OFF, FINE, FROM_START, Search};
use super::solver::{Minimum, Point};
use super::statistics::{OUTLIER, chi_squared_deviate, chi_squared_quantile};
use crate::scene::Name;

/// Most rounds of leaving out outliers.
const OUTLIER_ROUNDS: usize = 5;
/// Share of the values up to which outliers are single. Beyond it the model is wrong, not the data.
const MOST_OUTLIERS: f64 = 0.1;
/// Distance, in standard deviations, at which the rise of χ² is looked at.
const PROFILE: f64 = 6.0;
/// Standard deviation, over the scale of the field and the number of impacts to the power −3/2, below which no swing that is noise is told:
/// the error of a frequency falls like that power.
const SHARP: f64 = 0.2;
/// Distance from the first value, in scales of the field, beyond which a better minimum is looked for from there.
const WENT_FAR: f64 = 0.25;
/// Rise of χ² of which a share is enough, however far off.
const MOST_RISE: f64 = 100.0;
/// Rise, in [`MOST_RISE`], from which a slow search beside the minimum is given up: as far off as a motion without the swing.
const HOPELESS: f64 = 100.0;
/// Angle and angular velocity in a state.
const SWING: [usize; 2] = [0, 3];
/// Effort of the fit without a swing.
const STILL: (usize, f64) = (20, 0.1);
/// Normal deviate beyond which a swing is no chance: one of thirty thousand is beyond it.
const NO_SWING: f64 = 4.0;
/// Share of the rise of a parabola that tells an estimate from any other value.
const LEAST_RISE: f64 = 0.25;
/// Share of it below which the standard deviation is not that of the curvature, but the one that the rise shows.
const PARABOLIC: f64 = 0.75;

/// Normal deviate beyond which χ², or the correlation of neighbours, is no chance: one of a thousand is beyond it.
const NO_CHANCE: f64 = 3.3;

impl Search<'_> {
    /// Leaves out outliers, one round after another until they stay the same.
    pub(super) fn leave_out(&mut self, mut point: Point) -> Result<Minimum, FitFailure> {
        self.watch.enter(FitStage::Outliers);
        let mut before = None;
        for _ in 0..OUTLIER_ROUNDS {
            self.update_sd(&point, before.is_none());
            let residuals = self.problem.residuals(&point).ok_or(FitFailure::RunEnds)?;
            let far: Vec<[bool; STATES]> =
                residuals.iter().map(|row| row.map(|residual| residual.abs() > OUTLIER)).collect();
            let count = far.iter().flatten().filter(|far| **far).count();
            let values = self.problem.rows.iter().flat_map(|row| row.values).filter(|value| !value.is_nan()).count();
            let are_single = count as f64 <= (MOST_OUTLIERS * values as f64).max(2.0);
            for (row, far) in self.problem.rows.iter_mut().zip(&far) {
                row.outlier = if are_single { *far } else { [false; STATES] };
            }
            self.problem.robust = false;
            let found = self.settle(point, FINE)?;
            let is_same = before.as_ref() == Some(&far);
            if is_same || (!are_single && before.is_some()) {
                return Ok(found);
            }
            (before, point) = (Some(far), found.point);
        }
        self.settle(point, FINE)
    }

    pub(super) fn information(&mut self, minimum: &Minimum) -> Result<Information, FitFailure> {
        self.watch.enter(FitStage::Beside);
        let point = &minimum.point;
        let blocks = self.problem.linearize(point, self.watch.go_on);
        if !(self.watch.go_on)() {
            return Err(FitFailure::Cancelled);
        }
        let Some(blocks) = blocks else { return Ok(Information::missing(&self.problem.names)) };
        let (factor, _) = reduce(&blocks, &vec![0.0; self.problem.names.len()], 0.0);
        let values = (point.fields.as_slice(), self.typed.as_slice());
        let mut information =
            Information::new(&self.problem.draft, (&self.problem.names, &self.shifts), values, &factor, &blocks);
        self.doubt_swing(minimum, &mut information)?;
        information.withdraw(&self.problem.names, &point.fields);
        Ok(information)
    }

    /// Doubts fields that act through the swing alone, where a motion without swing explains the data. The fit then chose the frequency that
    /// follows the noise best, and its curvature there says nothing (Davies 1977).
    fn doubt_swing(&mut self, minimum: &Minimum, information: &mut Information) -> Result<(), FitFailure> {
        let (mut still, mut start) = (self.problem.clone(), minimum.point.clone());
        still.active.retain(|component| !SWING.contains(component));
        if still.active.len() == self.problem.active.len() {
            return Ok(());
        }
        for at in &mut start.starts {
            for component in SWING {
                at[component] = 0.0;
            }
        }
        for (field, name) in still.names.iter().enumerate() {
            if matches!(name, Name::Theta | Name::ThetaDot) {
                (still.held[field], start.fields[field]) = (true, 0.0);
            }
        }
        let Some(found) = self.watch.minimize(&still, start, STILL)? else { return Ok(()) };
        // Of χ², or of F where standard deviations are estimated from the same residuals.
        let freedom = self.problem.freedom();
        let rise = found.cost - minimum.cost;
        let told = if self.estimates_sd() { freedom * libm::log(1.0 + rise / minimum.cost) } else { rise };
        // Of a swing at one of as many frequencies as there are impacts.
        let swings = (SWING.len() * self.problem.windows.len()) as f64;
        let chance = chi_squared_quantile(swings, NO_SWING) + 2.0 * libm::log(self.problem.rows.len() as f64);
        if told > chance {
            return Ok(());
        }
        let Some(blocks) = still.linearize(&found.point, self.watch.go_on) else { return Ok(()) };
        for (field, name) in still.names.iter().enumerate() {
            if information.untold[field].is_none() && !acts(&blocks, field, information.scales[field]) {
                information.untold[field] = Some(format!(
                    "{} acts through the swing alone, and a motion without swing explains the data: chi_squared is {told} larger, and up to \
                     {chance} may be chance; measure a run that swings more",
                    name.row().path
                ));
            }
        }
        Ok(())
    }

    /// Tells whether the standard deviation of a measured column is estimated.
    fn estimates_sd(&self) -> bool {
        (0..STATES).any(|column| self.measured[column] && self.request.sd[column].is_none())
    }

    /// Looks at χ² some standard deviations away from each estimate: an estimate beside which far values fit as well is none. Gives a better
    /// minimum, if it meets one.
    pub(super) fn profile(
        &mut self,
        minimum: &Minimum,
        information: &mut Information,
    ) -> Result<Option<Minimum>, FitFailure> {
        // At the end of a bent valley the standard deviation is no measure of the way there.
        let mut ways = self.typed.iter().zip(&minimum.point.fields).zip(&information.scales);
        let went_far = ways.any(|((start, end), scale)| (start - end).abs() > WENT_FAR * scale);
        for field in 0..self.problem.names.len() {
            if information.untold[field].is_some() {
                continue;
            }
            let (sd, scale) = (information.sd(field), information.scales[field]);
            let (row, value) = (self.problem.names[field].row(), minimum.point.fields[field]);
            let near = [-PROFILE * sd, PROFILE * sd].map(|off| (off, BESIDE));
            // Far off lie the other minima of a swing whose phase is lost in noise.
            let rows = self.problem.rows.len() as f64;
            let is_sharp = sd < SHARP * scale / (rows * rows.sqrt());
            let far = FAR.iter().filter(|_| !is_sharp).map(|off| (off * scale, FAR_OFF));
            // Along a bent valley, such as κ − 1 ∝ ρ² of a small swing, a fit may slide far from first values that fit as well.
            let typed = (self.typed[field] - value, FROM_START);
            for (off, effort) in near.into_iter().chain(far).chain([typed]) {
                let aside = row.clamped(value + off);
                let distance = (aside - value) / sd;
                let went_far = went_far && effort == FROM_START;
                let is_near = distance.abs() < if effort == BESIDE || went_far { 0.5 * PROFILE } else { PROFILE };
                if is_near && !went_far {
                    continue;
                }
                let promised = (distance * distance).min(MOST_RISE);
                let mut start = minimum.point.clone();
                for (other, along) in start.fields.iter_mut().enumerate() {
                    let slope = information.covariance(field, other) / (sd * sd);
                    *along = self.problem.names[other].row().clamped(*along + slope * (aside - value));
                }
                start.fields[field] = aside;
                if effort == FROM_START {
                    start.fields.clone_from(&self.typed);
                }
                if effort != BESIDE {
                    let Some(guessed) = self.problem.clone().guessed(start.fields.clone()) else { continue };
                    if guessed.starts.len() == start.starts.len() {
                        start = guessed;
                    }
                }
                let mut held = self.problem.clone();
                held.held[field] = true;
                held.hopeless = minimum.cost + HOPELESS * MOST_RISE;
                let Some(found) = self.watch.minimize(&held, start, effort)? else { continue };
                let rise = found.cost - minimum.cost;
                if rise < -1e-3 * minimum.cost.max(1.0) {
                    return self.watch.minimize(&self.problem, found.point, FINE);
                }
                if !is_near && distance * distance <= MOST_RISE && rise < PARABOLIC * promised {
                    information.widen(field, (promised / rise.max(1.0)).sqrt());
                }
                if !is_near && rise < LEAST_RISE * promised {
                    let reason = format!(
                        "values far from the best fit the data nearly as well: at {} = {aside} {} chi_squared is {rise} larger, where its \
                         curvature promises {promised} or more",
                        row.path,
                        if row.unit == "1" { "" } else { row.unit }
                    );
                    // Fields that moved along are told no better.
                    for (other, moved) in found.point.fields.iter().enumerate() {
                        let distance = (moved - minimum.point.fields[other]) / information.sd(other);
                        if other == field || distance.abs() > PROFILE {
                            information.untold[other].get_or_insert_with(|| reason.clone());
                        }
                    }
                    break;
                }
            }
        }
        Ok(None)
    }

    /// Judges a fit by χ² (which says something where a standard deviation was given), by the length of its windows, and by the correlation of
    /// neighbouring residuals.
    fn judge(&self, minimum: &Minimum, freedom: f64, rows: &[FittedRow]) -> Quality {
        let (chi_squared, all_given) = (minimum.cost, !self.estimates_sd());
        let ratio = chi_squared / freedom;
        let deviate = if all_given { chi_squared_deviate(chi_squared, freedom) } else { 0.0 };
        let (kind, detail) = if !minimum.converged {
            let detail = "the iterations ran out before the minimum was found; the estimates are not to be used";
            (QualityKind::NotConverged, detail.to_owned())
        } else if deviate > NO_CHANCE {
            let detail = format!(
                "chi_squared is {ratio} per degree of freedom, {deviate} standard deviations too much: the model does not explain the \
                 data at these sd, so neither estimates nor intervals are to be trusted"
            );
            (QualityKind::NotExplained, detail)
        } else if deviate < -NO_CHANCE {
            let detail = format!(
                "chi_squared is {ratio} per degree of freedom: sd are larger than the residuals show, and so are the intervals"
            );
            (QualityKind::DeviationsTooLarge, detail)
        } else if !self.is_followed {
            let longest_window = self.problem.windows.iter().map(|range| range.len()).max().unwrap_or(0);
            let detail = format!(
                "windows of up to {longest_window} impacts explain the data and longer ones do not: something that adds up from impact to impact \
                 is missing in the model, a wrong field or noise of the table; estimates are those of the short windows"
            );
            (QualityKind::NotFollowed, detail)
        } else if let Some((column, correlation, count)) = neighbours(rows).filter(|found| strength(found) > NO_CHANCE)
        {
            let detail = format!(
                "neighbouring residuals of {column} have a correlation of {correlation}, which {count} random ones would not have: the model \
                 may not explain the data"
            );
            (QualityKind::NotRandom, detail)
        } else if all_given {
            let detail =
                format!("chi_squared is {ratio} per degree of freedom, as the sd say, and residuals look random");
            (QualityKind::Good, detail)
        } else {
            let detail = "residuals look random; sd is estimated from them, so compare it with what the instruments are known for";
            (QualityKind::Good, detail.to_owned())
        };
        Quality { kind, detail }
    }

    pub(super) fn finish(mut self, point: Point, mut notes: Vec<String>) -> Result<Fit, FitFailure> {
        let mut minimum = self.leave_out(point)?;
        let (values, unknowns) = (self.problem.values(), self.problem.unknowns());
        if values < unknowns + 3 {
            return Err(FitFailure::TooFew { values, unknowns });
        }
        let mut information = self.information(&minimum)?;
        if let Some(better) = self.profile(&minimum.clone(), &mut information)? {
            minimum = self.leave_out(better.point)?;
            information = self.information(&minimum)?;
            self.profile(&minimum.clone(), &mut information)?;
        }
        information.withdraw(&self.problem.names, &minimum.point.fields);
        information.stretch();
        let freedom = (values - unknowns) as f64;
        let rows = self.fitted_rows(&minimum.point)?;
        notes.extend(self.problem.rows.iter().zip(&rows).flat_map(|(measured, fitted)| outliers(measured, fitted)));
        let quality = self.judge(&minimum, freedom, &rows);
        if quality.kind == QualityKind::NotConverged {
            information.untold.fill(Some(quality.detail.clone()));
        }
        let names = &self.problem.names;
        let estimates = information.estimates(names, &minimum.point.fields, self.estimates_sd(), freedom);
        let told = estimates.iter().filter(|estimate| estimate.is_identifiable());
        let draft = self.request.scene.draft().with(told.map(|estimate| (estimate.name, Some(estimate.value))));
        let draft = draft.map_err(|error| FitFailure::Scene(vec![error]))?;
        let covariance = |one| (0..names.len()).map(|other| information.covariance(one, other)).collect();
        let sd = std::array::from_fn(|column| self.measured[column].then_some(self.problem.sd[column]));
        let kept = kept_values(&estimates, &self.typed);
        notes.extend(kept.as_ref().map(|kept| {
            let told = estimates.iter().any(Estimate::is_identifiable);
            format!(
                "the fitted scene {} {kept}",
                if told { "mixes estimates with" } else { "is the one that was given, with" }
            )
        }));
        Ok(Fit {
            covariance: (0..names.len()).map(covariance).collect(),
            estimates,
            scene: draft.build().map_err(FitFailure::Scene)?,
            kept,
            rows,
            sd,
            chi_squared: minimum.cost,
            degrees_of_freedom: freedom,
            windows: self.problem.windows.len(),
            quality,
            notes,
            iterations: self.watch.iterations,
        })
    }

    pub(super) fn fitted_rows(&self, point: &Point) -> Result<Vec<FittedRow>, FitFailure> {
        let predicted = self.problem.predict(point).ok_or(FitFailure::RunEnds)?;
        let window_of = |row: usize| self.problem.windows.iter().position(|range| range.contains(&row)).unwrap_or(0);
        let fitted = |(place, (row, predicted)): (usize, (&MeasuredRow, &Vector))| FittedRow {
            n: row.n,
            row: row.index,
            window: window_of(place),
            residuals: std::array::from_fn(|column| {
                Some(row.values[column] - predicted[column]).filter(|residual| !residual.is_nan())
            }),
            outliers: row.outlier,
        };
        Ok(self.problem.rows.iter().zip(&predicted).enumerate().map(fitted).collect())
    }
}

/// Unknown fields that keep their first value in the fitted scene, in words.
fn kept_values(estimates: &[Estimate], typed: &[f64]) -> Option<String> {
    let kept = |(estimate, value): (&Estimate, &f64)| {
        let row = estimate.name.row();
        let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
        (!estimate.is_identifiable()).then(|| format!("{} = {value}{unit}", row.path))
    };
    let kept: Vec<String> = estimates.iter().zip(typed).filter_map(kept).collect();
    let words = if kept.len() == 1 { "the first value" } else { "the first values" };
    (!kept.is_empty()).then(|| format!("{words} {}, which the data do not tell", kept.join(", ")))
}

/// A sentence on each value of a row that was left out.
fn outliers(measured: &MeasuredRow, fitted: &FittedRow) -> impl Iterator<Item = String> {
    let (left_out, row) = (measured.outlier, measured.index + 1);
    let of_column = move |column: usize| {
        let ((name, unit), value, residual) = (COLUMNS[column], measured.values[column], fitted.residuals[column]);
        let off = residual.unwrap_or(f64::NAN);
        format!("{name} of row {row} ({value} {unit}) is an outlier, left out: it is {off} {unit} from the fit")
    };
    (0..STATES).filter(move |&column| left_out[column]).map(of_column)
}

/// The strongest correlation of neighbouring residuals of a column, and their number.
fn neighbours(rows: &[FittedRow]) -> Option<(&'static str, f64, usize)> {
    /// Fewer say nothing.
    const LEAST: usize = 20;
    let of_column = |column: usize| {
        let value = |row: &FittedRow| row.residuals[column].filter(|_| !row.outliers[column]);
        let squares: f64 = rows.iter().filter_map(value).map(|residual| residual * residual).sum();
        let pairs = rows.windows(2).filter_map(|pair| Some(value(&pair[0])? * value(&pair[1])?));
        let count = pairs.clone().count();
        let correlation = pairs.sum::<f64>() / squares;
        (count >= LEAST && correlation.is_finite()).then_some((COLUMNS[column].0, correlation, count))
    };
    (0..STATES).filter_map(of_column).max_by(|a, b| strength(a).total_cmp(&strength(b)))
}

/// Size of a correlation in standard deviations of that of random residuals.
fn strength(&(_, correlation, count): &(&str, f64, usize)) -> f64 {
    correlation.abs() * (count as f64).sqrt()
}
