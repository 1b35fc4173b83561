//! Unfolds a dotted query into a JSON tree: `a.b=1&c.0=2` becomes `{"a": {"b": "1"}, "c": ["2"]}`.
//!
//! Every value is text; `scalar` reads it as the schema asks. Arrays are written by indices from 0.

use std::collections::BTreeMap;

use percent_encoding::percent_decode_str;
use serde_json::{Map, Value};

use crate::http::problem::{Problem, shortened};
use crate::http::request::reader::{Errors, join};
use crate::limits;

/// Decoded names and values of a query, in their order. 400 if the encoding is not valid.
pub fn parameters(query: &str) -> Result<Vec<(String, String)>, Problem> {
    let broken = query.split('%').skip(1).find(|rest| {
        let digits = rest.as_bytes().get(..2);
        !digits.is_some_and(|digits| digits.iter().all(u8::is_ascii_hexdigit))
    });
    if let Some(rest) = broken {
        let near: String = rest.chars().take(2).collect();
        return Err(Problem::not_readable(format!("the query has %{near}, which is no percent-encoding; % is %25")));
    }
    if percent_decode_str(query).decode_utf8().is_err() {
        return Err(Problem::not_readable("the query is not UTF-8 once its percent-encoding is undone"));
    }
    let parameters: Vec<_> = form_urlencoded::parse(query.as_bytes()).into_owned().collect();
    if parameters.len() > limits::QUERY_PARAMETERS {
        let (count, limit) = (parameters.len(), limits::QUERY_PARAMETERS);
        return Err(Problem::invalid_at("", format!("the query has {count} parameters; at most {limit} are read")));
    }
    Ok(parameters)
}

/// JSON tree of dotted parameters. 422 if they contradict each other.
pub fn unfold(parameters: Vec<(String, String)>) -> Result<Map<String, Value>, Problem> {
    let mut errors = Errors::default();
    let mut root = BTreeMap::new();
    for (name, text) in parameters {
        let segments: Vec<&str> = name.split('.').collect();
        let pointer = segments.iter().fold(String::new(), |pointer, segment| join(&pointer, segment));
        let shown = shortened(&name);
        let placed = if segments.iter().any(|segment| segment.is_empty()) {
            Err(format!("the parameter `{shown}` has an empty part between its dots"))
        } else if segments.len() > limits::DEPTH {
            Err(format!("the parameter `{shown}` has more than {} parts", limits::DEPTH))
        } else {
            place(&mut root, &segments, text).map_err(|error| format!("the parameter `{shown}` {error}"))
        };
        if let Err(error) = placed {
            errors.push(pointer, error);
        }
    }
    let fields = root.into_iter().map(|(name, node)| {
        let pointer = join("", &name);
        let value = node.into_value(&pointer, &mut errors);
        (name, value)
    });
    let fields = fields.collect();
    errors.into_result().map(|()| fields)
}

enum Node {
    Leaf(String),
    Branch(BTreeMap<String, Node>),
}

fn place(branch: &mut BTreeMap<String, Node>, segments: &[&str], text: String) -> Result<(), String> {
    let (first, rest) = segments.split_first().expect("splitting text gives one part at least");
    if rest.is_empty() {
        return match branch.get(*first) {
            None => {
                branch.insert((*first).to_owned(), Node::Leaf(text));
                Ok(())
            }
            Some(Node::Leaf(_)) => Err("is there twice".to_owned()),
            Some(Node::Branch(_)) => {
                Err("is given a value, and so are fields within it; it can be only one".to_owned())
            }
        };
    }
    match branch.entry((*first).to_owned()).or_insert_with(|| Node::Branch(BTreeMap::new())) {
        Node::Branch(inner) => place(inner, rest, text),
        Node::Leaf(_) => Err(format!("is within `{}`, which is given a value itself", shortened(first))),
    }
}

