//! The embedded page and its files: `web/index.html` is `/`, `web/embed/index.html` is `/embed/{panel}`, another
//! `web/NAME/index.html` is `/NAME`, and other files have their own names.
//!
//! Tags of the page's head show a link to it in other programs (Open Graph, <https://ogp.me>): the run that the address names, in words and as a
//! picture of `/v1/previews`. An address that names no valid run gets the tags of the first case. The tags never make the page fail.

use std::path::Path;
use std::sync::Arc;

use axum::Router;
use axum::body::{Body, Bytes};
use axum::extract::{Request, State};
use axum::http::request::Parts;
use axum::http::{HeaderValue, Response, header};
use axum::response::Redirect;
use axum::routing::{MethodRouter, get};
use form_urlencoded::Serializer;
use tower_http::set_header::SetResponseHeaderLayer;

use crate::api::app::App;
use crate::api::computed::previews::{PreviewAnswer, PreviewRequest};
use crate::api::resource::ResourceRequest;
use crate::charts::CARD_SIZE;
use crate::compute::{Peer, Price, TimeSlice};
use crate::http::request::reader::Source;
use crate::http::request::tree;
use crate::http::response::answers::{Client, KeptAnswer};
use crate::http::response::negotiate::Encoding;
use crate::http::response::representation::{EntityTag, StaticAsset};
use crate::http::response::{negotiate, representation};
use crate::http::security::host::PublicOrigin;
use crate::http::security::origin;
use crate::http::security::token::escaped;
use crate::http::{Errors, Problem, Reader, peer};
use crate::limits;

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
                    let tags = tags(&app, &parts).await;
                    StaticAsset::new(media_type, with_tags(&html, &tags.html)).answer(&parts.headers)
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
    let name = Bytes::from(name(app, parts, encoding));
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
    let tags = tags(app, parts).await;
    let page = with_tags(html, &tags.html);
    let sent = Bytes::from(match encoding {
        Encoding::Identity => page,
        Encoding::Gzip => representation::gzip_best(&page),
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

/// The preset of an address that names no run.
const DEFAULT_PRESET: &str = "case-1";

/// Words on a run that costs too much for a page.
const DEFAULT_WORDS: (&str, &str) =
    ("A rod bouncing on a tilting table", "Simulated live: does the table keep it in balance?");

/// Path of the pictures.
const PICTURES: &str = "/v1/previews?";

/// Bytes of a picture's address besides its run.
const ROOM: usize = PICTURES.len() + "&format=png".len();

/// The run that an address names.
struct NamedRun {
    request: PreviewRequest,
    /// The parameters that name it, encoded.
    query: String,
}

/// Tags for a request of the page.
#[derive(Debug)]
pub struct Tags {
    /// The tags as HTML.
    pub html: String,
    /// False if the run had to be left out because of load, or because another site asks. All else follows from the address.
    pub is_whole: bool,
}

/// Name of the page with its tags: all that determines its bytes.
pub fn name(app: &App, parts: &Parts, encoding: Encoding) -> Vec<u8> {
    let origin =
        PublicOrigin::of(&parts.headers, &parts.extensions).map(|origin| origin.to_string()).unwrap_or_default();
    let query = parts.uri.query().unwrap_or_default();
    // Zeros separate the parts, none of which has one.
    ["/", encoding.name(), &origin, &app.base_path, query].join("\0").into_bytes()
}

/// The tags for a request of the page.
pub async fn tags(app: &App, parts: &Parts) -> Tags {
    let pairs: Vec<(String, String)> =
        form_urlencoded::parse(parts.uri.query().unwrap_or_default().as_bytes()).into_owned().collect();
    let named = if pairs.len() > limits::QUERY_PARAMETERS { None } else { named_run(&pairs) };
    // The default names a preset, so it is valid.
    let first = || named_run(&[("preset".to_owned(), DEFAULT_PRESET.to_owned())]);
    let Some(run) = named.or_else(first) else { return Tags { html: String::new(), is_whole: true } };
    // A page of another site may not set this server to work.
    let is_foreign = origin::is_foreign(&parts.headers, &app.config.allow_origin);
    let words = if is_foreign { None } else { words(app, peer(&parts.extensions), run.request).await };
    let is_whole = words.is_some();
    let default = || (DEFAULT_WORDS.0.to_owned(), DEFAULT_WORDS.1.to_owned());
    let base = PublicOrigin::of(&parts.headers, &parts.extensions).map(|origin| format!("{origin}{}", app.base_path));
    Tags { html: written(base.as_deref(), &pairs, &run.query, &words.unwrap_or_else(default)), is_whole }
}

/// Headline and sentence on a run. Expensive runs get words without a result, so that the page need not wait for a place in the queue.
/// None if the server is overloaded.
async fn words(app: &App, peer: Peer, request: PreviewRequest) -> Option<(String, String)> {
    let bounces = request.bounces();
    if bounces > limits::INLINE_BOUNCES {
        return Some((DEFAULT_WORDS.0.to_owned(), DEFAULT_WORDS.1.to_owned()));
    }
    let compute = move |slice: &TimeSlice| {
        let answer = PreviewAnswer::compute(&request, &mut || slice.should_continue())?;
        Ok::<_, Problem>((answer.title, answer.text))
    };
    app.pool.for_peer(peer).run(Price::bounces(bounces), compute).await.ok()
}

/// The run that these parameters name; `None` if they name none, or not a valid one.
fn named_run(pairs: &[(String, String)]) -> Option<NamedRun> {
    let is_of_run = |name: &str| name == "preset" || name.starts_with("scene.") || name.starts_with("interventions.");
    let of_run: Vec<_> = pairs.iter().filter(|(name, _)| is_of_run(name)).cloned().collect();
    let query = Serializer::new(String::new()).extend_pairs(&of_run).finish();
    if of_run.is_empty() || query.len() + ROOM > limits::URL_BYTES {
        return None;
    }
    let request = read(of_run).ok()?;
    Some(NamedRun { request, query })
}

fn read(pairs: Vec<(String, String)>) -> Result<PreviewRequest, Problem> {
    let fields = tree::unfold(pairs)?;
    let mut errors = Errors::default();
    let mut reader = Reader::new(&fields, String::new(), Source::Query, &mut errors);
    let request = PreviewRequest::read(&mut reader);
    reader.finish();
    errors.into_result()?;
    request.ok_or_else(Problem::internal)
}

/// The tags as HTML. `base` is the address of the page without its query; without it there are no addresses, which have to be absolute.
fn written(base: Option<&str>, pairs: &[(String, String)], run: &str, (title, text): &(String, String)) -> String {
    let (width, height) = CARD_SIZE;
    let mut tags = vec![
        ("property", "og:type", "website".to_owned()),
        ("property", "og:site_name", "equipoise".to_owned()),
        ("property", "og:title", title.clone()),
        ("property", "og:description", text.clone()),
    ];
    if let Some(base) = base {
        let public = pairs.iter().filter(|(name, _)| name != "token");
        let query = Serializer::new(String::new()).extend_pairs(public).finish();
        let page = if query.is_empty() { format!("{base}/") } else { format!("{base}/?{query}") };
        tags.extend([
            ("property", "og:url", page),
            ("property", "og:image", format!("{base}{PICTURES}{run}&format=png")),
            ("property", "og:image:type", "image/png".to_owned()),
            ("property", "og:image:width", width.to_string()),
            ("property", "og:image:height", height.to_string()),
            ("property", "og:image:alt", format!("{title}. {text}")),
            ("name", "twitter:card", "summary_large_image".to_owned()),
        ]);
    }
    let line = |(kind, name, content): (&str, &str, String)| {
        format!("<meta {kind}=\"{name}\" content=\"{}\">\n", escaped(&content))
    };
    tags.into_iter().map(line).collect()
}

/// A page with tags at the end of its head. A page without a head stays as it is.
pub fn with_tags(html: &[u8], tags: &str) -> Vec<u8> {
    const END: &[u8] = b"</head>";
    match html.windows(END.len()).position(|window| window == END) {
        Some(at) => [&html[..at], tags.as_bytes(), &html[at..]].concat(),
        None => html.to_vec(),
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

    #[test]
    fn text_cannot_leave_its_attribute() {
        assert_eq!(escaped("a\"><script>'&\n"), "a&quot;&gt;&lt;script&gt;&#39;&amp; ");
        assert_eq!(with_tags(b"<head></head></head>", "<meta>"), b"<head><meta></head></head>");
        assert_eq!(with_tags(b"plain", "<meta>"), b"plain");
    }

    #[test]
    fn an_address_names_a_run_or_none() {
        let pairs = |query: &str| form_urlencoded::parse(query.as_bytes()).into_owned().collect::<Vec<_>>();
        let named = named_run(&pairs("preset=case-2&tab=map&scene.table.tilt_gain=1.2&epoch_ms=1")).unwrap();
        assert_eq!(named.query, "preset=case-2&scene.table.tilt_gain=1.2");
        for query in [
            "",
            "tab=map",
            "preset=none",
            "preset=case-1&preset=case-2",
            "scene.table.tilt_gain=1.2",
            "preset=case-1&scene.=1",
            "preset=case-1&scene.release.height=-1",
            "preset=case-1&interventions.1.impact=2",
        ] {
            assert!(named_run(&pairs(query)).is_none(), "{query}");
        }
        assert!(named_run(&pairs(&format!("preset={DEFAULT_PRESET}"))).is_some());
    }
}
