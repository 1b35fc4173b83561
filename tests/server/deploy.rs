//! The files of `docs/deploy` agree with the server, with each other and with the tools that read them.
//!
//! `tests/replicas` runs nginx itself before replicas.

use std::collections::BTreeSet;
use std::fs;
use std::io::{BufRead, BufReader, Write, stdout};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::support::Server;
use equipoise::limits;
use equipoise::limits::Limits;
use serde_json::Value;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn shipped(name: &str) -> String {
    fs::read_to_string(root().join("docs/deploy").join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The arguments of the only directive of a name.
fn nginx(begin: &str) -> Vec<String> {
    let text = shipped("nginx.conf");
    let mut found = text.lines().filter_map(|line| line.trim().strip_prefix(begin)?.strip_suffix(';'));
    let arguments = found.next().unwrap_or_else(|| panic!("no {begin}"));
    assert_eq!(found.next(), None, "{begin} is there twice");
    arguments.split_whitespace().map(str::to_owned).collect()
}

fn bytes(text: &str) -> usize {
    let kib = text.strip_suffix('k').unwrap_or_else(|| panic!("{text} is not in KiB"));
    1024 * kib.parse::<usize>().unwrap()
}

fn time(text: &str) -> Duration {
    Duration::from_secs(text.strip_suffix('s').unwrap_or_else(|| panic!("{text} is not in seconds")).parse().unwrap())
}

#[test]
fn nginx_takes_what_the_server_takes() {
    let limits = Limits::default();
    let size = |begin: &str| bytes(&nginx(begin)[0]);
    assert_eq!(size("client_max_body_size "), limits.body_bytes);
    assert_eq!(size("client_body_buffer_size "), limits.body_bytes, "bodies would go to the disk");
    let lines = nginx("large_client_header_buffers ");
    let (count, line) = (lines[0].parse::<usize>().unwrap(), bytes(&lines[1]));
    assert!(line > limits::URL_BYTES + "OPTIONS  HTTP/1.1\r\n".len());
    assert_eq!(count * line, limits::HEAD_BYTES);
    // The head of a redirect holds the URL; 4096 bytes are enough for its other headers.
    assert!(size("proxy_buffer_size ") >= limits::URL_BYTES + 4096);
    let ids = format!("\"~^[A-Za-z0-9._-]{{1,{}}}$\" $http_x_request_id;", limits::REQUEST_ID_BYTES);
    let text = shipped("nginx.conf");
    for said in [
        ids,
        format!("503 {};", limits::RETRY_AFTER_S),
        format!("413 \"the request body is larger than the limit of {} KiB\";", limits.body_bytes / 1024),
        format!("larger than {} KiB; the limit of a URL is {} KiB\";", line / 1024, limits::URL_BYTES / 1024),
        format!("or a header is larger than {} KiB\";", line / 1024),
    ] {
        assert!(text.contains(&said), "{said}");
    }
}

#[test]
fn nginx_waits_as_long_as_the_server_and_for_it() {
    let limits = Limits::default();
    let wait = |begin: &str| time(&nginx(begin)[0]);
    assert_eq!(wait("client_header_timeout "), limits.head_time);
    assert_eq!(wait("client_body_timeout "), limits.body_time);
    assert!(wait("send_timeout ") > limits.stall_time);
    // One `keepalive_timeout` is for replicas, the other for clients.
    let text = shipped("nginx.conf");
    let kept: Vec<_> = text
        .lines()
        .filter_map(|line| line.trim().strip_prefix("keepalive_timeout ")?.strip_suffix(';').map(time))
        .collect();
    assert!(kept.len() == 2 && kept[0] <= limits.head_time / 2 && kept[1] == limits.head_time, "{kept:?}");
    let (read, again) = (wait("proxy_read_timeout "), wait("proxy_next_upstream_timeout "));
    assert!(read >= 3 * limits::LIVE_PING_TIME && read > limits.queue_time);
    assert!(again < read, "what took too long would be asked for again");
    assert!(again > 10 * wait("proxy_connect_timeout ") && again > limits.queue_time + limits.shutdown_time);
    let peers: usize = nginx("limit_conn peers ")[0].parse().unwrap();
    assert!((limits.live_sessions..limits.connections).contains(&peers), "{peers}");
    let number = |begin: &str| nginx(begin)[0].parse::<usize>().unwrap();
    let connections = number("worker_connections ");
    assert!(number("worker_rlimit_nofile ") > connections && connections >= 2 * limits.connections);
}

/// The values of a setting in the systemd unit.
fn unit(name: &str) -> Vec<String> {
    let text = shipped("equipoise@.service");
    let values = text.lines().filter_map(|line| line.strip_prefix(name)?.strip_prefix('='));
    values.map(str::to_owned).collect()
}

#[test]
fn the_unit_gives_the_server_the_files_and_the_time_it_needs() {
    let limits = Limits::default();
    let number = |name: &str| unit(name)[0].parse::<u64>().unwrap();
    let files = limits.connections + limits.live_sessions + limits::OTHER_FILES;
    assert!(number("LimitNOFILE") >= files as u64);
    let said = format!("under {},{:03} leaves it fewer", files / 1000, files % 1000);
    assert!(shipped("README.md").contains(&said), "{said}");
    assert!(Duration::from_secs(number("TimeoutStopSec")) > limits.shutdown_time + limits::GOODBYE_TIME);
}

/// Starts the program with these variables. Returns its first line.
fn started_with(variables: &[(String, String)]) -> String {
    let mut child = Command::new(env!("CARGO_BIN_EXE_equipoise"))
        .env_clear()
        .envs(variables.iter().cloned())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    line
}

/// Name and value of an assignment; the port becomes 0, any free one.
fn assigned(text: &str, port: &str) -> (String, String) {
    let (name, value) = text.split_once('=').unwrap();
    (name.to_owned(), value.replace(port, ":0"))
}

#[test]
fn the_server_starts_in_each_of_the_environments() {
    let of_unit = unit("Environment")[0].split(' ').map(|text| assigned(text, ":%i")).collect::<Vec<_>>();
    let image = shipped("Containerfile");
    let of_image = image.lines().filter_map(|line| line.strip_prefix("ENV ")).map(|text| assigned(text, ":8080"));
    let pod = &deployment()["spec"]["template"]["spec"]["containers"][0];
    let of_pod = pod["env"].as_array().unwrap().iter().map(|variable| {
        let value = variable["value"].as_str().unwrap_or("0123456789abcdef").replace(":8080", ":0");
        (variable["name"].as_str().unwrap().to_owned(), value)
    });
    let help = Command::new(env!("CARGO_BIN_EXE_equipoise")).arg("--help").output().unwrap().stdout;
    // `--help` breaks long lines.
    let help = String::from_utf8(help).unwrap().split_whitespace().collect::<Vec<_>>().join(" ");
    for variables in [of_unit, of_image.collect(), of_pod.collect()] {
        assert!(!variables.is_empty());
        for (name, _) in &variables {
            assert!(help.contains(&format!("[env: {name}")), "{name}");
        }
        assert!(started_with(&variables).contains(" serves http://"), "{variables:?}");
    }
}

#[test]
fn systemd_accepts_the_unit_and_finds_it_hardened() {
    let analyze = |arguments: &[&str], folder: &Path| {
        Command::new("systemd-analyze").args(arguments).current_dir(folder).output()
    };
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("unit");
    if !analyze(&["--version"], Path::new("/")).is_ok_and(|output| output.status.success()) {
        let _ = writeln!(stdout(), "skip  deploy: systemd-analyze is not installed");
        return;
    }
    fs::create_dir_all(&folder).unwrap();
    let program = unit("ExecStart").remove(0);
    let text = shipped("equipoise@.service").replace(&program, env!("CARGO_BIN_EXE_equipoise"));
    fs::write(folder.join("equipoise@.service"), text).unwrap();
    // The exposure is out of 100; a unit without protection comes close to that.
    let most_exposed = "--threshold=15";
    for arguments in [
        vec!["verify", "./equipoise@.service"],
        vec!["security", "--offline=true", most_exposed, "./equipoise@.service"],
    ] {
        let output = analyze(&arguments, &folder).unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned() + &String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{arguments:?}: {said}");
        assert!(!said.contains("equipoise@.service:"), "{said}");
    }
}

/// The objects of the manifest.
fn objects() -> Vec<Value> {
    let text = shipped("kubernetes.yaml");
    text.split("\n---\n").map(|object| serde_saphyr::from_str(object).unwrap()).collect()
}

fn object(kind: &str) -> Value {
    objects().into_iter().find(|object| object["kind"] == kind).unwrap_or_else(|| panic!("no {kind}"))
}

fn deployment() -> Value {
    object("Deployment")
}

#[tokio::test]
async fn the_manifest_agrees_with_the_server() {
    let (deployment, limits) = (deployment(), Limits::default());
    let pod = &deployment["spec"]["template"];
    let container = &pod["spec"]["containers"][0];
    let server = Server::start();
    for (probe, path) in [("startup", "/health/ready"), ("readiness", "/health/ready"), ("liveness", "/health/live")] {
        let asked = &container[format!("{probe}Probe")]["httpGet"];
        assert_eq!((asked["path"].as_str(), &asked["port"]), (Some(path), &container["ports"][0]["name"]), "{probe}");
        server.get(path).await.expect(200);
    }
    let pause: u64 = container["lifecycle"]["preStop"]["exec"]["command"][1].as_str().unwrap().parse().unwrap();
    let grace = Duration::from_secs(pod["spec"]["terminationGracePeriodSeconds"].as_u64().unwrap());
    assert!(grace > Duration::from_secs(pause) + limits.shutdown_time + limits::GOODBYE_TIME);
    let memory = container["resources"]["limits"]["memory"].as_str().unwrap().strip_suffix("Gi").unwrap();
    let memory = memory.parse::<usize>().unwrap() << 30;
    assert!(memory >= 2 * limits.held_bytes + 100 * 1024 * limits.connections, "{memory}");
    for (labels, object) in [
        ("Service", "/spec/selector"),
        ("PodDisruptionBudget", "/spec/selector/matchLabels"),
        ("Deployment", "/spec/selector/matchLabels"),
    ] {
        assert_eq!(self::object(labels).pointer(object).unwrap(), &pod["metadata"]["labels"], "{labels}");
    }
    assert_eq!(object("Service")["spec"]["ports"][0]["targetPort"], container["ports"][0]["name"]);
    let kept = object("PodDisruptionBudget")["spec"]["minAvailable"].as_u64().unwrap();
    assert!(kept >= 1 && kept < deployment["spec"]["replicas"].as_u64().unwrap());
}

/// The arguments of an instruction, anywhere in the file.
fn instructions(name: &str) -> Vec<String> {
    let text = shipped("Containerfile");
    text.lines().filter_map(|line| Some(line.strip_prefix(name)?.strip_prefix(' ')?.to_owned())).collect()
}

/// Standard output of a program that succeeds.
fn printed(command: &mut Command) -> String {
    let output = command.output().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    assert!(output.status.success(), "{command:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// A release is the same program without symbols, tools find them beside it, and a second one has the same bytes.
#[test]
fn a_release_has_its_symbols_beside_it() {
    let program = env!("CARGO_BIN_EXE_equipoise");
    let [folder, again] =
        ["", "-again"].map(|end| std::env::temp_dir().join(format!("equipoise-release-{}{end}", std::process::id())));
    let sums = [&folder, &again].map(|folder| {
        let mut release = Command::new(root().join("docs/deploy/release"));
        let parts = ["--program", program, "program", "image"];
        printed(release.arg(folder).args(parts).env("SOURCE_DATE_EPOCH", "1795000000"))
    });
    assert_eq!(sums[0], sums[1]);
    fs::remove_dir_all(again).unwrap();
    let mut files = fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path());
    let image = files.find(|file| file.extension().is_some_and(|end| end == "tar")).unwrap();
    let listed = printed(Command::new("tar").arg("-tf").arg(image));
    assert_eq!(listed, "Containerfile\nLICENSE-APACHE\nLICENSE-MIT\nequipoise\n");
    let bare = folder.join("equipoise");
    assert_eq!(printed(Command::new(&bare).arg("--version")), printed(Command::new(program).arg("--version")));
    let length = |path: &Path| fs::metadata(path).unwrap().len();
    assert!(length(&bare) * 3 < length(Path::new(program)) * 2, "{} bytes are left", length(&bare));
    assert_eq!(printed(Command::new("nm").arg(&bare)), "");
    let symbols = printed(Command::new("nm").arg(folder.join("equipoise.debug")));
    let main = symbols.lines().find(|line| line.contains("9equipoise4main17h")).expect("the symbol of `main`");
    let place = printed(Command::new("addr2line").arg("-e").arg(&bare).arg(main.split(' ').next().unwrap()));
    assert!(place.contains("server/main.rs:"), "{place}");
    printed(Command::new("sha256sum").args(["--check", "SHA256SUMS"]).current_dir(&folder));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_image_is_of_this_version_and_user() {
    let manifest = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let minor = manifest.lines().find_map(|line| line.strip_prefix("rust-version = \"")?.strip_suffix('"')).unwrap();
    assert!(instructions("FROM")[0].contains(&format!("/rust:{minor}-")), "built with Rust {minor}");
    let image = format!("equipoise:{}", env!("CARGO_PKG_VERSION"));
    let deployment = deployment();
    let pod = &deployment["spec"]["template"]["spec"];
    assert_eq!(pod["containers"][0]["image"], image.as_str());
    assert!(shipped("Containerfile").contains(&format!("-t {image} ")) && shipped("README.md").contains(&image));
    let user = instructions("USER").remove(0);
    assert_eq!(user, format!("{}:{}", pod["securityContext"]["runAsUser"], pod["securityContext"]["runAsGroup"]));
    // The command is a list: a shell would not pass the signal on.
    let entry: Vec<String> = serde_json::from_str(&instructions("ENTRYPOINT")[0]).unwrap();
    assert_eq!(entry, [unit("ExecStart")[0].as_str()]);
    assert!(instructions("COPY").last().unwrap().ends_with(&entry[0]));
}

/// The copied files contain every target that the manifest names, and every input of the build script.
#[test]
fn the_image_is_built_from_all_that_it_is_made_of() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("image");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let mut copied = BTreeSet::new();
    for copy in instructions("COPY").iter().filter(|copy| !copy.starts_with("--from")) {
        let mut names: Vec<_> = copy.split(' ').collect();
        let to = names.pop().unwrap();
        for name in names {
            let from = root().join(name);
            let into = if from.is_dir() { folder.join(to) } else { folder.join(name) };
            assert!(Command::new("cp").arg("-r").args([&from, &into]).status().unwrap().success());
            copied.insert(name.to_owned());
        }
    }
    let build = fs::read_to_string(root().join("server/build.rs")).unwrap();
    let sources = build.lines().find_map(|line| line.strip_prefix("const SOURCES: [&str; 4] = ")).unwrap();
    let sources: Vec<String> = serde_json::from_str(sources.trim_end_matches(';')).unwrap();
    for source in sources {
        assert!(copied.contains(&source), "{source} is not copied");
    }
    // Cargo looks at every target before it reports that none has this name.
    let cargo = Command::new(env!("CARGO"))
        .args(["run", "--offline", "--locked", "--bin", "none"])
        .current_dir(&folder)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&cargo.stderr);
    assert!(said.contains("no bin target named"), "{said}");
}
