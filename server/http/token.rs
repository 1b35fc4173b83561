//! The one secret of a server on a shared network, and where a request may carry it.
//!
//! Programs send `Authorization: Bearer`. A browser sends no header of a page's choosing with a WebSocket, a picture or a frame,
//! so it keeps a cookie; and a page of another origin, which has no cookie here, offers the token as a subprotocol.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use axum::http::{HeaderMap, HeaderValue, header};
use subtle::ConstantTimeEq;

use crate::limits;

/// The name of the cookie.
const COOKIE: &str = "equipoise_token";

/// What stands before the token where it is offered as a subprotocol of a WebSocket.
const SUBPROTOCOL: &str = "equipoise.token.";

/// A secret that is whole wherever it has to stand: in a URL, a cookie, a subprotocol.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(Arc<str>);

impl FromStr for Token {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let most = limits::TOKEN_CHARACTERS;
        let is_fine = most.contains(&text.len())
            && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte));
        let (low, high) = (most.start(), most.end());
        let why = || format!("it must have {low} to {high} letters, digits or -._~, as `openssl rand -hex 16` gives");
        if is_fine { Ok(Self(text.into())) } else { Err(why()) }
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("Token(…)")
    }
}

impl Token {
    /// Whether this is it. How long that takes says nothing about how much of it was right.
    pub fn is(&self, offered: &str) -> bool {
        self.0.as_bytes().ct_eq(offered.as_bytes()).into()
    }

    /// Whether a request carries it.
    pub fn is_in(&self, headers: &HeaderMap) -> bool {
        let parts = |name, separator| {
            let values = headers.get_all(name).into_iter().filter_map(|value| value.to_str().ok());
            values.flat_map(move |value| value.split(separator)).map(str::trim)
        };
        let bearer = parts(header::AUTHORIZATION, ',').filter_map(|part| {
            let (scheme, token) = part.split_once(' ')?;
            scheme.eq_ignore_ascii_case("bearer").then(|| token.trim_start())
        });
        let cookie = parts(header::COOKIE, ';').filter_map(|part| part.strip_prefix(COOKIE)?.strip_prefix('='));
        let subprotocol = parts(header::SEC_WEBSOCKET_PROTOCOL, ',').filter_map(|part| part.strip_prefix(SUBPROTOCOL));
        bearer.chain(cookie).chain(subprotocol).any(|offered| self.is(offered))
    }

    /// What makes a browser keep it, for the folder of the page that it opened, out of reach of scripts and of requests
    /// that pages of other sites make.
    pub fn cookie(&self) -> HeaderValue {
        let cookie = format!("{COOKIE}={}; HttpOnly; SameSite=Lax", self.0);
        HeaderValue::from_str(&cookie).expect("a token is ASCII")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_found_wherever_it_may_stand_and_nowhere_else() {
        let token: Token = "0123456789abcdef".parse().unwrap();
        let carries = |name: header::HeaderName, value: &'static str| {
            token.is_in(&[(name, HeaderValue::from_static(value))].into_iter().collect())
        };
        assert!(carries(header::AUTHORIZATION, "Bearer 0123456789abcdef"));
        assert!(carries(header::AUTHORIZATION, "bearer  0123456789abcdef"));
        assert!(carries(header::COOKIE, "a=b; equipoise_token=0123456789abcdef; c=d"));
        assert!(carries(header::SEC_WEBSOCKET_PROTOCOL, "equipoise.v1, equipoise.token.0123456789abcdef"));
        for wrong in [
            "0123456789abcdef",
            "Bearer 0123456789abcde",
            "Bearer 0123456789abcdef0",
            "Basic 0123456789abcdef",
            "Bearer",
        ] {
            assert!(!carries(header::AUTHORIZATION, wrong), "{wrong}");
        }
        assert!(!carries(header::COOKIE, "token=0123456789abcdef"));
        assert!(!token.is_in(&HeaderMap::new()));
        let cookie = token.cookie();
        let (kept, _) = cookie.to_str().unwrap().split_once(';').unwrap();
        assert!(token.is_in(&[(header::COOKIE, HeaderValue::from_str(kept).unwrap())].into_iter().collect()));
    }

    #[test]
    fn it_can_be_guessed_by_nobody_and_is_never_shown() {
        for text in ["", "short", "0123456789 bcdef", "0123456789abcde;", "0123456789abcde\u{e9}"] {
            assert!(text.parse::<Token>().is_err(), "{text}");
        }
        let token: Token = "0123456789abcdef".parse().unwrap();
        assert!(!format!("{token:?}").contains("0123"));
    }
}
