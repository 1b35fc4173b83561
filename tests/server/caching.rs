//! The same request has the same bytes, and a client that has them gets 304 without any work. Answers are kept in memory, and computed
//! once for requests that come together.

use std::net::SocketAddr;
use std::sync::Arc;

use axum::http::{HeaderMap, Method};
use equipoise::api::App;
use equipoise::config::Config;
use equipoise::limits;
use equipoise::limits::Limits;
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::timeout;

use crate::support::{Answer, Server, socket};

const TARGETS: [&str; 8] = [
    "/v1/trajectories?preset=case-1",
    "/v1/jacobians?preset=case-1",
    "/v1/stability?preset=case-1&bounces=100",
    "/v1/ensembles?preset=case-1-noise&runs=20&bounces=50",
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
        ("/v1/trajectories?preset=case-1&bounces=0", 422),
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
    for format in ["json", "csv", "ndjson", "arrow", "svg"] {
        for headers in [&[][..], &[("accept-encoding", "gzip")]] {
            let answer = server.get_with(&format!("{target}&format={format}"), headers).await.expect(200);
            tags.push(answer.etag().to_owned());
        }
    }
    tags.push(server.get(&format!("{target}&format=png")).await.expect(200).etag().to_owned());
    for other in ["&bounces=99", "&scene.table.tilt_gain=1.2", "&samples_per_flight=1", "&epoch_ms=0", "&epoch_ms=1"] {
        tags.push(server.get(&format!("{target}{other}")).await.expect(200).etag().to_owned());
    }
    tags.push(server.get("/v1/stability?preset=case-1&bounces=100").await.expect(200).etag().to_owned());
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
        "/v1/trajectories?preset=case-1&bounces=100",
        "/v1/trajectories?bounces=100&preset=case-1",
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
    let dear = "/v1/trajectories?preset=case-1&bounces=20000";
    let (one, other) = tokio::join!(server.get(dear), server.get(dear));
    assert_eq!(one.expect(200).raw, other.expect(200).raw);
}

/// A server with so much memory for answers.
fn with_answer_cache(bytes: usize) -> Server {
    Server::with(&Config { limits: Limits { answer_cache: bytes, ..Limits::default() }, ..Config::default() })
}

/// A count at `/metrics`, without the prefix of all names.
async fn count(server: &Server, name: &str) -> u64 {
    let metrics = server.get("/metrics").await.expect(200);
    let line = metrics.text().lines().find_map(|line| line.strip_prefix(&format!("equipoise_{name} ")));
    line.unwrap_or_else(|| panic!("no count {name}")).parse().expect("a whole number")
}

/// Hits, misses and joined requests.
async fn counts(server: &Server) -> [u64; 3] {
    [
        count(server, "answer_cache_hits_total").await,
        count(server, "answer_cache_misses_total").await,
        count(server, "answer_cache_joined_total").await,
    ]
}

/// All headers but the id of the request.
fn lasting(answer: &Answer) -> HeaderMap {
    let mut headers = answer.headers.clone();
    assert!(headers.remove("x-request-id").is_some());
    headers
}

/// Every resource and format whose answers are kept.
const KEPT: [&str; 19] = [
    "/v1/trajectories?preset=case-1",
    "/v1/trajectories?preset=case-1&format=csv",
    "/v1/trajectories?preset=case-1&format=ndjson",
    "/v1/trajectories?preset=case-1&format=svg",
    "/v1/trajectories?preset=case-1&bounces=10&format=png",
    "/v1/jacobians?preset=case-1",
    "/v1/stability?preset=case-1&bounces=100",
    "/v1/stability?preset=case-1&bounces=100&format=svg",
    "/v1/controllers?preset=case-1",
    "/v1/ladder?preset=case-1&bounces=100",
    "/v1/previews?preset=case-1",
    "/v1/previews?preset=case-1&format=svg",
    "/v1/periodic-orbits?preset=case-1",
    "/v1/regions?preset=case-1&bounces=20&x.field=release.theta&x.from=-1&x.to=1&x.count=8&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=8",
    "/v1/regions?preset=case-1&bounces=20&x.field=release.theta&x.from=-1&x.to=1&x.count=8&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=8&format=svg",
    "/v1/ensembles?preset=case-1-noise&runs=20&bounces=50",
    "/v1/ensembles?preset=case-1-noise&runs=20&bounces=50&format=csv",
    "/v1/failures",
    "/v1/scenes",
];

