//! Who may ask, and under which address: the token, origins, request ids, and a proxy in front.

mod support;

use std::net::SocketAddr;

use axum::http::Method;
use clap::Parser;
use equipoise::config::Config;
use serde_json::json;
use support::socket::{open, refused, start_with, try_open};
use support::{Answer, Server};
use tokio::io::{AsyncReadExt, AsyncWriteExt, copy_bidirectional};
use tokio::net::{TcpListener, TcpStream};

const TOKEN: &str = "0123456789abcdef0123456789abcdef";

fn config(arguments: &[&str]) -> Config {
    Config::parse_from([&["equipoise"], arguments].concat())
}

fn guarded() -> Config {
    config(&["--token", TOKEN])
}

#[tokio::test]
async fn without_the_token_there_is_health_and_nothing_else() {
    let server = Server::with(&guarded());
    for target in
        ["/", "/style.css", "/v1/scenes", "/v1/stability?preset=case-1", "/v1/live?preset=case-1", "/metrics", "/none"]
    {
        let answer = server.get(target).await.expect(401);
        assert_eq!(answer.header("www-authenticate"), Some("Bearer realm=\"equipoise\""), "{target}");
    }
    server.post("/v1/stability", &json!({"preset": "case-1"})).await.expect(401);
    for target in ["/health/live", "/health/ready"] {
        server.get(target).await.expect(200);
    }
    for wrong in [&TOKEN[1..], "", "0123456789abcdef0123456789abcdeF"] {
        let header = format!("Bearer {wrong}");
        server.get_with("/v1/scenes", &[("authorization", &header)]).await.expect(401);
        server.get(&format!("/?token={wrong}")).await.expect(401);
    }
    // Only the page takes it from an address.
    server.get(&format!("/v1/scenes?token={TOKEN}")).await.expect(401);
    let header = format!("Bearer {TOKEN}");
    for target in ["/", "/v1/stability?preset=case-1", "/metrics"] {
        server.get_with(target, &[("authorization", &header)]).await.expect(200);
    }
}

#[tokio::test]
async fn a_browser_is_given_a_cookie_once_and_loses_nothing_of_the_address() {
    let server = Server::with(&guarded());
    let answer = server.get(&format!("/?preset=case-2&token={TOKEN}&table.tilt_gain=1.2")).await.expect(303);
    assert_eq!(answer.header("location"), Some("./?preset=case-2&table.tilt_gain=1.2"));
    assert_eq!(answer.header("cache-control"), Some("no-store"));
    let (cookie, rest) = answer.header("set-cookie").unwrap().split_once(';').unwrap();
    assert_eq!(rest, " HttpOnly; SameSite=Lax");
    for target in ["/?preset=case-2", "/v1/stability?preset=case-1&format=svg"] {
        server.get_with(target, &[("cookie", cookie)]).await.expect(200);
    }
}

#[tokio::test]
async fn a_live_run_asks_for_the_token_too() {
    let (_, address) = start_with(&guarded()).await;
    assert_eq!(refused(address, "/v1/live?preset=case-1", &[]).await["status"], 401);
    let bearer = format!("Bearer {TOKEN}");
    let cookie = format!("equipoise_token={TOKEN}");
    let offered = format!("equipoise.v1, equipoise.token.{TOKEN}");
    for (name, value) in [("authorization", &bearer), ("cookie", &cookie), ("sec-websocket-protocol", &offered)] {
        let (mut client, protocol) = try_open(address, "/v1/live?preset=case-1", &[(name, value)]).await.unwrap();
        assert_eq!(client.next().await["type"], "hello", "{name}");
        // The secret is not echoed.
        assert_eq!(protocol.is_some(), name == "sec-websocket-protocol");
        assert!(!protocol.unwrap_or_default().contains(TOKEN));
    }
}

/// An answer, whatever the contract says about it.
async fn ask(config: &Config, method: Method, target: &str, headers: &[(&str, &str)]) -> Answer {
    Server::with(config).send_unheld(method, target, headers, "").await
}

#[tokio::test]
async fn pages_of_allowed_origins_may_ask_and_no_others() {
    let config =
        config(&["--allow-origin", "https://lab.example", "--allow-origin", "http://10.0.0.2:3000", "--token", TOKEN]);
    let preflight = [
        ("origin", "https://lab.example"),
        ("access-control-request-method", "POST"),
        ("access-control-request-headers", "authorization,content-type"),
    ];
    // A browser asks whether it may without the token.
    let answer = ask(&config, Method::OPTIONS, "/v1/trajectories", &preflight).await.expect(200);
    assert_eq!(answer.header("access-control-allow-origin"), Some("https://lab.example"));
    assert!(answer.header("access-control-allow-methods").unwrap().contains("POST"));
    assert!(answer.header("access-control-allow-headers").unwrap().contains("authorization"));
    let bearer = format!("Bearer {TOKEN}");
    for (origin, is_allowed) in
        [("https://lab.example", true), ("http://10.0.0.2:3000", true), ("https://else.example", false)]
    {
        for (status, headers) in
            [(401, vec![("origin", origin)]), (200, vec![("origin", origin), ("authorization", &bearer)])]
        {
            let answer = ask(&config, Method::GET, "/v1/scenes", &headers).await.expect(status);
            assert_eq!(answer.header("access-control-allow-origin"), is_allowed.then_some(origin), "{origin} {status}");
            assert_eq!(answer.header("access-control-allow-credentials"), None);
            let varies: Vec<_> = answer.headers.get_all("vary").iter().map(|value| value.to_str().unwrap()).collect();
            assert!(varies.join(",").to_lowercase().contains("origin"), "{varies:?}");
        }
    }
}

