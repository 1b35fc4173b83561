//! The secret of a server on a shared network, and the places in a request that may carry it.
//!
//! Programs send `Authorization: Bearer`. A browser cannot add headers to a WebSocket, a picture or a frame, so it keeps a cookie;
//! a page of another origin has no cookie here, and offers the token as a subprotocol.
//!
//! The cookie is not the token but its HMAC. So the token stays secret even if someone reads the browser's files or runs a server
//! on another port of this host, to which the browser sends the cookie too. Replicas with one token have the same cookie.

use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

use axum::http::{HeaderMap, HeaderValue, header};
use hmac::{Hmac, Mac};
use sha2::Sha256;
use subtle::ConstantTimeEq;

use crate::limits;

/// Name of the cookie.
const COOKIE: &str = "equipoise_token";

/// Message whose HMAC is the cookie. Another message makes all cookies invalid.
const COOKIE_MESSAGE: &[u8] = b"equipoise cookie 1";

/// Prefix of a token that is offered as a subprotocol of a WebSocket.
const SUBPROTOCOL: &str = "equipoise.token.";

/// A secret of characters that need no escape in a URL, a header or a subprotocol.
#[derive(Clone, PartialEq, Eq)]
pub struct Token {
    secret: Arc<str>,
    /// Value of the cookie: HMAC-SHA-256 under the secret, in hexadecimal digits.
    derived: Arc<str>,
}

impl FromStr for Token {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let most = limits::TOKEN_CHARACTERS;
        let is_fine = most.contains(&text.len())
            && text.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-._~".contains(&byte));
        let (low, high) = (most.start(), most.end());
        let why = || format!("it must have {low} to {high} letters, digits or -._~, as `openssl rand -hex 16` gives");
        if is_fine { Ok(Self { secret: text.into(), derived: derived(text).into() }) } else { Err(why()) }
    }
}

fn derived(secret: &str) -> String {
    let mut mac = Hmac::<Sha256>::new_from_slice(secret.as_bytes()).expect("HMAC takes a key of any length");
    mac.update(COOKIE_MESSAGE);
    mac.finalize().into_bytes().iter().map(|byte| format!("{byte:02x}")).collect()
}

impl fmt::Debug for Token {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("Token(…)")
    }
}

impl Token {
    /// Compares the token in constant time.
    pub fn is(&self, offered: &str) -> bool {
        self.secret.as_bytes().ct_eq(offered.as_bytes()).into()
    }

    fn is_derived(&self, cookie: &str) -> bool {
        self.derived.as_bytes().ct_eq(cookie.as_bytes()).into()
    }

    /// Tells whether a request carries the token or its cookie.
    pub fn is_in(&self, headers: &HeaderMap) -> bool {
        let parts = |name, separator| {
            let values = headers.get_all(name).into_iter().filter_map(|value| value.to_str().ok());
            values.flat_map(move |value| value.split(separator)).map(str::trim)
        };
        let bearer = parts(header::AUTHORIZATION, ',').filter_map(|part| {
            let (scheme, token) = part.split_once(' ')?;
            scheme.eq_ignore_ascii_case("bearer").then(|| token.trim_start())
        });
        let mut cookie = parts(header::COOKIE, ';').filter_map(|part| part.strip_prefix(COOKIE)?.strip_prefix('='));
        let subprotocol = parts(header::SEC_WEBSOCKET_PROTOCOL, ',').filter_map(|part| part.strip_prefix(SUBPROTOCOL));
        bearer.chain(subprotocol).any(|offered| self.is(offered)) || cookie.any(|cookie| self.is_derived(cookie))
    }

    /// `Set-Cookie` for a browser: valid for the folder of the page, and out of reach of scripts and of requests that other sites
    /// make.
    pub fn cookie(&self) -> HeaderValue {
        let cookie = format!("{COOKIE}={}; HttpOnly; SameSite=Lax", self.derived);
        HeaderValue::from_str(&cookie).expect("digits are ASCII")
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
        // Python: hmac.new(b"0123456789abcdef", b"equipoise cookie 1", "sha256").hexdigest()
        assert!(carries(
            header::COOKIE,
            "a=b; equipoise_token=f5be863bbd70e3eb88f5e103042b7d4c5fe637fe1d7bb98053f72a296a19cd9d; c=d"
        ));
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
        for wrong in ["token=0123456789abcdef", "equipoise_token=0123456789abcdef", "equipoise_token="] {
            assert!(!carries(header::COOKIE, wrong), "{wrong}");
        }
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
        assert!(!token.cookie().to_str().unwrap().contains("0123456789abcdef"));
    }
}
