//! The table of symbols in `docs/physics.md` against the table of scene fields: units and defaults.

use equipoise_physics::scene::{FIELDS, Field, Value, field};

use equipoise::api::scene::schema::number;

/// Differences of the documentation from the table.
pub(crate) fn differences(document: &str) -> Vec<String> {
    let (mut differences, mut seen) = (Vec::new(), Vec::new());
    for line in document.lines().filter(|line| line.starts_with('|')) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let [_, paths, units, meaning] = cells[..] else { continue };
        let rows: Vec<&Field> = paths.split('`').skip(1).step_by(2).flat_map(expanded).filter_map(field).collect();
        let units: Vec<&str> = units.split(", ").filter(|unit| !unit.is_empty()).collect();
        seen.extend(rows.iter().map(|row| row.path));
        for (index, row) in rows.iter().enumerate() {
            let unit = if units.len() == rows.len() { units.get(index) } else { units.first() };
            if *unit.unwrap_or(&"1") != row.unit && rows.len() <= 4 {
                differences.push(format!("{} is in {unit:?}, and in the table of fields in {}", row.path, row.unit));
            }
            if !has_default(row, meaning) {
                differences.push(format!("the default of {} is not that of the table of fields: {meaning}", row.path));
            }
        }
    }
    let missing = FIELDS.iter().filter(|row| !seen.contains(&row.path));
    differences.extend(missing.map(|row| format!("{} is not in the table of symbols", row.path)));
    differences
}

/// The paths that a name with alternatives in braces, or with a star at its end, stands for.
fn expanded(name: &str) -> Vec<&str> {
    if let Some(group) = name.strip_suffix('*') {
        return FIELDS.iter().map(|row| row.path).filter(|path| path.starts_with(group)).collect();
    }
    let Some((group, rest)) = name.split_once('{') else { return vec![name] };
    let keys: Vec<&str> = rest.trim_end_matches('}').split(", ").collect();
    let matches = |path: &&str| path.strip_prefix(group).is_some_and(|key| keys.contains(&key));
    FIELDS.iter().map(|row| row.path).filter(matches).collect()
}

/// Tells whether a text that names a default names the default of the field.
fn has_default(row: &Field, meaning: &str) -> bool {
    let said = match row.default {
        Some(Value::Number(value)) => format!("default {}", number(value)),
        Some(Value::Choice(word)) => format!("`{word}` (default)"),
        Some(Value::Integer(_) | Value::Flag(_) | Value::Numbers(_)) | None => return true,
    };
    !meaning.contains("default") || meaning.contains(&said)
}
