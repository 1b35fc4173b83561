//! `trajectories`: the contacts of a run.

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use super::App;
use crate::compute::{Cancel, Cancelled, Price};
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;
use crate::wire::scene;
use crate::wire::trajectory::Trajectory;

const RESOURCE: Resource =
    Resource { name: "trajectories", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Numbers in a row of contacts, and in one of flight samples; and what a row costs beside its bounce, in bounces.
const CONTACT_NUMBERS: u64 = 17;
const SAMPLE_NUMBERS: u64 = 8;
const ROW_PRICE: u64 = 10;

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/trajectories", get(trajectories).post(trajectories))
}

async fn trajectories(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, impacts, samples) = ask.read(|reader| {
        let scene = scene::read(reader);
        let impacts = reader.integer("impacts", 1..=limits::IMPACTS).unwrap_or(100);
        let samples = reader.integer("samples_per_flight", 0..=limits::SAMPLES_PER_FLIGHT).unwrap_or(0);
        // There is one method so far, so that there is nothing to choose.
        reader.choice_so_far("method", &[("auto", ()), ("map", ())], &["linear", "extended"]);
        reader.not_available("tolerance");
        Some((scene?, impacts, samples))
    })?;
    let rows = impacts.saturating_mul(CONTACT_NUMBERS).saturating_add(impacts.saturating_mul(samples * SAMPLE_NUMBERS));
    limits::ANSWER.admit(rows)?;
    let price = Price::bounces(impacts).times(1 + samples).times(ROW_PRICE).within(&limits::WORK)?;
    let canonical = super::canonical(&scene, &(impacts, samples));
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, cancel: &Cancel| {
        let trajectory = Trajectory::compute(&scene, impacts, samples, || !cancel.is_set()).ok_or(Cancelled)?;
        metrics.bounces.inc_by(trajectory.outcome.impacts);
        match format {
            Format::Csv => Ok(trajectory.impacts.to_csv()),
            Format::Ndjson => Ok(trajectory.impacts.to_ndjson(&trajectory.end())),
            Format::Svg | Format::Png => super::picture(trajectory.to_picture(), format, cancel),
            _ => super::json(&trajectory),
        }
    })
    .await
}
