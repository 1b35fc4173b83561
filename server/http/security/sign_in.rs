//! Asks for the token: a problem for programs, a page with a field for people. A browser that brings the token gets the cookie.

use axum::extract::Request;
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Redirect, Response};

use crate::http::request::body::{self, FORM};
use crate::http::security::site;
use crate::http::{Problem, Token};
use crate::limits::Limits;

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
    let is_foreign = site::is_foreign_frame(request.headers());
    Err(Question { address: &address, up: &up, is_wrong: offered.is_some(), is_foreign }.ask())
}

/// Answers the form.
async fn received(token: &Token, limits: &Limits, request: Request) -> Result<Response, Problem> {
    let (parts, body) = request.into_parts();
    FORM.check(&parts.headers)?;
    let form = body::read(body, &parts.headers, limits).await?;
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

/// Text for HTML, in an attribute too.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;").replace('\'', "&#39;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use sha2::{Digest, Sha256};

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
