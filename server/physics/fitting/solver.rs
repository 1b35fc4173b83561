//! The least squares over fields and the initial states of windows, by the method of Levenberg (1944) and Marquardt (1963).
//!
//! `levenberg-marquardt` 0.15 is built on another nalgebra than ours, and takes one dense Jacobian of all unknowns: time would grow with the cube
//! of the number of windows. So the loop over the damping stands here; the linear algebra is nalgebra's.

use super::answer::{FitFailure, FitProgress, FitStage};
use super::confidence::scale;
use super::elimination;
use super::elimination::{Block, Step};
use super::impact_map::{Differentiated, ImpactMap, STATES, T, Vector, X, differentiated};
use super::measured::MeasuredRow;
use super::statistics::{loss, weight};
use crate::numbers::number::Number;
use crate::scene::{Draft, Name};
use nalgebra::DMatrix;
use std::iter;
use std::ops::Range;

/// Rows between two looks at the clock.
const LOOK_EVERY: usize = 64;

/// The problem at one stage of a fit.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub(super) rows: Vec<MeasuredRow>,
    pub(super) draft: Draft,
    pub(super) names: Vec<Name>,
    pub(super) sd: Vector,
    /// True while outliers are held back by Huber's weights.
    pub(super) robust: bool,
    pub(super) windows: Vec<Range<usize>>,
    /// Unknown components of the state at the beginning of a window.
    pub(super) active: Vec<usize>,
    /// True if the first window begins at the release of the scene.
    pub(super) from_release: bool,
    pub(super) held: Vec<bool>,
    /// Sum of squares above which a search that has become slow is given up.
    pub(super) hopeless: f64,
    /// Standard deviations to begin with. Those that are estimated change between stages, these do not.
    pub(super) first_sd: Vector,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Misfit {
    /// Sum of squares over their variances, or Huber's loss in place of it.
    pub(super) cost: f64,
    /// Root mean square of the residuals over the first standard deviations.
    residual: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) fields: Vec<f64>,
    /// State at the beginning of each window. Of one that begins at the release, the time alone counts.
    pub(super) starts: Vec<Vector>,
}

#[derive(Clone, Debug)]
pub(super) struct Minimum {
    pub(super) point: Point,
    /// Same as in [`Misfit`].
    pub(super) cost: f64,
    /// False if the iterations ran out.
    pub(super) converged: bool,
    pub(super) iterations: usize,
}

pub(super) struct Watch<'a> {
    tell: &'a mut dyn FnMut(&FitProgress),
    pub(super) go_on: &'a mut dyn FnMut() -> bool,
    now: FitProgress,
    /// Work planned for each stage.
    plan: [u64; FitStage::ALL.len()],
    /// Work done in this stage by searches that have ended.
    within: u64,
    /// Iterations of searches that have ended.
    pub(super) iterations: usize,
}

impl<'a> Watch<'a> {
    pub(super) fn new(tell: &'a mut dyn FnMut(&FitProgress), go_on: &'a mut dyn FnMut() -> bool) -> Self {
        let now = FitProgress { stage: FitStage::Numbers, search: 0, iterations: 0, residual: None, done: 0, of: 0 };
        Self { tell, go_on, now, plan: [0; FitStage::ALL.len()], within: 0, iterations: 0 }
    }

    /// Plans the work of each stage, and tells that it begins.
    pub(super) fn begin(&mut self, plan: [u64; FitStage::ALL.len()]) {
        self.plan = plan;
        self.now.of = plan.iter().sum();
        (self.tell)(&self.now);
    }

    /// Enters a stage. Work of the stages before it is done, or not needed.
    pub(super) fn enter(&mut self, stage: FitStage) {
        (self.now.stage, self.now.search, self.within) = (stage, 0, 0);
        self.advance(0);
    }

    /// Looks at a search under way.
    pub(super) fn look(&mut self, iteration: usize, residual: f64) {
        // Beside the minimum, residuals of a field that is held aside say nothing about the fit.
        if self.now.stage == FitStage::Beside {
            return;
        }
        self.now.residual = Some(residual).filter(|residual| residual.is_finite());
        self.now.iterations = self.iterations + iteration;
        self.advance(iteration as u64);
        (self.tell)(&self.now);
    }

