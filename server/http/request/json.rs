//! Reads a JSON body strictly: depth and length of names are bounded, and a duplicate key or a number too large for double
//! precision is an error with its pointer.

use std::fmt;

use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};

use crate::http::problem::{Problem, shortened};
use crate::http::request::reader::{Errors, join};
use crate::limits;

/// Returns the fields of a body: 400 if it is not JSON, 422 if it is not an object or is ambiguous.
pub fn object(body: &[u8]) -> Result<Map<String, Value>, Problem> {
    if body.trim_ascii().is_empty() {
        return Err(Problem::not_readable("the body is empty; it must be a JSON object"));
    }
    let text = std::str::from_utf8(body).map_err(|error| {
        Problem::not_readable(format!("the body is not JSON: it is not UTF-8 from byte {} on", error.valid_up_to()))
    })?;
    let mut state = ParseState::default();
    let mut deserializer = serde_json::Deserializer::from_str(text);
    let value = Strict(&mut state).deserialize(&mut deserializer);
    let value = value.and_then(|value| deserializer.end().map(|()| value));
    match value {
        Ok(Value::Object(fields)) => state.errors.into_result().map(|()| fields),
        Ok(_) => Err(Problem::invalid_at("", "the body must be a JSON object")),
        Err(_) if state.too_deep => Err(Problem::invalid_at(
            state.pointer(),
            format!("the body is nested more than {} levels deep", limits::DEPTH),
        )),
        // The only parser error about a value rather than the grammar. It has no category of its own.
        Err(error) if error.to_string().starts_with("number out of range") => Err(Problem::invalid_at(
            state.pointer(),
            format!("the number at line {} column {} is not finite in double precision", error.line(), error.column()),
        )),
        Err(error) => {
            let hint = word_at(text, error.line(), error.column())
                .filter(|word| ["NaN", "Infinity", "nan", "inf"].iter().any(|known| word.contains(known)))
                .map_or("", |_| ". JSON has no NaN and no infinity: write null for a value that does not exist");
            Err(Problem::not_readable(format!("the body is not JSON: {error}{hint}")))
        }
    }
}

/// The word of letters around a place of a text, which counts lines and bytes from 1.
fn word_at(text: &str, line: usize, column: usize) -> Option<&str> {
    let line = text.lines().nth(line.checked_sub(1)?)?;
    let (before, after) = line.split_at_checked(column.min(line.len()))?;
    let start = before.trim_end_matches(|letter: char| letter.is_ascii_alphabetic()).len();
    let end = after.len() - after.trim_start_matches(|letter: char| letter.is_ascii_alphabetic()).len();
    line.get(start..before.len() + end)
}

/// Position in the body, and the errors so far.
#[derive(Default)]
struct ParseState {
    path: Vec<String>,
    errors: Errors,
    too_deep: bool,
}

impl ParseState {
    fn pointer(&self) -> String {
        self.path.iter().fold(String::new(), |pointer, name| join(&pointer, name))
    }

    /// Reads one level deeper. After an error the path stays at its place.
    fn within<T, E: Error>(&mut self, name: String, read: impl FnOnce(&mut Self) -> Result<T, E>) -> Result<T, E> {
        self.path.push(name);
        if self.path.len() > limits::DEPTH {
            self.too_deep = true;
            return Err(E::custom("too deep"));
        }
        let value = read(self)?;
        self.path.pop();
        Ok(value)
    }
}

struct Strict<'r>(&'r mut ParseState);

