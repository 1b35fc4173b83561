//! The search for the minimum: numbers of the impacts, short windows from several starts, then longer windows.

use super::answer::{FitFailure, FitRequest, FitStage};
use super::elimination::leverages;
use super::impact_map::{ImpactMap, STATES, T, Vector};
use super::measured::MeasuredRow;
use super::numbering::renumber;
use super::solver::{Minimum, Point, Problem, Watch};
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
/// Starts beside the typed one: share of its scale by which each unknown is off, alternating in sign where the second number is −1.
pub(super) const STARTS: [(f64, f64); 3] = [(0.2, 1.0), (-0.2, 1.0), (0.2, -1.0)];

pub(super) struct Search<'a> {
    pub(super) request: &'a FitRequest,
    pub(super) problem: Problem,
    pub(super) typed: Vec<f64>,
    /// Reason for which a field cannot be told beside the place of the body; `None` if it can.
    pub(super) shifts: Vec<Option<String>>,
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

    /// Minimizes the squares of the whole problem, in which no run may end.
    pub(super) fn settle(&mut self, start: Point, effort: (usize, f64)) -> Result<Minimum, FitFailure> {
        self.watch.minimize(&self.problem, start, effort)?.ok_or(FitFailure::RunEnds)
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

    /// The squares for each degree of freedom of a problem in short windows, from these fields on, and the fields at their end; `None` if a run
    /// ends.
    fn tried(
        &mut self,
        mut problem: Problem,
        map: &mut ImpactMap,
        fields: Vec<f64>,
    ) -> Result<Option<(f64, Vec<f64>)>, FitFailure> {
        problem.windows = split(problem.rows.len(), self.shortest());
        let point = Self::guessed(&mut problem, map, fields);
        let Some(found) = self.watch.minimize(&problem, point, ROUGH)? else { return Ok(None) };
        // More windows take more unknowns, and each of them a share of the squares. Windows of hardly any impacts follow any data.
        let (values, unknowns) = (self.values(&problem) as f64, self.unknowns(&problem) as f64);
        let is_free = unknowns > values * (1.0 - LEAST_LEFT);
        let cost = found.cost / (values - unknowns).max(LEAST_LEFT * values);
        Ok(Some((if is_free { cost + values } else { cost }, found.point.fields)))
    }

    /// Short windows: numbers of the impacts, several starts, first standard deviations.
    pub(super) fn first_stage(&mut self, map: &mut ImpactMap, notes: &mut Vec<String>) -> Result<Point, FitFailure> {
        let (rows, found) = renumber(&self.problem.rows, map);
        if !found.is_empty() && rows.len() >= 2 {
            // The change has to pay: the same squares with the numbers as they came are larger.
            let changed = Problem { rows, ..self.problem.clone() };
            let mut misfits = [f64::INFINITY; 2];
            for (misfit, problem) in misfits.iter_mut().zip([self.problem.clone(), changed.clone()]) {
                let tried = self.tried(problem, map, self.typed.clone())?;
                *misfit = tried.map_or(*misfit, |tried| tried.0);
            }
            if misfits[1] < misfits[0] {
                self.problem = changed;
                notes.extend(found);
            }
        }
        self.watch.enter(FitStage::Starts);
        let mut part = self.problem.clone();
        part.rows.truncate(ROWS_OF_STARTS);
        let mut ends: Vec<(f64, Vec<f64>)> = Vec::new();
        for start in 0..=STARTS.len() {
            let fields = self.start(start);
            let Some(mut map) = part.map_at(&fields) else { continue };
            ends.extend(self.tried(part.clone(), &mut map, fields)?);
        }
        // The typed start comes first, and stands unless another one is better.
        let best = ends.iter().map(|end| end.0).reduce(f64::min).unwrap_or(f64::INFINITY);
        let taken = ends.into_iter().find(|end| end.0 <= best / 0.99);
        let fields = taken.map_or_else(|| self.typed.clone(), |taken| taken.1);
        let mut map = self.problem.map_at(&fields).ok_or(FitFailure::RunEnds)?;
        self.watch.enter(FitStage::ShortWindows);
        self.problem.windows = split(self.problem.rows.len(), self.shortest());
        let point = Self::guessed(&mut self.problem, &mut map, fields);
        let found = self.settle(point, ROUGH)?;
        self.update_sd(&found.point, true);
        Ok(self.settle(found.point, ROUGH)?.point)
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
    pub(super) fn lengthen(&mut self, mut point: Point) -> Result<Point, FitFailure> {
        self.watch.enter(FitStage::LongerWindows);
        while let Some((windows, starts)) = join(&self.problem, &point) {
            self.update_sd(&point, true);
            let shorter = self.problem.cost(&point).unwrap_or(f64::INFINITY) / self.freedom(&self.problem);
            let mut longer = self.problem.clone();
            longer.windows = windows;
            let found = self.watch.minimize(&longer, Point { fields: point.fields.clone(), starts }, ROUGH)?;
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
    pub(super) fn update_sd(&mut self, point: &Point, robust: bool) {
        let problem = &self.problem;
        let Some(predicted) = problem.predict(point) else { return };
        let residuals = problem.residuals(&predicted);
        let Some(blocks) = problem.linearize(point, self.watch.go_on) else { return };
        let taken = leverages(&blocks, &problem.ridges(point));
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
    }
}

/// Time of the data's clock at the release of the scene, s.
fn clock(row: &MeasuredRow, map: &mut ImpactMap) -> f64 {
    let at = map.release.and_then(|at| map.follow(1, row.n, &at));
    at.map_or(0.0, |at| row.values[T] - at[T])
}
