//! Origins of pages (RFC 6454), and which of them may open live runs.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};

use crate::http::problem::{Problem, shortened};

/// Scheme, host and port of a page, as browsers write them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin(HeaderValue);

impl Origin {
    /// The origin as the value of a header.
    pub fn header(&self) -> HeaderValue {
        self.0.clone()
    }
}

impl FromStr for Origin {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lower = text.to_ascii_lowercase();
        let is_fine = lower.split_once("://").is_some_and(|(scheme, authority)| {
            let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b"-._:[]".contains(&byte);
            scheme.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"+-.".contains(&byte))
                && !scheme.is_empty()
                && !authority.is_empty()
                && authority.bytes().all(is_name)
        });
        let value = HeaderValue::from_str(&lower).ok().filter(|_| is_fine);
        let why = "it must be scheme, host and port of a page as browsers send them, as in https://lab.example";
        value.map(Self).ok_or_else(|| why.to_owned())
    }
}

impl Display for Origin {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        formatter.write_str(self.0.to_str().unwrap_or_default())
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
    headers.get(header::ORIGIN).is_some_and(|origin| allowed.iter().any(|allowed| allowed.0 == origin))
}

fn is_same_host(origin: &str, host: &str) -> bool {
    let Some((scheme, authority)) = origin.split_once("://") else { return false };
    let port = if scheme == "https" { ":443" } else { ":80" };
    let bare = |text: &str| text.strip_suffix(port).unwrap_or(text).to_ascii_lowercase();
    bare(authority) == bare(host)
}

#[cfg(test)]
mod tests {
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
        for text in ["*", "null", "lab.example", "https://lab.example/", "https://a, https://b", "://x"] {
            assert!(text.parse::<Origin>().is_err(), "{text}");
        }
    }
}
