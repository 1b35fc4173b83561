//! `/v1/failures`: the gallery of scenes on which a common method is wrong.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::Response;
use axum::routing::get;
use serde::Serialize;

use crate::api::app::App;
use crate::api::failures::answer::FailureAnswer;
use crate::api::formats::{FigureFormat, FormatSet};
use crate::api::resource::negotiated;
use crate::api::shared::write;
use crate::charts::chart;
use crate::compute::{Cancelled, Price, Turn};
use crate::failure_cases;
use crate::failure_cases::CASES;
use crate::http::{Ask, Format, Problem, Resource};

/// The routes.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/failures", get(failures)).route("/v1/failures/{name}", get(failure))
}

async fn failures(State(app): State<App>, ask: Ask) -> Result<Response<Body>, Problem> {
    #[derive(Serialize)]
    struct Failures {
        failures: Vec<FailureAnswer>,
    }
    const RESOURCE: Resource = Resource { name: "failures", formats: &[Format::Json] };
    ask.read(|_| Some(()))?;
    let price = Price::bounces(CASES.iter().map(|case| case.price).sum());
    ask.respond(&app.pool, &RESOURCE, b"", price, move |_, turn: &Turn| {
        // Every case is a few milliseconds, and between two of them somebody may have gone away.
        let each = CASES.iter().map(|case| if turn.go_on() { Some(FailureAnswer::compute(case)) } else { None });
        write::json(&Failures { failures: each.collect::<Option<_>>().ok_or(Cancelled)? }, turn)
    })
    .await
}

async fn failure(State(app): State<App>, Path(name): Path<String>, ask: Ask) -> Result<Response<Body>, Problem> {
    const RESOURCE: Resource = Resource { name: "failure", formats: FigureFormat::FORMATS };
    let Some(case) = failure_cases::find(&name) else {
        let names = CASES.map(|case| case.name).join(", ");
        return Err(Problem::not_found(format!("there is no failure of this name; there are {names}")));
    };
    ask.read(|_| Some(()))?;
    let price = Price::bounces(case.price);
    ask.respond(&app.pool, &RESOURCE, case.name.as_bytes(), price, move |format, turn: &Turn| {
        match negotiated(format) {
            FigureFormat::Json => write::json(&FailureAnswer::compute(case), turn),
            FigureFormat::Svg => Ok(chart(&case.picture()).into_bytes()),
            FigureFormat::Png => write::pixels(&chart(&case.picture()), turn),
        }
    })
    .await
}
