//! `/v1/controllers`: state feedback that balances in place.

pub mod answer;
pub mod picture;
pub mod request;

use equipoise_physics::scene::capability::Analysis;

use crate::api::contract::Description;
use crate::api::controllers::answer::{ControllerAnswer, End, columns};
use crate::api::controllers::request::{AskedLaw, ControllerRequest};
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum Controllers {}

impl ComputedResource for Controllers {
    const NAME: &'static str = "controllers";
    const SINGULAR: &'static str = "Controller";
    type Format = ChartFormat;
    type Request = ControllerRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, _| format.write(&ControllerAnswer::compute(request)?, slice),
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<AskedLaw>()
            .answer::<ControllerAnswer>()
            .table("One row.", columns().map(|column| column.word()))
            .end::<End<'static>>()
            .refuses(Analysis::Controller);
    }
}
