//! Windows of impacts: how they begin, how long they may be, and a first guess of the state at their beginning.

use super::impact_map::{Differentiated, ImpactMap, T, Vector, X, differentiated};
use super::measured::MeasuredRow;
use super::solver::{Point, Problem};
use crate::numbers::trig::sin_cos;
use std::ops::Range;

/// Greatest growth of a small deviation of the state over a window. Beyond it the squares have more than one minimum within the noise.
const MOST_GROWTH: f64 = 100.0;

/// Windows that are joined to one at a time.
pub(super) const JOINED: usize = 3;

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

/// Growth of a small deviation over a window, in angle, velocity over that of the bounce, and angular velocity times flight time.
fn growth(map: &mut ImpactMap<Differentiated>, rows: &[MeasuredRow], start: &Vector) -> Option<f64> {
    const ANGLE_AND_VELOCITIES: usize = 4;
    let (mut at, mut most) = (differentiated(start), 1.0_f64);
    let (first, last) = (rows.first()?.n, rows.last()?.n);
    let speed = start[2].abs().max(1e-3);
    let mut scales = [1.0, speed, speed, 1.0];
    for n in first..last {
        // Of the place alone a deviation does not grow.
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

/// The same point with up to [`JOINED`] windows at a time joined to one, where small deviations stay small over it; `None` if none can be.
pub(super) fn join(problem: &Problem, point: &Point) -> Option<(Vec<Range<usize>>, Vec<Vector>)> {
    let mut map = ImpactMap::differentiated(&problem.draft_at(&point.fields)?, &[]).ok()?;
    let mut plain = problem.map_at(&point.fields)?;
    let (mut windows, mut starts) = (Vec::new(), Vec::new());
    let mut place = 0;
    while place < problem.windows.len() {
        let from = problem.windows[place].start;
        let mut count = JOINED.min(problem.windows.len() - place);
        // A rest of one or two goes with the last.
        if problem.windows.len() - place - count < JOINED && problem.windows.len() - place - count > 0 {
            count = problem.windows.len() - place;
        }
        while count > 1 {
            let rows = &problem.rows[from..problem.windows[place + count - 1].end];
            let states = problem.followed(place, point.starts[place], &mut plain, &mut || true);
            let start = states.map_or(point.starts[place], |states| states[0]);
            if growth(&mut map, rows, &start).is_some_and(|growth| growth <= MOST_GROWTH) {
                break;
            }
            count -= 1;
        }
        windows.push(from..problem.windows[place + count - 1].end);
        starts.push(point.starts[place]);
        place += count;
    }
    (windows.len() < problem.windows.len()).then_some((windows, starts))
}
