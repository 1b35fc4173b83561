//! Subcommands of the program: the bytes of the server, faults in its words, exit status, files and standard input.

use std::io::Write;
use std::process::{Command, Output, Stdio};

use axum::http::Method;
use serde_json::Value;

use crate::support::contract::operations;
use crate::support::{Answer, Server};

/// Runs the program with arguments and standard input.
fn run(arguments: &[&str], input: &[u8]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_equipoise"));
    let mut child = command
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // A program that does not read it may have ended.
    let _ = child.stdin.take().expect("a pipe").write_all(input);
    child.wait_with_output().expect("the program ends")
}

fn answered(arguments: &[&str], input: &[u8]) -> Vec<u8> {
    let Output { status, stdout, stderr } = run(arguments, input);
    assert_eq!((status.code(), String::from_utf8_lossy(&stderr).as_ref()), (Some(0), ""), "{arguments:?}");
    stdout
}

fn refused(arguments: &[&str], code: i32) -> String {
    let Output { status, stdout, stderr } = run(arguments, b"");
    assert_eq!((status.code(), stdout.as_slice()), (Some(code), b"".as_slice()), "{arguments:?}");
    String::from_utf8(stderr).expect("UTF-8")
}

/// First and last of the queries that the contract prints, by resource.
fn queries() -> Vec<(&'static str, &'static str)> {
    let of_operation = |(path, method, operation): (&'static str, Method, &'static Value)| {
        let name = path.strip_prefix("/v1/").filter(|_| method == Method::GET && operation["tags"][0] == "Compute")?;
        let queries = operation["x-queries"].as_array()?;
        // The clock of a measurement differs each time; a probe is of another resource.
        let is_own = !["precision", "probe"].contains(&name);
        is_own
            .then(|| [queries.first(), queries.last()].map(|query| (name, query.and_then(Value::as_str).expect("one"))))
    };
    operations().into_iter().filter_map(of_operation).flatten().collect()
}

#[tokio::test]
async fn answers_are_the_bytes_of_the_server() {
    let server = Server::start();
    let queries = queries();
    assert_eq!(queries.len(), 2 * 11);
    for (name, query) in queries {
        let expected = server.get(&format!("/v1/{name}?{query}")).await.expect(200);
        let arguments: Vec<_> = std::iter::once(name).chain(query.split('&')).collect();
        assert!(answered(&arguments, b"") == expected.body, "{name} {query}");
    }
    let preset = answered(&["stability", "--preset", "case-1", "table.tilt_gain=1.2", "--format", "csv"], b"");
    let expected = server.get("/v1/stability?preset=case-1&table.tilt_gain=1.2&format=csv").await.expect(200);
    assert!(preset == expected.body);
}

async fn post(server: &Server, target: &str, media_type: &str, body: &[u8]) -> Answer {
    server.send(Method::POST, target, &[("content-type", media_type)], body).await
}

#[tokio::test]
async fn data_come_from_standard_input_or_a_file() {
    let server = Server::start();
    let run = server.get("/v1/trajectories?preset=case-1&bounces=12&format=csv").await.expect(200);
    let query = "preset=case-1&unknown.0=table.tilt_gain&sd.t=0.001&sd.theta=0.001";
    let expected = post(&server, &format!("/v1/fits?{query}"), "text/csv", &run.body).await.expect(200);
    let mut arguments = vec!["fits", "--data", "-"];
    arguments.extend(query.split('&'));
    assert!(answered(&arguments, &run.body) == expected.body);

    let folder = folder();
    let file = format!("{folder}/run.csv");
    std::fs::write(&file, &run.body).expect("a file");
    arguments[2] = &file;
    assert!(answered(&arguments, b"") == expected.body);

    let body = br#"{"preset": "case-1", "bounces": 7}"#;
    let expected = post(&server, "/v1/trajectories", "application/json", body).await.expect(200);
    assert!(answered(&["trajectories", "--data", "-"], body) == expected.body);
}

#[tokio::test]
async fn the_extension_of_a_file_is_the_format() {
    let server = Server::start();
    let folder = folder();
    let query = "preset=case-1&bounces=5";
    for (extension, format) in [("json", "json"), ("csv", "csv"), ("arrows", "arrow"), ("png", "png"), ("SVG", "svg")] {
        let file = format!("{folder}/run.{extension}");
        assert_eq!(answered(&["trajectories", "preset=case-1", "bounces=5", "-o", &file], b""), b"");
        let expected = server.get(&format!("/v1/trajectories?{query}&format={format}")).await.expect(200);
        assert!(std::fs::read(&file).expect("a file") == expected.body, "{extension}");
    }
    let words = refused(&["trajectories", "preset=case-1", "-o", "run.xlsx"], 2);
    assert!(words.contains("run.xlsx has none of the extensions .json, .csv"), "{words}");
}

#[test]
fn faults_have_a_line_each_with_the_field() {
    let words = refused(&["stability", "--preset", "case-1", "table.tilt_gain=x", "bounces=0", "colour=1"], 1);
    let fields: Vec<_> =
        words.lines().filter_map(|line| line.strip_prefix("equipoise: ")?.split(": ").next()).collect();
    assert_eq!(fields, ["table.tilt_gain", "bounces", "colour"], "{words}");
    // A limit of the server is one here too.
    let words = refused(&["trajectories", "--work", "1000", "preset=case-1", "bounces=2000"], 1);
    assert!(
        words.starts_with("equipoise: the work of this request would be ") && words.lines().count() == 1,
        "{words}"
    );
}

#[test]
fn a_wrong_command_line_has_status_2() {
    for arguments in [
        vec!["stabile"],
        vec!["stability", "tilt_gain"],
        vec!["stability", "--format", "docx"],
        vec!["fits", "preset=case-1"],
        vec!["stability", "--listen", "127.0.0.1:0"],
        vec!["fits", "--data", "/no/such/file"],
    ] {
        assert!(!refused(&arguments, 2).is_empty(), "{arguments:?}");
    }
}

#[test]
fn help_lists_the_fields_of_a_request() {
    let all = String::from_utf8(answered(&["--help"], b"")).expect("UTF-8");
    for wanted in ["--listen", "serve", "stability", "Tell whether the bounce is stable", "periodic-orbits"] {
        assert!(all.contains(wanted), "{wanted} is not in {all}");
    }
    let own = String::from_utf8(answered(&["regions", "--help"], b"")).expect("UTF-8");
    for wanted in ["x.field", "table.tilt_gain [-100 to 100", "bounces [1 to ", "--output", "quantity ["] {
        assert!(own.contains(wanted), "{wanted} is not in {own}");
    }
    assert!(!own.contains("--work"), "{own}");
    let fits = String::from_utf8(answered(&["fits", "--help"], b"")).expect("UTF-8");
    for wanted in ["\n  unknown", "\n  sd", "\n  table.tilt_gain ["] {
        assert!(fits.contains(wanted), "{wanted} is not in {fits}");
    }
}

#[test]
fn completions_and_manual_pages_are_written() {
    for (arguments, wanted) in [
        (["completions", "bash"], "periodic-orbits"),
        (["man", "regions"], "equipoise-regions - Map survival over two fields"),
        (["man", "serve"], "--live-idle-time"),
    ] {
        let text = String::from_utf8(answered(&arguments, b"")).expect("UTF-8").replace("\\-", "-");
        assert!(text.contains(wanted), "{arguments:?}: {text}");
    }
}

/// A folder for the files of one test.
fn folder() -> String {
    let name = std::thread::current().name().unwrap_or_default().replace("::", "-");
    let folder = format!("{}/{name}", env!("CARGO_TARGET_TMPDIR"));
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}
