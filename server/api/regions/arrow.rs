//! The cells of a map as an Arrow stream. Each batch is written as soon as its cells are computed.

use std::io;
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, Int64Array};
use arrow_schema::{DataType, Field};
use equipoise_physics::scene::Name;
use equipoise_physics::surveys::stability_map::{MapCell, StabilityMap};

use crate::api::regions::answer::{RegionAnswer, outcome_name, outcome_names};
use crate::api::regions::request::{RegionRequest, quantity_name};
use crate::api::regions::rows::quantity_unit;
use crate::api::shared::table::arrow::{ArrowStream, Dictionary, field};
use crate::api::shared::write::rest_of;
use crate::compute::{Cancelled, TimeSlice};
use crate::http::Problem;

/// Writes the cells of a tile batch by batch, as they are computed.
pub struct ArrowRows {
    request: RegionRequest,
    stream: ArrowStream,
    outcomes: Dictionary,
    /// Number of the next cell.
    next: usize,
}

impl ArrowRows {
    /// No cells yet. Computes the limit curves, for the schema.
    ///
    /// # Errors
    /// Cancelled work.
    pub fn new(request: RegionRequest, slice: &TimeSlice) -> Result<Self, Problem> {
        let answer = RegionAnswer::new(request, Vec::new(), || slice.should_continue()).ok_or(Cancelled)?;
        let rest = rest_of(&answer, &["x", "y", "values", "outcomes", "counts"], slice)?;
        let stream = ArrowStream::new(fields(&request), rest).map_err(|_| Problem::internal())?;
        let outcomes = Dictionary::new(outcome_names(request.map.quantity).to_vec());
        Ok(Self { request, stream, outcomes, next: request.numbers().start })
    }

    /// The batch of these cells.
    ///
    /// # Errors
    /// None but a fault of the server.
    pub fn add(&mut self, cells: &[MapCell]) -> io::Result<Vec<u8>> {
        let mut out = Vec::new();
        if !cells.is_empty() {
            self.stream.write(self.columns(cells), &mut out)?;
            self.next += cells.len();
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
    fn columns(&self, cells: &[MapCell]) -> Vec<ArrayRef> {
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
fn fields(request: &RegionRequest) -> Vec<Field> {
    let StabilityMap { x, y, quantity, .. } = request.map;
    let of_axis = |name: Name| field(name.row().path, name.row().unit, "", DataType::Float64, false);
    let kind = if request.is_whole() { DataType::Int64 } else { DataType::Float64 };
    let value = field(quantity_name(quantity), quantity_unit(quantity), "", kind, true);
    let outcome = field("outcome", "", "End of the run, or of the catch.", Dictionary::kind(), true);
    vec![of_axis(x.name), of_axis(y.name), value, outcome]
}
