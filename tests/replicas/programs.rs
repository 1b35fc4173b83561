//! Replicas of the server, and the real nginx before them with `docs/deploy/nginx.conf`; clients that can tell a whole answer from a cut one, or
//! follow a live run over several connections.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::{Duration, Instant};
use std::{fmt, fs, io};

use serde_json::Value;
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader as AsyncBufReader};
use tokio::net::{TcpSocket, TcpStream};
use tokio::task::JoinHandle;
use tokio::time::{sleep, timeout};
use tokio_tungstenite::tungstenite::Error;

use crate::support::socket::{Row, SOON, held, impacts_in, try_open};

/// An empty folder for one test.
pub(crate) fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("replicas").join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// The lines of a JSON log.
fn lines(log: &Path) -> Vec<Value> {
    let text = fs::read_to_string(log).unwrap();
    // The last line may be incomplete.
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    whole.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|_| panic!("{line}"))).collect()
}

fn signal(name: &str, process: u32) {
    assert!(Command::new("kill").args([name, &process.to_string()]).status().unwrap().success());
}

/// Polls until a condition holds.
pub(crate) async fn until(what: &str, mut is_so: impl AsyncFnMut() -> bool) {
    let wait = async {
        while !is_so().await {
            sleep(Duration::from_millis(10)).await;
        }
    };
    timeout(6 * SOON, wait).await.unwrap_or_else(|_| panic!("it does not come to this: {what}"));
}

/// A replica; killed when dropped.
pub(crate) struct Replica {
    child: Child,
    pub(crate) address: SocketAddr,
    arguments: Vec<String>,
    log: PathBuf,
}

impl Replica {
    /// Starts a replica on a free port, with its access log in a folder.
    pub(crate) fn start(folder: &Path, name: &str, arguments: &[&str]) -> Self {
        let log = folder.join(name);
        let arguments: Vec<_> = arguments.iter().map(|&argument| argument.to_owned()).collect();
        let (child, address) = spawn("127.0.0.1:0", &arguments, &log);
        Self { child, address, arguments, log }
    }

    /// Sends SIGKILL, like a crash or the out-of-memory killer.
    pub(crate) fn kill(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    /// Sends SIGTERM, as a service manager does.
    pub(crate) fn stop(&self) {
        signal("-TERM", self.child.id());
    }

    /// Waits for its end; returns the exit code.
    pub(crate) async fn end(&mut self) -> Option<i32> {
        let mut status = None;
        until("the replica ends", async || {
            status = self.child.try_wait().unwrap();
            status.is_some()
        })
        .await;
        status.and_then(|status| status.code())
    }

    /// Starts it again at the same address.
    pub(crate) fn again(&mut self) {
        (self.child, self.address) = spawn(&self.address.to_string(), &self.arguments, &self.log);
    }

    /// A value of its metrics.
    pub(crate) async fn metric(&self, name: &str) -> f64 {
        let text = String::from_utf8(ask(self.address, &Ask::get("/metrics")).await.unwrap().body).unwrap();
        let line = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        line.unwrap_or_else(|| panic!("no {name} in {text}")).parse().unwrap()
    }

    /// The access log.
    pub(crate) fn log(&self) -> Vec<Value> {
        lines(&self.log)
    }
}

impl Drop for Replica {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn spawn(listen: &str, arguments: &[String], log: &Path) -> (Child, SocketAddr) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_equipoise"))
        .args(["--access-log", "--trust-proxy", "127.0.0.1", "--listen", listen])
        .args(arguments)
        .stdout(Stdio::piped())
        .stderr(OpenOptions::new().create(true).append(true).open(log).unwrap())
        .spawn()
        .unwrap();
    let mut first = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut first).unwrap();
    let (_, url) = first.split_once(" serves http://").expect("a line that says where it listens");
    (child, url.split('/').next().unwrap().parse().unwrap())
}

/// nginx before replicas; stopped when dropped.
pub(crate) struct Nginx {
    child: Child,
    pub(crate) address: SocketAddr,
    log: PathBuf,
}

