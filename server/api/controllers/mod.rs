//! `/v1/controllers`: state feedback that balances in place.

pub mod answer;
pub mod picture;
pub mod request;

use crate::api::controllers::answer::ControllerAnswer;
use crate::api::controllers::request::ControllerRequest;
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum Controllers {}

impl ComputedResource for Controllers {
    const NAME: &'static str = "controllers";
    type Format = ChartFormat;
    type Request = ControllerRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, _| format.write(&ControllerAnswer::compute(request)?, slice),
    };
}