#[tokio::test]
async fn a_kept_answer_is_the_first_one_again() {
    let server = Server::start();
    let none = with_answer_cache(0);
    for target in KEPT {
        for headers in [&[][..], &[("accept-encoding", "gzip")]] {
            let before = counts(&server).await;
            let cold = server.get_with(target, headers).await.expect(200);
            // Pixels are never compressed, so both encodings are one answer.
            let is_new = u64::from(headers.is_empty() || cold.header("content-encoding").is_some());
            let between = counts(&server).await;
            assert_eq!(between[1] - before[1], is_new, "{target}");
            let bounces = count(&server, "bounces_total").await;
            let warm = server.get_with(target, headers).await.expect(200);
            assert_eq!((&warm.raw, lasting(&warm)), (&cold.raw, lasting(&cold)), "{target}");
            assert_eq!(counts(&server).await, [between[0] + 1, between[1], between[2]], "{target}");
            assert_eq!(count(&server, "bounces_total").await, bounces, "{target}");
            let alone = none.get_with(target, headers).await.expect(200);
            assert_eq!((&alone.raw, lasting(&alone)), (&cold.raw, lasting(&cold)), "{target}");
            let head = server.send(Method::HEAD, target, headers, "").await.expect(200);
            assert_eq!((head.raw.len(), head.etag()), (0, cold.etag()), "{target}");
            let held = [headers, &[("if-none-match", cold.etag())]].concat();
            server.get_with(target, &held).await.expect(304);
        }
    }
}

#[tokio::test]
async fn get_post_and_batches_share_an_answer() {
    let server = Server::start();
    let first = server.get("/v1/trajectories?preset=case-1").await.expect(200);
    let again = server.post("/v1/trajectories", &json!({"preset": "case-1", "bounces": 100})).await.expect(200);
    assert_eq!(again.raw, first.raw);
    let lines = "{\"preset\": \"case-1\"}\n{\"preset\": \"case-1\", \"bounces\": 100}\n";
    let headers = [("content-type", "application/x-ndjson")];
    let batch = server.send(Method::POST, "/v1/batches/trajectories", &headers, lines).await.expect(200);
    let answers = batch.text().lines().filter(|line| line.ends_with(&format!("{}}}", first.text()))).count();
    assert_eq!(answers, 2);
    assert_eq!(counts(&server).await, [3, 1, 0]);
}

#[tokio::test]
async fn requests_that_come_together_are_computed_once() {
    for target in [
        "/v1/stability?preset=case-1&bounces=20000",
        "/v1/regions?preset=case-1&bounces=200&x.field=release.theta&x.from=-1&x.to=1&x.count=60&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=60",
        "/v1/trajectories?preset=case-1&bounces=20000",
    ] {
        let alone = Server::start();
        let one = alone.get(target).await.expect(200);
        let bounces = count(&alone, "bounces_total").await;
        let server = Server::start();
        let all = futures_util::future::join_all((0..8).map(|_| server.get(target))).await;
        for answer in all {
            assert_eq!(answer.expect(200).raw, one.raw, "{target}");
        }
        let [hits, misses, joined] = counts(&server).await;
        assert_eq!((misses, hits + joined), (1, 7), "{target}");
        assert_eq!(count(&server, "bounces_total").await, bounces, "{target}");
    }
}

#[tokio::test]
async fn a_computation_outlives_the_client_that_began_it() {
    let target = "/v1/stability?preset=case-1&bounces=100000";
    let server = Arc::new(Server::start());
    let begin = || {
        let server = server.clone();
        tokio::spawn(async move { server.get(target).await })
    };
    let first = begin();
    while count(&server, "answer_cache_misses_total").await == 0 {
        tokio::task::yield_now().await;
    }
    let second = begin();
    while count(&server, "answer_cache_joined_total").await == 0 {
        tokio::task::yield_now().await;
    }
    first.abort();
    second.await.unwrap().expect(200);
    assert_eq!(counts(&server).await, [0, 1, 1]);
    server.get(target).await.expect(200);
    assert_eq!(counts(&server).await, [1, 1, 1]);
}

