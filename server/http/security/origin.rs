//! Origins of pages (RFC 6454), and which of them may open live runs.

use std::fmt::{self, Display, Formatter};
use std::str::FromStr;

use axum::http::{HeaderMap, HeaderValue, StatusCode, header};

use crate::http::problem::{Problem, shortened};

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
}
