//! `/v1/regions`: maps of stability over two fields of a scene.

pub mod request;

use std::sync::{Arc, LazyLock};

use arrow_array::{ArrayRef, Float64Array, Int64Array};
use arrow_schema::{DataType, Field};
use equipoise_physics::catching::outcome::CatchOutcomeKind;
use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::scene::Name;
use equipoise_physics::surveys::stability_map;
use equipoise_physics::surveys::stability_map::{MapAxis, MapCell, MapOutcome, MapQuantity, StabilityMap};

use crate::api::computed::regions::request::{RegionQuantity, RegionRequest, quantity_name};
use crate::api::prelude::*;
use crate::api::scene::field_text;
use crate::api::shared::arrow::{ArrowStream, Dictionary, field};
use crate::api::shared::request_parts::Tile;
use crate::api::shared::table::with_unit;
use crate::api::shared::write::{line, rest_of};
use crate::charts::{HeatAxis, HeatMap, heat_map};

impl ComputedResource for RegionRequest {
    const NAME: &'static str = "regions";
    const SINGULAR: &'static str = "Region";
    type Format = ChartFormat;
    const WORK: Work<Self, ChartFormat> = Work::InSlices {
        canonical: RegionRequest::canonical,
        streamed: &[Format::Csv, Format::Ndjson, Format::Arrow],
        compute: |request, format, slices, out, bounces| {
            let (cells, block) = (request.numbers(), request.block_cells());
            let blocks = cells.len().div_ceil(block);
            let compute = |number: usize, slice: &TimeSlice| {
                let first = cells.start + number * block;
                let computed =
                    request.map.cells(first..(first + block).min(cells.end), &mut || slice.should_continue())?;
                bounces.inc_by(request.bounces_of(&computed));
                Some(computed)
            };
            let spread: Spread<'_> = &|done| slices.parallel_map(blocks, compute, done);
            match format {
                ChartFormat::Csv => send_rows(Rows::new(*request, RowFormat::Csv), out, spread),
                ChartFormat::Ndjson => send_rows(Rows::new(*request, RowFormat::Ndjson), out, spread),
                ChartFormat::Arrow => send_arrow(request, slices, out, spread),
                ChartFormat::Json => send_whole(request, FigureFormat::Json, slices, out, spread),
                ChartFormat::Svg => send_whole(request, FigureFormat::Svg, slices, out, spread),
                ChartFormat::Png => send_whole(request, FigureFormat::Png, slices, out, spread),
            }
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract.answer::<Region<'static>>().line::<RegionRow<'static>>().end::<Counts>();
    }
}

/// Computes all cells, and hands them on block by block.
type Spread<'a> = &'a dyn Fn(&mut (dyn FnMut(Vec<MapCell>) + Send)) -> Result<(), Cancelled>;

/// Sends the cells row by row, as they are computed by `spread`.
fn send_rows(mut rows: Rows, out: &mut BodyWriter, spread: Spread<'_>) -> Result<(), Problem> {
    out.send(rows.begin());
    spread(&mut |cells| out.send(rows.add(&cells)))?;
    out.send(rows.end());
    Ok(())
}

/// Sends the cells batch by batch, as they are computed by `spread`.
fn send_arrow(
    request: &RegionRequest,
    slices: &TimeSlices,
    out: &mut BodyWriter,
    spread: Spread<'_>,
) -> Result<(), Problem> {
    // The schema has the limit curves.
    let mut stream = slices.run_one(|slice| {
        let answer = RegionAnswer::new(*request, Vec::new(), || slice.should_continue()).ok_or(Cancelled)?;
        let rest = rest_of(&answer, &["x", "y", "values", "outcomes", "counts"], slice)?;
        ArrowStream::new(fields(request), rest).map_err(|_| Problem::internal())
    })??;
    let outcomes = Dictionary::new(outcome_names(request.map.quantity).to_vec());
    let (mut next, mut failed) = (request.numbers().start, None);
    spread(&mut |cells| {
        let mut batch = Vec::new();
        match stream.write(columns(request, next, &cells, &outcomes), &mut batch) {
            Ok(()) => out.send(batch),
            Err(error) => failed = Some(error),
        }
        next += cells.len();
    })?;
    let mut end = Vec::new();
    if let Err(error) = failed.map_or_else(|| stream.end(&mut end), Err) {
        tracing::error!(%error, "a batch of Arrow was not written");
        return Err(Problem::internal());
    }
    out.send(end);
    Ok(())
}

/// Sends the answer once all cells are computed by `spread`.
fn send_whole(
    request: &RegionRequest,
    format: FigureFormat,
    slices: &TimeSlices,
    out: &mut BodyWriter,
    spread: Spread<'_>,
) -> Result<(), Problem> {
    let mut all = Vec::with_capacity(request.numbers().len());
    spread(&mut |cells| all.extend(cells))?;
    slices.run_one(|slice| {
        let answer = RegionAnswer::new(*request, all, || slice.should_continue()).ok_or(Cancelled)?;
        Ok(out.send_whole(format.write(&answer, slice)?, slice)?)
    })?
}

/// Outcome of a cell without a run.
const NO_RUN: &str = "none";

/// Answer of `/v1/regions`: the cells of a tile.
#[derive(Debug)]
pub struct RegionAnswer {
    request: RegionRequest,
    cells: Vec<MapCell>,
    limit_curves: Vec<stability_map::BoundarySegment>,
}

impl RegionAnswer {
    /// The answer for the cells of a tile, row by row. Computes the limit curves; `None` if `go_on` returned false meanwhile.
    pub fn new(request: RegionRequest, cells: Vec<MapCell>, mut go_on: impl FnMut() -> bool) -> Option<Self> {
        // The limit curves are those of the scene's own law, which a catch does not follow.
        let limit_curves = if request.map.quantity.is_of_catches() {
            Vec::new()
        } else {
            request.map.boundary(limits::REGION_BOUNDARY_NODES, &mut go_on)?
        };
        Some(Self { request, cells, limit_curves })
    }

