//! `/v1/periodic-orbits`: orbits that repeat after some contacts, and branches of them.

pub mod answer;
pub mod picture;
pub mod request;

use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::periodic_orbits::answer::PeriodicOrbitAnswer;
use crate::api::periodic_orbits::request::PeriodicOrbitRequest;
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};

/// The resource.
#[derive(Debug)]
pub enum PeriodicOrbits {}

impl ComputedResource for PeriodicOrbits {
    const NAME: &'static str = "periodic-orbits";
    type Format = ChartFormat;
    type Request = PeriodicOrbitRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let answer = PeriodicOrbitAnswer::compute(request, || slice.should_continue())?;
            bounces.inc_by(answer.bounces());
            format.write(&answer, slice)
        },
    };
}
