//! The program: its first lines, its behaviour under overload, and its shutdown.
//!
//! Order, counts and content are asserted, never speed.

mod support;

use std::io::{BufRead, BufReader, Read};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use support::socket::{SOON, open};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

/// A running program; killed when dropped.
struct Program {
    child: Child,
    address: SocketAddr,
    /// The line about access in its output.
    openness: String,
}

impl Program {
    fn start(arguments: &[&str]) -> Self {
        Self::start_at("127.0.0.1:0", arguments)
    }

    /// With a resource limit, as `ulimit` takes it.
    fn start_within(limit: &str, arguments: &[&str]) -> Self {
        let script = format!("ulimit {limit} && exec \"$0\" \"$@\"");
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_equipoise")]);
        Self::start_as(command, "127.0.0.1:0", arguments)
    }

    fn start_at(listen: &str, arguments: &[&str]) -> Self {
        Self::start_as(Command::new(env!("CARGO_BIN_EXE_equipoise")), listen, arguments)
    }

    fn start_as(mut command: Command, listen: &str, arguments: &[&str]) -> Self {
        let mut child = command
            .args(["--listen", listen])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        let first = lines.next().expect("a line that says where it listens");
        let (_, url) = first.split_once(" serves http://").unwrap();
        let address = url.split('/').next().unwrap().parse().unwrap();
        Self { child, address, openness: lines.next().unwrap() }
    }

    /// Sends SIGTERM, as a service manager does.
    fn stop(&self) {
        let killed = Command::new("kill").args(["-TERM", &self.child.id().to_string()]).status().unwrap();
        assert!(killed.success());
    }

    /// Waits for the end; returns exit code and stderr.
    async fn end(mut self) -> (Option<i32>, String) {
        let ended = async {
            loop {
                if let Some(status) = self.child.try_wait().unwrap() {
                    return status.code();
                }
                sleep(Duration::from_millis(10)).await;
            }
        };
        let code = timeout(2 * SOON, ended).await.expect("the program does not end");
        let mut log = String::new();
        self.child.stderr.take().unwrap().read_to_string(&mut log).unwrap();
        (code, log)
    }

    async fn send(&self, target: &str, headers: &str) -> TcpStream {
        let mut socket = TcpStream::connect(self.address).await.unwrap();
        let request = format!("GET {target} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n{headers}\r\n");
        socket.write_all(request.as_bytes()).await.unwrap();
        socket
    }

    async fn get(&self, target: &str, headers: &str) -> String {
        whole(self.send(target, headers).await).await
    }

    async fn metric(&self, name: &str) -> f64 {
        let text = self.get("/metrics", "").await;
        let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        line.unwrap_or_else(|| panic!("no {name} in {text}")).parse().unwrap()
    }

