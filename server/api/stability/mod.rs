//! `/v1/stability`: the verdict on a scene.

pub mod answer;
pub mod budget;
pub mod cycle;
pub mod evidence;
pub mod linear;
mod open_metrics;
pub mod over_tolerances;
pub mod picture;
pub mod release_margins;
pub mod request;
mod rig;
pub mod verdict_name;
mod words;

use prometheus_client::metrics::counter::Counter;

use crate::api::contract::Description;
use crate::api::formats::{GaugeFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::shared::margins::columns::{least, limits, margins, release_limits, release_margins};
use crate::api::shared::table::columns::{ColumnWord, RowColumn};
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
        let words = |columns: &[RowColumn<StabilityAnswer<'static>>], only: &'static str| -> Vec<ColumnWord> {
            columns.iter().map(|column| column.word().only(only)).collect()
        };
        let columns = [
            words(&StabilityAnswer::COLUMNS, ""),
            words(&limits(), ""),
            words(&margins(), ""),
            words(&release_limits(), "with `release_margins`"),
            words(&release_margins(), "with `release_margins`"),
            words(&least(), "with `tolerances`"),
            over_tolerances::COLUMNS.map(|column| column.word().only("with `tolerances`")).to_vec(),
        ];
        contract
            .request::<StabilityRequest>()
            .answer::<StabilityAnswer<'static>>()
            .table("One row.", columns.concat())
            .end::<End<'static>>();
    }
}
