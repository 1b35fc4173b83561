//! `precision`: speed against accuracy. The one resource that measures a clock, so nothing of it is kept.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use crate::api::app::App;
use crate::api::precision::answer::{Precision, Request};
use crate::api::scene::read_frictionless_scene;
use crate::api::shared::progress;
use crate::api::shared::progress::Progress;
use crate::api::shared::write;
use crate::compute::Turn;
use crate::http::{Ask, Format, Outlet, Problem, Resource};

const RESOURCE: Resource = Resource {
    name: "precision",
    formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Progress, Format::Svg, Format::Png],
};

/// Those that are sent line by line while it is measured.
const STREAMED: [Format; 1] = [Format::Progress];

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/precision", get(precision).post(precision))
}

pub(crate) async fn precision(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, request) = ask.read(|reader| {
        let scene = read_frictionless_scene(reader);
        let request = Request::read(reader);
        Some((scene?, request?))
    })?;
    request.price().within(&app.config.limits.of_work())?;
    let metrics = app.metrics.clone();
    let compute = move |format: Format, turn: &Turn, out: &mut Outlet| {
        let mut lines = Progress::default();
        let mut tell = |done, of| {
            if STREAMED.contains(&format) {
                out.send(lines.line(done, of));
            }
        };
        let precision = Precision::compute(&scene, &request, &mut tell, turn)?;
        metrics.bounces.inc_by(precision.bounces());
        let bytes = match format {
            Format::Csv => write::csv(&precision.to_table(), turn)?,
            Format::Ndjson => write::ndjson(&precision.to_table(), &precision.end(), turn)?,
            Format::Progress => progress::end(&write::json(&precision, turn)?),
            Format::Svg | Format::Png => write::picture(precision.to_picture(), format, turn)?,
            _ => write::json(&precision, turn)?,
        };
        Ok(out.send_whole(bytes, turn)?)
    };
    ask.respond_afresh(&app.pool, &RESOURCE, &STREAMED, compute).await
}
