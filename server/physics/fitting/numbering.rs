//! Finds impacts that were missed, and rows that are no impact: flight times beside those that the model predicts from measured states.

use super::impact_map::{ImpactMap, T, Vector};
use super::measured::{MeasuredRow, median};
use super::windows::{follow, guess, guesses};

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
    let mut at = 0;
    while at < rows.len() {
        let shifted = |row: &MeasuredRow, shift: i64| MeasuredRow { n: row.n.saturating_add_signed(shift), ..*row };
        let row = shifted(&rows[at], shift);
        at += 1;
        let Some(last) = kept.last().copied() else {
            kept.push(row);
            continue;
        };
        let time = row.values[T] - last.values[T];
        let carried = state.filter(|_| kept.len() > 1);
        let here = guess(&kept, kept.len() - 1, map, carried);
        let times: Vec<f64> = predicted(last.n, &here, map).into_iter().map(|time| time * scale).collect();
        let flights = row.n.saturating_sub(last.n).max(1);
        let (Some(&one), Some(&expected)) = (times.first(), times.get(flights as usize - 1)) else {
            kept.push(row);
            continue;
        };
        // The row after this one, seen from the last.
        let beyond = rows.get(at).map(|next| next.values[T] - last.values[T]);
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
            kept.push(MeasuredRow { n: row.n + missed, ..row });
            state = follow(map, last.n, row.n + missed, &here);
            continue;
        }
        kept.push(row);
        state = follow(map, last.n, row.n, &here);
    }
    (kept, notes)
}
