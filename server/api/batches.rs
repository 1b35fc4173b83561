//! `batches`: many requests to one resource at once, a line each, answered line by line.
//!
//! Each line is a request of its own: it waits for its turn among those of all clients, and what is wrong with it is told
//! in its line and nowhere else. No more of them are under way than there are permits, and none is begun before the client
//! has taken what is done, so a batch holds no more than its few answers.

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
use serde::Serialize;
use tokio::task::yield_now;
use tokio::time::timeout;

use crate::api::app::App;
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
    let told = stream::iter(batch.into_items()).map(move |item| told(app.clone(), answer, item, context.clone()));
    let told = told.buffered(at_once).map(Some).chain(stream::iter([None]));
    let pieces = told.scan(End::default(), |end, told| ready(Some(end.pass(told)))).map(stream::iter).flatten();
    request.respond_stream(&RESOURCE, Body::from_stream(pieces.map(Ok::<_, Infallible>)))
}

/// How the lines of an answer came out, which its last line says.
#[derive(Debug, Default, Serialize)]
struct End {
    lines: usize,
    problems: usize,
}

impl End {
    /// The pieces of a line on their way; after the last one those of the end.
    fn pass(&mut self, told: Option<Told>) -> Vec<Bytes> {
        let Some(Told { number, said }) = told else {
            #[derive(Serialize)]
            struct Last<'a> {
                end: &'a End,
            }
            let last = serde_json::to_string(&Last { end: self }).expect("numbers");
            return vec![format!("{last}\n").into()];
        };
        self.lines += 1;
        let (name, json) = match said {
            Ok(answer) => ("answer", answer),
            Err(problem) => {
                self.problems += 1;
                ("problem", problem)
            }
        };
        // As it is, a large answer is not copied, and counts as the client's until it is sent.
        vec![format!("{{\"line\":{number},\"{name}\":").into(), json, Bytes::from_static(b"}\n")]
    }
}

/// What the resource says to a line, as JSON: its answer, or a problem.
struct Told {
    number: usize,
    said: Result<Bytes, Bytes>,
}

async fn told(app: App, answer: Answer, item: BatchItem, context: Option<RequestContext>) -> Told {
    // Cheap work is done in this task, and others' have to have their turn in between.
    yield_now().await;
    let number = item.number;
    let answered = AssertUnwindSafe(answered(app, answer, item)).catch_unwind();
    let telling = async {
        let answered = answered.await.unwrap_or_else(|_| Err(Problem::internal()));
        answered.map_err(|problem| problem.to_json().into())
    };
    // The body is sent by another task than the one that was asked.
    let said = match context {
        Some(context) => context.scope(telling).await,
        None => telling.await,
    };
    Told { number, said }
}

/// The answer as JSON. Who sends a batch has come to wait, so a line waits again where a request would be told to.
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
    // Only work that was given up breaks off, and that is done for nobody.
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
        let told = told(app, |_, _| async { panic!("on purpose") }.boxed(), item().await, None).await;
        let problem: serde_json::Value = serde_json::from_slice(&told.said.unwrap_err()).unwrap();
        assert_eq!(problem["status"], 500);
    }

    #[tokio::test(start_paused = true)]
    async fn a_line_waits_where_there_is_too_much_to_do_but_not_for_ever() {
        let app = App::new(&Config::default());
        let told = told(app, |_, _| async { Err(Problem::overloaded("full")) }.boxed(), item().await, None);
        let begin = tokio::time::Instant::now();
        let problem: serde_json::Value = serde_json::from_slice(&told.await.said.unwrap_err()).unwrap();
        assert_eq!((problem["status"].as_u64(), problem["detail"].as_str()), (Some(503), Some("full")));
        assert_eq!(begin.elapsed().as_secs(), u64::from(limits::BATCH_WAITS * limits::RETRY_AFTER_S));
    }
}
