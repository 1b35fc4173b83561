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

use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Redirect, Response};
use hmac::{Hmac, Mac};
use sha2::Sha256;
use subtle::ConstantTimeEq;

use crate::http::Problem;
use crate::http::request::tree;
use crate::http::request::tree::FORM;
use crate::http::security::origin;
use crate::limits;
use crate::limits::Limits;

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

// Asks for the token: a problem for programs, a page with a field for people. A browser that brings the token gets the cookie.

/// Field of the form, and parameter of the page's address, with the token.
pub(crate) const TOKEN_PARAMETER: &str = "token";

/// Hidden field of the form with the address to go on to, relative to the folder of the page.
const ADDRESS_FIELD: &str = "address";

/// Path to which the form is sent. It lies beside the page, so that its cookie is valid for the folder of the page.
const PATH: &str = "/sign-in";

const PAGE: &str = include_str!("sign_in.html");
const STYLE: &str = include_str!("sign_in.css");

/// SHA-256 of `STYLE`, in base 64. Files of the page need the token too, so the style is in the page.
const STYLE_HASH: &str = "SQKwUgSoE1SGnJWhcigYeieBqzCs/uqsAJL2JktS7Fo=";

/// Passes on a request with the token. Answers one without it: 303 with the cookie if the request brings the token, else 401.
pub(crate) async fn require(token: &Token, limits: &Limits, request: Request) -> Result<Request, Response> {
    let (path, query) = (request.uri().path(), request.uri().query().unwrap_or_default());
    if *request.method() == Method::POST && path == PATH {
        return Err(received(token, limits, request).await.unwrap_or_else(IntoResponse::into_response));
    }
    if path.starts_with("/health/") || token.is_in(request.headers()) {
        return Ok(request);
    }
    let (offered, others) = without_token(query);
    let address = match (if path == PATH { "" } else { path.trim_start_matches('/') }, &*others) {
        (page, "") => page.to_owned(),
        (page, others) => format!("{page}?{others}"),
    };
    if path == "/" && offered.as_ref().is_some_and(|offered| token.is(offered)) {
        return Err(welcome(token, &address));
    }
    let is_visit = *request.method() == Method::GET && accepts_html(request.headers());
    if !is_visit {
        return Err(Problem::unauthorized().into_response());
    }
    let depth = path.matches('/').count().saturating_sub(1);
    let up = if depth == 0 { "./".to_owned() } else { "../".repeat(depth) };
    let is_foreign = origin::is_foreign_frame(request.headers());
    Err(Question { address: &address, up: &up, is_wrong: offered.is_some(), is_foreign }.ask())
}

/// Answers the form.
async fn received(token: &Token, limits: &Limits, request: Request) -> Result<Response, Problem> {
    let (parts, body) = request.into_parts();
    FORM.check(&parts.headers)?;
    let form = tree::read(body, &parts.headers, limits).await?;
    let field = |wanted| form_urlencoded::parse(&form).find_map(|(name, value)| (name == wanted).then_some(value));
    let address = field(ADDRESS_FIELD).unwrap_or_default();
    let address = address.trim_start_matches('/');
    // Such an address was not written by this server.
    let is_own = address.bytes().all(|byte| byte.is_ascii_graphic() && byte != b'\\');
    let address = if is_own { address } else { "" };
    let is_right = field(TOKEN_PARAMETER).is_some_and(|offered| token.is(offered.trim()));
    let question = Question { address, up: "./", is_wrong: true, is_foreign: false };
    Ok(if is_right { welcome(token, address) } else { question.ask() })
}

/// Parts of a query: the first token in it, and the query without tokens.
fn without_token(query: &str) -> (Option<String>, String) {
    let given = |part: &str| {
        let (name, value) = form_urlencoded::parse(part.as_bytes()).next()?;
        (name == TOKEN_PARAMETER).then(|| value.into_owned())
    };
    let (tokens, others): (Vec<_>, Vec<_>) = query.split('&').partition(|part| given(part).is_some());
    (tokens.first().and_then(|part| given(part)), others.join("&"))
}

/// True if the request names HTML among the formats that it accepts, as a browser does for an address that somebody opens.
fn accepts_html(headers: &HeaderMap) -> bool {
    let accepted = headers.get_all(header::ACCEPT).into_iter().filter_map(|value| value.to_str().ok());
    accepted
        .flat_map(|value| value.split(','))
        .any(|part| part.split(';').next().is_some_and(|name| name.trim().eq_ignore_ascii_case("text/html")))
}

