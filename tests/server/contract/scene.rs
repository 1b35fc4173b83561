//! The parts of `openapi.yaml` that follow from the table of scene fields, from the presets, from the endings of runs and from what analyses
//! need of a scene.
//!
//! `UPDATE=1 cargo test --test server scene_parts` rewrites them: the blocks between `# >>>` and `# <<<`, every list of references to scene
//! parameters, the list of what is not derived and every `x-refuses`. Everything else in the file is written by hand.

use std::collections::BTreeSet;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write as _;

use equipoise::api::scene::{field_text, presets};
use equipoise::api::shared::refusal::{exceptions, refused_bodies};
use equipoise_physics::map::polygon::{FARTHEST, MAX_VERTICES};
use equipoise_physics::scene::capability::Analysis;
use equipoise_physics::scene::{FIELDS, Field, FieldKind, Name, VERTICES, Value};

use super::endings;

/// Operations that refuse a scene by what their analysis needs of the body.
const REFUSING: [(&str, Analysis); 3] =
    [("postController", Analysis::Controller), ("postCatch", Analysis::Catch), ("postThrow", Analysis::Throw)];

/// The contract with its scene parts written anew.
pub(crate) fn rewritten(contract: &str) -> String {
    let mut text = String::new();
    let mut lines = contract.lines().peekable();
    while let Some(line) = lines.next() {
        if let Some(name) = line.trim_start().strip_prefix("# >>> ") {
            let end = line.replace("# >>> ", "# <<< ");
            let skipped = lines.by_ref().take_while(|line| *line != end).count();
            assert!(lines.peek().is_some(), "no end of the block {name} after {skipped} lines");
            let _ = write!(text, "{line}\n{}{end}\n", block(name));
        } else if line.trim_start().starts_with("**Not derived.**") {
            let indent = &line[..line.len() - line.trim_start().len()];
            let _ = writeln!(text, "{line}");
            for exception in exceptions().lines() {
                let _ = writeln!(text, "{indent}{exception}");
            }
            while lines.next_if(|line| !line.is_empty()).is_some() {}
        } else if line.trim_start().starts_with("x-refuses:") {
            // Written after the operation's name.
        } else if let Some((indent, name)) = line.split_once("operationId: ")
            && let Some((_, analysis)) = REFUSING.iter().find(|(operation, _)| *operation == name)
        {
            let _ = writeln!(text, "{line}\n{indent}x-refuses: [{}]", refused_bodies(*analysis).join(", "));
        } else if is_scene_parameter(line) {
            while lines.next_if(|line| is_scene_parameter(line)).is_some() {}
            let indent = &line[..line.len() - line.trim_start().len()];
            for path in paths() {
                let _ = writeln!(text, "{indent}- {{ $ref: '#/components/parameters/scene.{path}' }}");
            }
        } else {
            text.push_str(line);
            text.push('\n');
        }
    }
    text
}

fn is_scene_parameter(line: &str) -> bool {
    line.trim_start().starts_with("- { $ref: '#/components/parameters/scene.")
}

/// The lines of a block.
fn block(name: &str) -> String {
    match name {
        "scene parameters" => FIELDS.iter().map(parameter).chain([vertices_parameter()]).collect(),
        "scene fields" => FIELDS.iter().map(schema).collect(),
        "presets" => preset_names(),
        "vertices" => vertices(),
        "ScenePatch" => {
            let mut text = String::new();
            tree(&mut text, Form::Patch, "", 4, &FIELDS.iter().map(|row| row.path).collect::<Vec<_>>());
            text
        }
        "Scene" => answered(),
        "LiveFields" => {
            let mut text = live_by_path();
            tree(&mut text, Form::Live, "", 4, &live().map(|row| row.path).collect::<Vec<_>>());
            text
        }
        "live.set" => live_by_path(),
        "OutcomeKind" => endings::kinds(),
        "AnyOutcomeKind" => endings::any_kinds(),
        "EnsembleCounts" => endings::counts(&[]),
        "RegionCounts" => endings::counts(&["none"]),
        "RegionOutcomes" => endings::codes(),
        _ => panic!("no block has the name {name}"),
    }
}

/// Paths of all fields, the vertices included, in the order of the table.
fn paths() -> Vec<&'static str> {
    FIELDS.iter().flat_map(|row| with_vertices(row.path)).collect()
}

/// The vertices stand before the contact vertex, which is one of them.
fn with_vertices(path: &'static str) -> Vec<&'static str> {
    if path == Name::ContactVertex.row().path { vec![VERTICES, path] } else { vec![path] }
}

fn live() -> impl Iterator<Item = &'static Field> {
    FIELDS.iter().filter(|row| row.live)
}

/// A text as a YAML scalar.
fn quoted(text: &str) -> String {
    format!("'{}'", text.replace('\'', "''"))
}

/// A number for people: multiples of π as such.
pub(crate) fn number(value: f64) -> String {
    match value {
        PI => "π".to_owned(),
        FRAC_PI_2 => "π/2".to_owned(),
        _ if value == -PI => "-π".to_owned(),
        _ => value.to_string(),
    }
}

