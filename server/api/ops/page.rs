//! The embedded page and its files: `web/index.html` is `/`, `web/embed/index.html` is `/embed/{panel}`, another
//! `web/NAME/index.html` is `/NAME`, and other files have their own names.

use std::path::Path;
use std::sync::Arc;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Request, State};
use axum::http::request::Parts;
use axum::http::{HeaderValue, Response, header};
use axum::response::Redirect;
use axum::routing::{MethodRouter, get};
use tower_http::set_header::SetResponseHeaderLayer;

use crate::api::app::App;
use crate::api::ops::link_preview;
use crate::http::response::etag::EntityTag;
use crate::http::response::negotiate::Encoding;
use crate::http::response::repeats::{Client, KeptAnswer};
use crate::http::response::static_asset::StaticAsset;
use crate::http::response::{gzip, negotiate};
use crate::http::{Problem, peer};

include!(concat!(env!("OUT_DIR"), "/assets.rs"));

/// The page of one panel, served under every panel name. Its script picks the panel. Its links are relative to the parent folder.
const EMBED: &str = "embed/index.html";

/// The page itself, which gets a link preview.
const PAGE: &str = "index.html";

/// Content security policy of the panel page. Any site may frame it, because it has no secret and changes no state.
const EMBED_POLICY: HeaderValue =
    HeaderValue::from_static("default-src 'self'; base-uri 'self'; frame-ancestors *; object-src 'none'");

/// One route for each file, embedded or found in `web` at the start, so that a path from a client is never looked up on disk.
pub fn routes(web: Option<&Path>) -> Router<App> {
    let embedded = ASSETS.iter().map(|&(name, bytes)| (name.to_owned(), bytes));
    let found = web.map(|folder| files_in(folder, "")).unwrap_or_default();
    let new =
        found.into_iter().filter(|name| ASSETS.iter().all(|(known, _)| known != name)).map(|name| (name, &[][..]));
    embedded.chain(new).fold(Router::new(), |router, (name, bytes)| {
        let handler = file(name.clone(), bytes);
        match (name.as_str(), name.strip_suffix("/index.html")) {
            (PAGE, _) => router.route("/", handler.clone()),
            (EMBED, _) => router.route("/embed/{panel}", handler.clone()),
            (_, Some(folder)) => place(router, folder, &handler),
            _ => router,
        }
        .route(&format!("/{name}"), handler)
    })
}

/// The route of a page with a name of its own.
fn place(router: Router<App>, name: &str, handler: &MethodRouter<App>) -> Router<App> {
    let address = format!("../{name}");
    let redirect = get(async move || Redirect::permanent(&address));
    router.route(&format!("/{name}"), handler.clone()).route(&format!("/{name}/"), redirect)
}

/// Answers with one file of the page.
fn file(name: String, bytes: &'static [u8]) -> MethodRouter<App> {
    let embed = name == EMBED;
    let fixed = Arc::new(StaticAsset::new(media_type(&name), bytes));
    let handler = get(async move |State(app): State<App>, request: Request| {
        let media_type = media_type(&name);
        let read = app.config.web.as_ref().map(|folder| {
            let read = tokio::task::block_in_place(|| std::fs::read(folder.join(&name)));
            read.map_err(|error| Problem::not_found(format!("{name}: {error}")))
        });
        let read = read.transpose()?;
        if name == PAGE {
            let (parts, _) = request.into_parts();
            return match read {
                Some(html) => {
                    let tags = link_preview::tags(&app, &parts).await;
                    StaticAsset::new(media_type, link_preview::with_tags(&html, &tags.html)).answer(&parts.headers)
                }
                None => page(&app, &parts, (media_type, bytes)).await,
            };
        }
        match read {
            None => fixed.answer(request.headers()),
            Some(bytes) => StaticAsset::new(media_type, bytes).answer(request.headers()),
        }
    });
    if embed {
        handler.layer(SetResponseHeaderLayer::overriding(header::CONTENT_SECURITY_POLICY, EMBED_POLICY))
    } else {
        handler
    }
}

/// The embedded page with its tags. They follow from its address, so it is kept as it is sent.
async fn page(
    app: &App,
    parts: &Parts,
    (media_type, html): (&'static str, &'static [u8]),
) -> Result<Response<Body>, Problem> {
    let encoding = negotiate::encoding(&parts.headers, false)?;
    let name = Bytes::from(link_preview::name(app, parts, encoding));
    let kept = |bytes: &Bytes| {
        let tag = EntityTag::of(&[media_type.as_bytes(), bytes]);
        let name = name.clone();
        KeptAnswer { name, is_permanent: false, media_type, encoding, has_parts: false, tag, route: None }
    };
    let held = |kept: &KeptAnswer| Client {
        peer: peer(&parts.extensions),
        held: kept.tag.if_none_match(&parts.headers),
        range: None,
    };
    if let Some(page) = app.answers.find(false, &name) {
        let kept = kept(&page);
        let client = held(&kept);
        if let Some(response) = kept.respond_repeatably(&app.answers, client) {
            return Ok(response);
        }
    }
    let tags = link_preview::tags(app, parts).await;
    let page = link_preview::with_tags(html, &tags.html);
    let sent = Bytes::from(match encoding {
        Encoding::Identity => page,
        Encoding::Gzip => gzip::gzip_best(&page),
    });
    if tags.is_whole {
        app.answers.keep(name.clone(), sent.clone());
    }
    let kept = kept(&sent);
    Ok(kept.with_bytes(&app.answers, held(&kept), sent))
}

/// The files of a folder and its folders, by their paths from `root`. Skips what cannot be read and names with a brace, which
/// routes would take for a parameter.
fn files_in(root: &Path, folder: &str) -> Vec<String> {
    let entries = std::fs::read_dir(root.join(folder)).into_iter().flatten().flatten();
    entries
        .filter_map(|entry| Some((format!("{folder}{}", entry.file_name().to_str()?), entry.file_type().ok()?)))
        .filter(|(name, _)| !name.contains(['{', '}']))
        .flat_map(|(name, kind)| if kind.is_dir() { files_in(root, &format!("{name}/")) } else { vec![name] })
        .collect()
}

fn media_type(name: &str) -> &'static str {
    match name.rsplit_once('.').map_or("", |(_, extension)| extension) {
        "css" => "text/css; charset=utf-8",
        "html" => "text/html; charset=utf-8",
        "ico" => "image/x-icon",
        "js" | "mjs" => "text/javascript; charset=utf-8",
        "json" | "map" => "application/json",
        "md" => "text/markdown; charset=utf-8",
        "png" => "image/png",
        "svg" => "image/svg+xml",
        "ts" | "txt" => "text/plain; charset=utf-8",
        "wasm" => "application/wasm",
        "webmanifest" => "application/manifest+json",
        "woff2" => "font/woff2",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_embedded_file_has_a_media_type_of_its_own() {
        for (name, _) in ASSETS {
            let is_licence = !name.contains('.');
            assert!(is_licence || media_type(name) != "application/octet-stream", "{name} needs a media type");
        }
    }
}
