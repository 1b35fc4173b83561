//! `/v1/failures`: the gallery of scenes for which a common method gives a wrong result.

pub mod answer;

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::Response;
use axum::routing::get;
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::app::App;
use crate::api::contract::Contract;
use crate::api::failures::answer::FailureAnswer;
use crate::api::formats::{FigureFormat, FormatSet};
use crate::api::resource::negotiated;
use crate::api::shared::write;
use crate::charts::chart;
use crate::compute::{Cancelled, Price, TimeSlice};
use crate::failure_cases;
use crate::failure_cases::CASES;
use crate::http::{ApiRequest, Format, Problem, Resource};

/// The routes.
pub fn routes() -> Router<App> {
    Router::new().route("/v1/failures", get(failures)).route("/v1/failures/{name}", get(failure))
}

/// Adds the paths to the contract.
pub fn describe(contract: &mut Contract) {
    contract.document::<Failures>("Gallery", "failures", "listFailures", FAILURES.formats);
    contract.document::<FailureAnswer>("Gallery", "failures/{name}", "getFailure", FAILURE.formats);
    let about = "Name of a case; `/v1/failures` lists them.";
    contract.path_name("/v1/failures/{name}", "FailureName", "FailureName", "double-eigenvalue-soft", about);
}

const FAILURES: Resource = Resource { name: "failures", formats: &[Format::Json] };
const FAILURE: Resource = Resource { name: "failure", formats: FigureFormat::FORMATS };

/// Answer of `/v1/failures`.
#[derive(Serialize, JsonSchema)]
struct Failures {
    /// The cases, in a fixed order.
    items: Vec<FailureAnswer>,
}

async fn failures(State(app): State<App>, api_request: ApiRequest) -> Result<Response<Body>, Problem> {
    api_request.read(|_| Some(()))?;
    let price = Price::bounces(CASES.iter().map(|case| case.price).sum());
    api_request
        .respond(&app.answers, &FAILURES, b"", price, move |_, slice: &TimeSlice| {
            // A case takes a few milliseconds, so one check per case is enough.
            let each = CASES
                .iter()
                .map(|case| if slice.should_continue() { Some(FailureAnswer::compute(case)) } else { None });
            write::json(&Failures { items: each.collect::<Option<_>>().ok_or(Cancelled)? }, slice)
        })
        .await
}

async fn failure(
    State(app): State<App>,
    Path(name): Path<String>,
    api_request: ApiRequest,
) -> Result<Response<Body>, Problem> {
    let Some(case) = failure_cases::find(&name) else {
        let names = CASES.map(|case| case.name).join(", ");
        return Err(Problem::not_found(format!("there is no failure of this name; there are {names}")));
    };
    api_request.read(|_| Some(()))?;
    let price = Price::bounces(case.price);
    api_request
        .respond(
            &app.answers,
            &FAILURE,
            case.name.as_bytes(),
            price,
            move |format, slice: &TimeSlice| match negotiated(format) {
                FigureFormat::Json => write::json(&FailureAnswer::compute(case), slice),
                FigureFormat::Svg => Ok(chart(&case.picture()).into_bytes()),
                FigureFormat::Png => write::pixels(&chart(&case.picture()), slice),
            },
        )
        .await
}
