//! Access: the token and the page that asks a person for it, origins, host names, request ids, and a proxy in front.

use std::net::SocketAddr;

use axum::http::Method;
use clap::Parser;
use equipoise::config::Config;
use serde_json::json;
use tokio::io::{AsyncReadExt, AsyncWriteExt, copy_bidirectional};
use tokio::net::{TcpListener, TcpStream};

use crate::support::socket::{open, refused, start, start_with, try_open};
use crate::support::{Answer, Server};

pub(crate) const TOKEN: &str = "0123456789abcdef0123456789abcdef";

fn config(arguments: &[&str]) -> Config {
    Config::parse_from([&["equipoise"], arguments].concat())
}

pub(crate) fn guarded() -> Config {
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
    // Only the page accepts the token in its URL.
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
    // The cookie is derived from the token, equally on every server, and does not reveal it.
    assert!(!cookie.contains(TOKEN) && cookie.len() == "equipoise_token=".len() + 64, "{cookie}");
    let again = Server::with(&guarded()).get(&format!("/?%74oken=%30{}", &TOKEN[1..])).await.expect(303);
    assert_eq!(again.header("location"), Some("./"));
    assert_eq!(again.header("set-cookie").unwrap().split_once(';').unwrap().0, cookie);
    let other = Server::with(&config(&["--token", &TOKEN.replace('0', "1")]));
    other.get_with("/v1/scenes", &[("cookie", cookie)]).await.expect(401);
    server.get_with("/v1/scenes", &[("cookie", &format!("equipoise_token={TOKEN}"))]).await.expect(401);
    for target in ["/?preset=case-2", "/v1/stability?preset=case-1&format=svg"] {
        server.get_with(target, &[("cookie", cookie)]).await.expect(200);
    }
}

#[tokio::test]
async fn a_live_run_asks_for_the_token_too() {
    let (_, address) = start_with(&guarded()).await;
    assert_eq!(refused(address, "/v1/live?preset=case-1", &[]).await["status"], 401);
    let bearer = format!("Bearer {TOKEN}");
    let welcome = get(address, &format!("/?token={TOKEN}")).await;
    let cookie =
        welcome.lines().find_map(|line| line.strip_prefix("set-cookie: ")?.split(';').next()).unwrap().to_owned();
    let itself = format!("equipoise_token={TOKEN}");
    assert_eq!(refused(address, "/v1/live?preset=case-1", &[("cookie", &itself)]).await["status"], 401);
    let offered = format!("equipoise.v1, equipoise.token.{TOKEN}");
    for (name, value) in [("authorization", &bearer), ("cookie", &cookie), ("sec-websocket-protocol", &offered)] {
        let (mut client, protocol) = try_open(address, "/v1/live?preset=case-1", &[(name, value)]).await.unwrap();
        assert_eq!(client.next().await["type"], "hello", "{name}");
        // The error does not repeat the token.
        assert_eq!(protocol.is_some(), name == "sec-websocket-protocol");
        assert!(!protocol.unwrap_or_default().contains(TOKEN));
    }
}

