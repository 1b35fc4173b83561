//! `/v1/jacobians`: the derivative of the map.

pub mod answer;
pub mod request;

use crate::api::formats::TableFormat;
use crate::api::jacobians::answer::JacobianAnswer;
use crate::api::jacobians::request::JacobianRequest;
use crate::api::resource::{ComputedResource, Work};
use crate::compute::{OverBudget, Price};
use crate::http::Reader;
use crate::limits::Limits;

/// The resource.
#[derive(Debug)]
pub enum Jacobians {}

impl ComputedResource for Jacobians {
    const NAME: &'static str = "jacobians";
    type Format = TableFormat;
    type Request = JacobianRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: JacobianRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = JacobianAnswer::compute(request, || slice.should_continue())?;
            bounces.inc_by(request.period);
            format.write(&answer, slice)
        },
    };

    fn read(reader: &mut Reader<'_, '_>) -> Option<JacobianRequest> {
        JacobianRequest::read(reader)
    }

    fn price(request: &JacobianRequest, limits: &Limits) -> Result<Price, OverBudget> {
        Price::bounces(request.price()).within(&limits.of_work())
    }
}
