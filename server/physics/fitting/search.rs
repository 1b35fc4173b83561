//! A fit: the request is checked, and the minimum is searched for: numbers of the impacts, short windows from several starts, then longer
//! windows.

use super::answer::{Fit, FitFailure, FitProgress, FitRequest, FitStage};
use super::elimination::leverages;
use super::impact_map::{ImpactMap, MOST_UNKNOWNS, STATES, T, Vector, X, differentiated};
use super::measured::MeasuredRow;
use super::solver::{JOINED, Minimum, Point, Problem, Watch};
use super::statistics::spread;
use super::windows::{follow, guesses, renumber, split};
use crate::analysis::limits::Parameter;
use crate::scene::{Draft, ERRORS, FIELDS, FieldKind, Name, Scene, names_of};
use nalgebra::DVector;
use std::ops::Range;

/// Searches that are planned for the numbers of impacts, with and without a change; for short windows, before and after standard deviations are
/// estimated; and for outliers, to leave them out and to see that they stay the same.
const TWICE: u64 = 2;

/// First rows at which derivatives by a field and by the place are compared, and the share of the squares that may differ: derivatives are exact to
/// 1e-10.
const STATES_LOOKED_AT: usize = 20;
const SAME_SHIFT: f64 = 1e-10;

/// Standard deviations to begin with, where none are given.
const FIRST_SD: Vector = [5e-3, 2e-2, 2e-2, 0.1, 2e-3, 2e-3];

/// Largest ratio of two misfits that are the same: searches end at a hundredth of the sum of squares.
const NO_DEARER: f64 = 1.01;

/// Least standard deviation: exact data have no other.
const LEAST_SD: f64 = 1e-10;
/// Rows of the part of the data on which several starts are tried.
const ROWS_OF_STARTS: usize = 40;
/// Most iterations, and the fall of the sum of squares that counts as none, on the way to the minimum: estimates move by a tenth of their
/// standard deviation.
const ROUGH: (usize, f64) = (20, 1e-2);
/// The same at the minimum: estimates move by a hundredth of their standard deviation.
pub(super) const FINE: (usize, f64) = (60, 1e-4);
/// The same beside the minimum, where the size of the rise counts.
pub(super) const BESIDE: (usize, f64) = (20, 1.0);
/// The same far off.
pub(super) const FAR_OFF: (usize, f64) = (9, 0.9);
/// The same from the first values and from where other starts ended, with one field held there.
pub(super) const FROM_START: (usize, f64) = (20, 0.9);
/// Distances, in scales of the field, at which the rise of χ² is looked at for other minima.
pub(super) const FAR: [f64; 6] = [-0.5, -0.25, -0.06, 0.06, 0.25, 0.5];
/// Least share of the values that unknowns leave in a start that is compared with others.
const LEAST_LEFT: f64 = 0.2;
/// Starts beside the typed one: share of its scale by which each unknown is off, alternating in sign where the second number is −1.
const STARTS: [(f64, f64); 3] = [(0.2, 1.0), (-0.2, 1.0), (0.2, -1.0)];

/// Faults of a request that are seen without a fit, all of them: of the data, and of the unknown fields.
pub fn check(request: &FitRequest) -> Vec<FitFailure> {
    let is_unknown = |name: Name| request.unknown.contains(&name);
    let gravity = Some(request.scene.gravity()).filter(|_| !is_unknown(Name::Gravity) && !is_unknown(Name::Incline));
    let data = request.measured.faults(gravity).into_iter().map(FitFailure::Data);
    data.chain(unknown_faults(request)).collect()
}