impl Nginx {
    /// Path of nginx; `None` if it is not installed. Debian keeps it outside the PATH of users.
    pub(crate) fn program() -> Option<&'static str> {
        ["nginx", "/usr/sbin/nginx"].into_iter().find(|program| {
            Command::new(program).arg("-v").stderr(Stdio::null()).status().is_ok_and(|status| status.success())
        })
    }

    /// Starts nginx before replicas, with the shipped file as changed by `edit`.
    pub(crate) async fn start(
        program: &str,
        folder: &Path,
        replicas: &[&Replica],
        edit: impl FnOnce(String) -> String,
    ) -> Self {
        // A port that was free a moment ago.
        let address = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let addresses: Vec<_> = replicas.iter().map(|replica| replica.address).collect();
        let file = folder.join("nginx.conf");
        fs::write(&file, edit(filled_in(folder, address, &addresses))).unwrap();
        let child = Command::new(program)
            .args(["-p".as_ref(), folder, "-c".as_ref(), &file, "-e".as_ref(), &folder.join("error.log")])
            .args(["-g", "daemon off;"])
            .stderr(File::create(folder.join("stderr.log")).unwrap())
            .spawn()
            .unwrap();
        let nginx = Self { child, address, log: folder.join("access.log") };
        until("nginx listens", async || TcpStream::connect(address).await.is_ok()).await;
        nginx
    }

    /// The access log.
    pub(crate) fn log(&self) -> Vec<Value> {
        lines(&self.log)
    }
}

impl Drop for Nginx {
    fn drop(&mut self) {
        // SIGKILL would leave its workers behind.
        signal("-TERM", self.child.id());
        let _ = self.child.wait();
    }
}

/// The shipped file.
pub(crate) fn shipped() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/deploy/nginx.conf")).unwrap()
}

/// The file with these addresses, and with its logs and temporary files in a folder.
fn filled_in(folder: &Path, listen: SocketAddr, replicas: &[SocketAddr]) -> String {
    let here = folder.display();
    let mut text = shipped();
    let mut put = |old: &str, new: &str| {
        assert_eq!(text.matches(old).count(), 1, "{old}");
        text = text.replace(old, new);
    };
    let like = |address: &str| format!("        server {address} max_fails=2 fail_timeout=1s;\n");
    put(&like("127.0.0.1:8082"), "");
    put(&like("127.0.0.1:8081"), &replicas.iter().map(|address| like(&address.to_string())).collect::<String>());
    put("        listen 80 default_server;", &format!("        listen {listen};"));
    put("        listen [::]:80 default_server;\n", "");
    put("pid /run/nginx.pid;", &format!("pid {here}/nginx.pid;"));
    put("error_log /var/log/nginx/error.log;", &format!("error_log {here}/error.log;"));
    put("access_log /var/log/nginx/access.log ", &format!("access_log {here}/access.log "));
    let kinds = ["client_body", "proxy", "fastcgi", "scgi", "uwsgi"];
    let places: String = kinds.iter().map(|kind| format!("    {kind}_temp_path {here}/{kind};\n")).collect();
    put("http {\n", &format!("http {{\n{places}"));
    text
}

// An HTTP/1.1 client that can tell a whole answer from a cut one.

/// A request.
#[derive(Debug, Clone)]
pub(crate) struct Ask {
    pub(crate) method: &'static str,
    pub(crate) target: String,
    pub(crate) headers: String,
    pub(crate) body: String,
    /// Local source address.
    pub(crate) from: Ipv4Addr,
}

impl Ask {
    pub(crate) fn get(target: impl Into<String>) -> Self {
        let (headers, body) = (String::new(), String::new());
        Self { method: "GET", target: target.into(), headers, body, from: Ipv4Addr::LOCALHOST }
    }

    pub(crate) fn post(target: &str, body: &str) -> Self {
        let ask = Self { method: "POST", body: body.to_owned(), ..Self::get(target) };
        ask.with("content-type", "application/json")
    }

    pub(crate) fn with(mut self, name: &str, value: &str) -> Self {
        self.headers += &format!("{name}: {value}\r\n");
        self
    }

    pub(crate) fn from(mut self, last: u8) -> Self {
        self.from = Ipv4Addr::new(127, 0, 0, last);
        self
    }
}

/// A whole answer.
#[derive(Debug, Clone)]
pub(crate) struct Answer {
    pub(crate) status: u16,
    pub(crate) headers: BTreeMap<String, String>,
    pub(crate) body: Vec<u8>,
}

