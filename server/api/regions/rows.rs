//! The cells of a map as rows of CSV and NDJSON. Each row is written as soon as it is complete.

use equipoise_physics::scene::Name;
use equipoise_physics::surveys::stability_map::{MapCell, MapQuantity, StabilityMap};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::regions::answer::{Counts, Outcomes, RowValues, outcome_name, written};
use crate::api::regions::request::{RegionRequest, quantity_name};
use crate::api::shared::table::with_unit;

/// A format whose rows are sent as they are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowFormat {
    /// Rows of CSV.
    Csv,
    /// Lines of JSON, and a last line.
    Ndjson,
}

/// Writes the cells of a tile row by row, as they are computed.
#[derive(Debug)]
pub struct Rows {
    request: RegionRequest,
    format: RowFormat,
    /// The values of x, as CSV has them.
    columns: Vec<String>,
    /// The next row, and its cells so far.
    row: usize,
    begun: Vec<MapCell>,
    counts: Counts,
}

impl Rows {
    /// No rows yet.
    pub fn new(request: RegionRequest, format: RowFormat) -> Self {
        let x = request.map.x;
        let columns = match format {
            RowFormat::Csv => (0..x.count).map(|column| written(x.value(column))).collect(),
            RowFormat::Ndjson => Vec::new(),
        };
        Self {
            request,
            format,
            columns,
            row: request.rows().start,
            begun: Vec::new(),
            counts: Counts::new(request.map.quantity),
        }
    }

    /// Text before all rows: in CSV the names of the two fields, the quantity and `outcome`.
    pub fn begin(&self) -> Vec<u8> {
        let StabilityMap { x, y, quantity, .. } = self.request.map;
        if self.format != RowFormat::Csv {
            return Vec::new();
        }
        let field = |name: Name| with_unit(name.row().path, name.row().unit);
        let value = with_unit(quantity_name(quantity), quantity_unit(quantity));
        format!("{},{},{value},outcome\r\n", field(x.name), field(y.name)).into_bytes()
    }

    /// The rows that are complete with these cells.
    pub fn add(&mut self, cells: &[MapCell]) -> Vec<u8> {
        self.counts.add(cells);
        self.begun.extend_from_slice(cells);
        let columns = self.request.map.x.count;
        let whole = self.begun.len() - self.begun.len() % columns;
        let mut out = Vec::new();
        if whole == 0 {
            return out;
        }
        let rest = self.begun.split_off(whole);
        let rows = std::mem::replace(&mut self.begun, rest);
        let rows = rows.chunks_exact(columns);
        for cells in rows {
            match self.format {
                RowFormat::Csv => self.write_csv(cells, &mut out),
                RowFormat::Ndjson => self.write_line(cells, &mut out),
            }
            self.row += 1;
        }
        out
    }

    /// Text after all rows: in NDJSON the line that marks the end.
    pub fn end(&self) -> Vec<u8> {
        #[derive(Serialize)]
        struct End<'a> {
            end: &'a Counts,
        }
        let mut out = Vec::new();
        if self.format == RowFormat::Ndjson {
            line(&End { end: &self.counts }, &mut out);
        }
        out
    }

    fn write_csv(&self, cells: &[MapCell], out: &mut Vec<u8>) {
        let y = written(self.request.map.y.value(self.row));
        let whole = self.request.is_whole();
        for (cell, x) in cells.iter().zip(&self.columns) {
            let value = match cell.value {
                Some(value) if whole => (value as u64).to_string(),
                Some(value) => written(value),
                None => String::new(),
            };
            for part in [x, ",", &y, ",", &value, ",", outcome_name(cell), "\r\n"] {
                out.extend_from_slice(part.as_bytes());
            }
        }
    }

    fn write_line(&self, cells: &[MapCell], out: &mut Vec<u8>) {
        let (row, y, whole) = (self.row, self.request.map.y.value(self.row), self.request.is_whole());
        line(
            &RegionRow {
                row,
                y,
                values: RowValues { cells, whole },
                outcomes: Outcomes(cells, self.request.map.quantity),
            },
            out,
        );
    }
}

/// A row of cells.
#[derive(Serialize, JsonSchema)]
pub(super) struct RegionRow<'a> {
    row: usize,
    y: f64,
    #[schemars(with = "Vec<Option<f64>>")]
    values: RowValues<'a>,
    #[schemars(with = "Vec<u64>")]
    outcomes: Outcomes<'a>,
}

/// Unit of a quantity; empty for none.
pub(super) fn quantity_unit(quantity: MapQuantity) -> &'static str {
    match quantity {
        MapQuantity::MaxTheta => "rad",
        MapQuantity::RestTime => "s",
        MapQuantity::Survival | MapQuantity::Residue | MapQuantity::SpectralRadius | MapQuantity::Caught => "",
    }
}

fn line(value: &impl Serialize, out: &mut Vec<u8>) {
    // Writing to memory does not fail.
    let _ = serde_json::to_writer(&mut *out, value);
    out.push(b'\n');
}
