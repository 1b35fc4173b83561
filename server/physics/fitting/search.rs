//! The search for the minimum: numbers of the impacts, short windows from several starts, then longer windows.

use super::answer::{FitFailure, FitProgress, FitRequest, FitStage};
use super::elimination::{leverages, reduced};
use super::impact_map::{ImpactMap, STATES, T, Vector};
use super::measured::MeasuredRow;
use super::numbering::renumber;
use super::solver::{Minimum, Point, Problem};
use super::statistics::spread;
use super::windows::{follow, guesses, join, split};
use std::ops::Range;

/// Least standard deviation: exact data have no other.
const LEAST_SD: f64 = 1e-10;
/// Rows of the part of the data on which several starts are tried.
const ROWS_OF_STARTS: usize = 40;
/// Most iterations, and the fall of the sum of squares that counts as none, on the way to the minimum: estimates move by a tenth of their
/// standard deviation.
pub(super) const ROUGH: (usize, f64) = (20, 1e-2);
/// Least share of the values that unknowns leave in a start that is compared with others.
const LEAST_LEFT: f64 = 0.2;
/// Most ends of starts that are looked at again beside the minimum, and how much larger their squares may be than the least.
const ENDS: (usize, f64) = (2, 1.5);
/// Starts beside the typed one: share of its scale by which each unknown is off, alternating in sign where the second number is −1.
pub(super) const STARTS: [(f64, f64); 3] = [(0.2, 1.0), (-0.2, 1.0), (0.2, -1.0)];

/// Progress of a fit, as it is told.
pub(super) struct Watch<'a> {
    tell: &'a mut dyn FnMut(&FitProgress),
    now: FitProgress,
    /// Work planned for each stage.
    plan: [u64; FitStage::ALL.len()],
    /// Work done in this stage by searches that have ended.
    within: u64,
    /// Iterations of searches that have ended.
    iterations: usize,
}

impl<'a> Watch<'a> {
    pub(super) fn new(tell: &'a mut dyn FnMut(&FitProgress)) -> Self {
        let now = FitProgress { stage: FitStage::Numbers, search: 0, iterations: 0, residual: None, done: 0, of: 0 };
        Self { tell, now, plan: [0; FitStage::ALL.len()], within: 0, iterations: 0 }
    }

    /// Iterations of all searches that have ended.
    pub(super) fn iterations(&self) -> usize {
        self.iterations
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

    fn begin_search(&mut self) {
        self.now.search += 1;
    }

    /// Looks at a search under way.
    fn look(&mut self, iteration: usize, residual: f64) {
        // Beside the minimum, residuals of a field that is held aside say nothing about the fit.
        if self.now.stage == FitStage::Beside {
            return;
        }
        self.now.residual = Some(residual).filter(|residual| residual.is_finite());
        self.now.iterations = self.iterations + iteration;
        self.advance(iteration as u64);
        (self.tell)(&self.now);
    }

    /// Ends a search that could take `most` iterations.
    fn end_search(&mut self, most: usize, iterations: usize) {
        self.within += most as u64;
        self.iterations += iterations;
        self.now.iterations = self.iterations;
        self.advance(0);
        if self.now.stage == FitStage::Beside {
            self.now.residual = None;
            (self.tell)(&self.now);
        }
    }

    /// Counts the work so far, with some of a search under way. A stage that takes longer than planned, or comes again, stands still.
    fn advance(&mut self, more: u64) {
        let stage = self.now.stage as usize;
        let before: u64 = self.plan[..stage].iter().sum();
        self.now.done = self.now.done.max(before + (self.within + more).min(self.plan[stage]));
    }
}

/// A fit under way.
pub(super) struct Search<'a> {
    pub(super) request: &'a FitRequest,
    pub(super) problem: Problem,
    pub(super) typed: Vec<f64>,
    /// Reason for which a field cannot be told beside the place of the body; `None` if it can.
    pub(super) shifts: Vec<Option<String>>,
    /// Fields at which other starts ended that fit about as well.
    pub(super) ends: Vec<Vec<f64>>,
    pub(super) measured: [bool; STATES],
    pub(super) watch: Watch<'a>,
    /// False if longer windows do not explain the data.
    pub(super) is_followed: bool,
}