impl Answer {
    /// The part of an answer that all replicas share.
    pub(crate) fn lasting(&self) -> (u16, [Option<&String>; 3], Shown<'_>) {
        let headers = ["etag", "content-type", "content-encoding"].map(|name| self.headers.get(name));
        (self.status, headers, Shown(&self.body))
    }

    pub(crate) fn json(&self) -> serde_json::Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&self.body)))
    }
}

/// Bytes of which a failed test shows only the beginning.
#[derive(PartialEq)]
pub(crate) struct Shown<'a>(&'a [u8]);

impl fmt::Debug for Shown<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let begin = String::from_utf8_lossy(&self.0[..self.0.len().min(200)]);
        write!(formatter, "{} bytes: {begin}", self.0.len())
    }
}

/// Reason for a missing answer.
#[derive(Debug)]
pub(crate) enum Failed {
    /// No answer at all.
    Unanswered(String),
    /// A head, but not the whole body.
    Cut,
}

/// An answer whose head has arrived.
pub(crate) struct Begun {
    pub(crate) status: u16,
    pub(crate) headers: BTreeMap<String, String>,
    rest: AsyncBufReader<TcpStream>,
    is_head: bool,
    left: Option<usize>,
}

/// Sends a request and reads the head of the answer.
pub(crate) async fn begin(to: SocketAddr, ask: &Ask) -> io::Result<Begun> {
    let socket = TcpSocket::new_v4()?;
    socket.bind((IpAddr::from(ask.from), 0).into())?;
    let mut socket = socket.connect(to).await?;
    let Ask { method, target, headers, body, .. } = ask;
    let length = if body.is_empty() { String::new() } else { format!("content-length: {}\r\n", body.len()) };
    let head = format!("{method} {target} HTTP/1.1\r\nhost: {to}\r\nconnection: close\r\n{headers}{length}\r\n");
    // A refusal may come before the whole request is sent.
    let _ = socket.write_all(format!("{head}{body}").as_bytes()).await;
    let mut rest = AsyncBufReader::new(socket);
    let first = line(&mut rest).await?;
    let status = first.split(' ').nth(1).and_then(|status| status.parse().ok());
    let status = status.ok_or_else(|| io::Error::other(format!("no status in {first:?}")))?;
    let mut headers = BTreeMap::new();
    loop {
        let line = line(&mut rest).await?;
        let Some((name, value)) = line.split_once(": ") else { break };
        headers.insert(name.to_ascii_lowercase(), value.to_owned());
    }
    let left = headers.get("content-length").map(|length| length.parse().unwrap());
    Ok(Begun { status, headers, rest, is_head: *method == "HEAD" || status == 304 || status == 204, left })
}

impl Begun {
    /// The next piece of the body; `None` at its end.
    pub(crate) async fn piece(&mut self) -> io::Result<Option<Vec<u8>>> {
        if self.is_head {
            return Ok(None);
        }
        let length = match self.left.take() {
            Some(length) => {
                self.is_head = true;
                length
            }
            None => {
                let size = line(&mut self.rest).await?;
                usize::from_str_radix(&size, 16).map_err(|_| io::Error::other(format!("no chunk: {size:?}")))?
            }
        };
        let mut piece = vec![0; length];
        timeout(3 * SOON, self.rest.read_exact(&mut piece)).await.expect("the server is silent")?;
        if self.is_head {
            return Ok(Some(piece));
        }
        line(&mut self.rest).await?;
        Ok(Some(piece).filter(|piece| !piece.is_empty()))
    }

    /// The rest of the body.
    pub(crate) async fn whole(mut self) -> Result<Answer, Failed> {
        let mut body = Vec::new();
        while let Some(piece) = self.piece().await.map_err(|_| Failed::Cut)? {
            body.extend(piece);
        }
        Ok(Answer { status: self.status, headers: self.headers, body })
    }
}

/// A line without its end; an error if the connection ends before it.
async fn line(from: &mut AsyncBufReader<TcpStream>) -> io::Result<String> {
    let mut line = String::new();
    timeout(3 * SOON, from.read_line(&mut line)).await.expect("the server is silent")?;
    line.strip_suffix("\r\n").map(str::to_owned).ok_or_else(|| io::ErrorKind::UnexpectedEof.into())
}

