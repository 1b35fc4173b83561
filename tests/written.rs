//! Files that follow from the code: `openapi.yaml`, and words of the fuzz dictionaries. `UPDATE=1 cargo test --test written` writes them.

use std::path::Path;

use equipoise::api::{contract, contract_parts};
use serde::{Serialize, Serializer};
use serde_json::Value;
use serde_saphyr::{FlowMap, FlowSeq};

#[path = "written/dictionaries.rs"]
mod dictionaries;

/// Longest line of prose.
const WIDTH: usize = 140;

/// Longest part on one line.
const SHORT: usize = 110;

const HEAD: &str = "# The contract of equipoise, served verbatim. The tests hold the router and every answer to it.\n#\n\
    # Written by `UPDATE=1 cargo test --test written` from the code and from server/api/contract.yaml; not to be edited.\n";

/// The contract as YAML.
fn contract() -> String {
    let by_hand: Value =
        serde_saphyr::from_str(include_str!("../server/api/contract.yaml")).expect("the part by hand is YAML");
    let document = contract::document(contract_parts(), by_hand);
    let options = serde_saphyr::ser_options! { folded_wrap_chars: WIDTH, compact_list_indent: false };
    let text =
        serde_saphyr::to_string_with_options(&Shown(&document), options).expect("a document of JSON is one of YAML");
    HEAD.lines().chain(text.lines()).flat_map(|line| [line.trim_end(), "\n"]).collect()
}

/// A part of the document: on one line if it is short.
struct Shown<'a>(&'a Value);

impl Serialize for Shown<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let text = self.0.to_string();
        let is_short = text.len() <= SHORT && !text.contains("\\n");
        match self.0 {
            Value::Object(members) if is_short => FlowMap(members).serialize(serializer),
            Value::Array(items) if is_short => FlowSeq(items).serialize(serializer),
            Value::Object(members) => serializer.collect_map(members.iter().map(|(key, member)| (key, Shown(member)))),
            Value::Array(items) => serializer.collect_seq(items.iter().map(Shown)),
            other => other.serialize(serializer),
        }
    }
}

/// Schemas of the messages that clients of live runs send.
fn client_messages() -> Vec<Value> {
    let document: Value = serde_saphyr::from_str(&contract()).expect("the contract is YAML");
    let sent = document["paths"]["/v1/live"]["get"]["x-messages"]["client"].as_array().expect("messages");
    let pointer = |message: &Value| message["$ref"].as_str().expect("a reference").trim_start_matches('#').to_owned();
    sent.iter().map(|message| document.pointer(&pointer(message)).expect("a schema").clone()).collect()
}

#[test]
fn the_contract_is_written() {
    is_written("openapi.yaml", |_| contract());
}

#[test]
fn dictionary_is_written() {
    for (name, words) in dictionaries::DICTIONARIES {
        let words = words();
        is_written(&format!("tests/fuzz/{name}.dict"), |dictionary| dictionaries::rewritten(dictionary, &words));
    }
}

/// Panics unless a file has the parts that follow from tables. With `UPDATE` set, writes them.
fn is_written(path: &str, rewritten: impl Fn(&str) -> String) {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let text = std::fs::read_to_string(&file).unwrap();
    let wanted = rewritten(&text);
    if std::env::var_os("UPDATE").is_some() {
        return std::fs::write(&file, wanted).unwrap();
    }
    let differs = text.lines().zip(wanted.lines()).position(|(written, wanted)| written != wanted);
    assert!(
        text == wanted,
        "{path}:{}: not what the code gives; UPDATE=1 cargo test --test written rewrites it",
        differs.map_or(0, |line| line + 1)
    );
}
