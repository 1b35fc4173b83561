//! Answers that are known when the server starts: pages, scripts, the contract. Each is compressed once, on first demand.

use std::sync::OnceLock;

use axum::body::{Body, Bytes};
use axum::http::{HeaderMap, Response, StatusCode};

use crate::http::problem::Problem;
use crate::http::response::builder::{ok, status_only, with_tag};
use crate::http::response::etag::{EntityTag, IfNoneMatch};
use crate::http::response::gzip;
use crate::http::response::negotiate;
use crate::http::response::negotiate::Encoding;

/// Bytes of a media type, and their compressed form.
#[derive(Debug)]
pub struct StaticAsset {
    media_type: &'static str,
    identity: Form,
    gzip: OnceLock<Option<Form>>,
}

/// Bytes as they are sent, with their tag.
#[derive(Debug)]
struct Form {
    bytes: Bytes,
    tag: OnceLock<EntityTag>,
}

impl From<Bytes> for Form {
    fn from(bytes: Bytes) -> Self {
        Self { bytes, tag: OnceLock::new() }
    }
}

impl StaticAsset {
    /// An asset of these bytes.
    pub fn new(media_type: &'static str, bytes: impl Into<Bytes>) -> Self {
        Self { media_type, identity: Form::from(bytes.into()), gzip: OnceLock::new() }
    }

    /// The answer to a GET or HEAD: 304 if the client has these bytes.
    pub fn answer(&self, headers: &HeaderMap) -> Result<Response<Body>, Problem> {
        let encoding = negotiate::encoding(headers, false)?;
        let compressed = (encoding == Encoding::Gzip).then(|| self.gzip()).flatten();
        let (encoding, form) = match compressed {
            Some(gzip) => (Encoding::Gzip, gzip),
            None => (Encoding::Identity, &self.identity),
        };
        let tag = form.tag.get_or_init(|| EntityTag::of(&[self.media_type.as_bytes(), &form.bytes]));
        Ok(respond(self.media_type, (encoding, &form.bytes), tag, headers))
    }

    /// The compressed form, if it is smaller.
    fn gzip(&self) -> Option<&Form> {
        let compressed = self.gzip.get_or_init(|| {
            let gzip = gzip::gzip_best(&self.identity.bytes);
            (gzip.len() < self.identity.bytes.len()).then(|| Form::from(Bytes::from(gzip)))
        });
        compressed.as_ref()
    }
}

fn respond(
    media_type: &'static str,
    (encoding, bytes): (Encoding, &Bytes),
    tag: &EntityTag,
    headers: &HeaderMap,
) -> Response<Body> {
    let response = match tag.if_none_match(headers) {
        IfNoneMatch::Match | IfNoneMatch::Any => status_only(StatusCode::NOT_MODIFIED),
        IfNoneMatch::NoMatch => ok(media_type, encoding, bytes.clone()),
    };
    with_tag(response, tag)
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::{HeaderValue, header};

    fn accepting_gzip() -> HeaderMap {
        [(header::ACCEPT_ENCODING, HeaderValue::from_static("gzip"))].into_iter().collect()
    }

    #[test]
    fn compressed_where_it_helps() {
        let long = StaticAsset::new("text/css", "a { color: red }\n".repeat(100));
        assert_eq!(long.answer(&accepting_gzip()).unwrap().headers()[header::CONTENT_ENCODING], "gzip");
        assert!(long.answer(&HeaderMap::new()).unwrap().headers().get(header::CONTENT_ENCODING).is_none());
        let short = StaticAsset::new("text/css", "a{}");
        assert!(short.answer(&accepting_gzip()).unwrap().headers().get(header::CONTENT_ENCODING).is_none());
    }

    #[test]
    fn each_form_has_its_tag() {
        let page = StaticAsset::new("text/html", "text ".repeat(100));
        let tag = |headers: &HeaderMap| page.answer(headers).unwrap().headers()[header::ETAG].clone();
        let mut held = accepting_gzip();
        assert_ne!(tag(&held), tag(&HeaderMap::new()));
        held.insert(header::IF_NONE_MATCH, tag(&held));
        assert_eq!(page.answer(&held).unwrap().status(), StatusCode::NOT_MODIFIED);
        held.remove(header::ACCEPT_ENCODING);
        assert_eq!(page.answer(&held).unwrap().status(), StatusCode::OK);
    }
}
