//! `/v1/periodic-orbits`: orbits that repeat after some contacts, and branches of them.

pub mod answer;
pub mod picture;
pub mod request;

use crate::api::contract::Description;
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::periodic_orbits::answer::{BRANCH, End, PeriodicOrbitAnswer, state_words};
use crate::api::periodic_orbits::request::{AskedOrbit, PeriodicOrbitRequest};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::shared::table::columns::RowColumn;

/// The resource.
#[derive(Debug)]
pub enum PeriodicOrbits {}

impl ComputedResource for PeriodicOrbits {
    const NAME: &'static str = "periodic-orbits";
    const SINGULAR: &'static str = "PeriodicOrbits";
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

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<AskedOrbit>()
            .answer::<PeriodicOrbitAnswer<'static>>()
            .table("Without `sweep`, one row for each state.", state_words())
            .table("With `sweep`, one row for each point of the branch.", BRANCH.iter().map(RowColumn::word))
            .end::<End<'static>>();
    }
}
