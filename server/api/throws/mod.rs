//! `/v1/throws`: the strike that sends the body to an apex of given height and angle.

pub mod answer;
pub mod picture;
pub mod request;

use equipoise_physics::scene::capability::Analysis;

use crate::api::contract::Description;
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::shared::table::columns::RowColumn;
use crate::api::throws::answer::{COLUMNS, End, ThrowAnswer};
use crate::api::throws::request::ThrowRequest;

/// The resource.
#[derive(Debug)]
pub enum Throws {}

impl ComputedResource for Throws {
    const NAME: &'static str = "throws";
    const SINGULAR: &'static str = "Throw";
    type Format = ChartFormat;
    type Request = ThrowRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = ThrowAnswer::compute(request, &mut || slice.should_continue())?;
            bounces.inc_by(answer.bounces);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<ThrowRequest>()
            .answer::<ThrowAnswer>()
            .table(
                "One row. For the rows of a catch, ask `/v1/catches` with the `scene` of the answer.",
                COLUMNS.iter().map(RowColumn::word),
            )
            .end::<End<'static>>()
            .refuses(Analysis::Throw);
    }
}
