//! The `Host` of a request (RFC 9110, section 7.2), and the names that this server answers to.
//!
//! A page of another site can make its own name resolve to this machine once it is loaded (DNS rebinding). Then the browser takes
//! the answers for the page's own, and neither CORS nor `Origin` protects them; only `Host` still has the page's name. Such a page
//! can have neither the name `localhost` nor an address for its name.

use std::borrow::Cow;
use std::fmt::{self, Display, Formatter};
use std::net::{Ipv4Addr, Ipv6Addr};
use std::str::FromStr;

use axum::http::uri::Authority;
use axum::http::{Extensions, HeaderMap, StatusCode, Uri, Version, header};

use crate::http::problem::{Problem, shortened};

/// A name of this server, in lower case and without a final dot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HostName(String);

impl FromStr for HostName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let name = plain(text).into_owned();
        let is_label = |label: &str| {
            !label.is_empty() && label.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_".contains(&byte))
        };
        let is_fine = name.len() <= 253 && name.split('.').all(is_label);
        let why = "it must be a name without scheme and port, as in rig.lab.example";
        if is_fine { Ok(Self(name)) } else { Err(why.to_owned()) }
    }
}

impl Display for HostName {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

fn plain(name: &str) -> Cow<'_, str> {
    let name = name.strip_suffix('.').unwrap_or(name);
    let is_lower = !name.bytes().any(|byte| byte.is_ascii_uppercase());
    if is_lower { name.into() } else { name.to_ascii_lowercase().into() }
}

/// Refuses a request without `Host` or with several: 400 (RFC 9112, section 3.2). HTTP/1.0 needs none.
pub fn check_form(version: Version, headers: &HeaderMap) -> Result<(), Problem> {
    let refused = |detail: String| Err(Problem::not_readable(detail));
    let mut hosts = headers.get_all(header::HOST).iter();
    match (hosts.next(), hosts.next()) {
        (None, _) if version < Version::HTTP_11 => Ok(()),
        (None, _) => refused("the request has no Host, which HTTP/1.1 requires".to_owned()),
        (Some(_), Some(_)) => {
            refused(format!("the request has Host {} times; it must be there once", hosts.count() + 2))
        }
        (Some(host), None) => match host.to_str().ok().and_then(name_of) {
            Some(_) => Ok(()),
            None => {
                let host = shortened(&String::from_utf8_lossy(host.as_bytes()));
                refused(format!("the request has Host: {host:?}, which is no name or address with an optional port"))
            }
        },
    }
}

/// The name in `name:port`; None if it has another form. A URL allows commas and other punctuation in a name, but no name that
/// resolves has them.
fn name_of(host: &str) -> Option<Cow<'_, str>> {
    let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b"-._".contains(&byte);
    // Nearly all requests name a host without a port, or with one.
    let (name, port) = host.split_once(':').unwrap_or((host, ""));
    if !name.is_empty() && name.bytes().all(is_name) && port.bytes().all(|byte| byte.is_ascii_digit()) {
        return Some(plain(name));
    }
    let authority: Authority = host.parse().ok()?;
    let (name, port) = host.split_at_checked(authority.host().len())?;
    if name != authority.host() {
        return None;
    }
    let is_port =
        port.is_empty() || port.strip_prefix(':').is_some_and(|port| port.bytes().all(|byte| byte.is_ascii_digit()));
    let is_fine = name.starts_with('[') || !name.is_empty() && name.bytes().all(is_name);
    (is_fine && is_port).then(|| plain(name))
}

/// Marks a request of a trusted proxy.
#[derive(Debug, Clone, Copy)]
pub struct FromProxy;

/// Scheme, name and port by which clients reach this server, as in `https://lab.example:8443`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PublicOrigin(String);

impl PublicOrigin {
    /// The origin of a request: `Host` over HTTP, or what a trusted proxy says in `X-Forwarded-Host` and `X-Forwarded-Proto`. `None` if the
    /// request does not name a host.
    pub fn of(headers: &HeaderMap, extensions: &Extensions) -> Option<Self> {
        let from_proxy = extensions.get::<FromProxy>().is_some();
        // The last entry is the one that the proxy has added. Anyone can send the entries before it.
        let last = |name: &str| headers.get_all(name).into_iter().next_back()?.to_str().ok()?.rsplit(',').next();
        let forwarded = |name: &str| last(name).filter(|_| from_proxy).map(str::trim);
        let named = forwarded("x-forwarded-host").filter(|host| name_of(host).is_some());
        let host = named.or_else(|| headers.get(header::HOST)?.to_str().ok())?;
        name_of(host)?;
        let is_secure = forwarded("x-forwarded-proto").is_some_and(|scheme| scheme.eq_ignore_ascii_case("https"));
        Some(Self(format!("{}://{}", if is_secure { "https" } else { "http" }, host.to_ascii_lowercase())))
    }
}

