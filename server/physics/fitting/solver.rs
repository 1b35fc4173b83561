//! The least squares over fields and the initial states of windows, by the method of Levenberg (1944) and Marquardt (1963).
//!
//! `levenberg-marquardt` 0.15 is built on another nalgebra than ours, and takes one dense Jacobian of all unknowns: time would grow with the cube
//! of the number of windows. So the loop over the damping stands here; the linear algebra is nalgebra's.

use super::confidence::scale;
use super::elimination;
use super::elimination::{Block, Step};
use super::impact_map::{DifferentiatedMap, ImpactMap, STATES, T, Vector, differentiated};
use super::measured::MeasuredRow;
use super::statistics::{loss, weight};
use crate::numbers::dual::Dual;
use crate::scene::{Draft, Name, Value};
use nalgebra::DMatrix;
use std::ops::Range;

/// Work was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cancelled;

/// Impacts between two looks at the clock.
const LOOK_EVERY: u64 = 64;

/// The problem at one stage of a fit.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub(super) rows: Vec<MeasuredRow>,
    /// The scene that is fitted.
    pub(super) draft: Draft,
    pub(super) names: Vec<Name>,
    /// Standard deviation of each column.
    pub(super) sd: Vector,
    /// True while outliers are held back by Huber's weights.
    pub(super) robust: bool,
    pub(super) windows: Vec<Range<usize>>,
    /// Unknown components of the state at the beginning of a window.
    pub(super) active: Vec<usize>,
    /// True if the first window begins at the release of the scene.
    pub(super) from_release: bool,
    /// Fields that keep their value.
    pub(super) held: Vec<bool>,
    /// Sum of squares above which a search that has become slow is given up.
    pub(super) hopeless: f64,
    /// Standard deviations to begin with. Those that are estimated change between stages, these do not.
    pub(super) first_sd: Vector,
}

/// Size of the residuals at a point.
#[derive(Clone, Copy, Debug)]
struct Misfit {
    /// See [`Minimum::cost`].
    cost: f64,
    /// Root mean square of the residuals over the first standard deviations.
    residual: f64,
}

/// Values of all unknowns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) fields: Vec<f64>,
    /// State at the beginning of each window. Of one that begins at the release, the time alone counts.
    pub(super) starts: Vec<Vector>,
}

/// The end of a minimization.
#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) point: Point,
    /// Sum of squares over their variances, or Huber's loss in place of it.
    pub(super) cost: f64,
    /// False if the iterations ran out.
    pub(super) converged: bool,
    pub(super) iterations: usize,
}

impl Problem {
    /// The scene with values of the fields.
    pub(super) fn draft_at(&self, fields: &[f64]) -> Option<Draft> {
        let mut draft = self.draft;
        for (&name, &value) in self.names.iter().zip(fields) {
            draft.set(name, Some(Value::Number(value))).ok()?;
        }
        Some(draft)
    }

    /// The map with values of the fields.
    pub(super) fn map_at(&self, fields: &[f64]) -> Option<ImpactMap> {
        ImpactMap::new(&self.draft_at(fields)?).ok()
    }

    /// Number of the first impact of a window.
    fn first(&self, window: usize) -> u64 {
        if self.is_released(window) { 1 } else { self.rows[self.windows[window].start].n }
    }

    fn is_released(&self, window: usize) -> bool {
        self.from_release && window == 0
    }

    /// Unknown components of the state at the beginning of a window.
    pub(super) fn unknowns_of(&self, window: usize) -> &[usize] {
        // The clock is the last.
        if self.is_released(window) { &self.active[self.active.len() - 1..] } else { &self.active }
    }

    /// The state at the beginning of a window, at its first row.
    pub(super) fn start_of(&self, window: usize, point: &Point, map: &mut ImpactMap) -> Vector {
        let start = point.starts[window];
        let run = map.release.filter(|_| self.is_released(window)).and_then(|mut at| {
            at[T] += start[T];
            map.follow(1, self.rows[self.windows[window].start].n, &at)
        });
        run.unwrap_or(start)
    }

    /// Values of the rows as the model gives them; `None` where a run ends.
    pub(super) fn predict(&self, point: &Point) -> Option<Vec<Vector>> {
        let mut map = self.map_at(&point.fields)?;
        let mut values = Vec::with_capacity(self.rows.len());
        for (window, range) in self.windows.iter().enumerate() {
            let mut at = point.starts[window];
            if self.is_released(window) {
                let clock = at[T];
                at = map.release?;
                at[T] += clock;
            }
            let mut n = self.first(window);
            for row in &self.rows[range.clone()] {
                at = map.follow(n, row.n, &at)?;
                n = row.n;
                values.push(at);
            }
        }
        Some(values)
    }

