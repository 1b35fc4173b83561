//! Origins of pages (RFC 6454), which of them may open live runs, and requests that pages of other sites make.

use std::fmt;
use std::fmt::{Display, Formatter};
use std::str::FromStr;

use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};

use crate::http::problem::{Problem, shortened};
use crate::http::security::origin;

/// Scheme, host and port of a page, as browsers write them. As a setting the port may be `*`, for every port.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// Scheme and host, with the port unless it is any.
    text: String,
    is_any_port: bool,
}

impl Origin {
    /// Tells whether the setting names the origin of a request.
    pub fn is(&self, origin: &HeaderValue) -> bool {
        let Some(rest) = origin.to_str().ok().and_then(|origin| origin.strip_prefix(self.text.as_str())) else {
            return false;
        };
        let is_port = |port: &str| (1..=5).contains(&port.len()) && port.bytes().all(|byte| byte.is_ascii_digit());
        // Browsers leave out the usual port of a scheme.
        rest.is_empty() || self.is_any_port && rest.strip_prefix(':').is_some_and(is_port)
    }
}

impl FromStr for Origin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.to_ascii_lowercase();
        let (text, is_any_port) = match lower.strip_suffix(":*") {
            Some(host) => (host, true),
            None => (lower.as_str(), false),
        };
        if text.contains('*') {
            let why = "`*` may stand only for the whole port, as in http://localhost:*; give each scheme and host by its name";
            return Err(why.to_owned());
        }
        let is_fine = text.split_once("://").is_some_and(|(scheme, authority)| {
            let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b"-._:[]".contains(&byte);
            let host = authority.rsplit_once(']').map_or(authority, |(_, after)| after);
            scheme.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte))
                && !scheme.is_empty()
                && !authority.is_empty()
                && authority.bytes().all(is_name)
                && !(is_any_port && host.contains(':'))
        });
        if !is_fine {
            let why = "it must be scheme, host and port of a page as browsers send them, as in https://lab.example, or * for \
                       every port, as in http://localhost:*";
            return Err(why.to_owned());
        }
        Ok(Self { text: text.to_owned(), is_any_port })
    }
}

impl Display for Origin {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        let port = if self.is_any_port { ":*" } else { "" };
        write!(formatter, "{}{port}", self.text)
    }
}

/// Refuses a page of another host that is not `allowed`: it must not open a run for its visitor, and CORS does not prevent that.
/// Programs send no origin.
pub fn check(headers: &HeaderMap, allowed: &[Origin]) -> Result<(), Problem> {
    let Some(origin) = headers.get(header::ORIGIN) else { return Ok(()) };
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
    let is_own = origin.to_str().ok().zip(host).is_some_and(|(origin, host)| is_same_host(origin, host));
    if is_own || is_among(headers, allowed) {
        return Ok(());
    }
    let shown = shortened(&String::from_utf8_lossy(origin.as_bytes()));
    let detail = format!(
        "the origin {shown} is not this server's host; open the page from it, send no Origin, or start the server with \
         --allow-origin"
    );
    Err(Problem::other(StatusCode::FORBIDDEN, detail))
}

/// Tells whether a request comes from a page of one of these origins.
pub fn is_among(headers: &HeaderMap, allowed: &[Origin]) -> bool {
    headers.get(header::ORIGIN).is_some_and(|origin| allowed.iter().any(|allowed| allowed.is(origin)))
}

fn is_same_host(origin: &str, host: &str) -> bool {
    let Some((scheme, authority)) = origin.split_once("://") else { return false };
    let port = if scheme == "https" { ":443" } else { ":80" };
    let bare = |text: &str| text.strip_suffix(port).unwrap_or(text).to_ascii_lowercase();
    bare(authority) == bare(host)
}

// Requests that pages of other sites make through their visitors' browsers (Fetch Metadata, W3C).
//
// A page of any site can put an address of this server into an `<img>`, a script or a form, and the browser of every visitor sends
// the request. The page cannot read the answer, but the work is done on the visitor's machine. A browser marks such requests with
// `Sec-Fetch-Site: cross-site`. Programs, and browsers on plain HTTP to another machine, do not send the header, and are not
// refused without it.

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
pub fn check_site(
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
    use axum::http::{HeaderName, HeaderValue};

    use super::*;

    #[test]
    fn an_origin_is_of_the_same_host_and_port() {
        assert!(is_same_host("http://localhost:8080", "localhost:8080"));
        assert!(is_same_host("https://Example.org", "example.org:443"));
        assert!(is_same_host("http://[::1]", "[::1]"));
        for (origin, host) in [
            ("http://localhost:8081", "localhost:8080"),
            ("http://localhost.evil.org", "localhost"),
            ("null", "localhost"),
            ("https://example.org:80", "example.org"),
        ] {
            assert!(!is_same_host(origin, host), "{origin} {host}");
        }
    }

    #[test]
    fn others_are_allowed_by_name() {
        let allowed = ["https://Lab.example".parse().unwrap(), "http://10.0.0.2:3000".parse().unwrap()];
        let of = |origin: &'static str| {
            [(header::ORIGIN, HeaderValue::from_static(origin)), (header::HOST, HeaderValue::from_static("rig"))]
        };
        let check = |origin| check(&of(origin).into_iter().collect(), &allowed);
        assert!(check("https://lab.example").is_ok() && check("http://10.0.0.2:3000").is_ok());
        assert!(check("http://rig").is_ok());
        for other in ["http://lab.example", "https://lab.example.org", "http://10.0.0.2", "null"] {
            assert_eq!(check(other).unwrap_err().status(), 403, "{other}");
        }
        for text in [
            "null",
            "http://:*",
            "http://a:80:*",
            "lab.example",
            "https://lab.example/",
            "https://a, https://b",
            "://x",
        ] {
            assert!(text.parse::<Origin>().is_err(), "{text}");
        }
    }

    #[test]
    fn every_port_of_a_host_is_allowed_by_a_star() {
        for host in ["http://localhost", "https://Lab.example", "http://[::1]"] {
            let allowed: Origin = format!("{host}:*").parse().unwrap();
            let host = host.to_lowercase();
            assert_eq!(allowed.to_string(), format!("{host}:*"));
            let is = |origin: &str| allowed.is(&HeaderValue::from_str(origin).unwrap());
            assert!(is(&host) && is(&format!("{host}:8888")) && is(&format!("{host}:65535")));
            for other in [":", ":*", ":88888888", ":80a", ":80.evil.example", ".evil.example", "0:80", ":80:80", ":1@a"]
            {
                assert!(!is(&format!("{host}{other}")), "{host}{other}");
            }
            assert!(!is(&host.replace("://", "s://")) && !is("null"));
        }
        for text in
            ["*", "*:*", "http://*", "http://*:80", "https://*.lab.example", "http://localhost:80*", "http://a:*/"]
        {
            assert!(text.parse::<Origin>().unwrap_err().contains("only for the whole port"), "{text}");
        }
    }

    const PICTURE: &str = "/v1/stability";

    fn check_of(method: Method, path: &str, embedding: bool, said: &[(&'static str, &'static str)]) -> bool {
        let headers =
            said.iter().map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value))).collect();
        let allowed = ["https://lab.example".parse().unwrap()];
        check_site(&method, path, &headers, &allowed, embedding).is_ok()
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
