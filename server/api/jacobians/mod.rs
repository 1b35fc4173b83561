//! `jacobians`: the derivative of the map.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;
use equipoise_physics::stability::fixed_point::JUDGED;

use crate::api::app::App;
use crate::api::jacobians::answer::{At, Jacobian, Method, price};
use crate::api::scene::read_scene_within;
use crate::api::shared::write;
use crate::compute::{Cancelled, Price, Turn};
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;

const RESOURCE: Resource = Resource { name: "jacobians", formats: &[Format::Json, Format::Csv, Format::Ndjson] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/jacobians", get(jacobians).post(jacobians))
}

pub(crate) async fn jacobians(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let (scene, at, period, method) = ask.read(|reader| {
        let scene = read_scene_within(reader, &JUDGED);
        let at = At::read(reader);
        let period = reader.integer("period", 1..=limits::PERIOD).unwrap_or(1);
        let method = reader
            .choice("method", &[("exact", Method::Exact), ("finite_difference", Method::FiniteDifference)])
            .unwrap_or(Method::Exact);
        Some((scene?, at?, period, method))
    })?;
    let price = Price::bounces(price(&scene, at, period, method)).within(&app.config.limits.of_work())?;
    let canonical = write::canonical(&scene, &(at, period, method));
    let metrics = app.metrics.clone();
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, turn: &Turn| {
        let jacobian = match Jacobian::compute(&scene, at, period, method, || turn.go_on()) {
            Ok(jacobian) => jacobian,
            Err(Some((pointer, detail))) => return Err(Problem::invalid_at(pointer, detail)),
            Err(None) => return Err(Cancelled.into()),
        };
        metrics.bounces.inc_by(period);
        match format {
            Format::Csv => write::csv(&jacobian.to_table(), turn),
            Format::Ndjson => write::ndjson(&jacobian.to_table(), &jacobian, turn),
            _ => write::json(&jacobian, turn),
        }
    })
    .await
}