/// Leads a browser to an address beside the page, with its cookie.
fn welcome(token: &Token, address: &str) -> Response {
    let mut response = Redirect::to(&format!("./{address}")).into_response();
    response.headers_mut().insert(header::SET_COOKIE, token.cookie());
    response.headers_mut().insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    response
}

/// The page that asks for the token.
struct Question<'a> {
    /// The address asked for, relative to the folder of the page.
    address: &'a str,
    /// The way from the browser's address to that folder.
    up: &'a str,
    is_wrong: bool,
    /// True in a frame of another site, where a browser sends no cookie.
    is_foreign: bool,
}

impl Question<'_> {
    fn ask(&self) -> Response {
        let is_panel = self.address.starts_with("embed/");
        let page = PAGE.replace("{style}", STYLE).replace("{content}", &self.content(is_panel));
        let ancestors = if is_panel { "*" } else { "'self'" };
        let policy = format!(
            "default-src 'self'; base-uri 'none'; form-action 'self'; frame-ancestors {ancestors}; object-src 'none'; \
             style-src 'sha256-{STYLE_HASH}'"
        );
        let policy = HeaderValue::from_str(&policy).expect("the policy is ASCII");
        let headers = [
            (header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8")),
            (header::CONTENT_SECURITY_POLICY, policy),
            (header::CACHE_CONTROL, HeaderValue::from_static("no-store")),
            (header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer realm=\"equipoise\"")),
        ];
        (StatusCode::UNAUTHORIZED, headers, page).into_response()
    }

    fn content(&self, is_panel: bool) -> String {
        let address = escaped(self.address);
        let up = self.up;
        let itself =
            format!("<a href=\"{up}{address}\" target=\"_blank\" rel=\"noopener\">Open the panel by itself</a>");
        if self.is_foreign {
            return format!(
                "<p>This panel is on a server that asks for a token. A browser keeps no token for a frame of another site. \
                 {itself}.</p>"
            );
        }
        let wrong = if self.is_wrong {
            "<p class=\"wrong\" id=\"wrong\" role=\"alert\">This is not the token of the server.</p>"
        } else {
            ""
        };
        let invalid = if self.is_wrong { " aria-invalid=\"true\" aria-describedby=\"wrong\"" } else { "" };
        let panel = if is_panel {
            format!("<p class=\"muted\">If it asks again, the browser keeps no token for this frame. {itself}.</p>")
        } else {
            String::new()
        };
        format!(
            "<p>This server asks for its token.</p>\n\
             <form method=\"post\" action=\"{up}{form}\">\n\
             <input type=\"hidden\" name=\"{ADDRESS_FIELD}\" value=\"{address}\">\n\
             <label for=\"token\">Token</label>\n\
             <input type=\"password\" id=\"token\" name=\"{TOKEN_PARAMETER}\" autocomplete=\"current-password\" required autofocus{invalid}>\n\
             <button>Open</button>\n\
             </form>\n\
             {wrong}{panel}\
             <p class=\"muted\">Whoever started the server has it. The browser keeps it until it is closed.</p>",
            form = &PATH[1..],
        )
    }
}

/// Text for HTML, in an attribute too. Control characters become spaces.
pub(crate) fn escaped(text: &str) -> String {
    let signs = [("&", "&amp;"), ("<", "&lt;"), (">", "&gt;"), ("\"", "&quot;"), ("'", "&#39;")];
    signs.into_iter().fold(text.replace(char::is_control, " "), |text, (sign, entity)| text.replace(sign, entity))
}

#[cfg(test)]
mod tests {
    use sha2::{Digest, Sha256};

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

    #[test]
    fn the_policy_allows_the_style_of_the_page() {
        const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        let hash = Sha256::digest(STYLE);
        let digit = |bits: u32, place: usize| char::from(DIGITS[(bits >> (18 - 6 * place)) as usize & 63]);
        let mut text = String::new();
        for bytes in hash.chunks(3) {
            let bits = (0..3).fold(0, |bits, place| bits << 8 | u32::from(*bytes.get(place).unwrap_or(&0)));
            text.extend((0..4).map(|place| if place <= bytes.len() { digit(bits, place) } else { '=' }));
        }
        assert_eq!(STYLE_HASH, text);
    }

    #[test]
    fn an_address_cannot_leave_its_attribute() {
        let question = Question { address: "?a=\"><script>&'", up: "./", is_wrong: false, is_foreign: false };
        assert!(question.content(false).contains("value=\"?a=&quot;&gt;&lt;script&gt;&amp;&#39;\""));
    }
}