    /// Minimizes the squares of a problem, and tells how far it is. `None` if a run ends.
    pub(super) fn minimize(
        &mut self,
        problem: &Problem,
        start: Point,
        effort: (usize, f64),
    ) -> Result<Option<Minimum>, FitFailure> {
        self.now.search += 1;
        let found = problem.minimize(start, effort, self);
        if !(self.go_on)() {
            return Err(FitFailure::Cancelled);
        }
        self.within += effort.0 as u64;
        self.iterations += found.as_ref().map_or(0, |found| found.iterations);
        self.now.iterations = self.iterations;
        self.advance(0);
        if self.now.stage == FitStage::Beside {
            self.now.residual = None;
            (self.tell)(&self.now);
        }
        Ok(found)
    }

    /// Counts the work so far, with some of a search under way. A stage that takes longer than planned, or comes again, stands still.
    fn advance(&mut self, more: u64) {
        let stage = self.now.stage as usize;
        let before: u64 = self.plan[..stage].iter().sum();
        self.now.done = self.now.done.max(before + (self.within + more).min(self.plan[stage]));
    }
}

impl Problem {
    pub(super) fn draft_at(&self, fields: &[f64]) -> Option<Draft> {
        self.draft.with(self.names.iter().zip(fields).map(|(&name, &value)| (name, Some(value)))).ok()
    }

    pub(super) fn map_at(&self, fields: &[f64]) -> Option<ImpactMap> {
        ImpactMap::new(&self.draft_at(fields)?).ok()
    }

    fn is_released(&self, window: usize) -> bool {
        self.from_release && window == 0
    }

    pub(super) fn unknowns_of(&self, window: usize) -> &[usize] {
        // The clock is the last.
        if self.is_released(window) { &self.active[self.active.len() - 1..] } else { &self.active }
    }

    /// Number of values that take part.
    pub(super) fn values(&self) -> usize {
        self.rows.iter().map(|row| row.columns().count()).sum()
    }

    /// Number of unknowns, those of the windows included.
    pub(super) fn unknowns(&self) -> usize {
        let fields = self.held.iter().filter(|held| !**held).count();
        (0..self.windows.len()).map(|window| self.unknowns_of(window).len()).sum::<usize>() + fields
    }

    /// Number of values less that of unknowns, at least 1.
    pub(super) fn freedom(&self) -> f64 {
        (self.values() as f64 - self.unknowns() as f64).max(1.0)
    }

