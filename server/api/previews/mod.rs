//! `/v1/previews`: a run in a headline and a picture, as programs show them beside a link to the page.

pub mod answer;
pub mod picture;
pub mod request;

use crate::api::contract::Description;
use crate::api::formats::{FigureFormat, WriteAnswer};
use crate::api::previews::answer::PreviewAnswer;
use crate::api::previews::request::PreviewRequest;
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum Previews {}

impl ComputedResource for Previews {
    const NAME: &'static str = "previews";
    const SINGULAR: &'static str = "Preview";
    type Format = FigureFormat;
    type Request = PreviewRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = PreviewAnswer::compute(request, &mut || slice.should_continue())?;
            bounces.inc_by(answer.outcome.bounces);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract.request::<PreviewRequest>().answer::<PreviewAnswer<'static>>();
    }
}