impl Search<'_> {
    /// Rows of the shortest windows: twice as many values as unknowns.
    pub(super) fn shortest(&self) -> usize {
        let columns = self.measured.iter().filter(|measured| **measured).count().max(1);
        (2 * self.problem.active.len()).div_ceil(columns).max(4)
    }

    /// Minimizes the squares, and tells how far it is.
    pub(super) fn minimize(
        &mut self,
        problem: &Problem,
        start: Point,
        effort: (usize, f64),
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Minimum>, FitFailure> {
        let watch = &mut self.watch;
        watch.begin_search();
        let found =
            problem.minimize(start, effort, &mut |iteration, residual| watch.look(iteration, residual), go_on)?;
        watch.end_search(effort.0, found.as_ref().map_or(0, |found| found.iterations));
        if !go_on() {
            return Err(FitFailure::Cancelled);
        }
        Ok(found)
    }

    /// [`Self::minimize`] of the whole problem, in which no run may end.
    pub(super) fn settle(
        &mut self,
        start: Point,
        effort: (usize, f64),
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Minimum, FitFailure> {
        let problem = self.problem.clone();
        self.minimize(&problem, start, effort, go_on)?.ok_or(FitFailure::RunEnds)
    }

    /// A point with these fields and guessed states. Windows in which the run of the model ends are halved.
    pub(super) fn guessed(problem: &mut Problem, map: &mut ImpactMap, fields: Vec<f64>) -> Point {
        let states = guesses(&problem.rows, map);
        let released = problem.from_release;
        let ends = |range: &Range<usize>, map: &mut ImpactMap| {
            let (from, to) = (problem.rows[range.start].n, problem.rows[range.end - 1].n);
            follow(map, from, to, &states[range.start]).is_none()
        };
        let mut windows: Vec<Range<usize>> = problem.windows.iter().rev().cloned().collect();
        let mut halved = Vec::new();
        while let Some(range) = windows.pop() {
            if range.len() > 1 && ends(&range, map) && !(released && range.start == 0) {
                let middle = range.start + range.len() / 2;
                windows.extend([middle..range.end, range.start..middle]);
            } else {
                halved.push(range);
            }
        }
        problem.windows = halved;
        let mut starts: Vec<Vector> = problem.windows.iter().map(|range| states[range.start]).collect();
        if released {
            starts[0][T] = clock(&problem.rows[0], map);
        }
        Point { fields, starts }
    }

    /// Short windows: numbers of the impacts, several starts, first standard deviations.
    pub(super) fn first_stage(
        &mut self,
        map: &mut ImpactMap,
        notes: &mut Vec<String>,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<Point, FitFailure> {
        let (rows, found) = renumber(&self.problem.rows, map);
        if !found.is_empty() && rows.len() >= 2 {
            // The change has to pay: the same squares with the numbers as they came are larger.
            let mut changed = self.problem.clone();
            changed.rows = rows;
            let cost =
                |search: &mut Self, problem: &mut Problem, map: &mut ImpactMap, go_on: &mut dyn FnMut() -> bool| {
                    problem.windows = split(problem.rows.len(), search.shortest());
                    let point = Self::guessed(problem, map, search.typed.clone());
                    let found = search.minimize(problem, point, ROUGH, go_on)?;
                    let cost = found.map_or(f64::INFINITY, |found| found.cost + search.unknowns(problem) as f64);
                    Ok::<_, FitFailure>(cost / problem.rows.len() as f64)
                };
            let as_it_came = cost(self, &mut self.problem.clone(), map, go_on)?;
            if cost(self, &mut changed, map, go_on)? < as_it_came {
                self.problem.rows = changed.rows;
                notes.extend(found);
            }
        }
        self.watch.enter(FitStage::Starts);
        let length = self.shortest();
        self.problem.windows = split(self.problem.rows.len(), length);
        let mut ends: Vec<(f64, Vec<f64>)> = Vec::new();
        let mut part = self.problem.clone();
        part.rows.truncate(ROWS_OF_STARTS);
        for start in 0..=STARTS.len() {
            let tried = self.start(start);
            let Some(mut map) = part.map_at(&tried) else { continue };
            part.windows = split(part.rows.len(), length);
            let point = Self::guessed(&mut part, &mut map, tried);
            let Some(found) = self.minimize(&part, point, ROUGH, go_on)? else { continue };
            // More windows take more unknowns, and each of them a share of the squares. Windows of hardly any impacts follow any data.
            let (values, unknowns) = (self.values(&part) as f64, self.unknowns(&part) as f64);
            let left = (values - unknowns).max(LEAST_LEFT * values);
            let cost =
                found.cost * values / left + if unknowns > values * (1.0 - LEAST_LEFT) { values * values } else { 0.0 };
            ends.push((cost, found.point.fields));
        }
        // The typed start comes first, and stands unless another one is better.
        let best = ends.iter().map(|end| end.0).reduce(f64::min).unwrap_or(f64::INFINITY);
        let taken = ends.iter().position(|end| end.0 <= best / 0.99);
        let fields = taken.map_or_else(|| self.typed.clone(), |taken| ends.remove(taken).1);
        ends.retain(|end| end.0 <= ENDS.1 * best);
        ends.sort_by(|one, other| one.0.total_cmp(&other.0));
        self.ends = ends.into_iter().take(ENDS.0).map(|end| end.1).collect();
        let mut map = self.problem.map_at(&fields).ok_or(FitFailure::RunEnds)?;
        self.watch.enter(FitStage::ShortWindows);
        let point = Self::guessed(&mut self.problem, &mut map, fields);
        let found = self.settle(point, ROUGH, go_on)?;
        self.update_sd(&found.point, true, go_on)?;
        Ok(self.settle(found.point, ROUGH, go_on)?.point)
    }

    /// Values of a start: the typed ones, or some about them.
    pub(super) fn start(&self, start: usize) -> Vec<f64> {
        let Some((share, turn)) = start.checked_sub(1).map(|start| STARTS[start]) else { return self.typed.clone() };
        let mut sign = 1.0;
        let moved = self.problem.names.iter().zip(&self.typed).map(|(&name, &value)| {
            let (minimum, maximum) = name.row().range();
            let moved = value + sign * share * value.abs().max(0.2 * (maximum - minimum).min(1.0));
            sign *= turn;
            moved.clamp(minimum, maximum)
        });
        moved
            .zip(&self.typed)
            .zip(&self.problem.held)
            .map(|((moved, typed), held)| if *held { *typed } else { moved })
            .collect()
    }

    /// Joins windows as long as small deviations stay small and the longer windows explain the data as well.
    pub(super) fn lengthen(&mut self, mut point: Point, go_on: &mut dyn FnMut() -> bool) -> Result<Point, FitFailure> {
        self.watch.enter(FitStage::LongerWindows);
        while let Some((windows, starts)) = join(&self.problem, &point) {
            self.update_sd(&point, true, go_on)?;
            let shorter = self.problem.cost(&point).unwrap_or(f64::INFINITY) / self.freedom(&self.problem);
            let mut longer = self.problem.clone();
            longer.windows = windows;
            let found = self.minimize(&longer, Point { fields: point.fields.clone(), starts }, ROUGH, go_on)?;
            let freedom = self.freedom(&self.problem);
            let most = shorter * (1.0 + f64::max(0.5, 6.0 / freedom.max(1.0).sqrt()));
            match found.filter(|found| found.cost / self.freedom(&longer) <= most) {
                Some(found) => (self.problem, point) = (longer, found.point),
                None => {
                    self.is_followed = false;
                    break;
                }
            }
        }
        Ok(point)
    }

    /// Number of values that take part less that of unknowns.
    pub(super) fn freedom(&self, problem: &Problem) -> f64 {
        (self.values(problem) as f64 - self.unknowns(problem) as f64).max(1.0)
    }

    pub(super) fn values(&self, problem: &Problem) -> usize {
        problem.rows.iter().map(|row| row.columns().count()).sum()
    }

    pub(super) fn unknowns(&self, problem: &Problem) -> usize {
        let fields = problem.held.iter().filter(|held| !**held).count();
        (0..problem.windows.len()).map(|window| problem.unknowns_of(window).len()).sum::<usize>() + fields
    }

    /// Takes standard deviations that were not given from the residuals: by their median, or by their squares.
    pub(super) fn update_sd(
        &mut self,
        point: &Point,
        robust: bool,
        go_on: &mut dyn FnMut() -> bool,
    ) -> Result<(), FitFailure> {
        let problem = &self.problem;
        let Some(predicted) = problem.predict(point) else { return Ok(()) };
        let residuals = problem.residuals(&predicted);
        let Some(blocks) = problem.linearize(point, go_on)? else { return Ok(()) };
        let (factor, factors) = reduced(&blocks, problem.names.len());
        let taken = leverages(&blocks, &factor, &factors);
        let (mut of_column, mut lines): ([Vec<f64>; STATES], [f64; STATES]) = Default::default();
        for (range, taken) in problem.windows.iter().zip(&taken) {
            let mut taken = taken.iter();
            for row in range.clone() {
                for column in problem.rows[row].columns() {
                    of_column[column].push(residuals[row][column]);
                    lines[column] += taken.next().copied().unwrap_or(0.0);
                }
            }
        }
        for column in (0..STATES).filter(|&column| self.request.sd[column].is_none() && self.measured[column]) {
            let count = of_column[column].len() as f64;
            let left = count - lines[column];
            if left < 1.0 {
                continue;
            }
            let squares: f64 = of_column[column].iter().map(|residual| residual * residual).sum();
            let share = if robust {
                spread(std::mem::take(&mut of_column[column])).unwrap_or(1.0) * (count / left).sqrt()
            } else {
                (squares / left).sqrt()
            };
            self.problem.sd[column] = (self.problem.sd[column] * share).max(LEAST_SD);
        }
        Ok(())
    }
}

/// Time of the data's clock at the release of the scene, s.
fn clock(row: &MeasuredRow, map: &mut ImpactMap) -> f64 {
    let at = map.release.and_then(|at| map.follow(1, row.n, &at));
    at.map_or(0.0, |at| row.values[T] - at[T])
}
