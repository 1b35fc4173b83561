//! `/v1/precision`: speed against accuracy of all methods. The answer has measured times, so it is never cached.

pub mod answer;
pub mod picture;
pub mod request;

use crate::api::contract::Description;
use crate::api::formats::{ProgressFormat, WriteAnswer};
use crate::api::precision::answer::{COLUMNS, End, PrecisionAnswer};
use crate::api::precision::request::{CostAxis, PrecisionRequest};
use crate::api::resource::{ComputedResource, Work};
use crate::api::shared::progress::Progress;
use crate::api::shared::table::columns::RowColumn;
use crate::http::Format;

/// The resource.
#[derive(Debug)]
pub enum Precision {}

impl ComputedResource for Precision {
    const NAME: &'static str = "precision";
    const SINGULAR: &'static str = "Precision";
    type Format = ProgressFormat;
    type Request = PrecisionRequest;
    const WORK: Work<Self> = Work::Measured {
        streamed: &[Format::Progress],
        compute: |request, format, slice, out, bounces| {
            let mut lines = Progress::default();
            let mut tell = |done, of| {
                if format == ProgressFormat::Progress {
                    out.send(lines.line(done, of));
                }
            };
            let answer = PrecisionAnswer::compute(request, &mut tell, slice)?;
            bounces.inc_by(answer.bounces());
            Ok(out.send_whole(format.write(&answer, slice)?, slice)?)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<PrecisionRequest>()
            .answer::<PrecisionAnswer<'static>>()
            .table("One row for each point.", COLUMNS.iter().map(RowColumn::word))
            .end::<End<'static>>()
            .progress(&CostAxis::ALL.map(|(name, _)| name));
    }
}
