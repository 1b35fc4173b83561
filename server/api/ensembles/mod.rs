//! `/v1/ensembles`: many runs of a scene, each with noise of its own.

pub mod answer;
pub mod picture;
pub mod request;

use equipoise_physics::surveys::ensemble::{EnsembleRuns, quantiles};
use prometheus_client::metrics::counter::Counter;

use crate::api::contract::Description;
use crate::api::ensembles::answer::{EnsembleAnswer, Summary, columns};
use crate::api::ensembles::picture::PICTURE;
use crate::api::ensembles::request::EnsembleRequest;
use crate::api::formats::{ProgressFormat, WriteAnswer};
use crate::api::resource::{CanonicalRequest, ComputedResource, Work};
use crate::api::shared::progress::Progress;
use crate::api::shared::table::columns::RowColumn;
use crate::compute::{Cancelled, TimeSlice, TimeSlices};
use crate::http::{BodyWriter, Format, Problem};

/// The resource.
#[derive(Debug)]
pub enum Ensembles {}

impl ComputedResource for Ensembles {
    const NAME: &'static str = "ensembles";
    const SINGULAR: &'static str = "Ensemble";
    type Format = ProgressFormat;
    type Request = EnsembleRequest;
    const WORK: Work<Self> =
        Work::InSlices { canonical: CanonicalRequest::canonical, streamed: &[Format::Progress], compute };

    fn describe(contract: &mut Description<'_>) {
        contract
            .request::<EnsembleRequest>()
            .answer::<EnsembleAnswer<'static>>()
            .table("One row for each contact.", columns().map(RowColumn::word))
            .end::<Summary>()
            .progress(&[PICTURE]);
    }
}

fn compute(
    request: &EnsembleRequest,
    format: ProgressFormat,
    slices: &TimeSlices,
    out: &mut BodyWriter,
    bounces: &Counter,
) -> Result<(), Problem> {
    let ensemble = request.ensemble();
    // The blocks depend on the request alone, never on the machine.
    let block = request.block_runs();
    let (numbers, all) = (request.numbers(), request.runs());
    let only_run = if ensemble.is_uniform() {
        let first = |slice: &TimeSlice| ensemble.runs(0..1, &mut || slice.should_continue()).ok_or(Cancelled);
        let runs = slices.run_one(first)??;
        bounces.inc_by(runs.ends.iter().map(|end| end.impacts).sum());
        Some(runs)
    } else {
        None
    };
    let compute = |number: usize, slice: &TimeSlice| {
        let first = numbers.start + number as u64 * block;
        let range = first..(first + block).min(numbers.end);
        if let Some(run) = &only_run {
            return Some(run.repeated((range.end - range.start) as usize));
        }
        let runs = ensemble.runs(range, &mut || slice.should_continue())?;
        bounces.inc_by(runs.ends.iter().map(|end| end.impacts).sum());
        Some(runs)
    };
    let (mut runs, mut lines) = (EnsembleRuns::default(), Progress::default());
    let mut tell = |ended| {
        if format == ProgressFormat::Progress {
            out.send(lines.line(ended, all));
        }
    };
    tell(0);
    slices.parallel_map(all.div_ceil(block) as usize, compute, |others| {
        runs.append(others);
        tell(runs.ends.len() as u64);
    })?;
    let angles = std::mem::take(&mut runs.angles);
    let (mut sorted, mut found) = (Vec::with_capacity(angles.len()), Vec::with_capacity(angles.len()));
    let sort = |place: usize, _: &TimeSlice| {
        let mut angles = angles[place].clone();
        angles.sort_unstable_by(f64::total_cmp);
        let quantiles = quantiles(&angles);
        // Angles may be many, so they are kept only for an answer that has them.
        Some((if request.angles { angles } else { Vec::new() }, quantiles))
    };
    slices.parallel_map(angles.len(), sort, |(angles, quantiles)| {
        sorted.push(angles);
        found.push(quantiles);
    })?;
    slices.run_one(|slice| {
        let answer = EnsembleAnswer::new(request, &runs, sorted, &found);
        Ok(out.send_whole(format.write(&answer, slice)?, slice)?)
    })?
}
