//! Problems (RFC 9457): the one shape of every 4xx and 5xx.
//!
//! A client sees only the fields here; internal causes go to the log, never into a body.

use std::borrow::Cow;
use std::fmt::Display;

use axum::http::{HeaderName, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Serialize, Serializer};

use crate::compute::{Cancelled, OverBudget, Overloaded};
use crate::http::request::context::RequestContext;
use crate::limits;

/// One error of one field.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ProblemError {
    /// JSON pointer (RFC 6901) into the request body, or into the body that a query stands for. Empty for the whole body.
    #[schemars(extend("pattern" = r"^(/[\s\S]*)?$"))]
    pub pointer: String,
    /// A sentence with the field's name, its value, its limits and its unit.
    pub detail: String,
}

/// An error as a client sees it. It is small to return: its parts are on the heap.
#[derive(Debug, Clone, PartialEq)]
pub struct Problem(Box<Parts>);

#[derive(Debug, Clone, PartialEq)]
struct Parts {
    status: StatusCode,
    /// Anchor in `/docs` for a problem with a meaning of its own; None is `about:blank`.
    slug: Option<&'static str>,
    title: &'static str,
    detail: String,
    errors: Vec<ProblemError>,
    headers: Vec<(HeaderName, HeaderValue)>,
}

impl Problem {
    fn plain(status: StatusCode, detail: impl Into<String>) -> Self {
        let title = status.canonical_reason().unwrap_or("Error");
        Self(Box::new(Parts { status, slug: None, title, detail: detail.into(), errors: vec![], headers: vec![] }))
    }

    fn named(mut self, slug: &'static str, title: &'static str) -> Self {
        (self.0.slug, self.0.title) = (Some(slug), title);
        self
    }

    pub(crate) fn header(mut self, name: HeaderName, value: HeaderValue) -> Self {
        self.0.headers.push((name, value));
        self
    }

    /// 400: the body is not JSON, or the URL is not properly encoded.
    pub fn not_readable(detail: impl Into<String>) -> Self {
        Self::plain(StatusCode::BAD_REQUEST, detail).named("not-readable", "The request cannot be read")
    }

    /// 401: the server has a token, and the request does not carry it.
    pub fn unauthorized() -> Self {
        let detail = "this server answers only who has its token: send it as Authorization: Bearer, or open the page once as \
                      /?token=…";
        Self::plain(StatusCode::UNAUTHORIZED, detail)
            .header(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer realm=\"equipoise\""))
    }

    /// 404: there is nothing of this name.
    pub fn not_found(detail: impl Into<String>) -> Self {
        Self::plain(StatusCode::NOT_FOUND, detail)
    }

    /// 405: `allow` lists the methods of the resource, as in the header `Allow`.
    pub fn method_not_allowed(method: &str, path: &str, allow: &str) -> Self {
        let spaced = allow.replace(',', ", ").replace(",  ", ", ");
        let problem = Self::plain(
            StatusCode::METHOD_NOT_ALLOWED,
            format!("{path} does not take {}; it takes {spaced}", shortened(method)),
        );
        match HeaderValue::from_str(&spaced) {
            Ok(value) => problem.header(header::ALLOW, value),
            Err(_) => problem,
        }
    }

    /// 406: the client accepts none of the formats or encodings.
    pub fn not_acceptable(detail: impl Into<String>) -> Self {
        Self::plain(StatusCode::NOT_ACCEPTABLE, detail)
    }

    /// 408: the client took too long to send its request.
    pub fn too_slow(detail: impl Into<String>) -> Self {
        Self::plain(StatusCode::REQUEST_TIMEOUT, detail).header(header::CONNECTION, HeaderValue::from_static("close"))
    }

    /// 413: the body is larger than the limit.
    pub fn too_large(limit_bytes: usize) -> Self {
        Self::plain(
            StatusCode::PAYLOAD_TOO_LARGE,
            format!("the request body is larger than the limit of {limit_bytes} bytes"),
        )
    }

    /// 414: path and query are longer than the limit. `bytes` is their length.
    pub fn url_too_long(bytes: impl Display) -> Self {
        let limit = limits::URL_BYTES;
        let detail =
            format!("the URL has {bytes} bytes of path and query; the limit is {limit}. POST the request instead");
        Self::plain(StatusCode::URI_TOO_LONG, detail)
    }

    /// 415: the body has another format or encoding than `accepted`.
    pub fn unsupported_media_type(accepted: &str, detail: impl Into<String>) -> Self {
        Self::plain(StatusCode::UNSUPPORTED_MEDIA_TYPE, detail)
            .header(header::ACCEPT, HeaderValue::try_from(accepted).expect("media types are text of headers"))
            .header(header::ACCEPT_ENCODING, HeaderValue::from_static("identity"))
    }

    /// 416: the answer has none of the bytes that are asked for. `length` is its length in bytes.
    pub fn range_not_satisfiable(length: usize) -> Self {
        let none = HeaderValue::try_from(format!("bytes */{length}")).expect("digits and signs");
        Self::plain(StatusCode::RANGE_NOT_SATISFIABLE, format!("the answer has {length} bytes, none of them in Range"))
            .header(header::CONTENT_RANGE, none)
    }

    /// 422: readable, but not a valid request. `errors` has all errors.
    pub fn invalid(errors: Vec<ProblemError>) -> Self {
        let detail = match errors.as_slice() {
            [] => "the request is not valid".to_owned(),
            [one] => one.detail.clone(),
            [first, rest @ ..] => format!("{}; and {} more", first.detail, rest.len()),
        };
        let mut problem =
            Self::plain(StatusCode::UNPROCESSABLE_ENTITY, detail).named("invalid-request", "The request is not valid");
        problem.0.errors = errors;
        problem
    }

    /// 422 with one error at one pointer.
    pub fn invalid_at(pointer: impl Into<String>, detail: impl Into<String>) -> Self {
        Self::invalid(vec![ProblemError { pointer: pointer.into(), detail: detail.into() }])
    }

    /// 500: a fault of the server. The client can do nothing about it.
    pub fn internal() -> Self {
        Self::plain(
            StatusCode::INTERNAL_SERVER_ERROR,
            "the server failed on this request, which is a defect in it; its log has the cause",
        )
    }

    /// 503: the server is overloaded.
    pub fn overloaded(detail: impl Into<String>) -> Self {
        Self::plain(StatusCode::SERVICE_UNAVAILABLE, detail)
            .named("overloaded", "The server is busy")
            .header(header::RETRY_AFTER, HeaderValue::from(limits::RETRY_AFTER_S))
    }

    /// Any other status, for errors that libraries answer with.
    pub fn other(status: StatusCode, detail: impl Into<String>) -> Self {
        Self::plain(status, detail)
    }

    /// Status of the answer.
    pub fn status(&self) -> StatusCode {
        self.0.status
    }

    /// The kind of problem, in a few words.
    pub fn title(&self) -> &'static str {
        self.0.title
    }

    /// The error in a sentence.
    pub fn detail(&self) -> &str {
        &self.0.detail
    }

    /// The errors of the fields.
    pub fn errors(&self) -> &[ProblemError] {
        &self.0.errors
    }

    /// The errors of the fields, consuming the problem.
    pub fn into_errors(self) -> Vec<ProblemError> {
        self.0.errors
    }

    /// The problem as JSON, as in the body of an answer.
    pub fn to_json(&self) -> Vec<u8> {
        serde_json::to_vec(self).expect("a problem is text and numbers under text keys")
    }
}

