//! `ladder`: the same scene on each rung of the ladder of models up to its own.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use crate::api::app::App;
use crate::api::ladder::answer::{Ladder, Request};
use crate::api::scene::read_scene;
use crate::api::shared::write;
use crate::compute::{Cancelled, Price, Turn};
use crate::http::{Ask, Format, Problem, Resource};

const RESOURCE: Resource = Resource { name: "ladder", formats: &[Format::Json, Format::Csv, Format::Ndjson] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/ladder", get(ladder).post(ladder))
}

pub(crate) async fn ladder(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, request) = ask.read(|reader| {
        let scene = read_scene(reader);
        let request = Request::read(reader);
        Some((scene?, request))
    })?;
    let price = Price::bounces(request.price(&scene)).within(&app.config.limits.of_work())?;
    let canonical = write::canonical(&scene, &request);
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, turn: &Turn| {
        let ladder = Ladder::compute(&scene, &request, || turn.go_on()).ok_or(Cancelled)?;
        metrics.bounces.inc_by(ladder.bounces());
        match format {
            Format::Csv => write::csv(&ladder.to_table(), turn),
            Format::Ndjson => write::ndjson(&ladder.to_table(), &ladder.end(), turn),
            _ => write::json(&ladder, turn),
        }
    })
    .await
}