#[tokio::test]
async fn work_that_every_client_has_left_is_cancelled_and_not_kept() {
    let target = "/v1/regions?preset=case-1&bounces=2000&x.field=release.theta&x.from=-1&x.to=1&x.count=500&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=500";
    let server = Arc::new(Server::start());
    let asked = server.clone();
    let first = tokio::spawn(async move { asked.get(target).await });
    while count(&server, "jobs_running").await == 0 {
        assert!(!first.is_finished(), "the work is too short to be seen");
        tokio::task::yield_now().await;
    }
    first.abort();
    while count(&server, "jobs_running").await > 0 {
        tokio::task::yield_now().await;
    }
    assert_eq!((counts(&server).await, count(&server, "answer_cache_bytes").await), ([0, 1, 0], 0));
}

#[tokio::test]
async fn memory_is_bounded_however_many_requests_differ() {
    const BYTES: usize = 256 * 1024;
    let server = with_answer_cache(BYTES);
    let mut most = 0;
    for n in 0..200 {
        let target = format!("/v1/trajectories?preset=case-1&bounces=40&scene.release.theta=0.{n:03}1");
        server.get(&target).await.expect(200);
        most = most.max(count(&server, "answer_cache_bytes").await);
        assert!(most <= BYTES as u64, "{most} bytes after {n} answers");
    }
    assert!(most > BYTES as u64 / 2, "{most}");
    assert_eq!(counts(&server).await[1], 200);
    // Some have made room, and are computed again.
    for n in 0..200 {
        server
            .get(&format!("/v1/trajectories?preset=case-1&bounces=40&scene.release.theta=0.{n:03}1"))
            .await
            .expect(200);
        assert!(count(&server, "answer_cache_bytes").await <= BYTES as u64);
    }
    let [hits, misses, _] = counts(&server).await;
    assert_eq!(hits + misses, 400);
    assert!(hits < 100, "{hits}");
}

#[tokio::test]
async fn a_large_answer_is_not_kept() {
    let server = Server::start();
    let large = "/v1/trajectories?preset=case-1&bounces=10000";
    for _ in 0..2 {
        assert!(server.get(large).await.expect(200).raw.len() > limits::KEPT_ANSWER_BYTES);
    }
    assert_eq!((counts(&server).await, count(&server, "answer_cache_bytes").await), ([0, 2, 0], 0));
}

#[tokio::test]
async fn without_memory_each_request_is_computed() {
    let server = with_answer_cache(0);
    let target = "/v1/stability?preset=case-1&bounces=100";
    let first = server.get(target).await.expect(200);
    let bounces = count(&server, "bounces_total").await;
    assert_eq!(server.get(target).await.expect(200).raw, first.raw);
    assert_eq!(count(&server, "bounces_total").await, 2 * bounces);
    assert_eq!(counts(&server).await, [0, 0, 0]);
    // Answers of the build are made once all the same.
    for fixed in ["/v1/scenes", "/v1/fields"] {
        let [hits, misses, _] = counts(&server).await;
        let first = server.get(fixed).await.expect(200);
        assert_eq!(server.get(fixed).await.expect(200).raw, first.raw);
        assert_eq!(counts(&server).await, [hits + 1, misses + 1, 0]);
    }
}

#[tokio::test]
async fn an_error_is_not_kept() {
    let server = Server::start();
    // The answer has nothing to draw, which is known only when it is computed.
    let target = "/v1/periodic-orbits?preset=case-4&format=svg";
    for _ in 0..2 {
        let answer = server.send_unheld(Method::GET, target, &[], "").await;
        let kept = count(&server, "answer_cache_bytes").await;
        assert_eq!(answer.status == 200, kept > 0, "{}", answer.status);
    }
    server.get("/v1/trajectories?preset=case-1&bounces=0").await.expect(422);
    assert_eq!(counts(&server).await[0], 0);
}

