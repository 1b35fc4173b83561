//! Responses without the headers of a resource: a body with its description, or a status alone.

use axum::body::Body;
use axum::http::{HeaderValue, Response, StatusCode, header};

use crate::http::response::negotiate::Encoding;

/// `Cache-Control` of answers that may be kept and are revalidated at each use, which costs no work.
pub(crate) const REVALIDATED: HeaderValue = HeaderValue::from_static("public, max-age=0, must-revalidate");

/// 200 with a body and the headers that describe it.
pub(crate) fn ok(media_type: &'static str, encoding: Encoding, bytes: impl Into<Body>) -> Response<Body> {
    let mut response = Response::new(bytes.into());
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type));
    headers.insert(header::VARY, HeaderValue::from_static("Accept, Accept-Encoding"));
    if encoding == Encoding::Gzip {
        headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"));
    }
    response
}

/// A status without a body, with the same `Vary`.
pub(crate) fn status_only(status: StatusCode) -> Response<Body> {
    let mut response = Response::new(Body::empty());
    *response.status_mut() = status;
    response.headers_mut().insert(header::VARY, HeaderValue::from_static("Accept, Accept-Encoding"));
    response
}
