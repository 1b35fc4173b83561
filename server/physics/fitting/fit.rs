//! A fit: checks the request and starts the search.

use super::answer::{Fit, FitFailure, FitRequest, MOST_UNKNOWNS};
use super::impact_map::{ImpactMap, STATES, T, Vector, X};
use super::measured::MeasuredRow;
use super::search::Search;
use super::solver::Problem;
use super::windows::guess;
use crate::scene::{FieldKind, Name};

/// Standard deviations to begin with, where none are given.
const FIRST_SD: Vector = [5e-3, 2e-2, 2e-2, 0.1, 2e-3, 2e-3];

/// Fits fields of a scene to measured impacts.
///
/// # Errors
/// The reason for which there is no fit.
pub fn fit(request: &FitRequest, go_on: &mut dyn FnMut() -> bool) -> Result<Fit, FitFailure> {
    let rows = request.measured.impacts().map_err(FitFailure::Data)?;
    let typed = first_values(request)?;
    let mut draft = request.scene.draft();
    let mut notes = Vec::new();
    if [Name::TimingSd, Name::AngleSd].into_iter().any(|name| request.scene.number(name).is_some_and(|sd| sd > 0.0)) {
        notes.push(
            "the noise of the scene is left out of the fit: the motion between measured impacts is taken as exact"
                .to_owned(),
        );
        for name in [Name::TimingSd, Name::AngleSd, Name::NoiseModel, Name::Seed, Name::NoiseRun] {
            draft.set(name, None).map_err(|error| FitFailure::Scene(vec![error]))?;
        }
    }
    let mut map = ImpactMap::new(&draft).map_err(FitFailure::Scene)?;
    let measured: [bool; STATES] = std::array::from_fn(|column| rows.iter().any(|row| !row.values[column].is_nan()));
    let from_release = request.unknown.iter().any(|name| name.row().group() == "release");
    let active = active(&mut map, &rows, &measured);
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
        held: vec![false; request.unknown.len()],
    };
    let mut search = Search { request, problem, typed, measured, iterations: 0, is_followed: true };
    let first = search.first_stage(&mut map, &mut notes, go_on)?;
    let point = search.lengthen(first, go_on)?;
    search.finish(point, notes, go_on)
}

/// First values of the unknown fields.
fn first_values(request: &FitRequest) -> Result<Vec<f64>, FitFailure> {
    let refuse = |index, detail| Err(FitFailure::Unknown(index, detail));
    let count = request.unknown.len();
    if !(1..=MOST_UNKNOWNS).contains(&count) {
        let detail = format!("{count} fields are unknown; a fit takes 1 to {MOST_UNKNOWNS}");
        return refuse(count.min(MOST_UNKNOWNS), detail);
    }
    let mut values = Vec::new();
    for (index, &name) in request.unknown.iter().enumerate() {
        let row = name.row();
        if request.unknown[..index].contains(&name) {
            return refuse(index, format!("{} is there twice", row.path));
        }
        if !matches!(row.kind, FieldKind::Number { .. }) || row.group() == "noise" {
            return refuse(index, format!("{} is no number that a motion without noise depends on", row.path));
        }
        let Some(value) = request.scene.number(name) else {
            return refuse(
                index,
                format!("{} has no value in the scene; give a first guess, {}", row.path, row.limits()),
            );
        };
        values.push(value);
    }
    Ok(values)
}

/// Unknown components of the state at the beginning of a window: all that something measured depends on.
fn active(map: &mut ImpactMap, rows: &[MeasuredRow], measured: &[bool; STATES]) -> Vec<usize> {
    let start = guess(rows, 0, map, None);
    let mut aside = start;
    aside[X] += 0.01;
    let follows_place = match (map.next(rows[0].n, &start), map.next(rows[0].n, &aside)) {
        (Some(here), Some(there)) => here[..X] != there[..X],
        _ => false,
    };
    let angles: &[usize] = if map.has_angle() { &[0, 1, 2, 3] } else { &[1, 2] };
    let place = (measured[X] || follows_place).then_some(X);
    // The clock comes last: times count from an unknown moment.
    angles.iter().copied().chain(place).chain([T]).collect()
}