    fn rows(&self) -> impl Iterator<Item = (usize, &[MapCell])> {
        self.request.rows().zip(self.cells.chunks(self.request.map.x.count))
    }

    fn counts(&self) -> Counts {
        let mut counts = Counts::new(self.request.map.quantity);
        counts.add(&self.cells);
        counts
    }
}

pub(crate) fn written(value: f64) -> String {
    serde_json::to_string(&value).unwrap_or_default()
}

/// Number of a cell's outcome among those of the quantity. The number after the last outcome stands for a cell without a run.
fn code(cell: &MapCell, quantity: MapQuantity) -> usize {
    cell.outcome.map_or_else(|| outcome_names(quantity).len() - 1, MapOutcome::code)
}

pub(crate) fn outcome_name(cell: &MapCell) -> &'static str {
    cell.outcome.map_or(NO_RUN, MapOutcome::name)
}

/// Names of the outcomes of a quantity, each at the place of its code.
fn outcome_names(quantity: MapQuantity) -> &'static [&'static str] {
    if quantity.is_of_catches() { &OF_CATCHES } else { &OF_RUNS }
}

/// Names of the endings of runs, and of a cell without a run.
static OF_RUNS: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| EndingKind::ALL.into_iter().map(EndingKind::name).chain([NO_RUN]).collect());

/// Names of the outcomes of catches, and of a cell without one.
static OF_CATCHES: LazyLock<Vec<&'static str>> =
    LazyLock::new(|| CatchOutcomeKind::ALL.into_iter().map(CatchOutcomeKind::name).chain([NO_RUN]).collect());

/// A row of values. Numbers of contacts are written as whole numbers.
pub(crate) struct RowValues<'a> {
    pub(crate) cells: &'a [MapCell],
    pub(crate) whole: bool,
}

impl Serialize for RowValues<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let values = self.cells.iter().map(|cell| cell.value);
        if self.whole {
            serializer.collect_seq(values.map(|value| value.map(|value| value as u64)))
        } else {
            serializer.collect_seq(values)
        }
    }
}

pub(crate) struct Outcomes<'a>(pub(crate) &'a [MapCell], pub(crate) MapQuantity);

impl Serialize for Outcomes<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.0.iter().map(|cell| code(cell, self.1)))
    }
}

schemas! {
    /// Number of cells by outcome of their runs; `none` counts cells without one.
    RegionCounts = counts(OF_RUNS.iter().copied());
    /// Number of cells by outcome of their catches; `none` counts cells without one.
    CatchCounts = counts(OF_CATCHES.iter().copied());
}

/// Number of cells by outcome, of runs or of catches.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "a schema alone: the counts are a list")]
enum CellCounts {
    Runs(RegionCounts),
    Catches(CatchCounts),
}

/// Number of cells of each outcome.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "RegionEnd")]
pub(crate) struct Counts {
    #[serde(serialize_with = "by_name")]
    #[schemars(with = "CellCounts")]
    counts: (MapQuantity, Vec<u64>),
}

impl Counts {
    /// No cells of a map of this quantity.
    pub(crate) fn new(quantity: MapQuantity) -> Self {
        Self { counts: (quantity, vec![0; outcome_names(quantity).len()]) }
    }

