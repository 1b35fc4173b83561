//! The checks of `tests/fuzz/checks` on their corpora and on mutations of them. `tests/fuzz/run` drives the same checks with libFuzzer
//! for any time.

#[path = "fuzz/checks/mod.rs"]
mod checks;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use checks::{ALL, Check};
use proptest::prelude::*;
use proptest::sample::Index;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz")
}

/// Names and bytes of all inputs of a corpus, in order. Each follows a line `==== name`; a line break after it is not its own.
fn corpus(check: &Check) -> Vec<(String, Vec<u8>)> {
    let path = folder().join("corpus").join(format!("{}.txt", check.name));
    let bytes = fs::read(path).expect("every check has a corpus");
    let mut inputs: Vec<(String, Vec<u8>)> = Vec::new();
    for line in bytes.split_inclusive(|&byte| byte == b'\n') {
        if let Some(name) = line.strip_prefix(b"==== ") {
            inputs.push((format!("{} {}", check.name, String::from_utf8_lossy(name.trim_ascii())), Vec::new()));
        } else {
            inputs.last_mut().expect("a name comes first").1.extend_from_slice(line);
        }
    }
    for (_, input) in &mut inputs {
        input.pop();
    }
    inputs
}

/// The words of a libFuzzer dictionary.
fn words(check: &Check) -> Vec<Vec<u8>> {
    let text = fs::read_to_string(folder().join(format!("{}.dict", check.name))).expect("a dictionary");
    let quoted = text.lines().filter_map(|line| line.strip_prefix('"')?.strip_suffix('"'));
    quoted.map(|word| word.replace("\\\"", "\"").replace("\\\\", "\\").into_bytes()).collect()
}

#[test]
fn every_input_of_the_corpus_passes() {
    let mut failed = Vec::new();
    for check in &ALL {
        let inputs = corpus(check);
        assert!(inputs.len() >= 10, "{}: {} inputs", check.name, inputs.len());
        for (path, input) in inputs {
            if catch_unwind(AssertUnwindSafe(|| (check.run)(&input))).is_err() {
                failed.push(path);
            }
        }
    }
    assert!(failed.is_empty(), "{failed:#?}");
}

/// One change to an input.
#[derive(Clone, Debug)]
enum Edit {
    Byte(Index, u8),
    Cut(Index, usize),
    Repeat(Index, usize),
    Word(Index, Index),
    Splice(Index, Index, Index),
}

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        (any::<Index>(), any::<u8>()).prop_map(|(at, byte)| Edit::Byte(at, byte)),
        (any::<Index>(), 1_usize..30).prop_map(|(at, length)| Edit::Cut(at, length)),
        (any::<Index>(), 1_usize..60).prop_map(|(at, length)| Edit::Repeat(at, length)),
        (any::<Index>(), any::<Index>()).prop_map(|(at, word)| Edit::Word(at, word)),
        (any::<Index>(), any::<Index>(), any::<Index>()).prop_map(|(at, input, from)| Edit::Splice(at, input, from)),
    ]
}

fn edited(mut input: Vec<u8>, edits: &[Edit], inputs: &[(String, Vec<u8>)], words: &[Vec<u8>]) -> Vec<u8> {
    for edit in edits {
        let place = |at: &Index| at.index(input.len() + 1);
        match edit {
            Edit::Byte(at, byte) => {
                let at = place(at);
                if at < input.len() {
                    input[at] = *byte;
                }
            }
            Edit::Cut(at, length) => {
                let at = place(at);
                input.drain(at..(at + length).min(input.len()));
            }
            Edit::Repeat(at, length) => {
                let at = place(at);
                let copy = input[at..(at + length).min(input.len())].to_vec();
                input.splice(at..at, copy);
            }
            Edit::Word(at, word) => {
                let at = place(at);
                input.splice(at..at, word.get(words).iter().copied());
            }
            Edit::Splice(at, other, from) => {
                let (at, other) = (place(at), &other.get(inputs).1);
                input.truncate(at);
                input.extend_from_slice(&other[from.index(other.len() + 1)..]);
            }
        }
    }
    input
}

/// Mutated inputs of the corpus.
fn hold_for_changed_inputs(name: &str, cases: u32) {
    let check = ALL.iter().find(|check| check.name == name).expect("a check");
    let (inputs, words) = (corpus(check), words(check));
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    proptest!(config, |(input: Index, edits in prop::collection::vec(edit(), 0..8))| {
        let input = edited(input.get(&inputs).1.clone(), &edits, &inputs, &words);
        let passed = catch_unwind(AssertUnwindSafe(|| (check.run)(&input))).is_ok();
        prop_assert!(passed, "{}", String::from_utf8_lossy(&input));
    });
}

#[test]
fn any_body_is_a_scene_or_refused_with_reasons() {
    hold_for_changed_inputs("scene", 2000);
}

#[test]
fn any_query_says_what_its_json_says() {
    hold_for_changed_inputs("query", 2000);
}

#[test]
fn any_live_message_leaves_a_run_that_its_url_gives_back() {
    hold_for_changed_inputs("live", 1000);
}

/// A number of any size.
fn number() -> impl Strategy<Value = f64> {
    prop_oneof![
        4 => -2.0..2.0,
        4 => (-6.0..3.0, any::<bool>()).prop_map(|(power, sign)| if sign { 10_f64.powf(power) } else { -(10_f64.powf(power)) }),
        1 => prop::sample::select(vec![0.0, 1.0, -1.0, std::f64::consts::PI, 1e-12, 1e6]),
    ]
}

/// Lines of inputs of the corpus with most numbers replaced.
fn hold_for_numbers(name: &str, cases: u32) {
    let check = ALL.iter().find(|check| check.name == name).expect("a check");
    let inputs = corpus(check);
    let config = ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() };
    let changes = prop::collection::vec(prop::option::weighted(0.6, number()), 20);
    proptest!(config, |(input: Index, changes in changes)| {
        let text = std::str::from_utf8(&input.get(&inputs).1).expect("lines of text");
        let lines = text.lines().zip(changes).map(|(line, change)| match (change, line.split_once(' ')) {
            (Some(number), Some((name, _))) => format!("{name} {number:?}\n"),
            _ => format!("{line}\n"),
        });
        let input: String = lines.collect();
        let passed = catch_unwind(AssertUnwindSafe(|| (check.run)(input.as_bytes()))).is_ok();
        prop_assert!(passed, "{input}");
    });
}

#[test]
fn any_flight_ends_at_its_first_contact() {
    hold_for_numbers("contact_time", 1500);
}

#[test]
fn any_strike_keeps_momentum_energy_and_its_laws() {
    hold_for_numbers("impulse", 4000);
}