impl Display for PublicOrigin {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

/// Refuses a request for a name that is not this server's: 421 (RFC 9110, section 15.5.20). Names of the machine itself, addresses
/// and `allowed` names are answered.
///
/// The headers have passed [`check_form`].
pub fn check_name(uri: &Uri, headers: &HeaderMap, allowed: &[HostName]) -> Result<(), Problem> {
    let said = headers.get(header::HOST).and_then(|host| name_of(host.to_str().ok()?));
    let targeted = uri.host().map(plain);
    let is_fine = |name: &str| is_local(name) || allowed.iter().any(|allowed| allowed.0 == name);
    let Some(name) = said.into_iter().chain(targeted).find(|name| !is_fine(name)) else { return Ok(()) };
    let name = shortened(&name);
    let detail = format!(
        "this server is not asked as {name:?}: without a token, and to its own machine alone, it answers to localhost, to addresses, \
         and to names that it was started with (--allow-host NAME)"
    );
    Err(Problem::other(StatusCode::MISDIRECTED_REQUEST, detail))
}

/// Tells whether the name is of this machine (RFC 6761) or an address. A page of another site cannot have it.
fn is_local(name: &str) -> bool {
    let in_brackets = name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    // A zone may follow, as in [fe80::1%25eth0].
    let is_v6 = in_brackets.is_some_and(|text| text.split('%').next().unwrap_or_default().parse::<Ipv6Addr>().is_ok());
    name == "localhost" || name.ends_with(".localhost") || name.parse::<Ipv4Addr>().is_ok() || is_v6
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::{HeaderName, HeaderValue};

    fn headers(hosts: &[&str]) -> HeaderMap {
        hosts.iter().map(|host| (header::HOST, HeaderValue::from_str(host).unwrap())).collect()
    }

    #[test]
    fn a_host_is_there_once_and_is_one() {
        for host in ["localhost", "localhost:80", "LAB.example.:8080", "[::1]", "[::1]:8080", "a_b-c", "x:"] {
            assert!(check_form(Version::HTTP_11, &headers(&[host])).is_ok(), "{host}");
        }
        for hosts in [
            &["a", "a"][..],
            &["a", "b", "c"],
            &[""],
            &["a b"],
            &["a,b"],
            &["u@a"],
            &["a/b"],
            &["http://a"],
            &["a:b"],
            &["a:1:2"],
            &[":80"],
            &["[::1"],
        ] {
            for version in [Version::HTTP_10, Version::HTTP_11] {
                assert_eq!(check_form(version, &headers(hosts)).unwrap_err().status(), 400, "{hosts:?}");
            }
        }
        assert_eq!(check_form(Version::HTTP_11, &headers(&[])).unwrap_err().status(), 400);
        assert!(check_form(Version::HTTP_10, &headers(&[])).is_ok());
    }

    #[test]
    fn names_of_the_machine_addresses_and_what_is_allowed_are_answered_to() {
        let allowed = ["Rig.lab.example.".parse().unwrap()];
        let check = |target: &str, host: &str| check_name(&target.parse().unwrap(), &headers(&[host]), &allowed);
        for host in [
            "localhost",
            "LOCALHOST:8080",
            "localhost.",
            "a.localhost:1",
            "127.0.0.1",
            "192.0.2.7:8080",
            "[::1]:8080",
            "[fe80::1%25eth0]:8080",
            "rig.lab.example:443",
        ] {
            assert!(check("/", host).is_ok(), "{host}");
        }
        for host in [
            "evil.example",
            "evil.example:8080",
            "localhost.evil.example",
            "127.0.0.1.evil.example",
            "notlocalhost",
            "rig",
            "lab.example",
            "x.rig.lab.example",
            "[localhost]",
            "0x7f.1",
        ] {
            let problem = check("/", host).err();
            assert!(
                problem.is_some_and(|problem| problem.status() == 421 && problem.detail().contains("--allow-host"))
            );
        }
        // In absolute form, as clients send it to a proxy.
        assert!(check("http://evil.example/", "localhost").is_err());
        assert!(check_name(&"/".parse().unwrap(), &HeaderMap::new(), &[]).is_ok());
    }

    #[test]
    fn the_public_origin_is_that_of_the_host_or_of_a_trusted_proxy() {
        let origin = |from_proxy: bool, pairs: &[(&'static str, &str)]| {
            let headers = pairs
                .iter()
                .map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_str(value).unwrap()));
            let mut extensions = Extensions::new();
            if from_proxy {
                extensions.insert(FromProxy);
            }
            PublicOrigin::of(&headers.collect(), &extensions).map(|origin| origin.to_string())
        };
        let forwarded =
            [("host", "inner:8080"), ("x-forwarded-host", "a, Lab.example"), ("x-forwarded-proto", "http,HTTPS")];
        assert_eq!(origin(false, &forwarded).as_deref(), Some("http://inner:8080"));
        assert_eq!(origin(true, &forwarded).as_deref(), Some("https://lab.example"));
        assert_eq!(
            origin(true, &[("host", "[::1]:80"), ("x-forwarded-proto", "gopher")]).as_deref(),
            Some("http://[::1]:80")
        );
        assert_eq!(origin(true, &[("host", "lab"), ("x-forwarded-host", "\"><b")]).as_deref(), Some("http://lab"));
        for host in ["\"><script>", "a b", "u@a", "a/b", "http://a", ""] {
            assert_eq!(origin(false, &[("host", host)]), None, "{host}");
        }
        assert_eq!(origin(true, &[]), None);
    }

    #[test]
    fn a_name_has_no_scheme_and_no_port() {
        for text in ["", ".", "a..b", "a b", "a:80", "http://a", "*", "*.a", "[::1]", "ä"] {
            assert!(text.parse::<HostName>().is_err(), "{text}");
        }
        assert_eq!("Rig.Lab.".parse::<HostName>().unwrap().to_string(), "rig.lab");
    }
}
