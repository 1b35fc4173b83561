//! `/v1/fits`: fields of a scene from measured impacts.

pub mod answer;
mod fault;
pub mod picture;
pub mod progress;
pub mod region;
pub mod request;

use prometheus_client::metrics::counter::Counter;

use crate::api::contract::Description;
use crate::api::fits::answer::{COLUMNS_OF_RESIDUALS, End, FitAnswer};
use crate::api::fits::picture::LineOfAnswer;
use crate::api::fits::progress::{Line, LineOfFailure, Step};
use crate::api::fits::request::{FitFields, FitsRequest, MEASURED, measured_values};
use crate::api::formats::{ProgressFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::shared::table::columns::RowColumn;
use crate::compute::TimeSlices;
use crate::http::request::table::TableBody;
use crate::http::{BodyWriter, Format, Problem};

/// The resource.
#[derive(Debug)]
pub enum Fits {}

impl ComputedResource for Fits {
    const NAME: &'static str = "fits";
    const SINGULAR: &'static str = "Fit";
    const POST_ONLY: bool = true;
    const TABLE: Option<&'static TableBody> = Some(&MEASURED);
    type Format = ProgressFormat;
    type Request = FitsRequest;
    const WORK: Work<Self> =
        Work::InSlices { canonical: CanonicalRequest::canonical, streamed: &[Format::Progress], compute };

    fn describe(contract: &mut Description<'_>) {
        contract
            .schema("MeasuredValues", measured_values())
            .request::<FitFields>()
            .answer::<FitAnswer>()
            .table(
                "One row for each measured impact: measured less fitted values.",
                COLUMNS_OF_RESIDUALS.iter().map(RowColumn::word),
            )
            .end::<End<'static>>()
            .line::<Line<'static>>()
            .line::<LineOfAnswer>()
            .line::<LineOfFailure>();
    }
}

fn compute(
    request: &FitsRequest,
    format: ProgressFormat,
    slices: &TimeSlices,
    out: &mut BodyWriter,
    bounces: &Counter,
) -> Result<(), Problem> {
    let tells = format == ProgressFormat::Progress;
    slices.run_one(|slice| {
        let mut tell = |step: Step| {
            if tells {
                out.send(step.line());
            }
        };
        match FitAnswer::compute(request, &mut tell, &mut || slice.should_continue()) {
            Ok(answer) => {
                bounces.inc_by(answer.bounces);
                out.send_whole(format.write(&answer, slice)?, slice)?;
            }
            Err(problem) if tells && !slice.cancel().is_set() => out.send(progress::failure(&problem)),
            Err(problem) => return Err(problem),
        }
        Ok(())
    })?
}