    async fn until(&self, name: &str, value: f64) {
        let wait = async {
            while self.metric(name).await != value {
                sleep(Duration::from_millis(10)).await;
            }
        };
        timeout(SOON, wait).await.unwrap_or_else(|_| panic!("{name} does not become {value}"));
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// All bytes up to the end of a connection.
async fn whole(mut socket: TcpStream) -> String {
    let mut answer = Vec::new();
    timeout(2 * SOON, socket.read_to_end(&mut answer)).await.expect("the server is silent").unwrap();
    String::from_utf8_lossy(&answer).into_owned()
}

/// A request that takes seconds of work and has no entity tag.
const DEAR: &str = "/v1/regions?preset=case-1&x.field=table.tilt_gain&x.from=0.95&x.to=1.6&x.count=1000\
                    &y.field=release.theta&y.from=0&y.to=0.5&y.count=1000&bounces=2000";

#[tokio::test]
async fn it_says_what_is_open_to_whom() {
    let program = Program::start(&[]);
    assert_eq!(
        program.openness,
        "open to programs on this machine, and whatever a proxy on it lets through: no token is asked for"
    );
    let token = "0123456789abcdef";
    let program = Program::start(&["--token", token, "--allow-origin", "https://lab.example"]);
    assert!(program.openness.contains("with the token") && program.openness.contains("https://lab.example"));
    assert!(!program.openness.contains(token));
}

#[test]
fn it_refuses_what_it_cannot_keep_to() {
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_equipoise")).args(arguments).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap() + &String::from_utf8(output.stdout).unwrap())
    };
    let (code, said) = run(&["--connections", "1"]);
    assert_eq!(code, Some(2));
    assert!(said.contains("'1' for '--connections <NUMBER>': it must be a whole number from 16 to"), "{said}");
    let (code, said) = run(&["--token", "short"]);
    assert!(code == Some(2) && said.contains("openssl rand -hex 16"), "{said}");
    let (code, help) = run(&["--help"]);
    assert_eq!(code, Some(0));
    let (code, said) = run(&["--allow-host", "http://rig.lab:8080"]);
    assert!(code == Some(2) && said.contains("without scheme and port"), "{said}");
    let (code, said) = run(&["--web", "nowhere"]);
    assert!(code == Some(2) && said.contains("no folder"), "{said}");
    let (code, said) = run(&["--access-log=maybe"]);
    assert!(code == Some(2) && said.contains("true or false, or 1 or 0"), "{said}");
    for word in ["--region-work <BOUNCES>", "EQUIPOISE_LIVE_SESSIONS", "[default: 16384]", "--trust-proxy"] {
        assert!(help.contains(word), "{word} is not in {help}");
    }
}

#[test]
fn an_error_names_the_variable_that_was_set() {
    let run = |variable: &str, value: &str, arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_equipoise"));
        let output = command.env(variable, value).args(arguments).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    for (variable, value, why) in [
        ("EQUIPOISE_CONNECTIONS", "1", "a whole number from 16 to"),
        ("EQUIPOISE_ACCESS_LOG", "maybe", "true or false, or 1 or 0"),
        ("EQUIPOISE_WEB", "nowhere", "no folder"),
        ("EQUIPOISE_LOG_FORMAT", "xml", "text, json"),
        ("RUST_LOG", "a=b=c", "RUST_LOG=a=b=c"),
    ] {
        let (code, said) = run(variable, value, &[]);
        assert!(code == Some(2) && said.contains(variable) && said.contains(why), "{code:?} {said}");
        assert!(!said.contains("for '--"), "{said}");
    }
    let (code, said) = run("EQUIPOISE_TOKEN", "short", &[]);
    assert!(code == Some(2) && said.contains("EQUIPOISE_TOKEN") && !said.contains("short"), "{said}");
    // The flag outranks the variable.
    let (code, said) = run("EQUIPOISE_CONNECTIONS", "1", &["--connections", "2"]);
    assert!(code == Some(2) && said.contains("--connections") && !said.contains("EQUIPOISE_"), "{said}");
}

#[test]
fn the_first_lines_follow_the_form_of_the_log() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_equipoise"))
        .args(["--listen", "127.0.0.1:0"])
        .envs([("EQUIPOISE_LOG_FORMAT", "json"), ("EQUIPOISE_ACCESS_LOG", "1")])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let first = BufReader::new(child.stdout.take().unwrap()).lines().next().unwrap().unwrap();
    let line: Value = serde_json::from_str(&first).unwrap();
    let address = line["url"].as_str().unwrap().trim_start_matches("http://").trim_end_matches('/').to_owned();
    assert!(line["build"].is_string() && line["access"].as_str().unwrap().starts_with("open to"), "{first}");
    // The address is taken, and the error has the form of the log.
    let output = Command::new(env!("CARGO_BIN_EXE_equipoise"))
        .args(["--listen", &address, "--log-format", "json"])
        .output()
        .unwrap();
    let said: Value = serde_json::from_slice(&output.stderr).unwrap();
    assert!(said["message"].as_str().unwrap().contains("taken by another program"), "{said}");
    assert_eq!(output.status.code(), Some(1));
    child.kill().unwrap();
    child.wait().unwrap();
}

