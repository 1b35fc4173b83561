//! `/v1/jacobians`: the derivative of the map.

pub mod answer;
pub mod request;

use crate::api::contract::Description;
use crate::api::formats::{TableFormat, WriteAnswer};
use crate::api::jacobians::answer::{JacobianAnswer, columns};
use crate::api::jacobians::request::JacobianRequest;
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum Jacobians {}

impl ComputedResource for Jacobians {
    const NAME: &'static str = "jacobians";
    const SINGULAR: &'static str = "Jacobian";
    type Format = TableFormat;
    type Request = JacobianRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = JacobianAnswer::compute(request, || slice.should_continue())?;
            bounces.inc_by(request.period);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<JacobianRequest>()
            .answer::<JacobianAnswer<'static>>()
            .table("One row for each part of the state.", columns())
            .end::<JacobianAnswer<'static>>();
    }
}
