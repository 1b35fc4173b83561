//! Frame of the black-box tests: the router in this process, requests to it, and a check of every answer against `openapi.yaml`.
//!
//! Every answer passes `contract::hold` before a test sees it, so each test is also a contract test. There is one test file for each
//! promise of the server.

#![allow(dead_code, reason = "each test file uses its own part of the frame")]

pub(crate) mod contract;
pub(crate) mod socket;
pub(crate) mod tables;

use std::io::Read;

use axum::body::Body;
use axum::http::{HeaderMap, Method, Request, StatusCode, header};
use http_body_util::BodyExt;
use serde_json::Value;
use tower::ServiceExt;

/// A JSON value as a number.
pub(crate) fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The number at a pointer.
pub(crate) fn number_at(answer: &Value, pointer: &str) -> f64 {
    answer.pointer(pointer).and_then(Value::as_f64).unwrap_or_else(|| panic!("{pointer} is no number: {answer}"))
}

/// The numbers of a column without nulls.
pub(crate) fn numbers(column: &Value) -> Vec<f64> {
    column.as_array().expect("a column").iter().map(number).collect()
}

/// Holds a number to its expected value.
pub(crate) fn close(value: &Value, expected: f64, tolerance: f64) {
    let number = value.as_f64().unwrap_or(f64::NAN);
    assert!((number - expected).abs() <= tolerance, "{value} is not {expected} ± {tolerance}");
}

/// The whole server without a socket.
pub(crate) struct Server {
    router: axum::Router,
}

impl Server {
    pub(crate) fn start() -> Self {
        Self::with(&equipoise::config::Config::default())
    }

    pub(crate) fn with_permits(permits: usize) -> Self {
        let permits = std::num::NonZeroUsize::new(permits);
        Self::with(&equipoise::config::Config { permits, ..Default::default() })
    }

    pub(crate) fn with(config: &equipoise::config::Config) -> Self {
        Self { router: equipoise::router::router(equipoise::api::App::new(config)) }
    }

    pub(crate) async fn get(&self, target: &str) -> Answer {
        self.send(Method::GET, target, &[], "").await
    }

    pub(crate) async fn get_with(&self, target: &str, headers: &[(&str, &str)]) -> Answer {
        self.send(Method::GET, target, headers, "").await
    }

    pub(crate) async fn head(&self, target: &str) -> Answer {
        self.send(Method::HEAD, target, &[], "").await
    }

    pub(crate) async fn post(&self, target: &str, body: &Value) -> Answer {
        self.send(Method::POST, target, &[("content-type", "application/json")], &body.to_string()).await
    }

    /// Sends a request unchanged and checks the answer against the contract.
    pub(crate) async fn send(
        &self,
        method: Method,
        target: &str,
        headers: &[(&str, &str)],
        body: impl AsRef<[u8]>,
    ) -> Answer {
        let answer = self.send_unheld(method.clone(), target, headers, body).await;
        contract::hold(&method, target, &answer);
        answer
    }

    /// The same without the contract, for behaviour that is set by flags.
    pub(crate) async fn send_unheld(
        &self,
        method: Method,
        target: &str,
        headers: &[(&str, &str)],
        body: impl AsRef<[u8]>,
    ) -> Answer {
        let mut request = Request::builder().method(&method).uri(target).header(header::HOST, "localhost");
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let request = request.body(Body::from(body.as_ref().to_vec())).expect("a request that HTTP allows");
        let response = self.router.clone().oneshot(request).await.expect("the router never fails");
        let (parts, body) = response.into_parts();
        let raw = body.collect().await.expect("a whole body").to_bytes().to_vec();
        Answer {
            request: format!("{method} {target}"),
            status: parts.status,
            body: decoded(&parts.headers, &raw),
            headers: parts.headers,
            raw,
        }
    }
}

fn decoded(headers: &HeaderMap, raw: &[u8]) -> Vec<u8> {
    match headers.get(header::CONTENT_ENCODING).map(|value| value.to_str().expect("ASCII")) {
        None => raw.to_vec(),
        Some("gzip") if raw.is_empty() => Vec::new(),
        Some("gzip") => {
            let mut body = Vec::new();
            flate2::read::GzDecoder::new(raw).read_to_end(&mut body).expect("a gzip body");
            body
        }
        Some(other) => panic!("content-encoding {other} was not asked for"),
    }
}

/// An answer.
pub(crate) struct Answer {
    /// Method and target, for messages of failed tests.
    pub(crate) request: String,
    pub(crate) status: StatusCode,
    pub(crate) headers: HeaderMap,
    /// The body as sent.
    pub(crate) raw: Vec<u8>,
    /// The body without its content encoding.
    pub(crate) body: Vec<u8>,
}

impl Answer {
    /// Returns the answer for chaining; panics with the body if it has another status.
    #[track_caller]
    pub(crate) fn expect(self, status: u16) -> Self {
        assert_eq!(self.status.as_u16(), status, "{}: {}", self.request, self.excerpt());
        self
    }

    #[track_caller]
    pub(crate) fn json(&self) -> Value {
        serde_json::from_slice(&self.body)
            .unwrap_or_else(|error| panic!("{}: {error}: {}", self.request, self.excerpt()))
    }

    #[track_caller]
    pub(crate) fn text(&self) -> &str {
        std::str::from_utf8(&self.body).expect("UTF-8")
    }

    #[track_caller]
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        self.headers.get(name).map(|value| value.to_str().expect("ASCII"))
    }

    /// The media type without parameters; empty without a content type.
    pub(crate) fn media_type(&self) -> &str {
        self.header("content-type").map_or("", |value| value.split(';').next().unwrap_or_default().trim())
    }

    #[track_caller]
    pub(crate) fn etag(&self) -> &str {
        self.header("etag").unwrap_or_else(|| panic!("{}: no ETag", self.request))
    }

    /// Pointers of a problem's errors, in order.
    #[track_caller]
    pub(crate) fn pointers(&self) -> Vec<String> {
        let problem = self.json();
        let errors = problem["errors"].as_array().cloned().unwrap_or_default();
        errors.iter().map(|error| error["pointer"].as_str().expect("a pointer").to_owned()).collect()
    }

    fn excerpt(&self) -> String {
        String::from_utf8_lossy(&self.body).chars().take(600).collect()
    }
}
