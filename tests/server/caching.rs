//! The same request has the same bytes, and a client that has them gets 304 without any work.

use crate::support::Server;
use axum::http::Method;
use serde_json::json;

const TARGETS: [&str; 8] = [
    "/v1/trajectories?preset=case-1",
    "/v1/jacobians?preset=case-1",
    "/v1/stability?preset=case-1&impacts=100",
    "/v1/ensembles?preset=case-1-noise&runs=20&impacts=50",
    "/v1/scenes",
    "/v1/scenes/case-1",
    "/v1/fields",
    "/v1/paper",
];

#[tokio::test]
async fn the_same_request_has_the_same_bytes() {
    for target in TARGETS {
        for headers in [&[][..], &[("accept-encoding", "gzip")]] {
            let one = Server::start().get_with(target, headers).await.expect(200);
            let other = Server::start().get_with(target, headers).await.expect(200);
            assert_eq!(one.raw, other.raw, "{target}");
            assert_eq!(one.etag(), other.etag(), "{target}");
        }
    }
}

#[tokio::test]
async fn who_has_it_is_told_so() {
    let server = Server::start();
    for target in TARGETS {
        let first = server.get(target).await.expect(200);
        let tag = first.etag();
        for method in [Method::GET, Method::HEAD] {
            let held = format!("\"another\", {tag}");
            for held in [tag, &held, &format!("W/{tag}"), "*"] {
                let again = server.send(method.clone(), target, &[("if-none-match", held)], "").await.expect(304);
                for name in ["etag", "vary", "cache-control"] {
                    assert_eq!(again.header(name), first.header(name), "{method} {target}: {name}");
                }
            }
            server.send(method.clone(), target, &[("if-none-match", "\"another\"")], "").await.expect(200);
        }
    }
}

#[tokio::test]
async fn an_error_outranks_what_the_client_has() {
    let server = Server::start();
    for (target, status) in [
        ("/v1/trajectories?preset=case-1&impacts=0", 422),
        ("/v1/trajectories?preset=nothing", 422),
        ("/v1/trajectories?preset=case-1&format=pdf", 406),
        ("/v1/scenes/nothing", 404),
    ] {
        let answer = server.get_with(target, &[("if-none-match", "*")]).await.expect(status);
        assert_eq!(answer.header("etag"), None, "{target}");
        assert_eq!(answer.header("cache-control"), Some("no-store"), "{target}");
    }
}

#[tokio::test]
async fn head_has_the_headers_of_get() {
    let server = Server::start();
    for target in TARGETS {
        let (get, head) = (server.get(target).await.expect(200), server.head(target).await.expect(200));
        for name in ["etag", "vary", "cache-control", "content-type", "equipoise-build"] {
            assert_eq!(get.header(name), head.header(name), "{target}: {name}");
        }
        if let Some(length) = head.header("content-length") {
            assert_eq!(length, get.raw.len().to_string(), "{target}");
        }
    }
}

#[tokio::test]
async fn each_form_of_an_answer_has_its_own_tag() {
    let server = Server::start();
    let target = "/v1/trajectories?preset=case-1";
    let mut tags = Vec::new();
    for format in ["json", "csv", "ndjson", "svg"] {
        for headers in [&[][..], &[("accept-encoding", "gzip")]] {
            let answer = server.get_with(&format!("{target}&format={format}"), headers).await.expect(200);
            tags.push(answer.etag().to_owned());
        }
    }
    tags.push(server.get(&format!("{target}&format=png")).await.expect(200).etag().to_owned());
    for other in ["&impacts=99", "&scene.table.tilt_gain=1.2", "&samples_per_flight=1", "&epoch=0", "&epoch=1"] {
        tags.push(server.get(&format!("{target}{other}")).await.expect(200).etag().to_owned());
    }
    tags.push(server.get("/v1/stability?preset=case-1&impacts=100").await.expect(200).etag().to_owned());
    let count = tags.len();
    tags.sort();
    tags.dedup();
    assert_eq!(tags.len(), count, "two answers share a tag");
}

#[tokio::test]
async fn one_request_said_in_many_ways_is_one_answer() {
    let server = Server::start();
    let first = server.get("/v1/trajectories?preset=case-1").await.expect(200);
    for same in [
        "/v1/trajectories?preset=case-1&impacts=100",
        "/v1/trajectories?impacts=100&preset=case-1",
        "/v1/trajectories?preset=case-1&format=json",
        "/v1/trajectories?preset=case-1&scene.table.tilt_gain=1.1",
        "/v1/trajectories?preset=case-1&scene.table.tilt_gain=11e-1&scene.contact.restitution=1",
        "/v1/trajectories?preset=case-1&samples_per_flight=0&method=auto",
    ] {
        let answer = server.get(same).await.expect(200);
        assert_eq!(answer.etag(), first.etag(), "{same}");
        assert_eq!(answer.raw, first.raw, "{same}");
    }
    let post = server.post("/v1/trajectories", &json!({"preset": "case-1"})).await.expect(200);
    assert_eq!(post.raw, first.raw);
}

#[tokio::test]
async fn post_computes_whatever_the_client_has() {
    let server = Server::start();
    let tag = server.get("/v1/trajectories?preset=case-1").await.expect(200).etag().to_owned();
    let headers = [("content-type", "application/json"), ("if-none-match", tag.as_str())];
    server.send(Method::POST, "/v1/trajectories", &headers, r#"{"preset": "case-1"}"#).await.expect(200);
}

#[tokio::test]
async fn the_pool_has_no_say_in_the_bytes() {
    let server = Server::start();
    let dear = "/v1/trajectories?preset=case-1&impacts=20000";
    let (one, other) = tokio::join!(server.get(dear), server.get(dear));
    assert_eq!(one.expect(200).raw, other.expect(200).raw);
}
