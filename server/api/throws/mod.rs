//! `/v1/throws`: the strike that sends the body to an apex of given height and angle.

pub mod answer;
pub mod picture;
pub mod request;

use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::throws::answer::ThrowAnswer;
use crate::api::throws::request::ThrowRequest;

/// The resource.
#[derive(Debug)]
pub enum Throws {}

impl ComputedResource for Throws {
    const NAME: &'static str = "throws";
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
}