    /// Residuals over their standard deviations, NaN where there is no value.
    pub(super) fn residuals(&self, predicted: &[Vector]) -> Vec<Vector> {
        let of_row = |(row, predicted): (&MeasuredRow, &Vector)| {
            std::array::from_fn(|column| (predicted[column] - row.values[column]) / self.sd[column])
        };
        self.rows.iter().zip(predicted).map(of_row).collect()
    }

    /// Sum of squares, or Huber's loss; `None` where a run ends.
    pub(super) fn cost(&self, point: &Point) -> Option<f64> {
        Some(self.misfit(point)?.cost)
    }

    /// Size of the residuals; `None` where a run ends.
    fn misfit(&self, point: &Point) -> Option<Misfit> {
        let residuals = self.residuals(&self.predict(point)?);
        let scales: Vector = std::array::from_fn(|column| self.sd[column] / self.first_sd[column]);
        let (mut cost, mut squares, mut count) = (0.0, 0.0, 0.0);
        for (row, residuals) in self.rows.iter().zip(&residuals) {
            for column in row.columns() {
                let residual = residuals[column];
                cost += if self.robust { loss(residual) } else { residual * residual };
                squares += (residual * scales[column]) * (residual * scales[column]);
                count += 1.0;
            }
        }
        Some(Misfit { cost, residual: (squares / f64::max(count, 1.0)).sqrt() }).filter(|found| found.cost.is_finite())
    }