impl Serialize for Problem {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let parts = &*self.0;
        let context = RequestContext::current();
        let base = context.as_ref().map_or("", |context| &context.base);
        let body = Body {
            r#type: parts.slug.map_or("about:blank".into(), |slug| format!("{base}/docs#problem-{slug}").into()),
            title: parts.title,
            status: parts.status.as_u16().into(),
            detail: &parts.detail,
            errors: (!parts.errors.is_empty()).then_some(&parts.errors),
            request_id: context.as_ref().map(RequestContext::id),
        };
        body.serialize(serializer)
    }
}

/// RFC 9457.
#[derive(Serialize, JsonSchema)]
#[schemars(rename = "Problem")]
struct Body<'a> {
    /// `about:blank`, or the address of an explanation of this kind of problem.
    r#type: Cow<'a, str>,
    title: &'a str,
    status: u64,
    detail: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    errors: Option<&'a [ProblemError]>,
    /// The `x-request-id` of the answer; the server's log has it too.
    #[serde(skip_serializing_if = "Option::is_none")]
    request_id: Option<&'a str>,
}

impl JsonSchema for Problem {
    fn schema_name() -> Cow<'static, str> {
        Body::schema_name()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Body::json_schema(generator)
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let mut response = (self.0.status, self.to_json()).into_response();
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, MEDIA_TYPE);
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
        for (name, value) in self.0.headers {
            headers.insert(name, value);
        }
        response
    }
}

/// The media type of a problem.
pub const MEDIA_TYPE: HeaderValue = HeaderValue::from_static("application/problem+json");

impl From<OverBudget> for Problem {
    fn from(over: OverBudget) -> Self {
        let mut problem = Self::invalid_at("", over.to_string());
        problem = problem.named("over-budget", "The request costs too much");
        problem
    }
}

impl From<Overloaded> for Problem {
    fn from(overloaded: Overloaded) -> Self {
        Self::overloaded(overloaded.to_string())
    }
}

/// Work is cancelled only when its client has gone, so nobody reads this.
impl From<Cancelled> for Problem {
    fn from(cancelled: Cancelled) -> Self {
        Problem::overloaded(cancelled.to_string())
    }
}

/// Cuts a client's own text to a length that keeps an error readable.
pub fn shortened(text: &str) -> String {
    const CHARACTERS: usize = 60;
    match text.char_indices().nth(CHARACTERS) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_says_everything_once() {
        let problem = Problem::invalid(vec![
            ProblemError { pointer: "/a".into(), detail: "a is wrong".into() },
            ProblemError { pointer: "/b".into(), detail: "b is wrong".into() },
        ]);
        let json: serde_json::Value = serde_json::from_slice(&problem.to_json()).unwrap();
        assert_eq!(json["type"], "/docs#problem-invalid-request");
        assert_eq!(json["status"], 422);
        assert_eq!(json["detail"], "a is wrong; and 1 more");
        assert_eq!(json["errors"][1]["pointer"], "/b");
    }

    #[test]
    fn a_405_names_the_methods_there_are() {
        let response = Problem::method_not_allowed("PUT", "/v1/scenes", "GET,HEAD").into_response();
        assert_eq!(response.status(), 405);
        assert_eq!(response.headers()[header::ALLOW], "GET, HEAD");
        assert_eq!(response.headers()[header::CONTENT_TYPE], "application/problem+json");
    }

    #[test]
    fn long_text_is_cut_between_characters() {
        assert_eq!(shortened("short"), "short");
        assert_eq!(shortened(&"é".repeat(100)), format!("{}…", "é".repeat(60)));
    }
}
