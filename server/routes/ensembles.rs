//! `ensembles`: many runs of a scene, each with noise of its own.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;
use equipoise_physics::ensemble::{Runs, quantiles};

use super::App;
use crate::compute::Turns;
use crate::http::{Ask, Format, Outlet, Problem, Resource};
use crate::limits;
use crate::wire::ensemble::{Answer, read};
use crate::wire::progress::{self, Progress};

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

async fn ensembles(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let ensemble = ask.read(read)?;
    app.config.limits.of_ensemble_work().admit(ensemble.runs.saturating_mul(ensemble.impacts))?;
    let canonical = super::canonical(&ensemble.scene, &(ensemble.runs, ensemble.impacts));
    let metrics = app.metrics.clone();
    ask.respond_in_turns(&app.pool, &RESOURCE, &canonical, &STREAMED, move |format, turns: &Turns, out: &mut Outlet| {
        let cancel = turns.cancel();
        // A matter of the request alone, not that it would show.
        let block = (limits::ENSEMBLE_BLOCK_WORK / ensemble.impacts).max(1);
        let compute = |number: usize| {
            let first = number as u64 * block;
            let runs = ensemble.runs(first..(first + block).min(ensemble.runs), &mut || !cancel.is_set())?;
            metrics.bounces.inc_by(runs.ends.iter().map(|end| end.impacts).sum());
            Some(runs)
        };
        let (mut runs, mut lines) = (Runs::default(), Progress::default());
        let mut tell = |ended| {
            if STREAMED.contains(&format) {
                out.send(lines.line(ended, ensemble.runs));
            }
        };
        tell(0);
        turns.spread(ensemble.runs.div_ceil(block) as usize, compute, |others| {
            runs.append(others);
            tell(runs.ends.len() as u64);
        })?;
        let angles = std::mem::take(&mut runs.angles);
        let mut found = Vec::with_capacity(angles.len());
        turns.spread(
            angles.len(),
            |place| Some(quantiles(angles[place].clone())),
            |quantiles| found.push(quantiles),
        )?;
        turns.take(|| {
            let answer = Answer::new(&ensemble, &runs, &found);
            let bytes = match format {
                Format::Csv => answer.rows().to_csv(),
                Format::Ndjson => answer.rows().to_ndjson(answer.summary()),
                Format::Progress => progress::end(&super::json(&answer)?),
                Format::Svg | Format::Png => super::picture(answer.to_picture(), format, cancel)?,
                _ => super::json(&answer)?,
            };
            Ok(out.send_whole(bytes, cancel)?)
        })?
    })
    .await
}
