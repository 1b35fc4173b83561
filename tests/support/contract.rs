//! `openapi.yaml` as a judge of answers: path template, method, status, headers, media type and body.
//!
//! Requests are not checked here: tests check that the server itself refuses invalid ones.

use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex};

use axum::http::{Method, StatusCode};
use jsonschema::Validator;
use serde_json::{Value, json};

use super::Answer;
use super::tables::{Stream, Table};

/// The contract as text, as it is served.
pub(crate) const TEXT: &str = include_str!("../../openapi.yaml");

/// The contract as a document.
pub(crate) static DOCUMENT: LazyLock<Value> =
    LazyLock::new(|| serde_saphyr::from_str(TEXT).expect("openapi.yaml is YAML"));

/// Follows `$ref`s to the end.
pub(crate) fn resolved(mut node: &Value) -> &Value {
    while let Some(reference) = node.get("$ref").and_then(Value::as_str) {
        let pointer = reference.strip_prefix('#').expect("references stay in the document");
        node = DOCUMENT.pointer(pointer).unwrap_or_else(|| panic!("{reference} leads nowhere"));
    }
    node
}

/// A validator for a schema of the contract, compiled once per schema.
pub(crate) fn validator(schema: &Value) -> Arc<Validator> {
    static COMPILED: LazyLock<Mutex<HashMap<String, Arc<Validator>>>> = LazyLock::new(Mutex::default);
    let mut compiled = COMPILED.lock().expect("no test panics while it compiles");
    let key = schema.to_string();
    if let Some(known) = compiled.get(&key) {
        return known.clone();
    }
    let mut whole = schema.clone();
    whole["components"] = DOCUMENT["components"].clone();
    let built = jsonschema::options()
        .with_draft(jsonschema::Draft::Draft202012)
        .should_validate_formats(true)
        .build(&whole)
        .unwrap_or_else(|error| panic!("{key}: {error}"));
    compiled.entry(key).or_insert(Arc::new(built)).clone()
}

/// Violations of a schema of the contract by a value, with their places; empty if the value is valid.
pub(crate) fn faults(schema: &Value, value: &Value) -> Vec<String> {
    validator(schema)
        .iter_errors(value)
        .take(5)
        .map(|error| {
            let text: String = error.to_string().chars().take(300).collect();
            format!("{}: {text}", error.instance_path())
        })
        .collect()
}

/// The path templates of the contract.
pub(crate) fn templates() -> impl Iterator<Item = &'static str> {
    DOCUMENT["paths"].as_object().expect("paths").keys().map(String::as_str)
}

/// The template of a path. Literal segments outrank parameters.
pub(crate) fn template(path: &str) -> Option<&'static str> {
    let matches = |template: &&str| {
        let (mut left, mut right) = (template.split('/'), path.split('/'));
        loop {
            match (left.next(), right.next()) {
                (None, None) => return true,
                (Some(name), Some(value)) if name.starts_with('{') => {
                    if value.is_empty() {
                        return false;
                    }
                }
                (Some(literal), Some(value)) if literal == value => {}
                _ => return false,
            }
        }
    };
    templates().filter(matches).min_by_key(|template| template.matches('{').count())
}

/// Every operation: template, method, operation.
pub(crate) fn operations() -> Vec<(&'static str, Method, &'static Value)> {
    let mut found = Vec::new();
    for (path, item) in DOCUMENT["paths"].as_object().expect("paths") {
        for (name, operation) in item.as_object().expect("a path item") {
            if ["get", "head", "post", "put", "patch", "delete", "options", "trace"].contains(&name.as_str()) {
                let method = Method::from_bytes(name.to_uppercase().as_bytes()).expect("a method");
                found.push((path.as_str(), method, operation));
            }
        }
    }
    found
}

/// Panics unless the contract allows this answer to this request.
#[track_caller]
pub(crate) fn hold(method: &Method, target: &str, answer: &Answer) {
    hold_everywhere(answer);
    let path = target.split(['?', '#']).next().expect("a first part");
    let item = template(path).map(|template| &DOCUMENT["paths"][template]);
    let get_of_head = if method == Method::HEAD { Some("get") } else { None };
    let name = method.as_str().to_lowercase();
    let operation = item.and_then(|item| item.get(&name).or_else(|| item.get(get_of_head?)));
    match (item, operation) {
        (_, Some(operation)) => hold_to_operation(method, operation, answer),
        (Some(_), None) => {
            assert_eq!(answer.status, StatusCode::METHOD_NOT_ALLOWED, "{}: not in the contract", answer.request);
            hold_to_response(method, &DOCUMENT["components"]["responses"]["MethodNotAllowed"], answer);
        }
        // Files of the page are not in the contract, but their errors are problems too.
        (None, _) => {
            if answer.status.is_client_error() || answer.status.is_server_error() {
                let is_unauthorized = answer.status == StatusCode::UNAUTHORIZED;
                let name = if is_unauthorized { "Unauthorized" } else { "NotFound" };
                let response = &DOCUMENT["components"]["responses"][name];
                hold_to_response(method, response, answer);
            }
        }
    }
}