/// Range and default of a field in a sentence; empty if it has neither.
fn range(row: &Field) -> String {
    let unit = if row.unit == "1" { String::new() } else { format!(" {}", row.unit) };
    let default = match row.default {
        Some(Value::Number(value)) => Some(number(value)),
        Some(Value::Choice(word)) => Some(format!("`{word}`")),
        Some(value) => Some(value.to_string()),
        None => None,
    };
    let range = match row.kind {
        FieldKind::Numbers { minimum, maximum, most } => {
            Some(format!("from 1 to {most} numbers, each from {} to {}{unit}", number(minimum), number(maximum)))
        }
        FieldKind::Number { minimum, maximum } => {
            Some(format!("from {} to {}{unit}", number(minimum), number(maximum)))
        }
        FieldKind::Integer { maximum } => Some(format!("from 0 to {maximum}")),
        FieldKind::Choice(_) | FieldKind::Flag => None,
    };
    let parts: Vec<String> = range.into_iter().chain(default.map(|value| format!("by default {value}"))).collect();
    let mut sentence = parts.join(", ");
    if let Some(first) = sentence.get(..1).map(str::to_uppercase) {
        sentence.replace_range(..1, &first);
        sentence.push('.');
    }
    sentence
}

fn description(row: &Field, with_detail: bool) -> String {
    let text = field_text(row.name);
    let detail = if with_detail { text.detail } else { "" };
    let sentences = [text.about, detail].into_iter().filter(|part| !part.is_empty()).map(|part| format!("{part}."));
    let all: Vec<String> = sentences.chain([range(row)]).filter(|part| !part.is_empty()).collect();
    quoted(&all.join(" "))
}

/// A line of `components/parameters`; a block for a list, each number of which is a parameter of its own.
fn parameter(row: &Field) -> String {
    let Field { path, .. } = row;
    if matches!(row.kind, FieldKind::Numbers { .. }) {
        return format!(
            "    scene.{path}:
      name: scene.{path}
      in: query
      description: |
        {}. {} Each number is a parameter of its own: `scene.{path}.0` is the first. Indices have no gaps.
        The parameter itself is never sent by this bare name.
      style: deepObject
      explode: true
      schema: {{ type: object }}
",
            field_text(row.name).about,
            range(row)
        );
    }
    let example = match field_text(row.name).example {
        "" => String::new(),
        example => format!(", example: {example}"),
    };
    format!(
        "    scene.{path}: {{ name: scene.{path}, in: query, schema: {{ $ref: '#/components/schemas/scene.{path}' }}{example}, \
         description: {} }}\n",
        description(row, false)
    )
}

fn vertices_parameter() -> String {
    format!(
        "    scene.{VERTICES}:
      name: scene.{VERTICES}
      in: query
      description: |
        Vertices of a polygon, counter-clockwise, in metres, in place of the two lengths. Each coordinate is a parameter of its own:
        `scene.{VERTICES}.0.0` is x of the first vertex, `scene.{VERTICES}.0.1` is its y. Indices have no gaps.
        The parameter itself is never sent by this bare name.
      style: deepObject
      explode: true
      schema: {{ type: object }}
"
    )
}

/// The format of an integer that does not fit into 32 bits, which generated clients take otherwise.
fn wide(maximum: u64) -> &'static str {
    if maximum > i32::MAX as u64 { ", format: int64" } else { "" }
}

/// A line of `components/schemas`: the values that a field takes.
fn schema(row: &Field) -> String {
    let mut parts = Vec::new();
    match row.kind {
        FieldKind::Number { minimum, maximum } => {
            parts.push(format!("type: number, minimum: {minimum}, maximum: {maximum}"));
        }
        FieldKind::Integer { maximum } => parts.push(format!("type: integer{}, minimum: 0, maximum: {maximum}", wide(maximum))),
        FieldKind::Choice(words) => parts.push(format!("type: string, enum: [{}]", words.join(", "))),
        FieldKind::Flag => parts.push("type: boolean".to_owned()),
        FieldKind::Numbers { minimum, maximum, most } => parts.push(format!(
            "type: array, minItems: 1, maxItems: {most}, items: {{ type: number, minimum: {minimum}, maximum: {maximum} }}"
        )),
    }
    parts.extend(row.default.map(|value| format!("x-default: {value}")));
    if matches!(row.kind, FieldKind::Number { .. } | FieldKind::Integer { .. } | FieldKind::Numbers { .. }) {
        parts.push(format!("x-unit: {}", quoted(row.unit)));
    }
    let symbol = field_text(row.name).symbol;
    if !symbol.is_empty() {
        parts.push(format!("x-symbol: {}", quoted(symbol)));
    }
    parts.push(format!("description: {}", description(row, true)));
    format!("    scene.{}: {{ {} }}\n", row.path, parts.join(", "))
}

fn preset_names() -> String {
    format!(
        "    PresetName: {{ type: string, enum: [{}], description: 'Name of a preset; `/v1/scenes` lists them.' }}\n",
        presets::names().join(", ")
    )
}