#[tokio::test]
async fn each_request_is_a_line_of_the_log_and_no_line_has_the_token() {
    let token = "0123456789abcdef";
    let program = Program::start(&["--access-log", "--token", token, "--trust-proxy", "127.0.0.1"]);
    let bearer = format!("authorization: Bearer {token}\r\n");
    program
        .get("/v1/scenes?a=%22%0a", &format!("{bearer}x-request-id: lab-1\r\nx-forwarded-for: 10.0.0.9, 192.0.2.7\r\n"))
        .await;
    program.get(&format!("/?preset=case-1&token={token}"), "").await;
    program.get("/none", &bearer).await;
    program.get(&format!("/?a=1&%74oken={token}&b=2"), "").await;
    program.get(&format!("/v1/scenes?TOK%65N%3d{token}"), &bearer).await;
    program.stop();
    let (_, log) = program.end().await;
    assert!(!log.contains(token), "{log}");
    let lines: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let told: Vec<_> =
        lines.iter().map(|line| (line["target"].as_str().unwrap(), line["status"].as_u64().unwrap())).collect();
    assert_eq!(
        told,
        [
            ("/v1/scenes?a=%22%0a", 422),
            ("/?preset=case-1&token=", 303),
            ("/none", 404),
            ("/?a=1&%74oken=", 303),
            ("/v1/scenes?TOK%65N%3d", 422),
        ]
    );
    assert_eq!((lines[0]["id"].as_str(), lines[0]["peer"].as_str()), (Some("lab-1"), Some("192.0.2.7")));
    assert_eq!((lines[1]["peer"].as_str(), lines[1]["method"].as_str()), (Some("127.0.0.1"), Some("GET")));
    assert!(lines[0]["ms"].as_f64().unwrap() > 0.0);
}

/// Another IPv6 address of the same /64 network is not the trusted proxy, as with IPv4.
#[tokio::test]
async fn a_proxy_is_believed_by_its_whole_address() {
    let named = "x-forwarded-for: 192.0.2.7\r\n";
    let mut peers = Vec::new();
    for trusted in ["::2", "::1", "::/64"] {
        let program = Program::start_at("[::1]:0", &["--access-log", "--trust-proxy", trusted]);
        program.get("/health/live", named).await;
        program.stop();
        let (_, log) = program.end().await;
        let line: Value = serde_json::from_str(&log).unwrap();
        peers.push(line["peer"].as_str().unwrap().to_owned());
    }
    assert_eq!(peers, ["::", "192.0.2.7", "192.0.2.7"]);
}

/// The memory for answers follows the memory limit of the process, here an rlimit.
#[test]
fn answers_are_held_in_a_share_of_what_the_process_may_have() {
    let help = |limit: &str| {
        let script = format!("ulimit {limit} && exec \"$0\" --help");
        let output = Command::new("sh").args(["-c", &script, env!("CARGO_BIN_EXE_equipoise")]).output().unwrap();
        let help = String::from_utf8(output.stdout).unwrap();
        let (_, held) = help.split_once("--held-bytes").unwrap_or_else(|| panic!("{help}"));
        let (_, default) = held.split_once("[default:").unwrap();
        default.split_once(']').unwrap().0.trim().parse::<u64>().unwrap()
    };
    assert_eq!(help("-d 1048576"), 256 << 20);
    assert_eq!(help("-v 2097152"), 512 << 20);
    let without = help("-c 0");
    assert!((1 << 20..=1 << 30).contains(&without), "{without}");
}

/// A server of little memory computes fewer large answers at a time and refuses the others; it never runs out of memory.
#[tokio::test]
async fn large_answers_that_come_together_end_no_process() {
    for limit in ["-d 400000", "-v 1500000"] {
        let program = Program::start_within(limit, &["--permits", "8", "--queue-time", "1"]);
        let mut clients = Vec::new();
        for number in 0..17 {
            let target = format!("/v1/trajectories?preset=case-1&bounces=100000&scene.release.theta=0.01{number}");
            clients.push(program.send(&target, "").await);
        }
        // Nobody reads before all are computed or refused.
        let mut statuses = Vec::new();
        for client in &mut clients {
            let mut status = [0; 12];
            timeout(6 * SOON, client.read_exact(&mut status)).await.expect("an answer").unwrap();
            statuses.push(String::from_utf8_lossy(&status).into_owned());
        }
        assert!(
            statuses.iter().all(|status| ["HTTP/1.1 200", "HTTP/1.1 503"].contains(&status.as_str())),
            "{statuses:?}"
        );
        assert!(statuses.contains(&"HTTP/1.1 200".to_owned()), "{limit}: {statuses:?}");
        drop(clients);
        program.until("equipoise_jobs_running", 0.0).await;
    }
    // A request that would take more than all of it is never begun.
    let program = Program::start_within("-d 400000", &[]);
    let refused = program.get("/v1/ensembles?preset=case-1-noise&runs=20000&bounces=200&angles=true", "").await;
    assert!(
        refused.starts_with("HTTP/1.1 422") && refused.contains("the memory of this request would be "),
        "{refused}"
    );
}

