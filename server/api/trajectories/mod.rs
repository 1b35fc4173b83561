//! `/v1/trajectories`: the contacts of a run.

pub mod answer;
pub mod columns;
pub mod flights;
pub mod hold;
pub mod impacts;
pub mod picture;
pub mod request;

use crate::api::contract::Description;
use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::trajectories::answer::{TrajectoryAnswer, TrajectoryEnd};
use crate::api::trajectories::columns::trajectory_words;
use crate::api::trajectories::hold::phase_words;
use crate::api::trajectories::request::TrajectoryRequest;
use crate::runs::playback::Playback;

/// The resource.
#[derive(Debug)]
pub enum Trajectories {}

impl ComputedResource for Trajectories {
    const NAME: &'static str = "trajectories";
    const SINGULAR: &'static str = "Trajectory";
    type Format = ChartFormat;
    type Request = TrajectoryRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let run = &request.run;
            // Without interventions, and where the body never meets the table, it is the scene's own run.
            let is_changed = !run.interventions().is_empty() && run.scene().orbit().is_ok();
            let mut playback = is_changed.then(|| Playback::new(run, request.bounces));
            let answer = TrajectoryAnswer::compute(request, playback.as_mut(), || slice.should_continue())?;
            bounces.inc_by(answer.outcome.bounces);
            format.write(&answer, slice)
        },
    };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<TrajectoryRequest>()
            .answer::<TrajectoryAnswer<'static>>()
            .table("One row for each impact.", trajectory_words())
            .table(
                "With `hold` above 0, one row for each impact, then one for each moment of the contact.",
                phase_words(),
            )
            .end::<TrajectoryEnd<'static>>();
    }
}
