//! The body of a request: its media type, its size, and the time it takes to arrive.

use axum::body::{Body, Bytes, to_bytes};
use axum::http::{HeaderMap, header};
use http_body_util::LengthLimitError;
use tokio::time::timeout;

use crate::http::problem::{Problem, shortened};
use crate::limits::Limits;

/// A media type that is read.
pub(crate) struct MediaType {
    name: &'static str,
    is: fn(&str) -> bool,
}

/// One request.
pub(crate) const JSON: MediaType = MediaType {
    name: "application/json",
    is: |essence| essence == "application/json" || (essence.starts_with("application/") && essence.ends_with("+json")),
};

/// Many requests, one on each line.
pub(crate) const NDJSON: MediaType = MediaType {
    name: "application/x-ndjson",
    is: |essence| matches!(essence, "application/x-ndjson" | "application/ndjson" | "application/jsonl"),
};

/// The fields of a form of a page.
pub(crate) const FORM: MediaType = MediaType {
    name: "application/x-www-form-urlencoded",
    is: |essence| essence == "application/x-www-form-urlencoded",
};

/// A table in the form of RFC 4180.
pub(crate) const CSV: MediaType = MediaType { name: "text/csv", is: |essence| essence == "text/csv" };

/// A table as a stream of Arrow.
pub(crate) const ARROW: MediaType = MediaType {
    name: "application/vnd.apache.arrow.stream",
    is: |essence| essence == "application/vnd.apache.arrow.stream",
};

impl MediaType {
    /// True if both are the same.
    pub(super) fn is(&self, other: &Self) -> bool {
        self.name == other.name
    }

    /// Refuses a body of another type, not in UTF-8, or compressed: 415.
    pub(crate) fn check(&self, headers: &HeaderMap) -> Result<(), Problem> {
        Self::among(&[self], headers).map(|_| ())
    }

    /// The one of these types that a body has. Refuses another one, a body not in UTF-8, and a compressed one: 415.
    pub(super) fn among<'t>(types: &[&'t Self], headers: &HeaderMap) -> Result<&'t Self, Problem> {
        let names = types.iter().map(|one| one.name).collect::<Vec<_>>().join(", ");
        let refused = |detail: String| Err(Problem::unsupported_media_type(&names, detail));
        let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or("not text"));
        let Some(media_type) = text(header::CONTENT_TYPE) else {
            return refused(format!("the request has no Content-Type; send it as Content-Type: {names}"));
        };
        let mut parameters = media_type.split(';').map(str::trim);
        let essence = parameters.next().unwrap_or_default().to_ascii_lowercase();
        let Some(found) = types.iter().find(|one| (one.is)(&essence)) else {
            let shown = shortened(media_type);
            return refused(format!("the request has Content-Type: {shown}; send it as Content-Type: {names}"));
        };
        let charset =
            parameters.find_map(|parameter| parameter.to_ascii_lowercase().strip_prefix("charset=").map(str::to_owned));
        let is_read = |charset: &String| matches!(charset.trim_matches('"'), "utf-8" | "utf8" | "us-ascii");
        if let Some(charset) = charset.filter(|charset| !is_read(charset)) {
            return refused(format!("the request is in {}; bodies are read as UTF-8", shortened(&charset)));
        }
        match text(header::CONTENT_ENCODING) {
            Some(coding) if !coding.trim().eq_ignore_ascii_case("identity") => refused(format!(
                "the request has Content-Encoding: {}; bodies are read uncompressed",
                shortened(coding)
            )),
            _ => Ok(*found),
        }
    }
}

/// Reads a body within the limits of size and time.
pub(crate) async fn read(body: Body, headers: &HeaderMap, limits: &Limits) -> Result<Bytes, Problem> {
    let announced = headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if announced.is_some_and(|length| length > limits.body_bytes as u64) {
        return Err(Problem::too_large(limits.body_bytes));
    }
    let reading = timeout(limits.body_time, to_bytes(body, limits.body_bytes)).await;
    let Ok(read) = reading else {
        let limit_s = limits.body_time.as_secs();
        return Err(Problem::too_slow(format!("the request body took longer than the limit of {limit_s} s to arrive")));
    };
    read.map_err(|error| {
        use std::error::Error;
        match error.source().is_some_and(|source| source.is::<LengthLimitError>()) {
            true => Problem::too_large(limits.body_bytes),
            false => Problem::not_readable("the connection ended, or broke the protocol, within the request body"),
        }
    })
}
