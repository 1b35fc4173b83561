//! `failures`: the gallery of scenes on which a common method is wrong.

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::Response;
use axum::routing::get;
use serde::Serialize;

use super::App;
use crate::compute::{Cancel, Cancelled, Price};
use crate::gallery::{self, CASES};
use crate::http::{Ask, Format, Problem, Resource};
use crate::picture::chart;
use crate::wire::failure::Failure;

/// Its paths.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/failures", get(failures)).route("/v1/failures/{name}", get(failure))
}

async fn failures(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    #[derive(Serialize)]
    struct Failures {
        failures: Vec<Failure>,
    }
    const RESOURCE: Resource = Resource { name: "failures", formats: &[Format::Json] };
    ask.read(|_| Some(()))?;
    let price = Price::bounces(CASES.iter().map(|case| case.price).sum());
    ask.respond(&app.pool, &RESOURCE, b"", price, move |_, cancel: &Cancel| {
        // Every case is a few milliseconds, and between two of them somebody may have gone away.
        let each = CASES.iter().map(|case| if cancel.is_set() { None } else { Some(Failure::compute(case)) });
        super::json(&Failures { failures: each.collect::<Option<_>>().ok_or(Cancelled)? }, cancel)
    })
    .await
}

async fn failure(State(app): State<App>, Path(name): Path<String>, ask: Ask) -> Result<Response<Body>, Problem> {
    const RESOURCE: Resource = Resource { name: "failure", formats: &[Format::Json, Format::Svg, Format::Png] };
    let Some(case) = gallery::find(&name) else {
        let names = CASES.map(|case| case.name).join(", ");
        return Err(Problem::not_found(format!("there is no failure of this name; there are {names}")));
    };
    ask.read(|_| Some(()))?;
    let price = Price::bounces(case.price);
    ask.respond(&app.pool, &RESOURCE, case.name.as_bytes(), price, move |format, cancel: &Cancel| match format {
        Format::Svg | Format::Png => super::picture(chart(&case.picture()), format, cancel),
        _ => super::json(&Failure::compute(case), cancel),
    })
    .await
}