    /// The states at the rows of a window that begins at `start`; of one that begins at the release, the time alone counts. `None` where a run
    /// ends, and once `go_on` says `false`.
    pub(super) fn followed<N: Number>(
        &self,
        window: usize,
        start: Vector<N>,
        map: &mut ImpactMap<N>,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Option<Vec<Vector<N>>> {
        let rows = &self.rows[self.windows[window].clone()];
        let (mut n, mut at) = (rows[0].n, start);
        if self.is_released(window) {
            (n, at) = (1, map.release?);
            at[T] = at[T] + start[T];
        }
        let state_at = |(place, row): (usize, &MeasuredRow)| {
            at = if place % LOOK_EVERY != 0 || go_on() { map.follow(n, row.n, &at)? } else { None? };
            n = row.n;
            Some(at)
        };
        rows.iter().enumerate().map(state_at).collect()
    }

    /// Values of the rows as the model gives them; `None` where a run ends.
    pub(super) fn predict(&self, point: &Point) -> Option<Vec<Vector>> {
        let mut map = self.map_at(&point.fields)?;
        let of_window = |window| self.followed(window, point.starts[window], &mut map, &mut || true);
        Some((0..self.windows.len()).map(of_window).collect::<Option<Vec<_>>>()?.concat())
    }

    /// Residuals over their standard deviations, NaN where there is no value; `None` where a run ends.
    pub(super) fn residuals(&self, point: &Point) -> Option<Vec<Vector>> {
        let of_row = |(row, predicted): (&MeasuredRow, Vector)| {
            std::array::from_fn(|column| (predicted[column] - row.values[column]) / self.sd[column])
        };
        Some(self.rows.iter().zip(self.predict(point)?).map(of_row).collect())
    }

    /// Size of the residuals; `None` where a run ends.
    pub(super) fn misfit(&self, point: &Point) -> Option<Misfit> {
        let residuals = self.residuals(point)?;
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

    /// The linearized rows of each window; `None` where a run ends, and once `go_on` says `false`.
    pub(super) fn linearize(&self, point: &Point, go_on: &mut dyn FnMut() -> bool) -> Option<Vec<Block>> {
        let mut map = ImpactMap::differentiated(&self.draft_at(&point.fields)?, &self.names).ok()?;
        let of_window = |window: usize| {
            let states = self.followed(window, differentiated(&point.starts[window]), &mut map, go_on)?;
            let own = self.unknowns_of(window);
            let directions = || own.iter().copied().chain(STATES..STATES + self.names.len());
            let rows = self.rows[self.windows[window].clone()].iter().zip(&states);
            let lines = rows.flat_map(|(row, at)| row.columns().map(move |column| (row, at, column)));
            let numbers = lines.flat_map(|(row, at, column)| {
                let residual = (at[column].value - row.values[column]) / self.sd[column];
                let share = if self.robust { weight(residual).sqrt() } else { 1.0 };
                let scale = share / self.sd[column];
                let slopes = directions().map(move |direction| at[column].partials[direction] * scale);
                slopes.chain(iter::once(residual * share))
            });
            let (numbers, width): (Vec<f64>, usize) = (numbers.collect(), directions().count() + 1);
            let is_finite = numbers.iter().all(|number| number.is_finite());
            let rows = DMatrix::from_row_slice(numbers.len() / width, width, &numbers);
            is_finite.then(|| Block::new(own.len(), rows))
        };
        (0..self.windows.len()).map(of_window).collect()
    }

    /// Weights of the wishes that the fields stay, in place of data that say nothing about them.
    pub(super) fn ridges(&self, point: &Point) -> Vec<f64> {
        self.names.iter().zip(&point.fields).map(|(&name, &value)| RIDGE / scale(name, value, value)).collect()
    }

    fn bounds(&self, point: &Point) -> Vec<(f64, f64)> {
        let of_field = |((&name, &held), &value): ((&Name, &bool), &f64)| {
            let (minimum, maximum) = name.row().range();
            if held { (0.0, 0.0) } else { (minimum - value, maximum - value) }
        };
        self.names.iter().zip(&self.held).zip(&point.fields).map(of_field).collect()
    }

    fn moved(&self, point: &Point, step: &Step) -> Point {
        let mut moved = point.clone();
        for ((value, change), name) in moved.fields.iter_mut().zip(&step.fields).zip(&self.names) {
            *value = name.row().clamped(*value + change);
        }
        for (window, (start, changes)) in moved.starts.iter_mut().zip(&step.own).enumerate() {
            for (&component, change) in self.unknowns_of(window).iter().zip(changes) {
                start[component] += change;
            }
        }
        moved
    }

    /// The windows and the point with up to [`JOINED`] windows at a time joined to one, where small deviations stay small over it; `None` if none
    /// can be.
    pub(super) fn joined(&self, point: &Point) -> Option<(Vec<Range<usize>>, Point)> {
        let mut map = ImpactMap::differentiated(&self.draft_at(&point.fields)?, &[]).ok()?;
        let mut plain = self.map_at(&point.fields)?;
        let (mut windows, mut starts) = (Vec::new(), Vec::new());
        let mut place = 0;
        while place < self.windows.len() {
            let from = self.windows[place].start;
            let mut count = JOINED.min(self.windows.len() - place);
            // A rest of one or two goes with the last.
            if self.windows.len() - place - count < JOINED && self.windows.len() - place - count > 0 {
                count = self.windows.len() - place;
            }
            while count > 1 {
                let rows = &self.rows[from..self.windows[place + count - 1].end];
                let states = self.followed(place, point.starts[place], &mut plain, &mut || true);
                let start = states.map_or(point.starts[place], |states| states[0]);
                if growth(&mut map, rows, &start).is_some_and(|growth| growth <= MOST_GROWTH) {
                    break;
                }
                count -= 1;
            }
            windows.push(from..self.windows[place + count - 1].end);
            starts.push(point.starts[place]);
            place += count;
        }
        let fields = point.fields.clone();
        (windows.len() < self.windows.len()).then_some((windows, Point { fields, starts }))
    }

    /// Minimizes the squares from a point, until a step promises a fall of less than `negligible`; `None` if a run ends there already.
    pub(super) fn minimize(
        &self,
        start: Point,
        (most_iterations, negligible): (usize, f64),
        watch: &mut Watch<'_>,
    ) -> Option<Minimum> {
        let Misfit { mut cost, mut residual } = self.misfit(&start)?;
        let (mut point, mut damping) = (start, 1e-3);
        let (converged, iterations) = 'search: {
            for iteration in 0..most_iterations {
                watch.look(iteration, residual);
                let Some(blocks) = self.linearize(&point, watch.go_on) else {
                    break 'search (false, iteration);
                };
                let bounds = self.bounds(&point);
                let ridges = self.ridges(&point);
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
                    let moved = self.moved(&point, &step);
                    let (mut found, there) = lower(moved.clone());
                    let is_near = there.is_some_and(|there| there.cost < UPHILL * (cost + UPHILL));
                    if found.is_none() && !looked_ahead && is_near {
                        // In a bent valley the step leaves its floor, and the next one comes back to it, farther on.
                        looked_ahead = true;
                        if let Some(blocks) = self.linearize(&moved, watch.go_on) {
                            let back = elimination::step(&blocks, &self.bounds(&moved), &ridges, damping);
                            found = lower(self.moved(&moved, &back)).0;
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
                    if damping > 1e12 || !(watch.go_on)() {
                        break 'search (false, iteration + 1);
                    }
                }
            }
            (false, most_iterations)
        };
        watch.look(iterations, residual);
        Some(Minimum { point, cost, converged, iterations })
    }
}

/// Share of the sum of squares by which a step of a search that is not slow makes it fall.
const SLOW: f64 = 0.1;

/// Rise of the sum of squares, as a factor and in itself, up to which a step is followed by another before both are judged.
const UPHILL: f64 = 10.0;

/// Weight, over the scale of a field, of the wish that it does not move in place of data that say nothing about it.
const RIDGE: f64 = 1e-5;

/// Windows that are joined to one at a time.
pub(super) const JOINED: usize = 3;

/// Greatest growth of a small deviation of the state over a window. Beyond it the squares have more than one minimum within the noise.
const MOST_GROWTH: f64 = 100.0;

/// Growth of a small deviation over a window, in angle, velocity over that of the bounce, and angular velocity times flight time.
fn growth(map: &mut ImpactMap<Differentiated>, rows: &[MeasuredRow], start: &Vector) -> Option<f64> {
    const ANGLE_AND_VELOCITIES: usize = 4;
    let (mut at, mut most) = (differentiated(start), 1.0_f64);
    let (first, last) = (rows.first()?.n, rows.last()?.n);
    let speed = start[2].abs().max(1e-3);
    let mut scales = [1.0, speed, speed, 1.0];
    for n in first..last {
        // A deviation of the place alone does not grow.
        at[X].partials.fill(0.0);
        let next = map.next(n, &at)?;
        if n == first {
            scales[3] = 1.0 / (next[T].value - at[T].value).max(1e-6);
        }
        at = next;
        let squares: f64 = (0..ANGLE_AND_VELOCITIES * ANGLE_AND_VELOCITIES)
            .map(|place| (place / ANGLE_AND_VELOCITIES, place % ANGLE_AND_VELOCITIES))
            .map(|(row, column)| at[row].partials[column] * scales[column] / scales[row])
            .map(|entry| entry * entry)
            .sum();
        most = most.max(0.5 * squares.sqrt());
    }
    Some(most)
}