/// An answer that is not held to the contract.
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
    // A browser sends the preflight request without the token.
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
async fn pages_of_every_port_may_ask_where_that_is_allowed() {
    let config = config(&["--allow-origin", "http://localhost:*,https://lab.example"]);
    for (origin, is_allowed) in [
        ("http://localhost", true),
        ("http://localhost:8888", true),
        ("https://localhost:8888", false),
        ("http://localhost.evil.example:80", false),
        ("https://lab.example", true),
        ("https://lab.example:8443", false),
    ] {
        let allowed = is_allowed.then_some(origin);
        let preflight = [("origin", origin), ("access-control-request-method", "POST")];
        let answer = ask(&config, Method::OPTIONS, "/v1/trajectories", &preflight).await.expect(200);
        assert_eq!(answer.header("access-control-allow-origin"), allowed, "{origin}");
        let work = [("origin", origin), ("sec-fetch-site", "cross-site")];
        let answer = ask(&config, Method::GET, "/v1/stability?preset=case-1", &work).await;
        assert_eq!(answer.status, if is_allowed { 200 } else { 403 }, "{origin}");
        assert_eq!(answer.header("access-control-allow-origin"), allowed, "{origin}");
    }
    let refused = Config::try_parse_from(["equipoise", "--allow-origin", "https://*.lab.example"]).unwrap_err();
    assert!(refused.to_string().contains("`*` may stand only for the whole port"), "{refused}");
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

/// The status of an answer over a socket, and its body.
async fn told(address: SocketAddr, request: &str, headers: &[&str]) -> (u16, String) {
    let mut socket = TcpStream::connect(address).await.unwrap();
    let headers: String = headers.iter().map(|header| format!("{header}\r\n")).collect();
    socket.write_all(format!("{request} HTTP/1.1\r\n{headers}connection: close\r\n\r\n").as_bytes()).await.unwrap();
    let mut answer = String::new();
    socket.read_to_string(&mut answer).await.unwrap();
    let (head, body) = answer.split_once("\r\n\r\n").unwrap();
    (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
}

/// DNS rebinding: a page of another site points its own name at this machine. To the browser it has the same origin, yet it reads
/// nothing.
#[tokio::test]
async fn a_name_that_is_not_the_servers_is_not_answered_to() {
    let (app, address) = start().await;
    let port = address.port();
    let own = ["localhost", "a.localhost", "127.0.0.1", "[::1]", "192.0.2.7"];
    for host in own {
        assert_eq!(told(address, "GET /v1/scenes", &[&format!("host: {host}:{port}")]).await.0, 200, "{host}");
    }
    let post = ["content-type: application/json", "content-length: 0"];
    for host in ["evil.example", "localhost.evil.example", "rig.lab", "127.0.0.1.nip.io", "rig"] {
        let named = format!("host: {host}:{port}");
        // Headers of a browser in that case: same origin, same site.
        let origin = format!("origin: http://{host}:{port}");
        for (request, more) in [
            ("GET /", &[][..]),
            ("GET /health/live", &[]),
            ("GET /v1/stability?preset=case-1", &["sec-fetch-site: same-origin"]),
            ("GET /v1/live/events?preset=case-1", &[&origin]),
            ("POST /v1/stability", &post),
            ("OPTIONS /v1/stability", &[]),
        ] {
            let (status, body) = told(address, request, &[&[named.as_str()], more].concat()).await;
            assert_eq!(status, 421, "{host}: {request}: {body}");
            assert!(body.contains("--allow-host") && body.contains("Misdirected Request"), "{body}");
        }
        let own = format!("http://{host}:{port}");
        let headers = [("host", named.strip_prefix("host: ").unwrap()), ("origin", &own)];
        assert_eq!(refused(address, "/v1/live?preset=case-1", &headers).await["status"], 421);
    }
    assert_eq!(told(address, "GET http://evil.example/v1/scenes", &["host: localhost"]).await.0, 421);
    assert_eq!(app.metrics.live_sessions.get(), 0);
}

#[tokio::test]
async fn names_that_are_allowed_are_answered_to() {
    let status = async |arguments: &[&str], host: &str| {
        let (_, address) = start_with(&config(arguments)).await;
        told(address, "GET /health/live", &[&format!("host: {host}")]).await.0
    };
    let allowed = ["--allow-host", "rig.lab.example,rig"];
    for (host, expected) in [("rig.lab.example", 200), ("RIG.", 200), ("localhost", 200), ("lab.example", 421)] {
        assert_eq!(status(&allowed, host).await, expected, "{host}");
        assert_eq!(status(&[&allowed[..], &["--listen", "0.0.0.0:80"]].concat(), host).await, expected, "{host}");
        // With a token, such a page has neither token nor cookie. On a network, a server has many names.
        assert_eq!(status(&["--token", TOKEN], host).await, 200, "{host}");
        assert_eq!(status(&["--listen", "0.0.0.0:80"], host).await, 200, "{host}");
    }
}

#[tokio::test]
async fn a_page_of_another_site_sets_no_server_to_work() {
    let (_, closed) = start_with(&config(&["--allow-origin", "https://lab.example"])).await;
    let (_, open) = start_with(&config(&["--allow-embedding"])).await;
    let picture = "GET /v1/stability?preset=case-1&format=svg";
    let cross = ["host: localhost", "sec-fetch-site: cross-site"];
    let status = async |address, request: &str, more: &[&str]| {
        let json = ["content-type: application/json", "content-length: 19"];
        let json = if request.starts_with("POST") { &json[..] } else { &[] };
        // The body of a refused request is not read.
        let body = if request.starts_with("POST") { "{\"preset\":\"case-1\"}" } else { "" };
        let mut socket = TcpStream::connect(address).await.unwrap();
        let headers: String = [&cross, json, more].concat().iter().map(|header| format!("{header}\r\n")).collect();
        let whole = format!("{request} HTTP/1.1\r\n{headers}connection: close\r\n\r\n{body}");
        socket.write_all(whole.as_bytes()).await.unwrap();
        let mut answer = [0; 12];
        socket.read_exact(&mut answer).await.unwrap();
        std::str::from_utf8(&answer[9..]).unwrap().parse::<u16>().unwrap()
    };
    for request in [
        picture,
        "HEAD /v1/stability?preset=case-1",
        "GET /v1/live/events?preset=case-1",
        "GET /v1/regions?preset=case-1",
        "GET /v1/failures",
        "POST /v1/stability",
        "POST /v1/batches/stability",
    ] {
        assert_eq!(status(closed, request, &[]).await, 403, "{request}");
        assert_eq!(status(closed, request, &["origin: https://else.example"]).await, 403, "{request}");
        assert_eq!(status(open, request, &["sec-fetch-mode: cors", "sec-fetch-dest: empty"]).await, 403, "{request}");
        let allowed = status(closed, request, &["origin: https://lab.example"]).await;
        assert!(![403, 421].contains(&allowed), "{request}: {allowed}");
    }
    let headers = [("sec-fetch-site", "cross-site"), ("host", "localhost")];
    assert_eq!(refused(closed, "/v1/live?preset=case-1", &headers).await["status"], 403);
    // Links that a person follows pass; prefetched ones do not.
    let visit = ["sec-fetch-mode: navigate", "sec-fetch-dest: document", "sec-fetch-user: ?1"];
    assert_eq!(status(closed, picture, &visit).await, 200);
    assert_eq!(status(closed, picture, &[&visit[..], &["sec-purpose: prefetch"]].concat()).await, 403);
    assert_eq!(status(closed, "POST /v1/stability", &visit).await, 403);
    // Pictures and panels embedded in another site's page.
    for (request, destination) in [(picture, "image"), ("GET /embed/map?preset=case-1", "iframe")] {
        let shown = [format!("sec-fetch-dest: {destination}")];
        let shown = [shown[0].as_str(), "sec-fetch-mode: no-cors"];
        assert_eq!(status(closed, request, &shown).await, 403, "{request}");
        assert_eq!(status(open, request, &shown).await, 200, "{request}");
    }
    // Resources that cost nothing, and clients that are not pages of another site.
    for request in ["GET /", "GET /docs", "GET /v1/scenes", "GET /v1/fields", "GET /embed/map", "GET /openapi.json"] {
        assert_eq!(status(closed, request, &[]).await, 200, "{request}");
    }
    for site in ["same-origin", "same-site", "none"] {
        let said = format!("sec-fetch-site: {site}");
        assert_eq!(told(closed, picture, &["host: localhost", &said]).await.0, 200, "{site}");
    }
    // A browser sends a preflight request, which is marked as cross-site too.
    let preflight = ["origin: https://lab.example", "access-control-request-method: POST"];
    assert_eq!(status(closed, "OPTIONS /v1/stability", &preflight).await, 200);
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

/// A proxy that serves a server under a prefix, which it strips. One request per connection.
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
    exchange(address, &format!("GET {target} HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n\r\n")).await
}

async fn exchange(address: SocketAddr, request: &str) -> String {
    let mut socket = TcpStream::connect(address).await.unwrap();
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
    // The redirect is relative to the browser's address, so it stays under the prefix, as does the cookie without a path.
    assert!(welcome.contains("\r\nlocation: ./\r\n") && !welcome.to_lowercase().contains("; path="), "{welcome}");
    let body = format!("token={TOKEN}&address=embed/map?preset=case-1");
    let length = body.len();
    let form = format!(
        "POST /rig/sign-in HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\ncontent-type: {}\r\ncontent-length: {length}\r\n\r\n{body}",
        "application/x-www-form-urlencoded"
    );
    let back = exchange(address, &form).await;
    assert!(back.contains("\r\nlocation: ./embed/map?preset=case-1\r\n") && !back.contains("; path="), "{back}");
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

// The page that asks a person for the token, and its form.

/// `Accept` of a browser for an address that somebody opens.
const VISIT: (&str, &str) = ("accept", "text/html,application/xhtml+xml,application/xml;q=0.9,*/*;q=0.8");
const FORM: (&str, &str) = ("content-type", "application/x-www-form-urlencoded");

#[tokio::test]
async fn a_person_is_asked_for_the_token_and_a_program_is_told() {
    let server = Server::with(&guarded());
    for (target, action, address) in [
        ("/", "./sign-in", ""),
        ("/?preset=case-2&x=%22%3E%3Cscript%3E", "./sign-in", "?preset=case-2&amp;x=%22%3E%3Cscript%3E"),
        ("/docs", "./sign-in", "docs"),
        ("/embed/map?preset=case-1", "../sign-in", "embed/map?preset=case-1"),
        ("/v1/stability?preset=case-1&format=svg", "../sign-in", "v1/stability?preset=case-1&amp;format=svg"),
        ("/sign-in", "./sign-in", ""),
    ] {
        let page = server.get_with(target, &[VISIT]).await.expect(401);
        assert_eq!(page.media_type(), "text/html", "{target}");
        assert_eq!(page.header("cache-control"), Some("no-store"), "{target}");
        assert_eq!(page.header("www-authenticate"), Some("Bearer realm=\"equipoise\""), "{target}");
        let framed = page.header("content-security-policy").unwrap().contains("frame-ancestors *");
        assert_eq!(framed, target.starts_with("/embed/"), "{target}");
        assert!(page.text().contains(&format!("<form method=\"post\" action=\"{action}\">")), "{}", page.text());
        let hidden = format!("name=\"address\" value=\"{address}\"");
        assert!(page.text().contains(&hidden) && !page.text().contains("not the token"), "{}", page.text());
        for program in [&[][..], &[("accept", "*/*")], &[("accept", "application/json")]] {
            let answer = server.get_with(target, program).await.expect(401);
            assert_eq!(answer.media_type(), "application/problem+json", "{target}");
        }
    }
    let wrong = server.get_with("/?preset=case-2&token=0123456789abcdef", &[VISIT]).await.expect(401);
    assert!(
        wrong.text().contains("not the token") && wrong.text().contains("value=\"?preset=case-2\""),
        "{}",
        wrong.text()
    );
    assert!(!wrong.text().contains("0123456789abcdef"));
}

#[tokio::test]
async fn the_form_leads_back_to_the_address_and_nowhere_else() {
    let server = Server::with(&guarded());
    let send = async |token: &str, address: &str| {
        let form = form_urlencoded::Serializer::new(String::new())
            .append_pair("address", address)
            .append_pair("token", token)
            .finish();
        server.send(Method::POST, "/sign-in", &[FORM], &form).await
    };
    for (address, location) in [
        ("", "./"),
        ("?preset=case-2&scene.table.tilt_gain=1.2", "./?preset=case-2&scene.table.tilt_gain=1.2"),
        ("embed/map?preset=case-1", "./embed/map?preset=case-1"),
        ("//elsewhere.example/", "./elsewhere.example/"),
        ("https://elsewhere.example/", "./https://elsewhere.example/"),
        ("\\\\elsewhere.example", "./"),
        ("a\r\nx: y", "./"),
        ("\u{e9}", "./"),
    ] {
        let answer = send(&format!(" {TOKEN} "), address).await.expect(303);
        assert_eq!(answer.header("location"), Some(location), "{address:?}");
        let cookie = answer.header("set-cookie").unwrap().split_once(';').unwrap().0;
        server.get_with("/v1/scenes", &[("cookie", cookie)]).await.expect(200);
    }
    let wrong = send(&TOKEN[1..], "docs").await.expect(401);
    assert!(wrong.header("set-cookie").is_none() && !wrong.text().contains(&TOKEN[1..]));
    assert!(wrong.text().contains("not the token") && wrong.text().contains("value=\"docs\""), "{}", wrong.text());
    // A form is read within the limits of every body, and only as a form.
    server.send(Method::POST, "/sign-in", &[("content-type", "application/json")], "{}").await.expect(415);
    server.send(Method::POST, "/sign-in", &[FORM], &"x".repeat(300_000)).await.expect(413);
    Server::start().send(Method::POST, "/sign-in", &[FORM], "").await.expect(404);
}

#[tokio::test]
async fn a_frame_of_another_site_is_not_asked_for_a_token_that_the_browser_would_not_keep() {
    let server = Server::with(&guarded());
    let frame = [VISIT, ("sec-fetch-site", "cross-site"), ("sec-fetch-dest", "iframe")];
    let page = server.get_with("/embed/map?preset=case-1", &frame).await.expect(401);
    assert!(
        !page.text().contains("<form") && page.text().contains("href=\"../embed/map?preset=case-1\""),
        "{}",
        page.text()
    );
    let own = [VISIT, ("sec-fetch-site", "same-origin"), ("sec-fetch-dest", "iframe")];
    assert!(server.get_with("/embed/map", &own).await.expect(401).text().contains("<form"));
}
