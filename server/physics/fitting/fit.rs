//! A fit: checks the request and starts the search.

use super::answer::{Fit, FitFailure, FitProgress, FitRequest, FitStage};
use super::impact_map::{ImpactMap, MOST_UNKNOWNS, STATES, T, Vector, X, differentiated};
use super::report::{FINE, effort_beside};
use super::search::{ROUGH, STARTS, Search};
use super::solver::{Problem, Watch};
use super::windows::{JOINED, guesses, split};
use crate::analysis::limits::Parameter;
use crate::scene::{Draft, ERRORS, FIELDS, FieldKind, Name, Scene, names_of};
use nalgebra::DVector;

/// Searches that are planned for the numbers of impacts, with and without a change; for short windows, before and after standard deviations are
/// estimated; and for outliers, to leave them out and to see that they stay the same.
const TWICE: u64 = 2;

/// First rows at which derivatives by a field and by the place are compared, and the share of the squares that may differ: derivatives are exact to
/// 1e-10.
const STATES_LOOKED_AT: usize = 20;
const SAME_SHIFT: f64 = 1e-10;

/// Standard deviations to begin with, where none are given.
const FIRST_SD: Vector = [5e-3, 2e-2, 2e-2, 0.1, 2e-3, 2e-3];

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
        for name in names_of("noise") {
            draft.set(name, None).map_err(|error| FitFailure::Scene(vec![error]))?;
        }
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
        FitStage::Beside => fields * effort_beside(),
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
