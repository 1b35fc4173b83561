//! `/v1/ladder`: the same scene on each level of the model hierarchy up to the level that it needs.

pub mod answer;
pub mod request;

use crate::api::contract::Description;
use crate::api::formats::{TableFormat, WriteAnswer};
use crate::api::ladder::answer::{COLUMNS, End, LadderAnswer};
use crate::api::ladder::request::LadderRequest;
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::shared::table::columns::RowColumn;
use crate::compute::Cancelled;

/// The resource.
#[derive(Debug)]
pub enum Ladder {}

impl ComputedResource for Ladder {
    const NAME: &'static str = "ladder";
    const SINGULAR: &'static str = "Ladder";
    type Format = TableFormat;
    type Request = LadderRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = LadderAnswer::compute(request, || slice.should_continue()).ok_or(Cancelled)?;
            bounces.inc_by(answer.computed());
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<LadderRequest>()
            .answer::<LadderAnswer<'static>>()
            .table("One row for each rung.", COLUMNS.iter().map(RowColumn::word))
            .end::<End<'static>>();
    }
}