impl Node {
    fn into_value(self, pointer: &str, errors: &mut Errors) -> Value {
        let fields = match self {
            Node::Leaf(text) => return Value::String(text),
            Node::Branch(fields) => fields,
        };
        let is_index = |name: &String| name.bytes().all(|byte| byte.is_ascii_digit());
        let indices = fields.keys().filter(|name| is_index(name)).count();
        if indices == 0 {
            let value = fields.into_iter().map(|(name, node)| {
                let value = node.into_value(&join(pointer, &name), errors);
                (name, value)
            });
            return Value::Object(value.collect());
        }
        let mut fields = fields;
        let count = fields.len();
        // Removed by index, since the map is sorted as text (10 before 2). The rest shows a missing index or a name.
        let items: Vec<Value> = (0..count)
            .map_while(|index| fields.remove(&index.to_string()).map(|node| (index, node)))
            .map(|(index, node)| node.into_value(&format!("{pointer}/{index}"), errors))
            .collect();
        if let Some(left) = fields.keys().next() {
            let detail = if indices < count {
                "the query mixes indices of an array with names of fields here".to_owned()
            } else {
                let (missing, found) = (items.len(), shortened(left));
                format!(
                    "the query has index {found} of an array but not {missing}; indices go 0, 1, 2, … without holes"
                )
            };
            errors.push(pointer, detail);
        }
        Value::Array(items)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn tree(query: &str) -> Result<Value, Problem> {
        unfold(parameters(query)?).map(Value::Object)
    }

    fn refused(query: &str) -> (u16, String, String) {
        let problem = tree(query).unwrap_err();
        let pointer = problem.errors().first().map(|error| error.pointer.clone()).unwrap_or_default();
        (problem.status().as_u16(), pointer, problem.detail().to_owned())
    }

    #[test]
    fn dots_are_levels() {
        assert_eq!(
            tree("preset=case-1&scene.table.tilt_gain=1.2&scene.table.kind=tilting&bounces=100").unwrap(),
            json!({"preset": "case-1", "scene": {"table": {"tilt_gain": "1.2", "kind": "tilting"}}, "bounces": "100"})
        );
        assert_eq!(tree("").unwrap(), json!({}));
        assert_eq!(tree("&&a=&").unwrap(), json!({"a": ""}));
        assert_eq!(tree("a%2Eb=x%20y+z%C3%A9").unwrap(), json!({"a": {"b": "x y zé"}}));
    }

    #[test]
    fn indices_are_arrays_in_order_of_number() {
        let query: Vec<String> = (0..12).rev().map(|n| format!("list.{n}.x={n}")).collect();
        let list = tree(&query.join("&")).unwrap();
        assert_eq!(list["list"].as_array().unwrap().len(), 12);
        assert_eq!(list["list"][10]["x"], "10");
        assert_eq!(tree("m.0.0=a&m.0.1=b&m.1.0=c").unwrap(), json!({"m": [["a", "b"], ["c"]]}));
    }

    #[test]
    fn contradictions_have_pointers() {
        for (query, at) in [
            ("a=1&a=2", "/a"),
            ("a=1&a.b=2", "/a/b"),
            ("a.b=2&a=1", "/a"),
            ("a..b=1", "/a//b"),
            (".a=1", "//a"),
            ("=1", "/"),
            ("list.1=x", "/list"),
            ("list.0=x&list.2=y", "/list"),
            ("list.0=x&list.00=y", "/list"),
            ("s.list.0=x&s.list.b=y", "/s/list"),
            ("list.99999999999999999999=x", "/list"),
        ] {
            let (status, pointer, detail) = refused(query);
            assert_eq!((status, pointer.as_str()), (422, at), "{query}: {detail}");
        }
        assert_eq!(refused("a=1&a=2").2, "the parameter `a` is there twice");
        assert!(refused("list.0=x&list.2=y").2.contains("index 2 of an array but not 1"));
    }

    #[test]
    fn encoding_is_checked() {
        for query in ["a=%", "a=%4", "a=%zz", "a=%+1", "a=%ff", "%c3%28=1"] {
            assert_eq!(refused(query).0, 400, "{query}");
        }
    }

    #[test]
    fn size_is_bounded() {
        let many = |n: usize| (0..n).map(|n| format!("k{n}=")).collect::<Vec<_>>().join("&");
        assert!(tree(&many(limits::QUERY_PARAMETERS)).is_ok());
        assert_eq!(refused(&many(limits::QUERY_PARAMETERS + 1)).0, 422);
        assert_eq!(refused(&format!("a{}=1", ".b".repeat(limits::DEPTH))).0, 422);
    }
}