/// Keeps no answers: each request needs a place in the queue, also one that was answered before.
const FORGETFUL: [&str; 2] = ["--answer-cache", "0"];

/// One client fills its whole share. Others are still served, and requests without a place get 503.
#[tokio::test]
async fn one_client_cannot_have_it_all() {
    let narrow = ["--permits", "1", "--queue", "4", "--trust-proxy", "127.0.0.1"];
    let program = Program::start(&[narrow.as_slice(), &FORGETFUL].concat());
    let of = |client: u8| format!("x-forwarded-for: 192.0.2.{client}\r\n");
    // One client gets 3 of 5 places.
    let mut held = Vec::new();
    for held_before in 0..3 {
        held.push(program.send(DEAR, &of(1)).await);
        program.until("equipoise_jobs_running", f64::from(held_before + 1)).await;
    }
    let refused = program.get(DEAR, &of(1)).await;
    assert!(refused.starts_with("HTTP/1.1 503") && refused.contains("retry-after: "), "{refused}");
    assert!(
        refused.contains("3 requests from this address are computed or waiting, and the last 2 places are for others")
    );
    let answered = program.get("/v1/stability?preset=case-1&bounces=2000", &of(2)).await;
    assert!(answered.starts_with("HTTP/1.1 200"), "{answered}");
    // Health and cheap requests need no place.
    assert!(program.get("/health/ready", &of(1)).await.starts_with("HTTP/1.1 200"));
    drop(held);
    program.until("equipoise_jobs_running", 0.0).await;
    assert!(program.get("/v1/stability?preset=case-1&bounces=2000", &of(1)).await.starts_with("HTTP/1.1 200"));
}

/// A client that does not read its answers gets no more of them; others do.
#[tokio::test]
async fn answers_that_nobody_reads_count() {
    let narrow = ["--held-bytes", "10000000", "--trust-proxy", "127.0.0.1"];
    let program = Program::start(&[narrow.as_slice(), &FORGETFUL].concat());
    let of = |client: u8| format!("x-forwarded-for: 192.0.2.{client}\r\n");
    let long = "/v1/trajectories?preset=case-1&bounces=30000";
    let short = "/v1/stability?preset=case-1&bounces=2000";
    let mut unread = program.send(long, &of(1)).await;
    unread.read_exact(&mut [0; 1024]).await.unwrap();
    let refused = program.get(short, &of(1)).await;
    assert!(refused.starts_with("HTTP/1.1 503") && refused.contains("still to be read from this address"), "{refused}");
    assert!(program.get(short, &of(2)).await.starts_with("HTTP/1.1 200"));
    drop(unread);
    let wait = async {
        while !program.get(short, &of(1)).await.starts_with("HTTP/1.1 200") {
            sleep(Duration::from_millis(10)).await;
        }
    };
    timeout(SOON, wait).await.expect("what nobody reads is held for ever");
}

