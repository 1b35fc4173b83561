//! The parts of `openapi.yaml` that follow from the endings of runs.

use std::fmt::Write as _;

use equipoise::api::shared::outcome::meaning;
use equipoise_physics::run::ending::EndingKind;

/// Longest line of the contract's prose.
const WIDTH: usize = 139;

fn names() -> Vec<&'static str> {
    EndingKind::ALL.into_iter().map(EndingKind::name).collect()
}

/// The schema of an ending's name.
pub(super) fn kinds() -> String {
    let mut text = "    OutcomeKind:\n      description: |\n".to_owned();
    for ending in EndingKind::ALL {
        let mut line = format!("        - `{}`:", ending.name());
        for word in meaning(ending).split(' ') {
            if line.chars().count() + 1 + word.chars().count() > WIDTH {
                let _ = writeln!(text, "{line}");
                line = " ".repeat(9);
            }
            let _ = write!(line, " {word}");
        }
        let _ = writeln!(text, "{line}");
    }
    text + &format!("      type: string\n      enum: [{}]\n", names().join(", "))
}

/// The schema of the name of an ending or of the outcome of a catch. One list, because generators do not join two.
pub(super) fn any_kinds() -> String {
    let catches = ["held", "rests_on_edge", "fell", "slipped", "beyond_limits", "not_caught"];
    let mut names = names();
    names.extend(catches.into_iter().filter(|name| EndingKind::ALL.into_iter().all(|ending| ending.name() != *name)));
    format!(
        "    AnyOutcomeKind:\n      description: A name of OutcomeKind or of CatchOutcomeKind.\n      type: string\n      enum: [{}]\n",
        names.join(", ")
    )
}

/// Counts by ending, and by other names.
pub(super) fn counts(others: &[&'static str]) -> String {
    let names = [&names(), others].concat();
    let properties: String =
        names.iter().map(|name| format!("        {name}: {{ type: integer, minimum: 0 }}\n")).collect();
    format!("      required: [{}]\n      properties:\n{properties}", names.join(", "))
}

/// Codes of cells: those of the endings, and one for no run.
pub(super) fn codes() -> String {
    format!("      items: {{ type: integer, minimum: 0, maximum: {} }}\n", EndingKind::ALL.len())
}
