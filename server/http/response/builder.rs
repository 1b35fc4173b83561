//! Responses without the headers of a resource: a body with its description, or a status alone.

use std::ops::Range;

use axum::body::Body;
use axum::http::{HeaderMap, HeaderValue, Response, StatusCode, header};

use crate::http::response::etag::EntityTag;
use crate::http::response::negotiate::Encoding;
use crate::http::response::ranges::content_range;

/// `Cache-Control` of answers that may be kept and are revalidated at each use, which costs no work.
const REVALIDATED: HeaderValue = HeaderValue::from_static("public, max-age=0, must-revalidate");

const VARY: HeaderValue = HeaderValue::from_static("Accept, Accept-Encoding");

const GZIP: HeaderValue = HeaderValue::from_static("gzip");

/// Headers of most answers. A map that grows is made anew.
const HEADERS: usize = 12;

/// 200 with a body and the headers that describe it.
pub(crate) fn ok(media_type: &'static str, encoding: Encoding, bytes: impl Into<Body>) -> Response<Body> {
    let mut response = with_room(bytes.into());
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(media_type));
    headers.insert(header::VARY, VARY);
    if encoding == Encoding::Gzip {
        headers.insert(header::CONTENT_ENCODING, GZIP);
    }
    response
}

/// 206 with a part of a body that is not compressed.
pub(crate) fn part(
    media_type: &'static str,
    range: &Range<usize>,
    length: usize,
    bytes: impl Into<Body>,
) -> Response<Body> {
    let mut response = ok(media_type, Encoding::Identity, bytes);
    *response.status_mut() = StatusCode::PARTIAL_CONTENT;
    response.headers_mut().insert(header::CONTENT_RANGE, content_range(range, length));
    response
}

/// A status without a body, with the same `Vary`.
pub(crate) fn status_only(status: StatusCode) -> Response<Body> {
    let mut response = with_room(Body::empty());
    *response.status_mut() = status;
    response.headers_mut().insert(header::VARY, VARY);
    response
}

/// A response with its entity tag, to be revalidated.
pub(crate) fn with_tag(mut response: Response<Body>, tag: &EntityTag) -> Response<Body> {
    response.headers_mut().insert(header::ETAG, tag.header());
    response.headers_mut().insert(header::CACHE_CONTROL, REVALIDATED);
    response
}

/// 200 with a body and room for headers.
pub(crate) fn with_room(body: Body) -> Response<Body> {
    let mut response = Response::new(body);
    *response.headers_mut() = HeaderMap::with_capacity(HEADERS);
    response
}
