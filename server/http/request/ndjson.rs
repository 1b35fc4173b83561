//! Batches: many requests in one body, one JSON object on each line (NDJSON).

use axum::body::Bytes;
use axum::extract::{FromRef, FromRequest, Request};
use axum::http::HeaderMap;

use crate::compute::Peer;
use crate::http::problem::Problem;
use crate::http::request::api_request::{ApiRequest, peer};
use crate::http::request::body;
use crate::http::request::body::NDJSON;
use crate::limits::Limits;

/// A batch of requests. As an extractor it takes the body, so it comes last.
#[derive(Debug)]
pub struct NdjsonBatch {
    /// Format and headers for the answer to the batch; it has no fields.
    pub request: ApiRequest,
    body: Bytes,
}

impl NdjsonBatch {
    /// The requests on lines that are not blank.
    pub fn into_items(self) -> impl Iterator<Item = BatchItem> + Send {
        let mut rest = Some(self.body);
        let lines = std::iter::from_fn(move || {
            let mut line = rest.take()?;
            if let Some(end) = line.iter().position(|byte| *byte == b'\n') {
                let mut after = line.split_off(end);
                rest = Some(after.split_off(1));
            }
            Some(line)
        });
        let peer = self.request.peer;
        let numbered = lines.zip(1..).filter(|(line, _)| !line.trim_ascii().is_empty());
        numbered.map(move |(body, number)| BatchItem { number, body, peer })
    }
}

/// One request of a batch.
#[derive(Debug)]
pub struct BatchItem {
    /// Number of the line in the body, from 1.
    pub number: usize,
    body: Bytes,
    peer: Peer,
}

impl BatchItem {
    /// The request, as if it had been posted alone.
    pub fn request(&self) -> Result<ApiRequest, Problem> {
        ApiRequest::from_body("", &self.body, HeaderMap::new(), self.peer)
    }
}

impl<S: Send + Sync> FromRequest<S> for NdjsonBatch
where
    Limits: FromRef<S>,
{
    type Rejection = Problem;

    async fn from_request(request: Request, state: &S) -> Result<Self, Problem> {
        let (parts, body) = request.into_parts();
        NDJSON.check(&parts.headers)?;
        let body = body::read(body, &parts.headers, &Limits::from_ref(state)).await?;
        let peer = peer(&parts.extensions);
        let request = ApiRequest::from_body(parts.uri.query().unwrap_or_default(), b"{}", parts.headers, peer)?;
        if body.trim_ascii().is_empty() {
            return Err(Problem::not_readable("the body is empty; it must be a JSON object on each line"));
        }
        Ok(Self { request, body })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::body::Body;
    use axum::http::header;

    async fn lines(query: &str, body: &'static str) -> Result<NdjsonBatch, Problem> {
        let request = Request::post(format!("/v1/x{query}")).header(header::CONTENT_TYPE, "application/jsonl");
        NdjsonBatch::from_request(request.body(Body::from(body)).unwrap(), &Limits::default()).await
    }

    #[tokio::test]
    async fn each_line_is_a_request_of_its_own() {
        let lines = lines("?format=ndjson", "{\"a\": 1}\r\n\n  \t\n{\"a\": }\n{}").await.unwrap();
        let asks: Vec<_> = lines.into_items().map(|line| (line.number, line.request())).collect();
        let numbers: Vec<usize> = asks.iter().map(|(number, _)| *number).collect();
        assert_eq!(numbers, [1, 4, 5]);
        assert_eq!(asks[0].1.as_ref().unwrap().fields["a"], 1);
        assert_eq!(asks[1].1.as_ref().unwrap_err().status(), 400);
        assert!(asks[2].1.as_ref().unwrap().fields.is_empty());
    }

    #[tokio::test]
    async fn no_line_and_other_parameters_are_refused() {
        assert_eq!(lines("", " \n\r\n").await.unwrap_err().status(), 400);
        assert_eq!(lines("?bounces=3", "{}").await.unwrap_err().status(), 422);
    }

    #[tokio::test]
    async fn json_alone_is_not_lines() {
        let request = Request::post("/v1/x").header(header::CONTENT_TYPE, "application/json").body(Body::from("{}"));
        assert_eq!(NdjsonBatch::from_request(request.unwrap(), &Limits::default()).await.unwrap_err().status(), 415);
    }
}
