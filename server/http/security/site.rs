//! Requests that pages of other sites make through their visitors' browsers (Fetch Metadata, W3C).
//!
//! A page of any site can put an address of this server into an `<img>`, a script or a form, and the browser of every visitor sends
//! the request. The page cannot read the answer, but the work is done on the visitor's machine. A browser marks such requests with
//! `Sec-Fetch-Site: cross-site`. Programs, and browsers on plain HTTP to another machine, do not send the header, and are not
//! refused without it.

use axum::http::{HeaderMap, Method, StatusCode};

use crate::http::problem::Problem;
use crate::http::security::origin;
use crate::http::security::origin::Origin;

/// Tables that are the same for everyone and cost nothing.
const TABLES: [&str; 2] = ["/v1/scenes", "/v1/fields"];

/// Refuses work for a page of another site: 403.
///
/// Exceptions:
/// - an `allowed` origin;
/// - a preflight, which CORS answers;
/// - a visit: a link that someone follows, in a window of its own. It is a single request that the visitor sees, and addresses of
///   this server are made to be shared. A prefetched page is no visit;
/// - with `embedding`: pictures (`<img>`), and frames of `/embed/`. Requests of such a frame have the same origin as the server, so
///   refusing them means refusing the frame.
pub fn check(
    method: &Method,
    path: &str,
    headers: &HeaderMap,
    allowed: &[Origin],
    embedding: bool,
) -> Result<(), Problem> {
    let says = |name, value| says(headers, name, value);
    let is_table = TABLES
        .iter()
        .any(|table| path.strip_prefix(table).is_some_and(|rest| rest.is_empty() || rest.starts_with('/')));
    let is_frame = path.starts_with("/embed/") && FRAMES.iter().any(|frame| says(DESTINATION, frame));
    let costs = path.starts_with("/v1/") && !is_table || is_frame;
    if !costs || *method == Method::OPTIONS || !is_foreign(headers, allowed) {
        return Ok(());
    }
    let reads = *method == Method::GET || *method == Method::HEAD;
    let is_early = headers.contains_key("sec-purpose") || headers.contains_key("purpose");
    let is_visit = says("sec-fetch-mode", "navigate") && says(DESTINATION, "document") && !is_early;
    let is_embedded = embedding && (is_frame || says(DESTINATION, "image"));
    if reads && (is_visit || is_embedded) {
        return Ok(());
    }
    let detail = if reads && (is_frame || says(DESTINATION, "image")) {
        "a page of another site may show pictures and panels of this server only if it was started with --allow-embedding"
    } else {
        "a page of another site may not set this server to work; start it with --allow-origin ORIGIN to let pages of that origin ask"
    };
    Err(Problem::other(StatusCode::FORBIDDEN, detail))
}

/// True for a request that a page of another site makes, unless that site is `allowed`.
pub fn is_foreign(headers: &HeaderMap, allowed: &[Origin]) -> bool {
    is_cross_site(headers) && !origin::is_among(headers, allowed)
}

/// True for a page in a frame of another site, as far as the browser tells.
pub(crate) fn is_foreign_frame(headers: &HeaderMap) -> bool {
    is_cross_site(headers) && FRAMES.iter().any(|frame| says(headers, DESTINATION, frame))
}

fn is_cross_site(headers: &HeaderMap) -> bool {
    says(headers, "sec-fetch-site", "cross-site")
}

fn says(headers: &HeaderMap, name: &str, value: &str) -> bool {
    headers.get(name).is_some_and(|own| own.as_bytes() == value.as_bytes())
}

const DESTINATION: &str = "sec-fetch-dest";

/// Destinations of a page within another page.
const FRAMES: [&str; 5] = ["iframe", "frame", "object", "embed", "fencedframe"];

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::{HeaderName, HeaderValue};

    const PICTURE: &str = "/v1/stability";

    fn check_of(method: Method, path: &str, embedding: bool, said: &[(&'static str, &'static str)]) -> bool {
        let headers =
            said.iter().map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value))).collect();
        let allowed = ["https://lab.example".parse().unwrap()];
        check(&method, path, &headers, &allowed, embedding).is_ok()
    }

    const CROSS: (&str, &str) = ("sec-fetch-site", "cross-site");

    #[test]
    fn work_for_another_site_is_refused_and_nothing_else() {
        let get = |path, said: &[(&'static str, &'static str)]| check_of(Method::GET, path, false, said);
        for path in [PICTURE, "/v1/live", "/v1/live/events", "/v1/batches/stability", "/v1/failures", "/v1/scenesque"] {
            assert!(!get(path, &[CROSS]), "{path}");
            assert!(!check_of(Method::POST, path, true, &[CROSS]), "{path}");
            assert!(check_of(Method::OPTIONS, path, false, &[CROSS]), "{path}");
            for site in ["same-origin", "same-site", "none"] {
                assert!(get(path, &[("sec-fetch-site", site)]), "{path} {site}");
            }
            assert!(get(path, &[]), "{path}");
        }
        for path in
            ["/", "/docs", "/style.css", "/v1/scenes", "/v1/scenes/case-1", "/v1/fields", "/embed/map", "/metrics"]
        {
            assert!(get(path, &[CROSS]), "{path}");
        }
    }

    #[test]
    fn an_allowed_origin_may_ask() {
        let origin = |origin| check_of(Method::POST, PICTURE, false, &[CROSS, ("origin", origin)]);
        assert!(origin("https://lab.example"));
        assert!(!origin("https://else.example") && !origin("null"));
    }

    #[test]
    fn a_visit_is_answered_and_a_fetch_before_it_is_not() {
        let visit = [CROSS, ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "document")];
        assert!(check_of(Method::GET, PICTURE, false, &visit));
        assert!(!check_of(Method::POST, PICTURE, false, &visit), "a form of another site");
        let early = [visit.as_slice(), &[("sec-purpose", "prefetch;prerender")]].concat();
        assert!(!check_of(Method::GET, PICTURE, false, &early));
        let frame = [CROSS, ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "iframe")];
        assert!(!check_of(Method::GET, PICTURE, true, &frame), "only panels are framed");
    }

    #[test]
    fn pictures_and_panels_are_shown_elsewhere_if_that_is_allowed() {
        let picture = [CROSS, ("sec-fetch-mode", "no-cors"), ("sec-fetch-dest", "image")];
        let frame = [CROSS, ("sec-fetch-mode", "navigate"), ("sec-fetch-dest", "iframe")];
        for embedding in [false, true] {
            assert_eq!(check_of(Method::GET, PICTURE, embedding, &picture), embedding);
            assert_eq!(check_of(Method::GET, "/embed/map", embedding, &frame), embedding);
            assert!(!check_of(Method::GET, PICTURE, embedding, &[CROSS, ("sec-fetch-dest", "script")]));
        }
    }
}