    pub(crate) fn add(&mut self, cells: &[MapCell]) {
        let (quantity, counts) = &mut self.counts;
        for cell in cells {
            if let Some(count) = counts.get_mut(code(cell, *quantity)) {
                *count += 1;
            }
        }
    }
}

fn by_name<S: Serializer>((quantity, counts): &(MapQuantity, Vec<u64>), serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(outcome_names(*quantity).iter().zip(counts))
}

/// A segment of a curve over the whole map on which the residue is 0 or 1, an end of the linear verdict.
#[derive(Debug, Serialize, JsonSchema)]
struct LimitSegment {
    /// 0 or 1.
    residue: f64,
    x: [f64; 2],
    y: [f64; 2],
}

/// A side of the whole map.
#[derive(Debug, Serialize, JsonSchema)]
struct RegionAxis {
    field: &'static str,
    unit: &'static str,
    from: f64,
    to: f64,
    count: usize,
}

/// A tile of a map.
#[derive(Serialize, JsonSchema)]
struct Region<'a> {
    scene: Resolved,
    /// Largest number of contacts of each run.
    bounces: u64,
    #[schemars(with = "RegionQuantity")]
    quantity: &'static str,
    /// The two sides of the whole map, x first.
    axes: [RegionAxis; 2],
    /// The tile: a band of whole rows.
    tile: Tile,
    /// The values along a row.
    x: Vec<f64>,
    /// The value of each row of the tile.
    y: Vec<f64>,
    /// A row for each y. Null if the scene is not valid. `rest_time` is also null if the body does not come to rest in the time that is followed.
    /// `residue` and `spectral_radius` are also null without a fixed point; `residue` also for a point mass, with state feedback, and if friction
    /// couples the angle with the other components.
    #[schemars(with = "Vec<Vec<Option<f64>>>")]
    values: Vec<RowValues<'a>>,
    /// For each cell, the index of its outcome in `outcome_names`.
    #[schemars(with = "Vec<Vec<u64>>")]
    outcomes: Vec<Outcomes<'a>>,
    outcome_names: Vec<&'static str>,
    limit_curves: Vec<LimitSegment>,
    #[serde(flatten)]
    counts: Counts,
    notes: Vec<String>,
}

impl Serialize for RegionAnswer {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let RegionRequest { map, scene, tile } = &self.request;
        let side = |axis: MapAxis| {
            let row = axis.name.row();
            RegionAxis { field: row.path, unit: row.unit, from: axis.from, to: axis.to, count: axis.count }
        };
        let mut notes = vec!["scene is one of the region; x and y replace its two fields".to_owned()];
        if self.cells.iter().any(|cell| cell.value.is_none()) {
            let beside = match map.quantity {
                MapQuantity::Survival | MapQuantity::MaxTheta | MapQuantity::Caught => "",
                MapQuantity::RestTime => ", or the body does not come to rest in the time that is followed",
                MapQuantity::SpectralRadius => ", has no fixed point or has noise",
                MapQuantity::Residue => {
                    ", has no fixed point or has noise; and where the angle has no block of its own: of a point mass, with \
                     state feedback, and where friction holds the contact"
                }
            };
            notes.push(format!("a value is null where the scene cannot be{beside}"));
        }
        Region {
            scene: Resolved(*scene),
            bounces: map.impacts,
            quantity: quantity_name(map.quantity),
            axes: [side(map.x), side(map.y)],
            tile: *tile,
            x: (0..map.x.count).map(|column| map.x.value(column)).collect(),
            y: self.request.rows().map(|row| map.y.value(row)).collect(),
            values: self.rows().map(|(_, cells)| RowValues { cells, whole: self.request.is_whole() }).collect(),
            outcomes: self.rows().map(|(_, cells)| Outcomes(cells, map.quantity)).collect(),
            outcome_names: outcome_names(map.quantity).to_vec(),
            limit_curves: self
                .limit_curves
                .iter()
                .map(|&(residue, a, b)| LimitSegment { residue, x: [a[0], b[0]], y: [a[1], b[1]] })
                .collect(),
            counts: self.counts(),
            notes,
        }
        .serialize(serializer)
    }
}

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
        if self.format == RowFormat::Ndjson { line(&End { end: &self.counts }) } else { Vec::new() }
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
        let RegionRequest { map, .. } = self.request;
        let values = RowValues { cells, whole: self.request.is_whole() };
        let outcomes = Outcomes(cells, map.quantity);
        out.append(&mut line(&RegionRow { row: self.row, y: map.y.value(self.row), values, outcomes }));
    }
}