#[tokio::test]
async fn a_measurement_and_a_stream_are_never_kept() {
    let server = Server::start();
    let before = counts(&server).await;
    for target in [
        "/v1/precision?preset=case-1&bounces=2&methods.0=time_stepping",
        "/v1/regions?preset=case-1&bounces=20&x.field=release.theta&x.from=-1&x.to=1&x.count=8&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=8&format=csv",
        "/v1/regions?preset=case-1&bounces=20&x.field=release.theta&x.from=-1&x.to=1&x.count=8&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=8&format=ndjson",
    ] {
        server.get(target).await.expect(200);
        server.get(target).await.expect(200);
        assert_eq!((counts(&server).await, count(&server, "answer_cache_bytes").await), (before, 0), "{target}");
    }
}

#[tokio::test]
async fn access_is_checked_before_the_cache() {
    let config = Config { token: Some("0123456789abcdef".parse().unwrap()), ..Config::default() };
    let server = Server::with(&config);
    let target = "/v1/stability?preset=case-1&bounces=100";
    let bearer = ("authorization", "Bearer 0123456789abcdef");
    for _ in 0..2 {
        server.get_with(target, &[bearer]).await.expect(200);
        let refused = server.send_unheld(Method::GET, target, &[], "").await.expect(401);
        assert_eq!(refused.header("etag"), None);
        let wrong = ("authorization", "Bearer 0123456789abcdee");
        server.send_unheld(Method::GET, target, &[wrong], "").await.expect(401);
    }
    let open = Server::start();
    open.get(target).await.expect(200);
    let foreign = [("sec-fetch-site", "cross-site"), ("sec-fetch-mode", "no-cors"), ("sec-fetch-dest", "image")];
    open.send_unheld(Method::GET, target, &foreign, "").await.expect(403);
}

#[tokio::test]
async fn the_page_is_kept_as_it_is_sent() {
    let (server, none) = (Server::start(), with_answer_cache(0));
    for target in ["/", "/?preset=case-2", "/?preset=case-2&scene.table.tilt_gain=1.2"] {
        for headers in [&[][..], &[("accept-encoding", "gzip")]] {
            let ask = async |server: &Server| server.get_with(target, headers).await.expect(200);
            let (cold, warm, alone) = (ask(&server).await, ask(&server).await, ask(&none).await);
            assert_eq!((&warm.raw, lasting(&warm)), (&cold.raw, lasting(&cold)), "{target}");
            assert_eq!((&alone.raw, lasting(&alone)), (&cold.raw, lasting(&cold)), "{target}");
        }
    }
    assert_eq!(counts(&server).await[0], 6);
}

// A request that repeats an earlier one is answered without being read again, and nobody can tell: bytes, headers, metrics and every
// check of access are those of the first time.

const TRAJECTORY: &str = "/v1/trajectories?preset=case-1";

/// Enough requests for the last ones to be repeats: the first computes the answer, the second finds it in memory.
const TIMES: usize = 4;

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

// Clients that ask for the same answer at the same time share one computation, over real connections: it is done once, and it lasts as
// long as one of them waits.

/// Work of some seconds, which counts its bounces on the way.
const TARGET: &str = "/v1/regions?preset=case-1&bounces=2000&x.field=release.theta&x.from=-1&x.to=1&x.count=300&y.field=table.tilt_gain&y.from=1&y.to=1.4&y.count=300";

/// Addresses of two clients, told by a trusted proxy.
const CLIENTS: [&str; 2] = ["192.0.2.1", "198.51.100.2"];

/// A server that believes this machine who its clients are.
async fn start() -> (App, SocketAddr) {
    socket::start_with(&Config { trust_proxy: vec!["127.0.0.1".parse().unwrap()], ..Config::default() }).await
}