/// The whole answer to a request.
pub(crate) async fn ask(to: SocketAddr, ask: &Ask) -> Result<Answer, Failed> {
    begin(to, ask).await.map_err(|error| Failed::Unanswered(error.to_string()))?.whole().await
}

// Clients that follow a live run over several connections and keep all messages.

/// Transport of a client.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Over {
    WebSocket,
    Events,
}

/// Everything that a client received.
#[derive(Debug)]
pub(crate) struct Heard {
    pub(crate) rows: Vec<Row>,
    /// Connections that broke or were closed.
    pub(crate) breaks: usize,
    /// Reconnects that were answered with 503.
    pub(crate) refused: usize,
    /// Longest time without an impact.
    pub(crate) silence: Duration,
    last: Instant,
}

/// A client that reconnects until it is dropped.
pub(crate) struct Follower {
    heard: Arc<Mutex<Heard>>,
    task: JoinHandle<()>,
}

impl Follower {
    /// Follows a run from its first impact.
    pub(crate) fn start(address: SocketAddr, query: &str, over: Over) -> Self {
        let (rows, silence, last) = (Vec::new(), Duration::ZERO, Instant::now());
        let heard = Arc::new(Mutex::new(Heard { rows, breaks: 0, refused: 0, silence, last }));
        let (keep, query) = (heard.clone(), query.to_owned());
        let task = tokio::spawn(async move {
            loop {
                match over {
                    Over::WebSocket => listen(address, &query, &keep).await,
                    Over::Events => follow(address, &query, &keep).await,
                }
                sleep(Duration::from_millis(20)).await;
            }
        });
        Self { heard, task }
    }

    pub(crate) fn heard(&self) -> MutexGuard<'_, Heard> {
        self.heard.lock().unwrap()
    }

    pub(crate) fn count(&self) -> usize {
        self.heard().rows.len()
    }

    /// True while it listens. It stops after an error.
    pub(crate) fn is_well(&self) -> bool {
        !self.task.is_finished()
    }
}

impl Drop for Follower {
    fn drop(&mut self) {
        self.task.abort();
    }
}

fn keep(heard: &Mutex<Heard>, message: &Value) {
    let mut heard = heard.lock().unwrap();
    for row in impacts_in(message) {
        heard.silence = heard.silence.max(heard.last.elapsed());
        heard.last = Instant::now();
        heard.rows.push(row);
    }
}

/// Number of the last impact received.
fn last(heard: &Mutex<Heard>) -> u64 {
    heard.lock().unwrap().rows.last().map_or(0, |row| row["n"].as_u64().unwrap())
}

/// One WebSocket, from the next impact on.
async fn listen(address: SocketAddr, query: &str, heard: &Mutex<Heard>) {
    let url = format!("/v1/live?{query}&from={}", last(heard) + 1);
    match try_open(address, &url, &[]).await {
        Ok((mut client, _)) => {
            while let Ok(message) = client.hear().await {
                assert_ne!(message["type"], "problem", "{message}");
                keep(heard, &message);
            }
            heard.lock().unwrap().breaks += 1;
        }
        Err(Error::Http(response)) => refused(response.status().as_u16(), heard),
        Err(other) => panic!("{url}: {other}"),
    }
}

/// One event stream, with reconnection as in browsers.
async fn follow(address: SocketAddr, query: &str, heard: &Mutex<Heard>) {
    let ask = Ask::get(format!("/v1/live/events?{query}&from=1")).with("accept", "text/event-stream");
    let ask = match last(heard) {
        0 => ask,
        last => ask.with("last-event-id", &last.to_string()),
    };
    let mut answer = begin(address, &ask).await.expect("nginx answers");
    if answer.status != 200 {
        return refused(answer.status, heard);
    }
    let mut text = Vec::new();
    while let Ok(Some(piece)) = answer.piece().await {
        text.extend(piece);
        while let Some(end) = text.windows(2).position(|pair| pair == b"\n\n") {
            let event = String::from_utf8(text.drain(..end + 2).collect()).unwrap();
            if let Some(message) = event.lines().find_map(|line| line.strip_prefix("data: ")) {
                keep(heard, &held(message));
            }
        }
    }
    heard.lock().unwrap().breaks += 1;
}

fn refused(status: u16, heard: &Mutex<Heard>) {
    assert_eq!(status, 503);
    heard.lock().unwrap().refused += 1;
}
