//! Windows of impacts, a first guess of the state at each impact, and the numbers of the impacts: flight times beside those that the model
//! predicts from measured states tell which were missed, and which rows are no impact.

use super::impact_map::{ImpactMap, T, Vector, X};
use super::measured::MeasuredRow;
use super::statistics::median;
use crate::numbers::trig::sin_cos;
use std::ops::Range;

/// Windows of `length` rows; the last one takes the rest.
pub(super) fn split(rows: usize, length: usize) -> Vec<Range<usize>> {
    let count = (rows / length).max(1);
    (0..count).map(|window| window * length..if window + 1 == count { rows } else { (window + 1) * length }).collect()
}

/// A state just before the impact of each row. What the data do not say is carried along from the row before by the map.
pub(super) fn guesses(rows: &[MeasuredRow], map: &mut ImpactMap) -> Vec<Vector> {
    let mut found: Vec<Vector> = Vec::with_capacity(rows.len());
    for at in 0..rows.len() {
        let carried = found.last().and_then(|last| follow(map, rows[at - 1].n, rows[at].n, last));
        found.push(guess(rows, at, map, carried));
    }
    found
}

/// The state just before impact `to`, from that just before impact `from`.
pub(super) fn follow(map: &mut ImpactMap, from: u64, to: u64, state: &Vector) -> Option<Vector> {
    map.follow(from, to.min(from + LONGEST_GUESS), state)
}

/// The state just before the impact of a row, from its values and those of the rows beside it; for the rest from the state that is carried
/// along, or from the scene's own run.
pub(super) fn guess(rows: &[MeasuredRow], at: usize, map: &mut ImpactMap, carried: Option<Vector>) -> Vector {
    let row = &rows[at];
    let rod = map.body().rod;
    let own_run = |map: &mut ImpactMap| {
        let release = map.release.filter(|_| row.n <= LONGEST_OWN_RUN)?;
        follow(map, 1, row.n, &release)
    };
    let mut state = carried.or_else(|| own_run(map)).unwrap_or([0.0, 0.0, -1.0, 0.0, 0.0, 0.0]);
    let before = at.checked_sub(1).map(|before| &rows[before]).filter(|before| before.n + 1 == row.n);
    let after = rows.get(at + 1).filter(|after| after.n == row.n + 1);
    let flight = |from: &MeasuredRow, to: &MeasuredRow| Some(to.values[T] - from.values[T]).filter(|time| *time > 0.0);
    let slope = |column: usize| {
        let (from, time) = before.and_then(|from| Some((from, flight(from, row)?)))?;
        Some((row.values[column] - from.values[column]) / time).filter(|slope| !slope.is_nan())
    };
    if let Some(time) = before.and_then(|from| flight(from, row)) {
        // Both contacts are at y = 0, and the flight between them is ballistic.
        let rise = |values: &Vector| if values[0].is_nan() { 0.0 } else { rod.contact_distance * sin_cos(values[0]).1 };
        let risen = before.filter(|from| !from.values[0].is_nan() && !row.values[0].is_nan());
        let risen = risen.map_or(0.0, |from| rise(&row.values) - rise(&from.values));
        state[2] = risen / time - 0.5 * rod.gravity * time;
        state[1] = slope(X).unwrap_or(state[1]);
        state[3] = slope(0).unwrap_or(state[3]);
    } else if let Some(time) = after.and_then(|to| flight(row, to)) {
        state[2] = -0.5 * rod.gravity * time;
    }
    for (column, component) in state.iter_mut().enumerate() {
        if row.counts(column) {
            *component = row.values[column];
        }
    }
    state
}

/// Longest run from the release that a guess follows, impacts: later the scene's own run says nothing about the rig.
const LONGEST_OWN_RUN: u64 = 100;

/// Longest run between two rows that a guess follows, impacts.
const LONGEST_GUESS: u64 = 10_000;

