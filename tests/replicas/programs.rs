//! Replicas of the server, and the real nginx before them with `docs/deploy/nginx.conf`. The clients are in `asking` and `following`.

use std::fs::{self, File, OpenOptions};
use std::io::{BufRead, BufReader};
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use tokio::net::TcpStream;
use tokio::time::{sleep, timeout};

use crate::asking::{Ask, ask};
use crate::support::socket::SOON;

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