    /// The linearized rows of each window; `Ok(None)` where a run ends.
    pub(super) fn linearize(
        &self,
        point: &Point,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Vec<Block>>, Cancelled> {
        let map = self.draft_at(&point.fields).and_then(|draft| DifferentiatedMap::new(&draft, &self.names).ok());
        let Some(mut map) = map else { return Ok(None) };
        (0..self.windows.len()).map(|window| self.linearize_window(window, point, &mut map, go_on)).collect()
    }

    fn linearize_window(
        &self,
        window: usize,
        point: &Point,
        map: &mut DifferentiatedMap,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Block>, Cancelled> {
        let (own, start) = (self.unknowns_of(window), point.starts[window]);
        let mut at = differentiated(&start);
        if self.is_released(window) {
            let Some(release) = map.release() else { return Ok(None) };
            at = release;
            at[T] = at[T] + Dual::along(start[T], T, 1.0);
        }
        let directions: Vec<usize> = own.iter().copied().chain(STATES..STATES + self.names.len()).collect();
        let rows = &self.rows[self.windows[window].clone()];
        let count = rows.iter().map(|row| row.columns().count()).sum();
        let mut matrix = DMatrix::zeros(count, directions.len() + 1);
        let (mut n, mut line) = (self.first(window), 0);
        for row in rows {
            while n < row.n {
                if n % LOOK_EVERY == 0 && !go_on() {
                    return Err(Cancelled);
                }
                let Some(next) = map.next(n, &at) else { return Ok(None) };
                (at, n) = (next, n + 1);
            }
            for column in row.columns() {
                let residual = (at[column].value - row.values[column]) / self.sd[column];
                let share = if self.robust { weight(residual).sqrt() } else { 1.0 };
                let scale = share / self.sd[column];
                for (place, &direction) in directions.iter().enumerate() {
                    matrix[(line, place)] = at[column].partials[direction] * scale;
                }
                matrix[(line, directions.len())] = residual * share;
                line += 1;
            }
        }
        let is_finite = matrix.iter().all(|value| value.is_finite());
        Ok(is_finite.then(|| Block::new(own.len(), matrix)))
    }

    /// Least and greatest change of each field.
    fn bounds(&self, point: &Point) -> Vec<(f64, f64)> {
        let of_field = |((&name, &held), &value): ((&Name, &bool), &f64)| {
            let (minimum, maximum) = name.row().range();
            if held { (0.0, 0.0) } else { (minimum - value, maximum - value) }
        };
        self.names.iter().zip(&self.held).zip(&point.fields).map(of_field).collect()
    }

    fn moved(&self, point: &Point, step: &Step) -> Point {
        let mut moved = point.clone();
        for ((value, change), &name) in moved.fields.iter_mut().zip(&step.fields).zip(&self.names) {
            let (minimum, maximum) = name.row().range();
            *value = (*value + change).clamp(minimum, maximum);
        }
        for (window, (start, changes)) in moved.starts.iter_mut().zip(&step.own).enumerate() {
            for (&component, change) in self.unknowns_of(window).iter().zip(changes) {
                start[component] += change;
            }
        }
        moved
    }

    /// A step with half the acceleration along it (Transtrum and Sethna 2012), which follows a bent valley; `None` if the acceleration is not
    /// small beside the step, and while residuals are weighted.
    fn bent(
        &self,
        point: &Point,
        blocks: &[Block],
        step: &Step,
        (bounds, ridges, damping): (&[(f64, f64)], &[f64], f64),
    ) -> Option<Step> {
        if self.robust {
            return None;
        }
        let residuals = self.residuals(&self.predict(&self.moved(point, &step.sum(AHEAD, (0.0, step))))?);
        let mut curved = Vec::with_capacity(blocks.len());
        for ((block, range), own) in blocks.iter().zip(&self.windows).zip(&step.own) {
            let (mut rows, last) = (block.rows.clone(), block.rows.ncols() - 1);
            let values = range.clone().flat_map(|row| self.rows[row].columns().map(move |column| (row, column)));
            for (line, (row, column)) in values.enumerate() {
                let by = |(place, change): (usize, &f64)| block.rows[(line, place)] * change;
                let slope: f64 = own.iter().chain(&step.fields).enumerate().map(by).sum();
                let change = residuals[row][column] - block.rows[(line, last)];
                rows[(line, last)] = 2.0 / AHEAD * (change / AHEAD - slope);
            }
            curved.push(Block::new(block.own, rows));
        }
        let acceleration = elimination::step(&curved, bounds, ridges, damping);
        let is_small = acceleration.size(blocks) <= MOST_BENT * step.size(blocks);
        is_small.then(|| step.sum(1.0, (0.5, &acceleration)))
    }

    /// Minimizes the squares from a point, until a step promises a fall of less than `negligible`; `Ok(None)` if a run ends there already.
    /// Calls `told` with the iterations so far and the root mean square of the residuals over the first standard deviations.
    pub(super) fn minimize(
        &self,
        start: Point,
        (most_iterations, negligible): (usize, f64),
        told: &mut dyn FnMut(usize, f64),
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Minimum>, Cancelled> {
        let Some(Misfit { mut cost, mut residual }) = self.misfit(&start) else { return Ok(None) };
        let (mut point, mut damping) = (start, 1e-3);
        let (converged, iterations) = 'search: {
            for iteration in 0..most_iterations {
                told(iteration, residual);
                let Some(blocks) = self.linearize(&point, go_on)? else {
                    break 'search (false, iteration);
                };
                let bounds = self.bounds(&point);
                let ridges: Vec<f64> = (self.names.iter().zip(&point.fields))
                    .map(|(&name, &value)| RIDGE / scale(name, value, value))
                    .collect();
                let squares: f64 =
                    blocks.iter().map(|block| block.rows.column(block.rows.ncols() - 1).norm_squared()).sum();
                let mut looked_ahead = false;
                loop {
                    let step = elimination::step(&blocks, &bounds, &ridges, damping);
                    let tiny = squares - step.left <= negligible;
                    let lower = |to: Point| {
                        let there = self.misfit(&to);
                        (there.filter(|there| there.cost <= cost).map(|there| (to, there)), there)
                    };
                    let bent = self.bent(&point, &blocks, &step, (&bounds, &ridges, damping));
                    let mut found = bent.and_then(|bent| lower(self.moved(&point, &bent)).0);
                    if found.is_none() {
                        let moved = self.moved(&point, &step);
                        let there;
                        (found, there) = lower(moved.clone());
                        let is_near = there.is_some_and(|there| there.cost < UPHILL * (cost + UPHILL));
                        if found.is_none() && !looked_ahead && is_near {
                            // In a bent valley the step leaves its floor, and the next one comes back to it, farther on.
                            looked_ahead = true;
                            if let Some(blocks) = self.linearize(&moved, go_on)? {
                                let back = elimination::step(&blocks, &self.bounds(&moved), &ridges, damping);
                                found = lower(self.moved(&moved, &back)).0;
                            }
                        }
                    }
                    let has_moved = found.is_some();
                    let before = cost;
                    if let Some((to, there)) = found {
                        (point, cost, residual) = (to, there.cost, there.residual);
                        damping = (damping * 0.1).max(1e-10);
                    }
                    if cost > self.hopeless && before - cost < SLOW * before {
                        break 'search (false, iteration + 1);
                    }
                    if tiny && (damping < 1.0 || !has_moved) {
                        break 'search (true, iteration + 1);
                    }
                    if has_moved {
                        break;
                    }
                    damping *= 8.0;
                    if damping > 1e12 || !go_on() {
                        break 'search (false, iteration + 1);
                    }
                }
            }
            (false, most_iterations)
        };
        told(iterations, residual);
        Ok(Some(Minimum { point, cost, converged, iterations }))
    }
}

/// Share of the sum of squares by which a step of a search that is not slow makes it fall.
const SLOW: f64 = 0.1;

/// Share of a step at which the acceleration along it is measured.
const AHEAD: f64 = 0.1;

/// Largest acceleration beside a step.
const MOST_BENT: f64 = 0.75;

/// Rise of the sum of squares, as a factor and in itself, up to which a step is followed by another before both are judged.
const UPHILL: f64 = 10.0;

/// Weight, over the scale of a field, of the wish that it does not move in place of data that say nothing about it.
const RIDGE: f64 = 1e-5;