/// A request of a client on a connection of its own.
async fn ask(address: SocketAddr, client: &str) -> TcpStream {
    let mut stream = TcpStream::connect(address).await.unwrap();
    let head =
        format!("GET {TARGET} HTTP/1.1\r\nhost: localhost\r\nx-forwarded-for: {client}\r\nconnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).await.unwrap();
    stream
}

/// A request of a client for another region, of the same size.
async fn ask_for_another(address: SocketAddr, client: &str, number: usize) -> TcpStream {
    let mut stream = TcpStream::connect(address).await.unwrap();
    let target = TARGET.replace("y.to=1.4", &format!("y.to=1.{}", 41 + number));
    let head =
        format!("GET {target} HTTP/1.1\r\nhost: localhost\r\nx-forwarded-for: {client}\r\nconnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).await.unwrap();
    stream
}

/// Body of the answer, which has to be a 200 of the announced length.
async fn answer(mut stream: TcpStream) -> String {
    let mut text = String::new();
    timeout(6 * socket::SOON, stream.read_to_string(&mut text)).await.expect("an answer").unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    assert!(head.starts_with("HTTP/1.1 200 "), "{head}");
    assert!(head.contains(&format!("content-length: {}\r\n", body.len())), "{head}");
    body.to_owned()
}

/// Waits until the metrics of a server are so.
async fn until(what: &str, is_so: impl Fn() -> bool) {
    let waiting = async {
        while !is_so() {
            tokio::task::yield_now().await;
        }
    };
    timeout(socket::SOON, waiting).await.unwrap_or_else(|_| panic!("{what}"));
}

/// Two clients that wait for one computation: their connections in the order of their requests.
async fn joined(app: &App, address: SocketAddr) -> [TcpStream; 2] {
    let counts = app.answers.counts();
    let first = ask(address, CLIENTS[0]).await;
    // Others join work that has left the queue.
    until("the work begins", || app.metrics.bounces.get() > 0).await;
    let second = ask(address, CLIENTS[1]).await;
    until("the second client joins", || counts.joined.get() + counts.misses.get() == 2).await;
    assert_eq!((counts.misses.get(), counts.joined.get()), (1, 1));
    [first, second]
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn either_client_may_leave_and_the_other_gets_the_answer() {
    let mut answers = Vec::new();
    for leaves in 0..2 {
        let (app, address) = start().await;
        let mut clients = joined(&app, address).await.map(Some);
        drop(clients[leaves].take());
        let [stays] = clients.into_iter().flatten().collect::<Vec<_>>().try_into().unwrap();
        answers.push((answer(stays).await, app.metrics.bounces.get()));
        let counts = app.answers.counts();
        assert_eq!((counts.hits.get(), counts.misses.get(), counts.joined.get()), (0, 1, 1));
    }
    // Both ran to the end, and neither began again.
    assert!(answers[0] == answers[1]);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn work_ends_when_both_clients_have_left() {
    let (app, address) = start().await;
    drop(joined(&app, address).await);
    until("the work ends", || app.pool.running().get() == 0).await;
    let counts = app.answers.counts();
    assert_eq!((counts.misses.get(), counts.joined.get(), counts.bytes.get()), (1, 1, 0));
}

/// The first client has many regions under way, and the second one waits for one of them, the last: it gets half of all blocks, not the
/// last place among those of the first.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn who_joins_does_not_wait_behind_the_other_work_of_the_first_client() {
    const OTHERS: usize = 6;
    let mut attempts = 0;
    let (app, address, [first, second], others) = loop {
        let (app, address) = start().await;
        let mut others = Vec::new();
        for number in 0..OTHERS {
            others.push(ask_for_another(address, CLIENTS[0], number).await);
            until("it is under way", || app.pool.running().get() == number as i64 + 1).await;
        }
        let first = ask(address, CLIENTS[0]).await;
        until("it is under way", || app.pool.running().get() == OTHERS as i64 + 1).await;
        let second = ask(address, CLIENTS[1]).await;
        let counts = app.answers.counts();
        let asked = || counts.joined.get() + counts.misses.get() == OTHERS as u64 + 2;
        until("the second client asks", asked).await;
        if counts.joined.get() == 1 {
            break (app, address, [first, second], others);
        }
        // Its worker had not begun yet, and others join only then.
        attempts += 1;
        assert!(attempts < 10, "the second client never joins");
    };
    let (begun, first, second) = (app.metrics.bounces.get(), answer(first), answer(second));
    let (first, second) = tokio::join!(first, second);
    let until_joined = app.metrics.bounces.get() - begun;
    assert!(first == second);
    drop(others);
    until("the others end", || app.pool.running().get() == 0).await;
    let alone = app.metrics.bounces.get();
    answer(ask_for_another(address, CLIENTS[1], OTHERS).await).await;
    let alone = app.metrics.bounces.get() - alone;
    // In its turn among seven the joined region would end with the others, after six times as many bounces.
    assert!(until_joined < 4 * alone, "{until_joined} bounces until it was done, {alone} of its own");
}
