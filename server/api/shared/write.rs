//! Writes answers: JSON, tables as CSV, NDJSON and Arrow, pictures, and the canonical form of a request.

use equipoise_physics::scene::Scene;
use serde::Serialize;

use crate::api::scene::write::Resolved;
use crate::api::shared::table::Table;
use crate::api::shared::table::rest::Rest;
use crate::charts::{NoPixels, png};
use crate::compute::{Cancelled, TimeSlice};
use crate::http::Problem;
use crate::http::output::write_to_memory;

/// Length of a cell as text, bytes: a number of 17 digits with sign, point and comma.
const CELL_BYTES: usize = 20;

/// Length of a cell in Arrow, bytes: a double, with its share of bits for nulls.
const ARROW_CELL_BYTES: usize = 9;

/// Length of an answer besides its table, bytes, of most answers.
const OTHER_BYTES: usize = 2048;

/// Room for a table of so many cells, bytes.
fn room(cells: usize) -> usize {
    OTHER_BYTES + CELL_BYTES * cells
}

/// An answer as JSON.
pub(crate) fn json(answer: &impl Serialize, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    json_with_table(answer, 0, slice)
}

/// An answer with a table of so many cells as JSON.
pub(crate) fn json_with_table(answer: &impl Serialize, cells: usize, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    write_to_memory(room(cells), &|| slice.should_continue(), |out| Ok(serde_json::to_writer(out, answer)?))
}

/// A table as CSV.
pub(crate) fn csv(table: &Table, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    write_to_memory(room(table.cells()), &|| slice.should_continue(), |out| table.write_csv(out))
}

/// A table as NDJSON, with `end` in its last line.
pub(crate) fn ndjson(table: &Table, end: &impl Serialize, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    let room = room(table.cells()) + table.rows() * table.names_bytes();
    write_to_memory(room, &|| slice.should_continue(), |out| table.write_ndjson(end, out))
}

/// A table as a stream of Arrow, with meanings of its columns, and the rest of the answer as JSON in its schema.
pub(crate) fn arrow(
    table: &Table,
    about: impl Fn(&str) -> &'static str,
    rest: String,
    slice: &TimeSlice,
) -> Result<Vec<u8>, Problem> {
    let room = ARROW_CELL_BYTES * table.cells() + rest.len() + OTHER_BYTES;
    write_to_memory(room, &|| slice.should_continue(), |out| table.write_arrow(about, rest, out))
}

/// The JSON of an answer without some of its members.
pub(crate) fn rest_of(
    answer: &impl Serialize,
    members: &'static [&'static str],
    slice: &TimeSlice,
) -> Result<String, Problem> {
    let rest = json(&Rest { answer, without: members }, slice)?;
    String::from_utf8(rest).map_err(|_| Problem::internal())
}

/// An SVG in pixels, as PNG.
pub(crate) fn pixels(svg: &str, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    png(svg, || slice.should_continue()).map_err(|none| match none {
        NoPixels::Cancelled => Cancelled.into(),
        NoPixels::Unfit => Problem::internal(),
    })
}

/// Canonical form of a request: the scene with all defaults, and everything else that determines the answer.
pub(crate) fn canonical(scene: &Scene, rest: &impl Serialize) -> Vec<u8> {
    canonical_of(&(Resolved(scene), rest))
}

/// Canonical form of a request without a scene.
pub(crate) fn canonical_of(request: &impl Serialize) -> Vec<u8> {
    // Writing to memory does not fail.
    serde_json::to_vec(request).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::shared::table::{Cells, Column};
    use equipoise_physics::numbers::double_double::DoubleDouble;

    #[test]
    fn a_large_table_is_not_written_for_nobody() {
        let cells = Cells::Decimals(vec![Some(DoubleDouble::from(0.1)); 100_000]);
        let table = Table(vec![Column { name: "t", unit: "s", cells }]);
        type Way = fn(&Table, &TimeSlice) -> Result<Vec<u8>, Problem>;
        let ways: [Way; 4] = [
            |table, slice| json(table, slice),
            csv,
            |table, slice| ndjson(table, &"end", slice),
            |table, slice| arrow(table, |_| "", "{}".to_owned(), slice),
        ];
        for write in ways {
            let slice = TimeSlice::unbounded();
            assert!(write(&table, &slice).unwrap().len() > 3_000_000);
            slice.cancel().set();
            assert_eq!(write(&table, &slice).unwrap_err().status(), 503);
        }
    }
}
