//! Files that follow from the code: `openapi.yaml`, and words of the fuzz dictionaries. `UPDATE=1 cargo test --test written` writes them.

use std::collections::BTreeSet;
use std::path::Path;

use equipoise::api::{contract, contract_parts};
use equipoise_physics::scene::{FIELDS, Field, FieldKind};
use serde::{Serialize, Serializer};
use serde_json::Value;
use serde_saphyr::{FlowMap, FlowSeq};

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
    for (name, words) in DICTIONARIES {
        let words = words();
        is_written(&format!("tests/fuzz/{name}.dict"), |dictionary| rewritten(dictionary, &words));
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

// The words of the fuzz dictionaries (`tests/fuzz/*.dict`) that follow from the table of scene fields, and from the messages of live clients.

/// Words of a dictionary.
type Words = fn() -> BTreeSet<String>;

/// The dictionaries by name, each with the function that gives the words between its marks.
const DICTIONARIES: [(&str, Words); 3] = [("scene", of_bodies), ("query", of_queries), ("live", of_messages)];

/// The lines before and after the words that follow.
const MARKS: [&str; 2] = ["# >>> written by UPDATE=1 cargo test --test written", "# <<<"];

/// A dictionary with these words between its marks.
fn rewritten(dictionary: &str, words: &BTreeSet<String>) -> String {
    let [begin, end] = MARKS.map(|mark| format!("{mark}\n"));
    let (before, rest) = dictionary.split_once(&begin).expect("the first mark");
    let (_, after) = rest.split_once(&end).expect("the second mark");
    let words: String =
        words.iter().map(|word| format!("\"{}\"\n", word.replace('\\', "\\\\").replace('"', "\\\""))).collect();
    format!("{before}{begin}{words}{end}{after}")
}

/// Keys of all groups and fields, and the words that fields take.
fn of_bodies() -> BTreeSet<String> {
    let keys = FIELDS.iter().flat_map(|row| row.path.split('.')).map(|key| format!("\"{key}\":"));
    keys.chain(FIELDS.iter().flat_map(choices).map(|word| format!("\"{word}\""))).collect()
}

/// Parameters of all fields, and the words that fields take.
fn of_queries() -> BTreeSet<String> {
    let parameter = |row: &Field| match row.kind {
        FieldKind::Numbers { .. } => format!("scene.{}.0=", row.path),
        FieldKind::Number { .. } | FieldKind::Integer { .. } | FieldKind::Choice(_) | FieldKind::Flag => {
            format!("scene.{}=", row.path)
        }
    };
    FIELDS.iter().map(parameter).chain(FIELDS.iter().flat_map(choices).map(|word| (*word).to_owned())).collect()
}

/// Dotted paths of all fields, and types and members of the messages of clients.
fn of_messages() -> BTreeSet<String> {
    let mut words: BTreeSet<String> = FIELDS.iter().map(|row| format!("\"{}\":", row.path)).collect();
    for message in client_messages() {
        let members = message["properties"].as_object().expect("members");
        words.extend(members.keys().map(|key| format!("\"{key}\":")));
        words.extend(members["type"]["const"].as_str().map(|name| format!("\"{name}\"")));
    }
    words
}

/// The words that a field takes.
fn choices(row: &Field) -> &'static [&'static str] {
    match row.kind {
        FieldKind::Choice(words) => words,
        FieldKind::Number { .. } | FieldKind::Integer { .. } | FieldKind::Flag | FieldKind::Numbers { .. } => &[],
    }
}
