//! `/v1/batches/{resource}`: many requests to one resource at once, one on each line, answered line by line.
//!
//! Each line is a request of its own. It waits for its turn among the requests of all clients, and its errors stand in its own
//! line. At most as many lines as there are permits are computed at a time, and the next one starts only after the client has
//! read the answers so far, so a batch holds few answers in memory.

use std::convert::Infallible;
use std::future::ready;
use std::panic::AssertUnwindSafe;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Path, State};
use axum::http::{Response, StatusCode};
use axum::routing::post;
use futures_util::{FutureExt, StreamExt, stream};
use http_body_util::BodyExt;
use schemars::JsonSchema;
use serde::Serialize;
use tokio::task::yield_now;
use tokio::time::timeout;

use crate::api::app::App;
use crate::api::contract::Contract;
use crate::api::resource::{Answer, Endpoint};
use crate::http::{BatchItem, Format, NdjsonBatch, Problem, RequestContext, Resource};
use crate::limits;

/// The route, for these resources.
pub fn routes(resources: &'static [Endpoint]) -> Router<App> {
    let handler = move |State(app): State<App>, Path(name): Path<String>, batch: NdjsonBatch| async move {
        batches(resources, app, &name, batch)
    };
    Router::new().route("/v1/batches/{resource}", post(handler))
}

fn batches(resources: &[Endpoint], app: App, name: &str, batch: NdjsonBatch) -> Result<Response<Body>, Problem> {
    const RESOURCE: Resource = Resource { name: "batches", formats: &[Format::Ndjson] };
    let Some(Endpoint { answer, .. }) = resources.iter().find(|resource| resource.name == name).copied() else {
        let names: Vec<&str> = resources.iter().map(|resource| resource.name).collect();
        return Err(Problem::not_found(format!("there are no batches of this name; there are {}", names.join(", "))));
    };
    let (request, context, at_once) = (batch.request.clone(), RequestContext::current(), app.config.permits());
    let answers =
        stream::iter(batch.into_items()).map(move |item| answer_item(app.clone(), answer, item, context.clone()));
    let answers = answers.buffered(at_once).map(Some);
    request.respond_stream(&RESOURCE, |_| {
        let answers = answers.chain(stream::once(ready(None)));
        let pieces = answers.scan(BatchEnd::default(), |end, answer| ready(Some(end.pass(answer))));
        Body::from_stream(pieces.map(stream::iter).flatten().map(Ok::<_, Infallible>))
    })
}

/// Adds the path to the contract.
pub fn describe(contract: &mut Contract, resources: &[Endpoint]) {
    let names: Vec<_> = resources.iter().map(|resource| resource.name).collect();
    contract.batches::<BatchLine>(&names);
}

/// A line of the answer to a batch.
#[derive(JsonSchema)]
#[schemars(untagged)]
#[expect(dead_code, reason = "a schema alone: lines are put together from bytes")]
enum BatchLine {
    /// The answer of the resource.
    Answer {
        /// Number of the line of the request, from 1, including blank lines.
        line: usize,
        /// The JSON answer of the resource to this line.
        answer: serde_json::Map<String, serde_json::Value>,
    },
    /// The problem with the request.
    Problem { line: usize, problem: Problem },
    /// The last line. Without it the answer is incomplete.
    Last { end: BatchEnd },
}

/// Number of lines and of problems, for the last line.
#[derive(Debug, Default, Serialize, JsonSchema)]
struct BatchEnd {
    /// Number of lines answered.
    lines: usize,
    /// Number of lines answered with a problem.
    problems: usize,
}

impl BatchEnd {
    /// The bytes of a line, or of the last line after all others.
    fn pass(&mut self, answer: Option<BatchAnswer>) -> Vec<Bytes> {
        let Some(BatchAnswer { number, result }) = answer else {
            #[derive(Serialize)]
            struct Last<'a> {
                end: &'a BatchEnd,
            }
            let last = serde_json::to_string(&Last { end: self }).expect("numbers");
            return vec![format!("{last}\n").into()];
        };
        self.lines += 1;
        let (name, json) = match result {
            Ok(answer) => ("answer", answer),
            Err(problem) => {
                self.problems += 1;
                ("problem", problem)
            }
        };
        // In pieces, a large answer is not copied, and its bytes count as the client's until they are sent.
        vec![format!("{{\"line\":{number},\"{name}\":").into(), json, Bytes::from_static(b"}\n")]
    }
}

/// The response to a line, as JSON: an answer or a problem.
struct BatchAnswer {
    number: usize,
    result: Result<Bytes, Bytes>,
}

async fn answer_item(app: App, answer: Answer, item: BatchItem, context: Option<RequestContext>) -> BatchAnswer {
    // Cheap work runs in this task, so other tasks get their turn between lines.
    yield_now().await;
    let number = item.number;
    let answered = AssertUnwindSafe(answered(app, answer, item)).catch_unwind();
    let telling = async {
        let answered = answered.await.unwrap_or_else(|_| Err(Problem::internal()));
        answered.map_err(|problem| problem.to_json().into())
    };
    // The body is sent by another task than the one that got the request.
    let result = match context {
        Some(context) => context.scope(telling).await,
        None => telling.await,
    };
    BatchAnswer { number, result }
}

/// The answer as JSON. A batch can wait, so an overloaded server is asked again instead of telling the client to.
async fn answered(app: App, answer: Answer, item: BatchItem) -> Result<Bytes, Problem> {
    let request = item.request()?;
    let mut waits = 0..limits::BATCH_WAITS;
    let response = loop {
        if app.is_closing() {
            return Err(Problem::overloaded("the server is being stopped; ask for this line again"));
        }
        match answer(app.clone(), request.clone()).await {
            Err(problem) if problem.status() == StatusCode::SERVICE_UNAVAILABLE && waits.next().is_some() => {
                let _ = timeout(limits::BATCH_WAIT_TIME, app.closing()).await;
            }
            answered => break answered?,
        }
    };
    // A body breaks off only if its work was cancelled, and then nobody reads it.
    Ok(response.into_body().collect().await.map_err(|_| Problem::internal())?.to_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Config;
    use crate::limits::Limits;
    use axum::extract::FromRequest;
    use axum::http::{Request, header};

    async fn item() -> BatchItem {
        let request = Request::post("/").header(header::CONTENT_TYPE, "application/x-ndjson").body(Body::from("{}"));
        let batch = NdjsonBatch::from_request(request.unwrap(), &Limits::default()).await.unwrap();
        batch.into_items().next().unwrap()
    }

    #[tokio::test]
    async fn a_panic_is_told_in_its_line() {
        let app = App::new(&Config::default());
        let answered = answer_item(app, |_, _| async { panic!("on purpose") }.boxed(), item().await, None).await;
        let problem: serde_json::Value = serde_json::from_slice(&answered.result.unwrap_err()).unwrap();
        assert_eq!(problem["status"], 500);
    }

    #[tokio::test(start_paused = true)]
    async fn a_line_waits_where_there_is_too_much_to_do_but_not_for_ever() {
        let app = App::new(&Config::default());
        let answered = answer_item(app, |_, _| async { Err(Problem::overloaded("full")) }.boxed(), item().await, None);
        let begin = tokio::time::Instant::now();
        let problem: serde_json::Value = serde_json::from_slice(&answered.await.result.unwrap_err()).unwrap();
        assert_eq!((problem["status"].as_u64(), problem["detail"].as_str()), (Some(503), Some("full")));
        assert_eq!(begin.elapsed().as_secs(), u64::from(limits::BATCH_WAITS * limits::RETRY_AFTER_S));
    }
}
