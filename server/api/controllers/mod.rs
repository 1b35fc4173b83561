//! `/v1/controllers`: state feedback that balances in place.

pub mod answer;
pub mod picture;
pub mod request;

use crate::api::controllers::answer::ControllerAnswer;
use crate::api::controllers::request::ControllerRequest;
use crate::api::formats::ChartFormat;
use crate::api::resource::{ComputedResource, Work};
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits;
use crate::limits::Limits;

/// The resource.
#[derive(Debug)]
pub enum Controllers {}

impl ComputedResource for Controllers {
    const NAME: &'static str = "controllers";
    type Format = ChartFormat;
    type Request = ControllerRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: ControllerRequest::canonical,
        compute: |request, format, slice, _| format.write(&ControllerAnswer::compute(request)?, slice),
    };

    fn read(reader: &mut Reader<'_, '_>) -> Option<ControllerRequest> {
        ControllerRequest::read(reader)
    }

    fn price(_: &ControllerRequest, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(limits::CONTROLLER_PRICE).within(&limits.of_work())
    }
}
