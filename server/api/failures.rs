//! `/v1/failures`: the gallery of scenes for which a common method gives a wrong result.

use axum::Router;
use axum::body::Body;
use axum::extract::{Path, State};
use axum::http::Response;
use axum::routing::get;
use equipoise_physics::scene::{FIELDS, Scene};
use schemars::JsonSchema;
use serde::Serialize;

use crate::api::app::App;
use crate::api::contract::Contract;
use crate::api::formats::{FigureFormat, FormatSet};
use crate::api::resource::negotiated;
use crate::api::scene::{Resolved, value_to_json};
use crate::api::shared::write;
use crate::charts::chart;
use crate::compute::{Cancelled, Price, TimeSlice};
use crate::failure_cases;
use crate::failure_cases::{CASES, FailureCase, MethodClaim};
use crate::http::{ApiRequest, Format, Problem, Resource};
use crate::words;

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

words! {
    /// Name of a case of the failure gallery.
    FailureName = CASES.map(|case| case.name);
}

/// Answer of `/v1/failures/{name}`.
#[derive(Debug, Serialize, JsonSchema)]
#[schemars(rename = "Failure")]
pub struct FailureAnswer {
    #[schemars(with = "FailureName")]
    name: &'static str,
    /// A short title.
    title: &'static str,
    /// The usual method that fails here.
    method: &'static str,
    /// Reason for the failure, in a paragraph.
    why: &'static str,
    scene: Resolved,
    /// Largest number of impacts of the runs.
    bounces: u64,
    /// The claim of each method, the usual one first.
    says: Vec<FailureClaim>,
    truth: FailureTruth,
    /// A request to this server that shows the truth.
    ask: String,
    /// The picture of the case.
    picture: String,
}

/// Claim of a method.
#[derive(Debug, Serialize, JsonSchema)]
struct FailureClaim {
    method: &'static str,
    /// The claim in a word or two.
    text: &'static str,
    /// The number behind the claim.
    value: Option<f64>,
    /// Unit of the value; null for a pure number and without a value.
    unit: Option<&'static str>,
    /// True if the claim is the truth.
    right: bool,
    /// Explanation with numbers.
    detail: String,
}

/// The truth.
#[derive(Debug, Serialize, JsonSchema)]
struct FailureTruth {
    text: &'static str,
    /// Evidence, with numbers.
    detail: String,
}

impl FailureAnswer {
    /// Computes the claims of a case.
    pub fn compute(case: &FailureCase) -> Self {
        let (scene, seen) = (case.scene(), case.findings());
        let said = |MethodClaim { method, verdict: text, value, unit, detail }| {
            let value = value.filter(|value| value.is_finite());
            FailureClaim { method, text, value, unit, right: text == seen.truth, detail }
        };
        Self {
            name: case.name,
            title: case.title,
            method: case.method,
            why: case.why,
            scene: Resolved(scene),
            bounces: case.impacts,
            says: seen.says.into_iter().map(said).collect(),
            truth: FailureTruth { text: seen.truth, detail: seen.detail },
            ask: ask(&scene, case.ask),
            picture: format!("/v1/failures/{}?format=svg", case.name),
        }
    }
}

/// Path and query of a request to this server, with the fields of the scene that differ from the defaults.
fn ask(scene: &Scene, (resource, rest): (&str, &str)) -> String {
    let said = FIELDS.iter().filter_map(|row| {
        let value = scene.value(row.name).filter(|value| Some(*value) != row.default)?;
        let value = value_to_json(value);
        Some(format!("scene.{}={}&", row.path, value.as_str().map_or_else(|| value.to_string(), str::to_owned)))
    });
    format!("/v1/{resource}?{}{rest}", said.collect::<String>())
}
