//! `/v1/stability`: the verdict on a scene.

pub mod answer;
pub mod budget;
pub mod cycle;
pub mod evidence;
pub mod gain_margins;
pub mod linear;
pub mod margins;
mod open_metrics;
pub mod picture;
pub mod request;
mod rig;
pub mod verdict_name;
mod words;

use prometheus_client::metrics::counter::Counter;

use crate::api::contract::Description;
use crate::api::formats::{GaugeFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::shared::table::columns::RowColumn;
use crate::api::stability::answer::{End, StabilityAnswer};
use crate::api::stability::request::StabilityRequest;
use crate::compute::{Cancelled, TimeSlice};

/// The resource.
#[derive(Debug)]
pub enum Stability {}

/// Computes an answer, and counts its bounces.
///
/// # Errors
/// Cancelled work.
pub fn computed<'a>(
    request: &'a StabilityRequest,
    slice: &TimeSlice,
    bounces: &Counter,
) -> Result<StabilityAnswer<'a>, Cancelled> {
    let answer = StabilityAnswer::compute(request, || slice.should_continue()).ok_or(Cancelled)?;
    bounces.inc_by(answer.bounces());
    Ok(answer)
}

impl ComputedResource for Stability {
    const NAME: &'static str = "stability";
    const SINGULAR: &'static str = "Stability";
    type Format = GaugeFormat;
    type Request = StabilityRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| format.write(&computed(request, slice, bounces)?, slice),
    };

    fn describe(contract: &mut Description<'_>) {
        let margins = margins::COLUMNS.map(|column| column.word().only("with `tolerances`"));
        contract
            .request::<StabilityRequest>()
            .answer::<StabilityAnswer<'static>>()
            .table("One row.", StabilityAnswer::COLUMNS.iter().map(RowColumn::word).chain(margins))
            .end::<End<'static>>();
    }
}
