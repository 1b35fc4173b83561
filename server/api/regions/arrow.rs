//! The cells of a map as an Arrow stream. Each batch is written as soon as its cells are computed.

use std::io;
use std::sync::Arc;

use arrow_array::{Array, ArrayRef, FixedSizeListArray, Float64Array, Int8Array, Int64Array};
use arrow_schema::{DataType, Field};
use equipoise_physics::scene::Name;
use equipoise_physics::surveys::stability_map::{MapCell, StabilityMap};

use crate::api::regions::answer::{RegionAnswer, code, outcome_name, outcome_names};
use crate::api::regions::request::{RegionRequest, quantity_name};
use crate::api::regions::rows::quantity_unit;
use crate::api::shared::table::arrow::{ArrowStream, Dictionary, field};
use crate::api::shared::write::rest_of;
use crate::compute::{Cancelled, TimeSlice};
use crate::http::Problem;

/// The rows of a stream.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MapLayout {
    /// A row for each cell.
    Long,
    /// A row for each row of cells.
    Grid,
}

impl MapLayout {
    /// Members of the JSON answer that the columns have, or that are known only at the end.
    fn without(self) -> &'static [&'static str] {
        match self {
            Self::Long => &["x", "y", "values", "outcomes", "counts"],
            Self::Grid => &["y", "values", "outcomes", "counts"],
        }
    }
}

/// Writes the cells of a tile batch by batch, as they are computed.
pub struct ArrowRows {
    request: RegionRequest,
    layout: MapLayout,
    stream: ArrowStream,
    outcomes: Dictionary,
    /// Number of the next cell.
    next: usize,
    /// Cells of a row that is not complete.
    begun: Vec<MapCell>,
}

impl ArrowRows {
    /// No cells yet. Computes the boundary, for the schema.
    ///
    /// # Errors
    /// Cancelled work.
    pub fn new(request: RegionRequest, layout: MapLayout, slice: &TimeSlice) -> Result<Self, Problem> {
        let answer = RegionAnswer::new(request, Vec::new(), || slice.should_continue()).ok_or(Cancelled)?;
        let rest = rest_of(&answer, layout.without(), slice)?;
        let stream = ArrowStream::new(fields(&request, layout), rest).map_err(|_| Problem::internal())?;
        let outcomes = Dictionary::new(outcome_names(request.map.quantity).to_vec());
        Ok(Self { request, layout, stream, outcomes, next: request.numbers().start, begun: Vec::new() })
    }

    /// The batch of the rows that are complete with these cells.
    ///
    /// # Errors
    /// None but a fault of the server.
    pub fn add(&mut self, cells: &[MapCell]) -> io::Result<Vec<u8>> {
        let mut out = Vec::new();
        let columns = match self.layout {
            MapLayout::Long => {
                let columns = self.long(cells);
                self.next += cells.len();
                columns
            }
            MapLayout::Grid => {
                self.begun.extend_from_slice(cells);
                let side = self.request.map.x.count;
                let rest = self.begun.split_off(self.begun.len() - self.begun.len() % side);
                let rows = std::mem::replace(&mut self.begun, rest);
                let columns = self.grid(&rows)?;
                self.next += rows.len();
                columns
            }
        };
        if columns.first().is_some_and(|column| !column.is_empty()) {
            self.stream.write(columns, &mut out)?;
        }
        Ok(out)
    }

    /// The end of the stream.
    ///
    /// # Errors
    /// None but a fault of the server.
    pub fn end(self) -> io::Result<Vec<u8>> {
        let mut out = Vec::new();
        self.stream.end(&mut out)?;
        Ok(out)
    }

    /// Columns with a row for each cell.
    fn long(&self, cells: &[MapCell]) -> Vec<ArrayRef> {
        let StabilityMap { x, y, .. } = self.request.map;
        let numbers = self.next..self.next + cells.len();
        let at = |number: usize| (x.value(number % x.count), y.value(number / x.count));
        vec![
            Arc::new(Float64Array::from_iter_values(numbers.clone().map(|number| at(number).0))),
            Arc::new(Float64Array::from_iter_values(numbers.map(|number| at(number).1))),
            self.values(cells),
            self.outcomes.array(cells.iter().map(|cell| Some(outcome_name(cell)))),
        ]
    }

    /// Columns with a row for each row of cells: its y, its values and the codes of its outcomes.
    fn grid(&self, cells: &[MapCell]) -> io::Result<Vec<ArrayRef>> {
        let StabilityMap { x, y, quantity, .. } = self.request.map;
        let first = self.next / x.count;
        let rows = first..first + cells.len() / x.count;
        let listed = |values: ArrayRef| {
            let item = Arc::new(Field::new_list_field(values.data_type().clone(), true));
            let list = FixedSizeListArray::try_new(item, x.count as i32, values, None).map_err(io::Error::other)?;
            Ok::<_, io::Error>(Arc::new(list) as ArrayRef)
        };
        // There are fewer outcomes than 128.
        let codes = Int8Array::from_iter_values(cells.iter().map(|cell| code(cell, quantity) as i8));
        Ok(vec![
            Arc::new(Float64Array::from_iter_values(rows.map(|row| y.value(row)))),
            listed(self.values(cells))?,
            listed(Arc::new(codes))?,
        ])
    }

    fn values(&self, cells: &[MapCell]) -> ArrayRef {
        let values = cells.iter().map(|cell| cell.value);
        if self.request.is_whole() {
            Arc::new(values.map(|value| value.map(|value| value as i64)).collect::<Int64Array>())
        } else {
            Arc::new(values.collect::<Float64Array>())
        }
    }
}

/// The columns of a map.
fn fields(request: &RegionRequest, layout: MapLayout) -> Vec<Field> {
    let StabilityMap { x, y, quantity, .. } = request.map;
    let of_axis = |name: Name| field(name.row().path, name.row().unit, "", DataType::Float64, false);
    let kind = if request.is_whole() { DataType::Int64 } else { DataType::Float64 };
    let value = |kind, nullable| field(quantity_name(quantity), quantity_unit(quantity), "", kind, nullable);
    let listed = |kind| DataType::FixedSizeList(Arc::new(Field::new_list_field(kind, true)), x.count as i32);
    match layout {
        MapLayout::Long => {
            let outcome = field("outcome", "", "End of the run, or of the catch.", Dictionary::kind(), true);
            vec![of_axis(x.name), of_axis(y.name), value(kind, true), outcome]
        }
        MapLayout::Grid => {
            let about = "Codes of the outcomes, whose names are in outcome_names.";
            vec![
                of_axis(y.name),
                value(listed(kind), false),
                field("outcome", "", about, listed(DataType::Int8), false),
            ]
        }
    }
}
