//! The words of the fuzz dictionaries (`tests/fuzz/*.dict`) that follow from the table of scene fields, and from the messages of live clients.

use std::collections::BTreeSet;

use equipoise_physics::scene::{FIELDS, Field, FieldKind};

use super::client_messages;

/// Words of a dictionary.
type Words = fn() -> BTreeSet<String>;

/// The dictionaries by name, each with the function that gives the words between its marks.
pub(super) const DICTIONARIES: [(&str, Words); 3] =
    [("scene", of_bodies), ("query", of_queries), ("live", of_messages)];

/// The lines before and after the words that follow.
const MARKS: [&str; 2] = ["# >>> written by UPDATE=1 cargo test --test written", "# <<<"];

/// A dictionary with these words between its marks.
pub(super) fn rewritten(dictionary: &str, words: &BTreeSet<String>) -> String {
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
