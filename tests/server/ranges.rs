//! One range of an answer, for programs that read a file by parts: polars and DuckDB ask for the length, then for ranges.

use crate::support::{Answer, Server};
use axum::http::Method;
use equipoise::config::Config;
use equipoise::limits::Limits;
use serde_json::json;

const RUN: &str = "/v1/trajectories?preset=case-1&bounces=50&format=csv";

/// A map, which is streamed if it is asked for as a whole.
const MAP: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1&x.to=1.6&x.count=9\
                   &y.field=release.theta&y.from=0&y.to=0.5&y.count=7&bounces=20&format=csv";

const TARGETS: [&str; 6] = [
    RUN,
    MAP,
    "/v1/scenes/case-1",
    "/v1/stability?preset=case-1&bounces=50&format=png",
    "/v1/trajectories?preset=case-1&bounces=50&format=arrow",
    "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=1&x.to=1.6&x.count=9&y.field=release.theta&y.from=0&y.to=0.5&y.count=7&bounces=20&format=arrow",
];

async fn range(server: &Server, target: &str, range: &str) -> Answer {
    server.get_with(target, &[("range", range)]).await
}

/// The length that HEAD tells.
async fn length(server: &Server, target: &str) -> usize {
    let head = server.head(target).await.expect(200);
    assert_eq!(head.header("accept-ranges"), Some("bytes"), "{target}");
    head.header("content-length").unwrap_or_else(|| panic!("{target}: no length")).parse().unwrap()
}

#[tokio::test]
async fn parts_put_together_are_the_whole() {
    // With answers in memory and without.
    for answer_cache in [1 << 20, 0] {
        for target in TARGETS {
            let whole = Server::start().get(target).await.expect(200);
            let limits = Limits { answer_cache, ..Limits::default() };
            let server = Server::with(&Config { limits, ..Config::default() });
            let length = length(&server, target).await;
            assert_eq!(length, whole.raw.len(), "{target}");
            let mut parts = Vec::new();
            let step = length / 3 + 1;
            for first in (0..length).step_by(step) {
                let last = first + step - 1;
                let part = range(&server, target, &format!("bytes={first}-{last}")).await.expect(206);
                let expected = format!("bytes {first}-{}/{length}", last.min(length - 1));
                assert_eq!(part.header("content-range"), Some(expected.as_str()), "{target}");
                for name in ["etag", "content-type", "vary", "cache-control", "accept-ranges"] {
                    if name != "accept-ranges" {
                        assert_eq!(part.header(name), whole.header(name), "{target}: {name}");
                    }
                    assert!(part.header(name).is_some(), "{target}: {name}");
                }
                parts.extend_from_slice(&part.raw);
            }
            assert!(parts == whole.raw, "{target}");
            let end = range(&server, target, "bytes=-5").await.expect(206);
            assert_eq!(end.raw, whole.raw[length - 5..], "{target}");
            let rest = range(&server, target, &format!("bytes={}-", length - 1)).await.expect(206);
            assert_eq!(rest.raw, whole.raw[length - 1..], "{target}");
            assert_eq!(server.get(target).await.expect(200).raw, whole.raw, "{target}");
        }
    }
}

#[tokio::test]
async fn a_range_beyond_the_end_is_416() {
    let server = Server::start();
    for target in [RUN, MAP] {
        let length = length(&server, target).await;
        for beyond in [format!("bytes={length}-"), "bytes=99999999999999999999-".to_owned(), "bytes=-0".to_owned()] {
            // The second one is answered from memory.
            for _ in 0..2 {
                let refused = range(&server, target, &beyond).await.expect(416);
                assert_eq!(refused.header("content-range"), Some(format!("bytes */{length}").as_str()), "{target}");
                assert_eq!(refused.media_type(), "application/problem+json", "{target}");
            }
        }
    }
}

#[tokio::test]
async fn other_ranges_get_the_whole() {
    let server = Server::start();
    let whole = server.get(RUN).await.expect(200);
    for invalid in ["bytes=0-1,4-5", "bytes=5-2", "rows=0-1", "bytes", "bytes=x-"] {
        assert_eq!(range(&server, RUN, invalid).await.expect(200).raw, whole.raw, "{invalid}");
    }
    // Ranges are for GET alone.
    let head = server.send(Method::HEAD, RUN, &[("range", "bytes=0-1")], "").await.expect(200);
    assert_eq!(head.header("content-length"), Some(whole.raw.len().to_string().as_str()));
    let headers = [("range", "bytes=0-1"), ("content-type", "application/json")];
    let body = json!({"preset": "case-1", "bounces": 50}).to_string();
    let post = server.send(Method::POST, "/v1/trajectories?format=csv", &headers, &body).await.expect(200);
    assert_eq!(post.raw, whole.raw);
    // A measurement differs each time.
    let measured = "/v1/precision?preset=case-1&bounces=2&methods.0=map&format=csv";
    assert_eq!(range(&server, measured, "bytes=0-1").await.expect(200).header("accept-ranges"), None);
    // Errors have no ranges.
    range(&server, "/v1/trajectories?preset=case-1&bounces=0", "bytes=0-1").await.expect(422);
}

#[tokio::test]
async fn a_range_of_another_answer_is_not_cut() {
    let server = Server::start();
    for target in [RUN, MAP] {
        let whole = server.get(target).await.expect(200);
        let own = server.get_with(target, &[("range", "bytes=2-4"), ("if-range", whole.etag())]).await.expect(206);
        assert_eq!(own.raw, whole.raw[2..5]);
        for other in ["\"other\"", &format!("W/{}", whole.etag()), "Mon, 23 Nov 2026 10:00:00 GMT"] {
            let answer = server.get_with(target, &[("range", "bytes=2-4"), ("if-range", other)]).await.expect(200);
            assert_eq!(answer.raw, whole.raw, "{target}: {other}");
        }
        let held = server.get_with(target, &[("range", "bytes=2-4"), ("if-none-match", whole.etag())]).await;
        held.expect(304);
    }
}

/// A range is one of the bytes without compression, also for a client that takes gzip, as fsspec does. Whole answers are compressed.
#[tokio::test]
async fn a_part_is_not_compressed() {
    let server = Server::start();
    for target in [RUN, MAP] {
        let whole = server.get(target).await.expect(200);
        // Twice: the second ones are answered from memory.
        for _ in 0..2 {
            let packed = server.get_with(target, &[("accept-encoding", "gzip")]).await.expect(200);
            assert_eq!((packed.header("content-encoding"), packed.header("accept-ranges")), (Some("gzip"), None));
            assert_eq!(packed.body, whole.body, "{target}");
            let part =
                server.get_with(target, &[("range", "bytes=0-3"), ("accept-encoding", "gzip")]).await.expect(206);
            assert_eq!((part.header("content-encoding"), part.etag()), (None, whole.etag()), "{target}");
            assert_eq!(part.raw, whole.raw[..4], "{target}");
            let headers = [("range", "bytes=0-3"), ("accept-encoding", "gzip, identity;q=0")];
            let refused = server.get_with(target, &headers).await.expect(200);
            assert_eq!(refused.header("content-encoding"), Some("gzip"), "{target}");
        }
    }
}
