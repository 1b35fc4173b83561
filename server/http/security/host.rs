//! Names under which this server is asked (`Host`, RFC 9110, section 7.2), and which of them it answers to.
//!
//! A page of another site can let its own name lead to this machine once it is loaded (DNS rebinding). To the browser the answers are
//! then the page's own, and neither CORS nor `Origin` keeps it from them; only `Host` still has its name. No such page can have the
//! name `localhost` or an address for a name.

use std::fmt::{self, Display, Formatter};
use std::net::{Ipv4Addr, Ipv6Addr};
use std::str::FromStr;

use axum::http::uri::Authority;
use axum::http::{HeaderMap, StatusCode, Uri, Version, header};

use crate::http::problem::{Problem, shortened};

/// Name of this server, in lower case and without a final dot.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HostName(String);

impl FromStr for HostName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let name = plain(text);
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

fn plain(name: &str) -> String {
    name.strip_suffix('.').unwrap_or(name).to_ascii_lowercase()
}

/// Refuses a request that does not say under which name it asks, or says several: 400 (RFC 9112, section 3.2). HTTP/1.0 need not
/// say it.
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

/// The name in `name:port`; none if it is not of this form. Of what a URL allows in a name, commas and other punctuation are in none
/// that can be looked up; a comma stands between two of them.
fn name_of(host: &str) -> Option<String> {
    let authority: Authority = host.parse().ok()?;
    let name = authority.host();
    let port = host.strip_prefix(name)?;
    let is_port =
        port.is_empty() || port.strip_prefix(':').is_some_and(|port| port.bytes().all(|byte| byte.is_ascii_digit()));
    let is_name = |byte: u8| byte.is_ascii_alphanumeric() || b"-._".contains(&byte);
    let is_fine = name.starts_with('[') || !name.is_empty() && name.bytes().all(is_name);
    (is_fine && is_port).then(|| plain(name))
}

/// Refuses a request to a name that leads to this machine without being its name: 421 (RFC 9110, section 15.5.20), since the
/// server does not answer for that name whoever asks, which 403 would not say. Names of the machine itself, addresses, and what is
/// `allowed` are answered to.
///
/// The headers have passed [`check_form`].
pub fn check_name(uri: &Uri, headers: &HeaderMap, allowed: &[HostName]) -> Result<(), Problem> {
    let said = headers.get(header::HOST).and_then(|host| name_of(host.to_str().ok()?));
    let targeted = uri.host().map(plain);
    let is_fine = |name: &String| is_local(name) || allowed.iter().any(|allowed| allowed.0 == *name);
    let Some(name) = said.into_iter().chain(targeted).find(|name| !is_fine(name)) else { return Ok(()) };
    let name = shortened(&name);
    let detail = format!(
        "this server is not asked as {name:?}: without a token, and to its own machine alone, it answers to localhost, to addresses, \
         and to names that it was started with (--allow-host NAME)"
    );
    Err(Problem::other(StatusCode::MISDIRECTED_REQUEST, detail))
}

/// A name that no page of another site can have: of this machine (RFC 6761), or an address.
fn is_local(name: &str) -> bool {
    let in_brackets = name.strip_prefix('[').and_then(|rest| rest.strip_suffix(']'));
    // A zone may follow, as in [fe80::1%25eth0].
    let is_v6 = in_brackets.is_some_and(|text| text.split('%').next().unwrap_or_default().parse::<Ipv6Addr>().is_ok());
    name == "localhost" || name.ends_with(".localhost") || name.parse::<Ipv4Addr>().is_ok() || is_v6
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::HeaderValue;

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
        // As a target says it to a proxy.
        assert!(check("http://evil.example/", "localhost").is_err());
        assert!(check_name(&"/".parse().unwrap(), &HeaderMap::new(), &[]).is_ok());
    }

    #[test]
    fn a_name_has_no_scheme_and_no_port() {
        for text in ["", ".", "a..b", "a b", "a:80", "http://a", "*", "*.a", "[::1]", "ä"] {
            assert!(text.parse::<HostName>().is_err(), "{text}");
        }
        assert_eq!("Rig.Lab.".parse::<HostName>().unwrap().to_string(), "rig.lab");
    }
}