/// Connections with half a head, half a body, silence after an answer, or a slow reader are closed.
#[tokio::test]
async fn who_keeps_the_server_waiting_is_let_go() {
    let times = ["--head-time", "1", "--body-time", "1", "--stall-time", "1"];
    let program = Program::start(&[times.as_slice(), &["--held-bytes", "10000000"], &FORGETFUL].concat());
    for (begin, end) in [
        ("GET / HT", ""),
        ("GET /health/live HTTP/1.1\r\nhost: localhost\r\n\r\n", "HTTP/1.1 200"),
        (
            "POST /v1/stability HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 9\r\n\r\n{",
            "HTTP/1.1 408",
        ),
    ] {
        let mut socket = TcpStream::connect(program.address).await.unwrap();
        socket.write_all(begin.as_bytes()).await.unwrap();
        let answer = whole(socket).await;
        assert!(answer.starts_with(end), "{begin}: {answer}");
    }
    let mut slow = program.send("/v1/trajectories?preset=case-1&bounces=30000", "").await;
    let drips = tokio::spawn(async move {
        while slow.read_exact(&mut [0; 64]).await.is_ok() {
            sleep(Duration::from_millis(50)).await;
        }
    });
    let short = "/v1/stability?preset=case-1&bounces=2000";
    let freed = async {
        while program.get(short, "").await.starts_with("HTTP/1.1 200") {
            sleep(Duration::from_millis(5)).await;
        }
        // From now on its answer counts, until it is cut off.
        while !program.get(short, "").await.starts_with("HTTP/1.1 200") {
            sleep(Duration::from_millis(50)).await;
        }
    };
    timeout(SOON, freed).await.expect("who takes a byte now and then is waited for");
    drips.abort();
}

/// More clients than connection slots send nothing, half a head, or half a body. A proper request is still answered.
#[tokio::test]
async fn silent_clients_keep_nobody_out() {
    let program = Program::start(&["--connections", "32"]);
    let mut silent = Vec::new();
    for index in 0..200 {
        let mut socket = TcpStream::connect(program.address).await.unwrap();
        let begin: &[u8] = match index % 3 {
            0 => b"",
            1 => b"GET /v1/scenes HTTP/1.1\r\nho",
            _ => b"POST /v1/stability HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 9\r\n\r\n{",
        };
        socket.write_all(begin).await.unwrap();
        silent.push(socket);
        if index % 20 == 0 {
            assert!(program.get("/v1/scenes", "").await.starts_with("HTTP/1.1 200"));
        }
    }
    // A connection whose answer is being computed keeps its slot.
    let computing = program.send(&DEAR.replace("=1000", "=300"), "").await;
    program.until("equipoise_jobs_running", 1.0).await;
    for _ in 0..100 {
        silent.push(TcpStream::connect(program.address).await.unwrap());
    }
    assert!(whole(computing).await.starts_with("HTTP/1.1 200"));
}

/// Shutdown while a client has read half an answer: the rest still comes, sockets are closed with 1001, no new client gets in, and the
/// exit code is 0.
#[tokio::test]
async fn it_ends_when_it_is_told_to_and_breaks_nothing_off() {
    let program = Program::start(&[]);
    let mut client = open(program.address, "/v1/live?preset=case-1").await;
    assert_eq!(client.next().await["type"], "hello");
    let target = "/v1/trajectories?preset=case-1&bounces=50000";
    let expected = program.get(target, "").await;
    let mut half = program.send(target, "").await;
    let mut begun = vec![0; 64 * 1024];
    half.read_exact(&mut begun).await.unwrap();
    let computing = program.send(&DEAR.replace("=1000", "=300"), "").await;
    program.until("equipoise_jobs_running", 1.0).await;
    let address = program.address;
    program.stop();
    assert_eq!(client.closed().await, Some(1001));
    timeout(SOON, async {
        while TcpStream::connect(address).await.is_ok() {
            sleep(Duration::from_millis(5)).await;
        }
    })
    .await
    .expect("it still lets clients in");
    let all = String::from_utf8(begun).unwrap() + &whole(half).await;
    let body = |answer: &str| answer.split_once("\r\n\r\n").unwrap().1.to_owned();
    assert!(body(&all) == body(&expected), "the answer under way was cut off");
    let computed = whole(computing).await;
    assert!(computed.starts_with("HTTP/1.1 200") && computed.ends_with('}'), "{computed:.300}");
    let (code, log) = program.end().await;
    assert_eq!((code, log.as_str()), (Some(0), ""));
}