#[tokio::test]
async fn without_a_list_no_other_origin_may() {
    let answer =
        ask(&Config::default(), Method::GET, "/v1/scenes", &[("origin", "https://lab.example")]).await.expect(200);
    assert_eq!(answer.header("access-control-allow-origin"), None);
    let method = [("origin", "https://lab.example"), ("access-control-request-method", "POST")];
    ask(&Config::default(), Method::OPTIONS, "/v1/scenes", &method).await.expect(405);
}

#[tokio::test]
async fn live_runs_keep_to_the_same_list() {
    let (_, address) = start_with(&config(&["--allow-origin", "https://lab.example"])).await;
    let url = "/v1/live?preset=case-1";
    assert!(try_open(address, url, &[("origin", "https://lab.example")]).await.is_ok());
    assert_eq!(refused(address, url, &[("origin", "https://else.example")]).await["status"], 403);
}

#[tokio::test]
async fn a_request_has_an_id_which_its_problem_says() {
    let server = Server::start();
    let problem = server.get_with("/v1/stability?preset=none", &[("x-request-id", "lab-7")]).await.expect(422);
    assert_eq!((problem.header("x-request-id"), &problem.json()["request_id"]), (Some("lab-7"), &json!("lab-7")));
    let ids = [server.get("/none").await, server.get("/none").await].map(|answer| answer.json()["request_id"].clone());
    assert_ne!(ids[0], ids[1]);
    let hostile = server.get_with("/none", &[("x-request-id", "a\" b")]).await;
    assert_ne!(hostile.json()["request_id"], "a\" b");
}

#[tokio::test]
async fn a_base_path_is_taken_with_and_without_and_stands_in_every_link() {
    let server = Server::with(&config(&["--base-path", "/lab/rig"]));
    let plain = server.get("/v1/stability?preset=case-1").await.expect(200);
    let under =
        ask(&config(&["--base-path", "/lab/rig"]), Method::GET, "/lab/rig/v1/stability?preset=case-1", &[]).await;
    assert_eq!((&under.body, under.etag()), (&plain.body, plain.etag()));
    for target in ["/lab/rig", "/lab/rig?preset=case-2"] {
        let answer = ask(&config(&["--base-path", "/lab/rig"]), Method::GET, target, &[]).await.expect(308);
        assert_eq!(answer.header("location").unwrap(), target.replace("/rig", "/rig/"));
    }
    ask(&config(&["--base-path", "/lab/rig"]), Method::GET, "/lab/rigs/v1/scenes", &[]).await.expect(404);
    let problem = server.get("/v1/stability?preset=none").await.expect(422);
    assert_eq!(problem.json()["type"], "/lab/rig/docs#problem-invalid-request");
    let slash = server.get("/docs/").await;
    assert_eq!((slash.status.as_u16(), slash.header("location")), (308, Some("../docs")));
}

/// A proxy that shows a server under a prefix, which it takes away. One request for each connection.
async fn proxy(prefix: &'static str, server: SocketAddr) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        while let Ok((mut client, _)) = listener.accept().await {
            tokio::spawn(async move {
                let mut head = Vec::new();
                while !head.windows(4).any(|window| window == b"\r\n\r\n") {
                    if client.read_buf(&mut head).await.unwrap_or_default() == 0 {
                        return;
                    }
                }
                let head = String::from_utf8(head).unwrap().replacen(&format!("{prefix}/"), "/", 1);
                let mut upstream = TcpStream::connect(server).await.unwrap();
                upstream.write_all(head.as_bytes()).await.unwrap();
                let _ = copy_bidirectional(&mut client, &mut upstream).await;
            });
        }
    });
    address
}

async fn get(address: SocketAddr, target: &str) -> String {
    let mut socket = TcpStream::connect(address).await.unwrap();
    let request = format!("GET {target} HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n\r\n");
    socket.write_all(request.as_bytes()).await.unwrap();
    let mut answer = String::new();
    socket.read_to_string(&mut answer).await.unwrap();
    answer
}

#[tokio::test]
async fn behind_a_proxy_that_strips_a_prefix_every_address_leads_back() {
    let (_, server) = start_with(&config(&["--base-path", "/rig", "--token", TOKEN])).await;
    let address = proxy("/rig", server).await;
    let welcome = get(address, &format!("/rig/?token={TOKEN}")).await;
    // Relative to where the browser is: under the prefix, as is the cookie without a path.
    assert!(welcome.contains("\r\nlocation: ./\r\n") && !welcome.to_lowercase().contains("; path="), "{welcome}");
    let offered = format!("equipoise.v1, equipoise.token.{TOKEN}");
    let offered = [("sec-websocket-protocol", offered.as_str())];
    let (mut client, _) = try_open(address, "/rig/v1/live?preset=case-1&speed=10", &offered).await.unwrap();
    let hello = client.next().await;
    assert!(hello["url"].as_str().unwrap().starts_with("/rig/v1/live?"), "{hello}");
    let ack = client.ask(json!({"type": "pause"})).await;
    let (mut again, _) = try_open(address, ack["url"].as_str().unwrap(), &offered).await.unwrap();
    assert_eq!(again.next().await["paused"], true);
}

#[tokio::test]
async fn without_a_base_path_the_run_is_at_the_root() {
    let (_, address) = start_with(&Config::default()).await;
    let hello = open(address, "/v1/live?preset=case-1").await.next().await;
    assert!(hello["url"].as_str().unwrap().starts_with("/v1/live?"));
}
