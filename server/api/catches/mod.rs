//! `/v1/catches`: bring a falling body to rest on the table, and hold it.

pub mod answer;
pub mod columns;
pub mod outcome;
pub mod picture;
pub mod request;

use equipoise_physics::scene::capability::Analysis;

use crate::api::catches::answer::{CatchAnswer, End};
use crate::api::catches::columns::words;
use crate::api::catches::request::CatchRequest;
use crate::api::contract::Description;
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum Catches {}

impl ComputedResource for Catches {
    const NAME: &'static str = "catches";
    const SINGULAR: &'static str = "Catch";
    type Format = ChartFormat;
    type Request = CatchRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = CatchAnswer::compute(&request.scene, &request.options, &mut || slice.should_continue())?;
            bounces.inc_by(answer.strike_count());
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<CatchRequest>()
            .answer::<CatchAnswer>()
            .table(
                "One row for each strike (`phase` strike), then one for each moment of the hold (`phase` hold).",
                words(),
            )
            .end::<End<'static>>()
            .refuses(Analysis::Catch);
    }
}
