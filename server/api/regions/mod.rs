//! `/v1/regions`: maps of stability over two fields of a scene.

pub mod answer;
pub mod arrow;
pub mod picture;
pub mod request;
pub mod rows;

use equipoise_physics::surveys::stability_map::MapCell;

use crate::api::contract::Description;
use crate::api::formats::{FigureFormat, MapFormat, WriteAnswer};
use crate::api::regions::answer::{Counts, Region, RegionAnswer};
use crate::api::regions::arrow::ArrowRows;
use crate::api::regions::request::{RegionFields, RegionRequest};
use crate::api::regions::rows::{RegionRow, RowFormat, Rows};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::compute::{Cancelled, TimeSlice, TimeSlices};
use crate::http::{BodyWriter, Format, Problem};

/// The resource.
#[derive(Debug)]
pub enum Regions {}

impl ComputedResource for Regions {
    const NAME: &'static str = "regions";
    const SINGULAR: &'static str = "Region";
    type Format = MapFormat;
    type Request = RegionRequest;
    const WORK: Work<Self> = Work::InSlices {
        canonical: CanonicalRequest::canonical,
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
            let spread = |done: &mut (dyn FnMut(Vec<MapCell>) + Send)| slices.parallel_map(blocks, compute, done);
            match format {
                MapFormat::Csv => send_rows(Rows::new(*request, RowFormat::Csv), out, spread),
                MapFormat::Ndjson => send_rows(Rows::new(*request, RowFormat::Ndjson), out, spread),
                MapFormat::Arrow => send_arrow(request, slices, out, spread),
                MapFormat::Json => send_whole(request, FigureFormat::Json, slices, out, spread),
                MapFormat::Svg => send_whole(request, FigureFormat::Svg, slices, out, spread),
                MapFormat::Png => send_whole(request, FigureFormat::Png, slices, out, spread),
            }
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract.request::<RegionFields>().answer::<Region<'static>>().line::<RegionRow<'static>>().end::<Counts>();
    }
}

/// Sends the cells row by row, as they are computed by `spread`.
fn send_rows(
    mut rows: Rows,
    out: &mut BodyWriter,
    spread: impl FnOnce(&mut (dyn FnMut(Vec<MapCell>) + Send)) -> Result<(), Cancelled>,
) -> Result<(), Problem> {
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
    spread: impl FnOnce(&mut (dyn FnMut(Vec<MapCell>) + Send)) -> Result<(), Cancelled>,
) -> Result<(), Problem> {
    let mut rows = slices.run_one(|slice| ArrowRows::new(*request, slice))??;
    let mut failed = None;
    spread(&mut |cells| match rows.add(&cells) {
        Ok(batch) => out.send(batch),
        Err(error) => failed = Some(error),
    })?;
    match failed.map_or_else(|| rows.end(), Err) {
        Ok(end) => out.send(end),
        Err(error) => {
            tracing::error!(%error, "a batch of Arrow was not written");
            return Err(Problem::internal());
        }
    }
    Ok(())
}

/// Sends the answer once all cells are computed by `spread`.
fn send_whole(
    request: &RegionRequest,
    format: FigureFormat,
    slices: &TimeSlices,
    out: &mut BodyWriter,
    spread: impl FnOnce(&mut (dyn FnMut(Vec<MapCell>) + Send)) -> Result<(), Cancelled>,
) -> Result<(), Problem> {
    let mut all = Vec::with_capacity(request.numbers().len());
    spread(&mut |cells| all.extend(cells))?;
    slices.run_one(|slice| {
        let answer = RegionAnswer::new(*request, all, || slice.should_continue()).ok_or(Cancelled)?;
        Ok(out.send_whole(format.write(&answer, slice)?, slice)?)
    })?
}