fn vertices() -> String {
    format!(
        "      minItems: 3
      maxItems: {MAX_VERTICES}
      items:
        type: array
        minItems: 2
        maxItems: 2
        items: {{ type: number, minimum: -{FARTHEST}, maximum: {FARTHEST} }}
"
    )
}

/// Forms in which a scene stands in the contract as an object of objects.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    /// As it is asked for: null takes a value back.
    Patch,
    /// As it is answered.
    Answer,
    /// As it is set during a run.
    Live,
}

/// Parts of an answered scene that may be null by the contract. They never are; generated clients have names of types for them.
const NULLABLE: [&str; 5] =
    ["table.tilt_gain", "table.target_height", "table.feedback", "table.assumed_restitution", "noise"];

/// Tells whether the contract allows null in place of this field or group.
fn is_nullable(form: Form, path: &str) -> bool {
    form == Form::Patch || (form == Form::Answer && NULLABLE.contains(&path))
}

/// A reference to the schema of a field.
fn reference(form: Form, path: &str) -> String {
    let schema = if path == VERTICES { "Vertices".to_owned() } else { format!("scene.{path}") };
    let reference = format!("{{ $ref: '#/components/schemas/{schema}' }}");
    if is_nullable(form, path) { format!("{{ anyOf: [{reference}, {{ type: 'null' }}] }}") } else { reference }
}

/// Properties below `group` (empty or ending in a dot), one line for each field and one block for each group of fields.
fn tree(text: &mut String, form: Form, group: &str, depth: usize, paths: &[&'static str]) {
    let indent = "  ".repeat(depth);
    let mut seen = BTreeSet::new();
    for path in paths.iter().flat_map(|path| if form == Form::Live { vec![*path] } else { with_vertices(path) }) {
        let Some(rest) = path.strip_prefix(group) else { continue };
        let Some((key, _)) = rest.split_once('.') else {
            // In `LiveFields` these stand there by path already.
            if form != Form::Live || !group.is_empty() {
                let _ = writeln!(text, "{indent}{rest}: {}", reference(form, path));
            }
            continue;
        };
        if !seen.insert(key) {
            continue;
        }
        let inner = format!("{group}{key}.");
        if form == Form::Answer && inner == "body." {
            text.push_str(&bodies());
            continue;
        }
        let kind = if is_nullable(form, inner.trim_end_matches('.')) { "[object, 'null']" } else { "object" };
        let _ = writeln!(text, "{indent}{key}:\n{indent}  type: {kind}\n{indent}  additionalProperties: false");
        let always: Vec<&str> = if form == Form::Answer {
            let below = FIELDS.iter().filter_map(|row| Some((row, row.path.strip_prefix(inner.as_str())?)));
            below.filter(|(row, _)| is_always_answered(row)).map(|(_, key)| key).collect()
        } else {
            Vec::new()
        };
        if !always.is_empty() {
            let _ = writeln!(text, "{indent}  required: [{}]", always.join(", "));
        }
        let _ = writeln!(text, "{indent}  properties:");
        tree(text, form, &inner, depth + 2, paths);
    }
}

/// Tells whether every scene that is answered has the field. A point mass has no angle, and state feedback no tilt gain.
fn is_always_answered(row: &Field) -> bool {
    let depends = matches!(row.name, Name::Theta | Name::ThetaDot | Name::TiltGain);
    (row.default.is_some() || row.required) && !depends
}

fn answered() -> String {
    let mut groups: Vec<&str> = Vec::new();
    for row in FIELDS.iter().filter(|row| is_always_answered(row)) {
        if !groups.contains(&row.group()) {
            groups.push(row.group());
        }
    }
    let mut text = format!("      required: [{}]\n      properties:\n", groups.join(", "));
    tree(&mut text, Form::Answer, "", 4, &FIELDS.iter().map(|row| row.path).collect::<Vec<_>>());
    text
}

/// The three kinds of body, each with all of its fields.
fn bodies() -> String {
    let [length, rho, offset, point, contact_vertex] =
        [Name::ContactDistance, Name::RadiusOfGyration, Name::Offset, Name::PointMass, Name::ContactVertex]
            .map(|name| name.row().path);
    let mut text = "        body:\n          oneOf:\n".to_owned();
    for (title, paths, optional) in [
        ("A rod.", vec![length, rho], vec![offset]),
        ("A point mass.", vec![point], vec![]),
        ("A polygon.", vec![VERTICES, contact_vertex], vec![]),
    ] {
        let keys: Vec<&str> = paths.iter().map(|path| path.trim_start_matches("body.")).collect();
        let _ = write!(
            text,
            "            - type: object\n              description: {title}\n              additionalProperties: false\n              \
             required: [{}]\n              properties:\n",
            keys.join(", ")
        );
        let keys = paths.iter().chain(&optional).map(|path| (path.trim_start_matches("body."), path));
        for (key, path) in keys {
            let _ = writeln!(text, "                {key}: {}", reference(Form::Answer, path));
        }
    }
    text
}

fn live_by_path() -> String {
    let line = |row: &Field| format!("        {}: {}\n", row.path, reference(Form::Live, row.path));
    live().map(line).collect()
}
