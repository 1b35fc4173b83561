//! `/v1/trajectories`: the contacts of a run.

pub mod answer;
pub mod columns;
pub mod flights;
pub mod hold;
pub mod impacts;
pub mod picture;
pub mod request;

use crate::api::formats::{ChartFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::trajectories::answer::TrajectoryAnswer;
use crate::api::trajectories::request::TrajectoryRequest;
use crate::runs::playback::Playback;

/// The resource.
#[derive(Debug)]
pub enum Trajectories {}

impl ComputedResource for Trajectories {
    const NAME: &'static str = "trajectories";
    type Format = ChartFormat;
    type Request = TrajectoryRequest;
    const WORK: Work<Self> = Work::Pure {
        canonical: CanonicalRequest::canonical,
        compute: |request, format, slice, bounces| {
            let run = &request.run;
            // Without interventions, and where the body never meets the table, it is the scene's own run.
            let is_changed = !run.interventions().is_empty() && run.scene().orbit().is_ok();
            let mut playback = is_changed.then(|| Playback::new(run, request.impacts));
            let answer = TrajectoryAnswer::compute(request, playback.as_mut(), || slice.should_continue())?;
            bounces.inc_by(answer.outcome.impacts);
            format.write(&answer, slice)
        },
    };
}