/// Fits fields of a scene to measured impacts. Calls `tell` at the beginning and after each iteration, beside the minimum after each search.
pub fn fit(
    request: &FitRequest,
    tell: &mut dyn FnMut(&FitProgress),
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Fit, FitFailure> {
    if let Some(fault) = check(request).into_iter().next() {
        return Err(fault);
    }
    let rows = request.measured.impacts();
    let typed: Vec<f64> = request.unknown.iter().filter_map(|&name| first_value(&request.scene, name)).collect();
    let mut draft = request.scene.draft();
    let mut notes = Vec::new();
    if request.scene.has_noise() {
        notes.push(
            "the noise of the scene is left out of the fit: the motion between measured impacts is taken as exact"
                .to_owned(),
        );
        let exact = draft.with(names_of("noise").into_iter().map(|name| (name, None)));
        draft = exact.map_err(|error| FitFailure::Scene(vec![error]))?;
    }
    let mut map = ImpactMap::new(&draft).map_err(FitFailure::Scene)?;
    let measured: [bool; STATES] = std::array::from_fn(|column| rows.iter().any(|row| !row.values[column].is_nan()));
    let from_release = request.unknown.iter().any(|name| name.row().group() == "release");
    let active = active(&map, &measured, &request.unknown);
    notes.extend(start_notes(request, from_release));
    let is_open = active.contains(&X) && !measured[X] && !from_release;
    let shifts = if is_open {
        place_shifts(&draft, &request.unknown, &guesses(&rows, &mut map))
    } else {
        vec![None; request.unknown.len()]
    };
    let sd = std::array::from_fn(|column| request.sd[column].unwrap_or(FIRST_SD[column]));
    let problem = Problem {
        rows,
        draft,
        names: request.unknown.clone(),
        sd,
        robust: true,
        windows: Vec::new(),
        active,
        from_release,
        held: shifts.iter().map(Option::is_some).collect(),
        hopeless: f64::INFINITY,
        first_sd: sd,
    };
    let watch = Watch::new(tell, go_on);
    let mut search = Search { request, problem, typed, shifts, measured, watch, is_followed: true };
    search.watch.begin(plan(&search));
    let first = search.first_stage(&mut map, &mut notes)?;
    let point = search.lengthen(first)?;
    search.finish(point, notes)
}

/// Work of each stage of a fit without surprises, in iterations.
fn plan(search: &Search<'_>) -> [u64; FitStage::ALL.len()] {
    let (rough, fine) = (ROUGH.0 as u64, FINE.0 as u64);
    // Near the minimum on both sides, far off, and from the first values.
    let beside = (2 * BESIDE.0 + FAR.len() * FAR_OFF.0 + FROM_START.0) as u64;
    let (fields, mut windows) =
        (search.problem.names.len() as u64, split(search.problem.rows.len(), search.shortest()).len());
    let mut joinings = 0;
    while windows > 1 {
        windows = windows.div_ceil(JOINED);
        joinings += 1;
    }
    FitStage::ALL.map(|stage| match stage {
        FitStage::Numbers | FitStage::ShortWindows => TWICE * rough,
        FitStage::Starts => (1 + STARTS.len() as u64) * rough,
        FitStage::LongerWindows => joinings * rough,
        FitStage::Outliers => TWICE * fine,
        FitStage::Beside => fields * beside,
    })
}

/// First value of an unknown field; 0 of an error of the rig that the scene leaves out.
fn first_value(scene: &Scene, name: Name) -> Option<f64> {
    scene.number(name).or_else(|| ERRORS.contains(&name).then_some(0.0))
}

/// Faults of the unknown fields.
fn unknown_faults(request: &FitRequest) -> Vec<FitFailure> {
    let count = request.unknown.len();
    if !(1..=MOST_UNKNOWNS).contains(&count) {
        let detail = format!("{count} fields are unknown; a fit takes 1 to {MOST_UNKNOWNS}");
        return vec![FitFailure::Unknown(count.min(MOST_UNKNOWNS), detail)];
    }
    let fault = |(index, &name): (usize, &Name)| {
        let row = name.row();
        let detail = if request.unknown[..index].contains(&name) {
            format!("{} is there twice", row.path)
        } else if !matches!(row.kind, FieldKind::Number { .. }) || row.group() == "noise" {
            format!("{} is no number that a motion without noise depends on", row.path)
        } else if let Some(value) = first_value(&request.scene, name) {
            contradiction(&request.scene, name, value)?
        } else {
            format!("{} has no value in the scene; give a first guess, {}", row.path, row.limits())
        };
        Some(FitFailure::Unknown(index, detail))
    };
    request.unknown.iter().enumerate().filter_map(fault).collect()
}

/// Relative step by which a field is moved to see whether the scene allows it.
const STEP: f64 = 6e-6;

/// The contradictions of the scene with a field a step aside, if there are some.
fn contradiction(scene: &Scene, name: Name, value: f64) -> Option<String> {
    let (minimum, maximum) = name.row().range();
    let step = STEP * value.abs().max(0.01 * (maximum - minimum).min(1.0));
    let aside = [value + step, value - step].into_iter().filter(|moved| (minimum..=maximum).contains(moved));
    let details = aside.filter_map(|moved| Parameter::Field(name).moved(scene, moved).err()).next()?;
    Some(format!("{} cannot be unknown in this scene: {details}", name.row().path))
}

/// Unknown components of the state at the beginning of a window: all that something measured depends on.
fn active(map: &ImpactMap, measured: &[bool; STATES], unknown: &[Name]) -> Vec<usize> {
    let follows_place = map.follows_place() || unknown.contains(&Name::FeedbackX);
    let angles: &[usize] = if map.has_angle() { &[0, 1, 2, 3] } else { &[1, 2] };
    let place = (measured[X] || follows_place).then_some(X);
    // The clock comes last: times count from an unknown moment.
    angles.iter().copied().chain(place).chain([T]).collect()
}

/// Sentences on parts of the start that are taken as known.
fn start_notes(request: &FitRequest, from_release: bool) -> Vec<String> {
    let mut notes = Vec::new();
    if from_release {
        let known = FIELDS.iter().filter(|row| row.group() == "release" && !request.unknown.contains(&row.name));
        let values =
            known.filter_map(|row| Some(format!("{} = {} {}", row.path, request.scene.number(row.name)?, row.unit)));
        let values: Vec<String> = values.collect();
        if !values.is_empty() {
            notes.push(format!(
                "the first impact follows from the release, of which is taken as exact: {}",
                values.join(", ")
            ));
        }
    }
    let heights = request.scene.program().map_or(0, |program| program.heights().len());
    if heights > 1 && request.measured.n.is_empty() {
        notes.push(format!(
            "the first row is taken as impact 1, so as strike 1 of the {heights} of table.program: there is no column n"
        ));
    }
    notes
}

/// Reason for each field that acts as a shift of the place of the body does, if it does: no motion tells them apart where no place was measured.
fn place_shifts(draft: &Draft, names: &[Name], states: &[Vector]) -> Vec<Option<String>> {
    let Ok(mut map) = ImpactMap::differentiated(draft, names) else { return vec![None; names.len()] };
    let looked = states.iter().take(STATES_LOOKED_AT);
    let looked: Vec<_> = looked.filter_map(|state| map.next(1, &differentiated(state))).collect();
    // Derivatives of all that was looked at, that by the place less the way of the place itself.
    let by = |direction: usize| {
        let own = |row: usize| if (row, direction) == (X, X) { 1.0 } else { 0.0 };
        let rows =
            looked.iter().flat_map(|found| (0..STATES).map(move |row| found[row].partials[direction] - own(row)));
        DVector::from_iterator(STATES * looked.len(), rows)
    };
    let by_place = by(X);
    let of_field = |field: usize| {
        let by_field = by(STATES + field);
        let (place, size, both) = (by_place.norm_squared(), by_field.norm_squared(), by_field.dot(&by_place));
        let is_shift = place > 0.0 && size > 0.0 && size - both * both / place < SAME_SHIFT * size;
        is_shift.then(|| {
            format!(
                "{path} acts on the motion as a shift of the place x does, and x at the first impact is unknown: measure x of one impact or \
                 more, or give {path} a known value",
                path = names[field].row().path
            )
        })
    };
    (0..names.len()).map(of_field).collect()
}

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
    fn shortest(&self) -> usize {
        let columns = self.measured.iter().filter(|measured| **measured).count().max(1);
        (2 * self.problem.active.len()).div_ceil(columns).max(4)
    }

    /// Minimizes the squares of the whole problem, in which no run may end.
    pub(super) fn settle(&mut self, start: Point, effort: (usize, f64)) -> Result<Minimum, FitFailure> {
        self.watch.minimize(&self.problem, start, effort)?.ok_or(FitFailure::RunEnds)
    }

    /// The squares for each degree of freedom of a problem in short windows, from these fields on, and the fields at their end; `None` if a run
    /// ends.
    fn tried(&mut self, mut problem: Problem, fields: Vec<f64>) -> Result<Option<(f64, Vec<f64>)>, FitFailure> {
        problem.windows = split(problem.rows.len(), self.shortest());
        let Some(point) = problem.guessed(fields) else { return Ok(None) };
        let Some(found) = self.watch.minimize(&problem, point, ROUGH)? else { return Ok(None) };
        // More windows take more unknowns, and each of them a share of the squares. Windows of hardly any impacts follow any data.
        let (values, unknowns) = (problem.values() as f64, problem.unknowns() as f64);
        let is_free = unknowns > values * (1.0 - LEAST_LEFT);
        let cost = found.cost / (values - unknowns).max(LEAST_LEFT * values);
        Ok(Some((if is_free { cost + values } else { cost }, found.point.fields)))
    }

    /// Short windows: numbers of the impacts, several starts, first standard deviations.
    fn first_stage(&mut self, map: &mut ImpactMap, notes: &mut Vec<String>) -> Result<Point, FitFailure> {
        let (rows, found) = renumber(&self.problem.rows, map);
        if !found.is_empty() && rows.len() >= 2 {
            // The change must not cost: the same squares with the numbers as they came are larger, or as large where no short window has the gap in it.
            let changed = Problem { rows, ..self.problem.clone() };
            let mut misfits = [f64::INFINITY; 2];
            for (misfit, problem) in misfits.iter_mut().zip([self.problem.clone(), changed.clone()]) {
                let tried = self.tried(problem, self.typed.clone())?;
                *misfit = tried.map_or(*misfit, |tried| tried.0);
            }
            if misfits[1] <= misfits[0] * NO_DEARER {
                self.problem = changed;
                notes.extend(found);
            }
        }
        self.watch.enter(FitStage::Starts);
        let mut part = self.problem.clone();
        part.rows.truncate(ROWS_OF_STARTS);
        let mut ends: Vec<(f64, Vec<f64>)> = Vec::new();
        for start in 0..=STARTS.len() {
            ends.extend(self.tried(part.clone(), self.start(start))?);
        }
        // The typed start comes first, and stands unless another one is better.
        let best = ends.iter().map(|end| end.0).reduce(f64::min).unwrap_or(f64::INFINITY);
        let taken = ends.into_iter().find(|end| end.0 <= best / 0.99);
        let fields = taken.map_or_else(|| self.typed.clone(), |taken| taken.1);
        self.watch.enter(FitStage::ShortWindows);
        self.problem.windows = split(self.problem.rows.len(), self.shortest());
        let point = self.problem.guessed(fields).ok_or(FitFailure::RunEnds)?;
        let found = self.settle(point, ROUGH)?;
        self.update_sd(&found.point, true);
        Ok(self.settle(found.point, ROUGH)?.point)
    }

    /// Values of a start: the typed ones, or some about them.
    fn start(&self, start: usize) -> Vec<f64> {
        let Some((share, turn)) = start.checked_sub(1).map(|start| STARTS[start]) else { return self.typed.clone() };
        let mut sign = 1.0;
        let moved = |((name, &value), &held): ((&Name, &f64), &bool)| {
            let (minimum, maximum) = name.row().range();
            let moved = value + sign * share * value.abs().max(0.2 * (maximum - minimum).min(1.0));
            sign *= turn;
            if held { value } else { name.row().clamped(moved) }
        };
        self.problem.names.iter().zip(&self.typed).zip(&self.problem.held).map(moved).collect()
    }

    /// Joins windows as long as small deviations stay small and the longer windows explain the data as well.
    fn lengthen(&mut self, mut point: Point) -> Result<Point, FitFailure> {
        self.watch.enter(FitStage::LongerWindows);
        while let Some((windows, start)) = self.problem.joined(&point) {
            self.update_sd(&point, true);
            let longer = Problem { windows, ..self.problem.clone() };
            let freedom = self.problem.freedom();
            let shorter = self.problem.misfit(&point).map_or(f64::INFINITY, |misfit| misfit.cost) / freedom;
            let found = self.watch.minimize(&longer, start, ROUGH)?;
            let most = shorter * (1.0 + f64::max(0.5, 6.0 / freedom.max(1.0).sqrt()));
            match found.filter(|found| found.cost / longer.freedom() <= most) {
                Some(found) => (self.problem, point) = (longer, found.point),
                None => {
                    self.is_followed = false;
                    break;
                }
            }
        }
        Ok(point)
    }

    /// Takes standard deviations that were not given from the residuals: by their median, or by their squares.
    pub(super) fn update_sd(&mut self, point: &Point, robust: bool) {
        let problem = &self.problem;
        let Some(residuals) = problem.residuals(point) else { return };
        let Some(blocks) = problem.linearize(point, self.watch.go_on) else { return };
        let mut taken = leverages(&blocks, &problem.ridges(point)).into_iter();
        let (mut of_column, mut lines): ([Vec<f64>; STATES], [f64; STATES]) = Default::default();
        for (row, residuals) in problem.rows.iter().zip(&residuals) {
            for column in row.columns() {
                of_column[column].push(residuals[column]);
                lines[column] += taken.next().unwrap_or(0.0);
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

impl Problem {
    /// A point with these fields and guessed states, if the scene allows them. Windows in which the run of the model ends are halved.
    pub(super) fn guessed(&mut self, fields: Vec<f64>) -> Option<Point> {
        let mut map = self.map_at(&fields)?;
        let states = guesses(&self.rows, &mut map);
        let released = self.from_release;
        let ends = |range: &Range<usize>, map: &mut ImpactMap| {
            let (from, to) = (self.rows[range.start].n, self.rows[range.end - 1].n);
            follow(map, from, to, &states[range.start]).is_none()
        };
        let mut windows: Vec<Range<usize>> = self.windows.iter().rev().cloned().collect();
        let mut halved = Vec::new();
        while let Some(range) = windows.pop() {
            if range.len() > 1 && ends(&range, &mut map) && !(released && range.start == 0) {
                let middle = range.start + range.len() / 2;
                windows.extend([middle..range.end, range.start..middle]);
            } else {
                halved.push(range);
            }
        }
        self.windows = halved;
        let mut starts: Vec<Vector> = self.windows.iter().map(|range| states[range.start]).collect();
        if released {
            starts[0][T] = clock(&self.rows[0], &mut map);
        }
        Some(Point { fields, starts })
    }
}

/// Time of the data's clock at the release of the scene, s.
fn clock(row: &MeasuredRow, map: &mut ImpactMap) -> f64 {
    let at = map.release.and_then(|at| map.follow(1, row.n, &at));
    at.map_or(0.0, |at| row.values[T] - at[T])
}