/// A row of cells.
#[derive(Serialize, JsonSchema)]
struct RegionRow<'a> {
    row: usize,
    y: f64,
    #[schemars(with = "Vec<Option<f64>>")]
    values: RowValues<'a>,
    #[schemars(with = "Vec<u64>")]
    outcomes: Outcomes<'a>,
}

/// Unit of a quantity; empty for none.
fn quantity_unit(quantity: MapQuantity) -> &'static str {
    match quantity {
        MapQuantity::MaxTheta => "rad",
        MapQuantity::RestTime => "s",
        MapQuantity::Survival | MapQuantity::Residue | MapQuantity::SpectralRadius | MapQuantity::Caught => "",
    }
}

/// Columns of Arrow with a row for each cell, from number `first` on.
fn columns(request: &RegionRequest, first: usize, cells: &[MapCell], outcomes: &Dictionary) -> Vec<ArrayRef> {
    let StabilityMap { x, y, .. } = request.map;
    let numbers = first..first + cells.len();
    let values = cells.iter().map(|cell| cell.value);
    vec![
        Arc::new(Float64Array::from_iter_values(numbers.clone().map(|number| x.value(number % x.count)))),
        Arc::new(Float64Array::from_iter_values(numbers.map(|number| y.value(number / x.count)))),
        if request.is_whole() {
            Arc::new(values.map(|value| value.map(|value| value as i64)).collect::<Int64Array>())
        } else {
            Arc::new(values.collect::<Float64Array>())
        },
        outcomes.array(cells.iter().map(|cell| Some(outcome_name(cell)))),
    ]
}

/// Fields of those columns.
fn fields(request: &RegionRequest) -> Vec<Field> {
    let StabilityMap { x, y, quantity, .. } = request.map;
    let of_axis = |name: Name| field(name.row().path, name.row().unit, "", DataType::Float64, false);
    let kind = if request.is_whole() { DataType::Int64 } else { DataType::Float64 };
    let value = field(quantity_name(quantity), quantity_unit(quantity), "", kind, true);
    let outcome = field("outcome", "", "End of the run, or of the catch.", Dictionary::kind(), true);
    vec![of_axis(x.name), of_axis(y.name), value, outcome]
}

impl Pictured for RegionAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let RegionRequest { map, tile, .. } = &self.request;
        let rows = self.request.rows();
        let side = |axis: &MapAxis, first: usize, count: usize| {
            let (row, text) = (axis.name.row(), field_text(axis.name));
            HeatAxis {
                name: text.title,
                symbol: text.symbol,
                unit: row.unit,
                from: axis.value(first),
                to: axis.value(first + count.max(1) - 1),
                count,
            }
        };
        let (quantity, unit) = match map.quantity {
            MapQuantity::Survival => ("contacts survived", "1"),
            MapQuantity::MaxTheta => ("largest |θ|", "rad"),
            MapQuantity::Residue => ("residue R", "1"),
            MapQuantity::SpectralRadius => ("spectral radius", "1"),
            MapQuantity::Caught => ("caught", "1"),
            MapQuantity::RestTime => ("time to rest", "s"),
        };
        let values: Vec<Option<f64>> = self.cells.iter().map(|cell| cell.value).collect();
        let outcomes: Vec<u8> = self.cells.iter().map(|cell| code(cell, map.quantity) as u8).collect();
        let finite = || values.iter().flatten().copied().filter(|value| value.is_finite());
        let scale = match map.quantity {
            MapQuantity::Survival => (0.0, map.impacts as f64),
            MapQuantity::Caught => (0.0, 1.0),
            MapQuantity::MaxTheta | MapQuantity::Residue | MapQuantity::SpectralRadius | MapQuantity::RestTime => {
                (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max))
            }
        };
        let part = if tile.of > 1 { format!(", tile {} of {}", tile.index + 1, tile.of) } else { String::new() };
        Ok(heat_map(&HeatMap {
            title: &format!("{quantity} over {} and {}", field_text(map.x.name).title, field_text(map.y.name).title),
            subtitle: &match map.quantity.is_of_catches() {
                true => format!("catches, {} s in contact{part}", map.catch.hold),
                false => format!("runs of up to {} contacts{part}", map.impacts),
            },
            x: side(&map.x, 0, map.x.count),
            y: side(&map.y, rows.start, rows.len()),
            values: &values,
            outcomes: &outcomes,
            scale,
            quantity,
            unit,
            boundary: &self.limit_curves,
        }))
    }
}
