//! `controllers`: state feedback that balances in place.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::State;
use axum::http::Response;
use axum::routing::get;

use crate::api::app::App;
use crate::api::controllers::answer::{Controller, Request};
use crate::api::shared::write;
use crate::compute::{Price, Turn};
use crate::http::{Ask, Format, Problem, Resource};
use crate::limits;

const RESOURCE: Resource =
    Resource { name: "controllers", formats: &[Format::Json, Format::Csv, Format::Ndjson, Format::Svg, Format::Png] };

/// Its path.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/controllers", get(controllers).post(controllers))
}

pub(crate) async fn controllers(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    let request = ask.read(Request::read)?;
    let price = Price::bounces(limits::CONTROLLER_PRICE).within(&app.config.limits.of_work())?;
    let canonical = write::canonical(&request.scene, &request.rest());
    ask.respond(&app.pool, &RESOURCE, &canonical, price, move |format: Format, turn: &Turn| {
        let controller =
            Controller::compute(&request).map_err(|(pointer, detail)| Problem::invalid_at(pointer, detail))?;
        match format {
            Format::Csv => write::csv(&controller.to_table(), turn),
            Format::Ndjson => write::ndjson(&controller.to_table(), &controller.end(), turn),
            Format::Svg | Format::Png => write::picture(controller.to_picture(), format, turn),
            _ => write::json(&controller, turn),
        }
    })
    .await
}
