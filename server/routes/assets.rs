//! The page and its files, embedded: `web/index.html` is `/`, `web/docs/index.html` is `/docs`, others are by name.

use std::sync::Arc;

use axum::Router;
use axum::extract::State;
use axum::http::HeaderMap;
use axum::response::Redirect;
use axum::routing::get;

use super::App;
use crate::http::Problem;
use crate::http::fixed::Fixed;

include!(concat!(env!("OUT_DIR"), "/assets.rs"));

/// One route for each file, so that a path is known or is not: nothing is looked up by what a client sends.
pub fn routes() -> Router<App> {
    let mut router = Router::new();
    for (name, bytes) in ASSETS.iter().copied() {
        let fixed = Arc::new(Fixed::new(media_type(name), bytes));
        let handler = get(async move |State(app): State<App>, headers: HeaderMap| match &app.web {
            None => fixed.answer(&headers),
            Some(folder) => match tokio::task::block_in_place(|| std::fs::read(folder.join(name))) {
                Ok(bytes) => Fixed::new(media_type(name), bytes).answer(&headers),
                Err(error) => Err(Problem::not_found(format!("{name}: {error}"))),
            },
        });
        router = router.route(&format!("/{name}"), handler.clone());
        router = match name {
            "index.html" => router.route("/", handler),
            "docs/index.html" => {
                router.route("/docs", handler).route("/docs/", get(async || Redirect::permanent("/docs")))
            }
            _ => router,
        };
    }
    router
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
        "txt" => "text/plain; charset=utf-8",
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
