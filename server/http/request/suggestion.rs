//! The known name that somebody may have meant by an unknown one.

/// Least likeness (Jaro and Winkler, 0 to 1) of a name that is suggested. Lower ones are other words.
const LIKENESS: f64 = 0.85;

/// Names in requests of version 0.2, and the names that they have since.
const RENAMED: [(&str, &str); 7] = [
    ("impacts", "bounces"),
    ("epoch", "epoch_ms"),
    ("wall", "wall_ms"),
    ("last_event_id", "after"),
    ("parameter", "field"),
    ("path", "field"),
    ("gain_margins", "release_margins"),
];

/// Names in earlier requests that are gone, and what does the same.
const RETIRED: [(&str, &str); 4] = [
    ("columns", "gone since 0.3: all live impacts are flat"),
    ("dial", "gone after 0.3: `linear.eigenvalues` and `margins` have its numbers, and `format=svg` draws it"),
    ("end", "gone since 0.3: the last line of NDJSON is a record that readers can skip"),
    ("layout", "gone since 0.3: the cells of a map stand row by row, so a column reshapes to the map"),
];

/// The advice on a name that is gone.
pub fn retired(name: &str) -> Option<&'static str> {
    RETIRED.iter().find(|(old, _)| *old == name).map(|(_, advice)| *advice)
}

/// Advice on an unknown name, to follow it in a sentence: the name that it has since version 0.3, what does the same if it is gone, the known name
/// most like it, or nothing if none is like it. A dotted path with the same last part is like it.
pub fn did_you_mean<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    let renamed = RENAMED.iter().find(|(old, new)| *old == name && known.contains(new));
    if let Some((_, new)) = renamed {
        return format!(" (since 0.3 it is `{new}`)");
    }
    if let Some(advice) = retired(name) {
        return format!(" ({advice})");
    }
    let last = |path: &str| path.rsplit('.').next().unwrap_or_default().to_owned();
    let likeness = |known: &str| {
        let whole = strsim::jaro_winkler(name, known);
        if last(known) == last(name) { whole.max(LIKENESS) } else { whole }
    };
    let best = known.into_iter().map(|known| (likeness(known), known)).filter(|(likeness, _)| *likeness >= LIKENESS);
    let best = best.reduce(|best, other| if other.0 > best.0 { other } else { best });
    best.map_or_else(String::new, |(_, known)| format!(" (did you mean `{known}`?)"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn like_names_are_suggested() {
        let known = ["table.tilt_gain", "table.energy_gain", "bounces", "release.theta"];
        for (name, suggestion) in [
            ("impacts", " (since 0.3 it is `bounces`)"),
            ("table.tilt_gian", " (did you mean `table.tilt_gain`?)"),
            ("tilt_gain", " (did you mean `table.tilt_gain`?)"),
            ("bounce", " (did you mean `bounces`?)"),
            ("colour", ""),
            ("end", " (gone since 0.3: the last line of NDJSON is a record that readers can skip)"),
        ] {
            assert_eq!(did_you_mean(name, known), suggestion, "{name}");
        }
    }
}
