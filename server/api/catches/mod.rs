//! `/v1/catches`: bring a falling body to rest on the table, and hold it.

pub mod answer;
pub mod columns;
pub mod outcome;
pub mod picture;
pub mod request;

use crate::api::catches::answer::CatchAnswer;
use crate::api::catches::request::CatchRequest;
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum Catches {}

impl ComputedResource for Catches {
    const NAME: &'static str = "catches";
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
}
