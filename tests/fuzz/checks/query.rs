//! The query of a GET: from its text to the equivalent tree, and to the same scene as the equivalent JSON.

use equipoise::api::scene::scene_to_json;
use equipoise::http::request::tree;
use equipoise::http::{Problem, Source};
use equipoise_physics::scene::{FIELDS, FieldKind, VERTICES, field};
use serde_json::{Map, Number, Value};

use super::{problem, scene};

/// A tree is written as a query that reads back as the same tree. Errors point to a parameter. The JSON of the same request gives the
/// same scene or the same errors.
pub(crate) fn check(data: &[u8]) {
    let Ok(query) = std::str::from_utf8(data) else { return };
    let parameters = match tree::parameters(query) {
        Ok(parameters) => parameters,
        Err(refused) => return problem::hold(&refused, None, data.len()),
    };
    let names: Vec<String> = parameters.iter().map(|(name, _)| pointer(name)).collect();
    let fields = match tree::unfold(parameters) {
        Ok(fields) => fields,
        Err(refused) => {
            problem::hold(&refused, None, data.len());
            for error in refused.errors() {
                let leads = |name: &String| {
                    name.strip_prefix(&error.pointer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
                };
                assert!(names.iter().any(leads), "{} is in no parameter of {query}", error.pointer);
            }
            return;
        }
    };
    let sent = Value::Object(fields);
    let mut leaves = Vec::new();
    flatten(String::new(), &sent, &mut leaves);
    assert_eq!(leaves.len(), names.len(), "every parameter is in the tree, and nothing else: {query} is {sent}");
    let written = form_urlencoded::Serializer::new(String::new()).extend_pairs(leaves).finish();
    let again = tree(&written).unwrap_or_else(|refused| panic!("{written} was refused: {refused:?}"));
    assert_eq!(Value::Object(again), sent, "{query} and {written}");
    compare(&sent, data.len());
}

/// The tree of a query.
pub(crate) fn tree(query: &str) -> Result<Map<String, Value>, Problem> {
    tree::unfold(tree::parameters(query)?)
}

/// Panics unless the JSON equivalent of this tree is read the same.
fn compare(sent: &Value, bytes: usize) {
    // Two names of one group have no equivalent.
    let Some(long) = with_scene(sent) else { return };
    let same = in_json("", &long);
    let asked = scene::read(sent.as_object().expect("a query is an object"), Source::Query);
    let posted = scene::read(same.as_object().expect("a query is an object"), Source::Json);
    match (asked, posted) {
        (Ok(asked), Ok(posted)) => {
            assert_eq!(scene_to_json(&asked).to_string(), scene_to_json(&posted).to_string(), "{sent} and {same}");
            scene::hold(&asked);
        }
        (Err(asked), Err(posted)) => {
            problem::hold(&asked, Some(&long), bytes);
            let pointers = |refused: &Problem| -> Vec<String> {
                refused.errors().iter().map(|error| error.pointer.clone()).collect()
            };
            assert_eq!(pointers(&asked), pointers(&posted), "{sent} and {same}: {asked:?} and {posted:?}");
        }
        (asked, posted) => panic!("{sent} and {same}: {asked:?} and {posted:?}"),
    }
}

/// The tree with the groups of a scene in `scene`, where a query may leave that out. None if a group is there in both ways.
fn with_scene(sent: &Value) -> Option<Value> {
    let mut long = sent.clone();
    let fields = long.as_object_mut().expect("a query is an object");
    let mut groups: Vec<&str> = FIELDS.iter().filter_map(|row| row.path.split('.').next()).collect();
    groups.dedup();
    for group in groups {
        let is_of_scene = |value: &&Value| value.is_object() || field(group).is_some();
        let Some(value) = fields.get(group).filter(is_of_scene).cloned() else { continue };
        fields.shift_remove(group);
        let scene = fields.entry("scene").or_insert_with(|| Value::Object(Map::new())).as_object_mut()?;
        if scene.insert(group.to_owned(), value).is_some() {
            return None;
        }
    }
    Some(long)
}

/// The JSON equivalent of a query's text: a number for a numeric field, if the text is one.
fn in_json(path: &str, value: &Value) -> Value {
    match value {
        Value::Object(fields) => {
            let below = |(name, value): (&String, &Value)| {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                (name.clone(), in_json(&path, value))
            };
            Value::Object(fields.iter().map(below).collect())
        }
        Value::Array(items) => Value::Array(items.iter().map(|item| in_json(path, item)).collect()),
        Value::String(text) => {
            let as_number = || text.parse().ok().and_then(Number::from_f64).map(Value::Number);
            let row = path.strip_prefix("scene.").and_then(field);
            let read = match (row, row.map(|row| row.kind)) {
                (Some(_), _) if text == "null" => Some(Value::Null),
                (_, Some(FieldKind::Number { .. } | FieldKind::Integer { .. } | FieldKind::Numbers { .. })) => {
                    as_number()
                }
                (_, Some(FieldKind::Flag)) => flag(text).map(Value::Bool),
                (None, _) if path.strip_prefix("scene.") == Some(VERTICES) => as_number(),
                _ => None,
            };
            read.unwrap_or_else(|| value.clone())
        }
        other => panic!("{other} in the tree of a query"),
    }
}

/// The dotted parameters of a tree.
fn flatten(path: String, value: &Value, leaves: &mut Vec<(String, String)>) {
    let mut below = |name: &str, value: &Value| {
        flatten(if path.is_empty() { name.to_owned() } else { format!("{path}.{name}") }, value, leaves)
    };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(name, value)| below(name, value)),
        Value::Array(items) => items.iter().enumerate().for_each(|(index, value)| below(&index.to_string(), value)),
        Value::String(text) => leaves.push((path, text.clone())),
        other => panic!("{other} in the tree of a query"),
    }
}

/// The place of a parameter's value in the tree.
fn pointer(name: &str) -> String {
    name.split('.').map(|part| format!("/{}", part.replace('~', "~0").replace('/', "~1"))).collect()
}

/// The meaning of a boolean's text in a query.
fn flag(text: &str) -> Option<bool> {
    match text {
        "true" | "1" => Some(true),
        "false" | "0" => Some(false),
        _ => None,
    }
}
