//! `ensembles`: many runs of a scene, each with noise of its own.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;
use equipoise_physics::surveys::ensemble::{Runs, quantiles};

use crate::api::app::App;
use crate::api::ensembles::answer::{Answer, Request};
use crate::api::shared::progress;
use crate::api::shared::progress::Progress;
use crate::api::shared::write;
use crate::compute::{Turn, Turns};
use crate::http::{Ask, Format, Outlet, Problem, Resource};
use crate::limits;

const RESOURCE: Resource = Resource {
    name: "ensembles",
    formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Progress, Format::Svg, Format::Png],
};

/// Those that are sent line by line as runs end.
const STREAMED: [Format; 1] = [Format::Progress];

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/ensembles", get(ensembles).post(ensembles))
}

pub(crate) async fn ensembles(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let request = ask.read(Request::read)?;
    let ensemble = request.ensemble;
    app.config.limits.of_answer().admit(request.angles())?;
    app.config.limits.of_ensemble_work().admit(request.price())?;
    let rest = (ensemble.runs, ensemble.impacts, request.tile, request.angles);
    let canonical = write::canonical(&ensemble.scene, &rest);
    let metrics = app.metrics.clone();
    ask.respond_in_turns(&app.pool, &RESOURCE, &canonical, &STREAMED, move |format, turns: &Turns, out: &mut Outlet| {
        // A matter of the request alone, not that it would show.
        let block = (limits::ENSEMBLE_BLOCK_WORK / ensemble.impacts).max(1);
        let (numbers, all) = (request.numbers(), request.runs());
        let compute = |number: usize, turn: &Turn| {
            let first = numbers.start + number as u64 * block;
            let runs = ensemble.runs(first..(first + block).min(numbers.end), &mut || turn.go_on())?;
            metrics.bounces.inc_by(runs.ends.iter().map(|end| end.impacts).sum());
            Some(runs)
        };
        let (mut runs, mut lines) = (Runs::default(), Progress::default());
        let mut tell = |ended| {
            if STREAMED.contains(&format) {
                out.send(lines.line(ended, all));
            }
        };
        tell(0);
        turns.spread(all.div_ceil(block) as usize, compute, |others| {
            runs.append(others);
            tell(runs.ends.len() as u64);
        })?;
        let angles = std::mem::take(&mut runs.angles);
        let (mut sorted, mut found) = (Vec::with_capacity(angles.len()), Vec::with_capacity(angles.len()));
        let sort = |place: usize, _: &Turn| {
            let mut angles = angles[place].clone();
            angles.sort_unstable_by(f64::total_cmp);
            let quantiles = quantiles(&angles);
            // Kept for the answer alone: many are large.
            Some((if request.angles { angles } else { Vec::new() }, quantiles))
        };
        turns.spread(angles.len(), sort, |(angles, quantiles)| {
            sorted.push(angles);
            found.push(quantiles);
        })?;
        turns.take(|turn| {
            let answer = Answer::new(&request, &runs, sorted, &found);
            let bytes = match format {
                Format::Csv => write::csv(&answer.rows(), turn)?,
                Format::Ndjson => write::ndjson(&answer.rows(), answer.summary(), turn)?,
                Format::Progress => progress::end(&write::json(&answer, turn)?),
                Format::Svg | Format::Png => write::picture(answer.to_picture(), format, turn)?,
                _ => write::json(&answer, turn)?,
            };
            Ok(out.send_whole(bytes, turn)?)
        })?
    })
    .await
}
