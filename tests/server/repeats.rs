//! A request that repeats an earlier one is answered without being read again, and nobody can tell: bytes, headers, metrics and every
//! check of access are those of the first time.

use crate::support::{Answer, Server};
use axum::http::{HeaderMap, Method};
use equipoise::config::Config;

const TRAJECTORY: &str = "/v1/trajectories?preset=case-1";

/// Enough requests for the last ones to be repeats: the first computes the answer, the second finds it in memory.
const TIMES: usize = 4;

/// All headers but the id of the request.
fn lasting(answer: &Answer) -> HeaderMap {
    let mut headers = answer.headers.clone();
    assert!(headers.remove("x-request-id").is_some());
    headers
}

/// A sample at `/metrics`; 0 without it.
async fn sample(server: &Server, name: &str) -> u64 {
    let metrics = server.get("/metrics").await.expect(200);
    let line = metrics.text().lines().find_map(|line| line.strip_prefix(&format!("equipoise_{name} ")));
    line.map_or(0, |count| count.parse().expect("a whole number"))
}

#[tokio::test]
async fn repeats_are_the_first_answer_again() {
    for target in [
        TRAJECTORY,
        "/",
        "/?preset=case-2",
        "/v1/scenes",
        "/v1/scenes/case-1",
        "/v1/stability?preset=case-1&format=svg",
    ] {
        let server = Server::start();
        let first = server.get(target).await.expect(200);
        let mut ids = vec![first.header("x-request-id").unwrap().to_owned()];
        for _ in 1..TIMES {
            let again = server.get(target).await.expect(200);
            assert_eq!((&again.raw, lasting(&again)), (&first.raw, lasting(&first)), "{target}");
            ids.push(again.header("x-request-id").unwrap().to_owned());
        }
        ids.sort();
        ids.dedup();
        assert_eq!(ids.len(), TIMES, "{target}");
        let named = server.get_with(target, &[("x-request-id", "lab-1")]).await.expect(200);
        assert_eq!(named.header("x-request-id"), Some("lab-1"));
        let head = server.head(target).await.expect(200);
        assert_eq!((head.raw.len(), lasting(&head)), (0, lasting(&first)), "{target}");
    }
}

#[tokio::test]
async fn repeats_are_counted_like_any_request() {
    let server = Server::start();
    let tag = server.get(TRAJECTORY).await.expect(200).etag().to_owned();
    for _ in 1..TIMES {
        server.get(TRAJECTORY).await.expect(200);
        server.get_with(TRAJECTORY, &[("if-none-match", &tag)]).await.expect(304);
    }
    for (status, count) in [(200, TIMES), (304, TIMES - 1)] {
        let labels = format!("{{method=\"GET\",route=\"/v1/trajectories\",status=\"{status}\"}}");
        assert_eq!(sample(&server, &format!("requests_total{labels}")).await, count as u64);
    }
    let labels = "{method=\"GET\",route=\"/v1/trajectories\"}";
    assert_eq!(sample(&server, &format!("request_duration_seconds_count{labels}")).await, 2 * TIMES as u64 - 1);
    // A 304 sends no answer.
    assert_eq!(sample(&server, "answer_cache_hits_total").await, TIMES as u64 - 1);
    assert_eq!(sample(&server, "answer_cache_misses_total").await, 1);
}

#[tokio::test]
async fn a_repeat_is_negotiated_as_it_asks() {
    let server = Server::start();
    let forms: [&[(&str, &str)]; 5] = [
        &[],
        &[("accept", "text/csv")],
        &[("accept-encoding", "gzip")],
        &[("accept", "text/csv"), ("accept-encoding", "gzip")],
        &[("accept", "text/csv;q=0.1"), ("accept", "application/json")],
    ];
    let mut first = Vec::new();
    for headers in forms {
        first.push(server.get_with(TRAJECTORY, headers).await.expect(200));
    }
    for _ in 1..TIMES {
        for (headers, first) in forms.iter().zip(&first) {
            let again = server.get_with(TRAJECTORY, headers).await.expect(200);
            assert_eq!((&again.raw, lasting(&again)), (&first.raw, lasting(first)), "{headers:?}");
        }
        server.get_with(TRAJECTORY, &[("accept", "image/webp")]).await.expect(406);
        server.get(&format!("{TRAJECTORY}&bounces=0")).await.expect(422);
    }
    assert_eq!(first[0].raw, first[4].raw);
}

#[tokio::test]
async fn a_repeat_is_not_sent_to_who_has_it() {
    let server = Server::start();
    let first = server.get(TRAJECTORY).await.expect(200);
    let weak = format!("W/{}", first.etag());
    let told = lasting(&server.get_with(TRAJECTORY, &[("if-none-match", "*")]).await.expect(304));
    for _ in 0..TIMES {
        for held in [first.etag(), "*", weak.as_str(), "\"other\", *"] {
            let answer = server.get_with(TRAJECTORY, &[("if-none-match", held)]).await.expect(304);
            assert_eq!((answer.raw.len(), answer.etag(), lasting(&answer)), (0, first.etag(), told.clone()));
        }
        let other = server.get_with(TRAJECTORY, &[("if-none-match", "\"other\"")]).await.expect(200);
        assert_eq!(other.raw, first.raw);
    }
}

#[tokio::test]
async fn access_is_checked_for_each_repeat() {
    let token = "0123456789abcdef";
    let origin = "https://lab.example";
    let config = Config {
        token: Some(token.parse().unwrap()),
        allow_origin: vec![origin.parse().unwrap()],
        ..Config::default()
    };
    let server = Server::with(&config);
    let bearer = format!("Bearer {token}");
    let own = ("authorization", bearer.as_str());
    for _ in 0..TIMES {
        for target in [TRAJECTORY, "/"] {
            server.get_with(target, &[own]).await.expect(200);
            server.send_unheld(Method::GET, target, &[], "").await.expect(401);
        }
        let foreign = [own, ("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "no-cors")];
        server.send_unheld(Method::GET, TRAJECTORY, &foreign, "").await.expect(403);
        let answer = server.get_with(TRAJECTORY, &[own, ("origin", origin)]).await.expect(200);
        assert_eq!(answer.header("access-control-allow-origin"), Some(origin));
        let answer = server.get_with(TRAJECTORY, &[own]).await.expect(200);
        assert_eq!(answer.header("access-control-allow-origin"), None);
    }
    let local = Server::with(&Config { listen: "127.0.0.1:8080".to_owned(), ..Config::default() });
    for _ in 0..TIMES {
        local.get(TRAJECTORY).await.expect(200);
    }
}

#[tokio::test]
async fn a_repeat_of_another_method_or_path_is_another_request() {
    let server = Server::start();
    for _ in 0..TIMES {
        let answer = server.get("/v1/scenes/case-1").await.expect(200);
        assert_ne!(answer.raw, server.get("/v1/scenes/case-2").await.expect(200).raw);
        server.send(Method::DELETE, TRAJECTORY, &[], "").await.expect(405);
        server.get(TRAJECTORY).await.expect(200);
        server.send(Method::POST, "/v1/trajectories", &[("content-type", "text/plain")], "{}").await.expect(415);
    }
}
