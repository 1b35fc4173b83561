//! `/v1/fits`: fields of a scene from measured impacts.

pub mod answer;
mod fault;
pub mod picture;
pub mod region;
pub mod request;

use crate::api::fits::answer::FitAnswer;
use crate::api::fits::request::FitsRequest;
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum Fits {}

impl ComputedResource for Fits {
    const NAME: &'static str = "fits";
    const POST_ONLY: bool = true;
    type Format = ChartFormat;
    type Request = FitsRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = FitAnswer::compute(request, &mut || slice.should_continue())?;
            bounces.inc_by(answer.bounces);
            format.write(&answer, slice)
        },
    };
}