/// Most impacts in a row that are looked for as missed.
const MOST_MISSED: u64 = 4;

/// Share of the predicted flight below which a flight is too short to be one.
const TOO_SHORT: f64 = 0.4;

/// Share of the predicted flight above which it is more than one.
const TOO_LONG: f64 = 1.5;

/// Largest error, in flights, of a flight that is explained by missed or doubled impacts.
const EXPLAINED: f64 = 0.3;

/// The predicted duration of flights after a row: of the first, the first two, and so on.
fn predicted(n: u64, state: &Vector, map: &mut ImpactMap) -> Vec<f64> {
    let (start, mut state, mut times) = (state[T], *state, Vec::new());
    for n in n..n + MOST_MISSED + 1 {
        let Some(next) = map.next(n, &state) else { break };
        state = next;
        times.push(state[T] - start);
    }
    times
}

/// Rows with their numbers set right, and a sentence on each change.
pub(super) fn renumber(rows: &[MeasuredRow], map: &mut ImpactMap) -> (Vec<MeasuredRow>, Vec<String>) {
    let states = guesses(rows, map);
    let ratios = (0..rows.len() - 1).filter_map(|at| {
        let flights = rows[at + 1].n - rows[at].n;
        let time = rows[at + 1].values[T] - rows[at].values[T];
        let expected = *predicted(rows[at].n, &states[at], map).get(flights as usize - 1)?;
        Some(time / expected).filter(|ratio| !ratio.is_nan())
    });
    let scale = median(ratios.collect()).unwrap_or(1.0);
    let (mut kept, mut notes, mut shift) = (Vec::<MeasuredRow>::new(), Vec::new(), 0_i64);
    // The state just before the last impact that is kept.
    let mut state: Option<Vector> = None;
    for (at, row) in rows.iter().enumerate() {
        let mut row = MeasuredRow { n: row.n.saturating_add_signed(shift), ..*row };
        let Some(last) = kept.last().copied() else {
            kept.push(row);
            continue;
        };
        let time = row.values[T] - last.values[T];
        let here = guess(&kept, kept.len() - 1, map, state);
        let times: Vec<f64> = predicted(last.n, &here, map).into_iter().map(|time| time * scale).collect();
        let flights = row.n.saturating_sub(last.n).max(1);
        let (Some(&one), Some(&expected)) = (times.first(), times.get(flights as usize - 1)) else {
            kept.push(row);
            continue;
        };
        // The row after this one, seen from the last.
        let beyond = rows.get(at + 1).map(|next| next.values[T] - last.values[T]);
        let fits = |time: f64, expected: f64| (time - expected).abs() < EXPLAINED * one;
        if flights == 1 && time < TOO_SHORT * one && beyond.is_none_or(|beyond| fits(beyond, one)) {
            let detail = format!(
                "row {} (t = {} s) is {time} s after the one before, where a flight of about {one} s is predicted: a \
                 doubled impact, left out",
                row.index + 1,
                row.values[T]
            );
            notes.push(detail);
            shift -= 1;
            continue;
        }
        let best = times.iter().zip(1_u64..).min_by(|a, b| (a.0 - time).abs().total_cmp(&(b.0 - time).abs()));
        if let Some((&found, count)) = best
            && count > flights
            && time > expected + (TOO_LONG - 1.0) * one
            && fits(time, found)
        {
            let missed = count - flights;
            let detail = format!(
                "{missed} impact{} between rows {} and {} (t = {} s to {} s) {} missed: the time between them is that of {count} flights",
                if missed == 1 { "" } else { "s" },
                last.index + 1,
                row.index + 1,
                last.values[T],
                row.values[T],
                if missed == 1 { "was" } else { "were" },
            );
            notes.push(detail);
            shift += missed as i64;
            row.n += missed;
        }
        kept.push(row);
        state = follow(map, last.n, row.n, &here);
    }
    (kept, notes)
}