/// Panics unless the contract allows a GET of this template to answer with this status and these headers (lowercase names). For
/// endless answers, whose messages are checked one by one.
#[track_caller]
pub(crate) fn hold_head(template: &str, status: &str, headers: &HashMap<String, String>) {
    let responses = &DOCUMENT["paths"][template]["get"]["responses"];
    let response = responses.get(status).unwrap_or_else(|| panic!("{template}: the contract has no {status}"));
    let response = resolved(response);
    for (name, header) in response["headers"].as_object().into_iter().flatten() {
        let header = resolved(header);
        match headers.get(&name.to_lowercase()) {
            Some(value) => {
                let faults = faults(&header["schema"], &json!(value));
                assert!(faults.is_empty(), "{template} {status}: header {name}: {value}: {faults:?}");
            }
            None => assert!(header["required"] != json!(true), "{template} {status}: no header {name}"),
        }
    }
    let media_type = headers.get("content-type").map(|value| value.split(';').next().unwrap_or_default().trim());
    match (response.get("content"), media_type) {
        (None, None) => {}
        (Some(content), Some(media_type)) if content.get(media_type).is_some() => {}
        _ => panic!("{template} {status}: {media_type:?} is not in the contract"),
    }
}

/// Rules for the answers of all resources.
#[track_caller]
fn hold_everywhere(answer: &Answer) {
    let request = &answer.request;
    let policy = answer.header("content-security-policy").unwrap_or_else(|| panic!("{request}: no CSP"));
    assert!(policy.contains("default-src 'self'"), "{request}: {policy}");
    assert!(!policy.contains("unsafe"), "{request}: {policy}");
    assert_eq!(answer.header("x-content-type-options"), Some("nosniff"), "{request}");
    assert_eq!(answer.header("referrer-policy"), Some("no-referrer"), "{request}");
    let id = answer.header("x-request-id").unwrap_or_else(|| panic!("{request}: no id"));
    if answer.status == StatusCode::NOT_MODIFIED {
        assert!(answer.raw.is_empty(), "{request}: a 304 with a body");
    }
    if answer.media_type() == "application/problem+json" && !answer.body.is_empty() {
        let problem = answer.json();
        assert_eq!(problem["status"], answer.status.as_u16(), "{request}: {problem}");
        assert_eq!(problem["request_id"], id, "{request}: {problem}");
    }
}

#[track_caller]
fn hold_to_operation(method: &Method, operation: &Value, answer: &Answer) {
    let request = &answer.request;
    let responses = operation["responses"].as_object().expect("responses");
    let response = responses.get(answer.status.as_str()).unwrap_or_else(|| {
        panic!("{request}: the contract has no {}; the answer: {}", answer.status, answer.excerpt());
    });
    hold_to_response(method, resolved(response), answer);
}

#[track_caller]
fn hold_to_response(method: &Method, response: &Value, answer: &Answer) {
    let request = &answer.request;
    let headers = response.get("headers").and_then(Value::as_object);
    for (name, header) in headers.into_iter().flatten() {
        let header = resolved(header);
        match answer.header(name) {
            Some(value) => {
                let faults = faults(&header["schema"], &json!(value));
                assert!(faults.is_empty(), "{request}: header {name}: {value}: {faults:?}");
            }
            None => assert!(header["required"] != json!(true), "{request}: no header {name}"),
        }
    }
    let Some(content) = response.get("content").and_then(Value::as_object) else {
        assert!(answer.raw.is_empty(), "{request}: a body that is not in the contract");
        return;
    };
    let media_type = answer.media_type();
    let media = content.get(media_type).unwrap_or_else(|| {
        panic!("{request}: {} as {media_type:?} is not in the contract: {}", answer.status, answer.excerpt());
    });
    if method == Method::HEAD {
        assert!(answer.raw.is_empty(), "{request}: a body on HEAD");
        return;
    }
    // A part of a body is held to nothing but its media type.
    if answer.status != StatusCode::PARTIAL_CONTENT {
        hold_body(media, media_type, answer);
    }
}

#[track_caller]
fn hold_body(media: &Value, media_type: &str, answer: &Answer) {
    let request = &answer.request;
    match media_type {
        "application/json" | "application/problem+json" => {
            let faults = faults(&media["schema"], &answer.json());
            assert!(faults.is_empty(), "{request}: {faults:#?}");
        }
        "application/x-ndjson" => {
            let text = answer.text();
            assert!(text.ends_with('\n'), "{request}: the last line is cut off");
            let lines: Vec<Value> =
                text.lines().map(|line| serde_json::from_str(line).expect("a line of JSON")).collect();
            for (index, line) in lines.iter().enumerate() {
                let faults = faults(&media["x-line"], line);
                assert!(faults.is_empty(), "{request}: line {index}: {faults:#?}");
                let is_last = index + 1 == lines.len();
                // The status is sent before the work that tells its progress, so a problem may come as the end.
                let is_problem = request.contains("format=progress") && line.get("problem").is_some();
                assert_eq!(line.get("end").is_some() || is_problem, is_last, "{request}: line {index}: {line}");
            }
        }
        "text/csv" => {
            let table = Table::parse(answer.text()).unwrap_or_else(|fault| panic!("{request}: {fault}"));
            assert!(!table.names.is_empty(), "{request}: no columns");
        }
        "application/vnd.apache.arrow.stream" => {
            let stream = Stream::parse(&answer.body).unwrap_or_else(|fault| panic!("{request}: {fault}"));
            assert!(!stream.names().is_empty() && stream.rest().is_object(), "{request}: no columns");
        }
        "image/svg+xml" => {
            let text = answer.text();
            let picture = roxmltree::Document::parse(text).unwrap_or_else(|error| panic!("{request}: {error}"));
            let root = picture.root_element();
            assert_eq!(root.tag_name().name(), "svg", "{request}");
            assert_eq!(root.tag_name().namespace(), Some("http://www.w3.org/2000/svg"), "{request}");
            assert!(!text.contains("NaN") && !text.contains("inf"), "{request}: a number that is none");
        }
        "image/png" => assert!(answer.body.starts_with(b"\x89PNG\r\n\x1a\n"), "{request}: no PNG"),
        _ => {
            answer.text();
        }
    }
}
