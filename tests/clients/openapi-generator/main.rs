//! Calls every operation with openapi-generator's Rust client. Prints a line of JSON for each decoded request and for each answer.
//!
//! generator_calls.py writes the calls, and compares these lines with the requests and the answers of the server.

use std::fmt::Display;

use equipoise_client::apis::configuration::Configuration;
use reqwest::header::{CONTENT_TYPE, HeaderMap, HeaderValue};
use serde::{Serialize, de::DeserializeOwned};
use serde_json::json;

/// A value that the client has decoded from JSON.
fn decoded<T: DeserializeOwned>(text: &str) -> T {
    serde_json::from_str(text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// A body that the client has decoded from JSON, printed as the client encodes it.
fn body<T: DeserializeOwned + Serialize>(text: &str) -> T {
    let body = decoded(text);
    println!("{}", json!(["request", body]));
    body
}

/// The text of an answer that the client leaves undecoded.
async fn text<E: Display>(answer: Result<reqwest::Response, E>) -> Result<String, String> {
    match answer {
        Ok(answer) => answer.text().await.map_err(|error| error.to_string()),
        Err(error) => Err(error.to_string()),
    }
}

/// Prints the answer to an operation as the client encodes it, or the error.
fn answered<T: Serialize, E: Display>(operation: &str, answer: Result<T, E>) {
    match answer {
        Ok(answer) => println!("{}", json!(["answer", operation, answer])),
        Err(error) => println!("{}", json!(["error", operation, error.to_string()])),
    }
}

#[tokio::main(flavor = "current_thread")]
async fn main() {
    let base_path = std::env::args().nth(1).expect("an address");
    let client = reqwest::Client::new();
    let plain = Configuration { base_path: base_path.clone(), client, ..Configuration::default() };
    let headers = HeaderMap::from_iter([(CONTENT_TYPE, HeaderValue::from_static("application/x-ndjson"))]);
    let client = reqwest::Client::builder().default_headers(headers).build().expect("a client");
    // For bodies of NDJSON, which the client sends without their type.
    let typed = Configuration { base_path, client, ..Configuration::default() };
    include!("../.generators/calls.rs")
}