impl<'de> DeserializeSeed<'de> for Strict<'_> {
    type Value = Value;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Strict<'_> {
    type Value = Value;

    fn expecting(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.write_str("a JSON value")
    }

    fn visit_unit<E: Error>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E: Error>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Value, E> {
        Ok(Value::from(value))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Number::from_f64(value).map(Value::Number).ok_or_else(|| E::custom("number out of range"))
    }

    fn visit_str<E: Error>(self, value: &str) -> Result<Value, E> {
        Ok(Value::String(value.to_owned()))
    }

    fn visit_string<E: Error>(self, value: String) -> Result<Value, E> {
        Ok(Value::String(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Value, A::Error> {
        let mut items = Vec::new();
        loop {
            let index = items.len().to_string();
            let item = self.0.within(index, |state| sequence.next_element_seed(Strict(state)))?;
            match item {
                Some(item) => items.push(item),
                None => return Ok(Value::Array(items)),
            }
        }
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Value, A::Error> {
        let mut fields = Map::new();
        while let Some(name) = map.next_key::<String>()? {
            if name.len() > limits::NAME_BYTES {
                let (shown, bytes, most) = (shortened(&name), name.len(), limits::NAME_BYTES);
                let pointer = self.0.pointer();
                self.0.errors.push(pointer, format!("the name {shown:?} has {bytes} bytes; a name has at most {most}"));
                map.next_value::<IgnoredAny>()?;
                continue;
            }
            let value = self.0.within(name.clone(), |state| map.next_value_seed(Strict(state)))?;
            if fields.contains_key(&name) {
                let pointer = join(&self.0.pointer(), &name);
                self.0.errors.push(pointer, format!("{} is there twice in one object", shortened(&name)));
            }
            fields.insert(name, value);
        }
        Ok(Value::Object(fields))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn refused(body: &str) -> (u16, String, String) {
        let problem = object(body.as_bytes()).unwrap_err();
        let pointer = problem.errors().first().map(|error| error.pointer.clone()).unwrap_or_default();
        (problem.status().as_u16(), pointer, problem.detail().to_owned())
    }

    #[test]
    fn what_json_lacks_gets_a_hint() {
        for body in [r#"{"a": NaN}"#, r#"{"a": [1, -Infinity]}"#, "{\n  \"a\": nan\n}", r#"{"a": inf}"#] {
            let problem = object(body.as_bytes()).unwrap_err();
            assert!(problem.detail().ends_with("write null for a value that does not exist"), "{}", problem.detail());
        }
        assert!(!object(b"{\"a\": no}").unwrap_err().detail().contains("null"));
    }

    #[test]
    fn an_object_is_read_as_it_is() {
        let body = r#"{"a": [1, -2, 0.1, 1e-320], "b": {"c": null, "d": true, "e": "é\n"}}"#;
        assert_eq!(Value::Object(object(body.as_bytes()).unwrap()), serde_json::from_str::<Value>(body).unwrap());
        assert_eq!(object(b"{}").unwrap(), Map::new());
        assert_eq!(object(br#"{"a":-0.0}"#).unwrap()["a"].as_f64().unwrap().to_bits(), (-0.0_f64).to_bits());
    }

    #[test]
    fn what_is_not_json_says_where() {
        let (status, _, detail) = refused("{\n \"a\": 1,\n}");
        assert_eq!((status, detail.contains("line 3 column 1")), (400, true), "{detail}");
        for body in ["", "  ", "{", "{} {}", "{\"a\": NaN}", "{'a': 1}", "{\"a\": 01}"] {
            assert_eq!(refused(body).0, 400, "{body}");
        }
        assert_eq!(object(b"{\"a\": \"\xff\"}").unwrap_err().status(), 400);
    }

    #[test]
    fn what_is_no_object_is_not_valid() {
        for body in ["1", "[]", "null", "\"a\""] {
            assert_eq!(refused(body).0, 422, "{body}");
        }
    }

    #[test]
    fn a_key_comes_once() {
        let (status, pointer, detail) = refused(r#"{"scene": {"list": [{"a": 1, "a": 1}]}}"#);
        assert_eq!((status, pointer.as_str()), (422, "/scene/list/0/a"));
        assert_eq!(detail, "a is there twice in one object");
        assert_eq!(object(br#"{"a": {"x": 1}, "b": {"x": 1}}"#).unwrap()["b"], json!({"x": 1}));
    }

    #[test]
    fn a_number_too_large_has_its_pointer() {
        let (status, pointer, detail) = refused(r#"{"ok": 1, "scene": {"body": [0, 1e999]}}"#);
        assert_eq!((status, pointer.as_str()), (422, "/scene/body/1"), "{detail}");
    }

    #[test]
    fn names_are_bounded() {
        let named = |bytes: usize| format!("{{\"scene\": {{\"{}\": [1e999, {{}}]}}}}", "é".repeat(bytes / 2));
        let (status, pointer, detail) = refused(&named(limits::NAME_BYTES + 2));
        assert_eq!((status, pointer.as_str()), (422, "/scene"));
        assert!(detail.ends_with("…\" has 258 bytes; a name has at most 256"), "{detail}");
        assert!(object(named(limits::NAME_BYTES).replace("1e999", "1").as_bytes()).is_ok());
        // The length of the answer does not grow with the number of errors below the name.
        let twice = format!("{{\"{}\": {{{}}}}}", "x".repeat(100_000), vec!["\"a\": 1"; 100].join(","));
        assert!(object(twice.as_bytes()).unwrap_err().to_json().len() < 1000);
    }

    #[test]
    fn depth_is_bounded() {
        let nested = |levels: usize| format!("{}1{}", "{\"a\":".repeat(levels), "}".repeat(levels));
        assert!(object(nested(limits::DEPTH).as_bytes()).is_ok());
        assert_eq!(refused(&nested(limits::DEPTH + 1)).0, 422);
        assert_eq!(refused(&format!("{{\"a\":{}", "[".repeat(100_000))).0, 422);
    }
}
