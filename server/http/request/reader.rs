//! Reads the fields of one JSON object by name, and gathers all errors instead of stopping at the first.
//!
//! A getter returns None both for an absent field and for a wrong one, whose error is recorded. So `.unwrap_or(default)` is safe as
//! long as the errors are checked before the value is used. `null` is absent.

use std::ops::RangeInclusive;

use serde_json::{Map, Value};

use crate::http::problem::{Problem, ValidationError};
use crate::http::request::scalar;
use crate::http::request::scalar::Source;
use crate::http::request::suggestion::did_you_mean;
use crate::limits;

/// Errors of a request so far.
#[derive(Debug, Default)]
pub struct Errors(Vec<ValidationError>);

impl Errors {
    /// Adds an error. Errors beyond the limit are dropped.
    pub fn push(&mut self, pointer: impl Into<String>, detail: impl Into<String>) {
        if self.0.len() < limits::ERRORS {
            self.0.push(ValidationError { pointer: pointer.into(), detail: detail.into() });
        }
    }

    /// Number of errors.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Tells whether there are no errors.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Returns a 422 with all errors, if there are any.
    pub fn into_result(self) -> Result<(), Problem> {
        if self.0.is_empty() { Ok(()) } else { Err(Problem::invalid(self.0)) }
    }
}

/// One object of a request, at its JSON pointer. Call `finish`, or unknown fields stay unnoticed.
#[must_use = "call `finish`, which reports unknown fields"]
#[derive(Debug)]
pub struct Reader<'v, 'e> {
    fields: &'v Map<String, Value>,
    pointer: String,
    source: Source,
    known: Vec<&'v str>,
    errors: &'e mut Errors,
}

impl<'v, 'e> Reader<'v, 'e> {
    /// A reader of `fields`, which are at `pointer` in the request.
    pub fn new(fields: &'v Map<String, Value>, pointer: String, source: Source, errors: &'e mut Errors) -> Self {
        Self { fields, pointer, source, known: Vec::new(), errors }
    }

    /// Pointer of this object in the request.
    pub fn pointer(&self) -> &str {
        &self.pointer
    }

    /// Pointer of a field of this object in the request.
    pub fn pointer_to(&self, name: &str) -> String {
        join(&self.pointer, name)
    }

    /// Source of the values: JSON or a query.
    pub fn source(&self) -> Source {
        self.source
    }

    /// The errors, for other readers of the same request.
    pub fn errors(&mut self) -> &mut Errors {
        self.errors
    }

    /// Tells whether the field has an error so far.
    pub fn is_wrong(&self, name: &str) -> bool {
        let pointer = self.pointer_to(name);
        self.errors.0.iter().any(|error| error.pointer == pointer)
    }

    /// Records an error of the field `name`; `detail` is the whole sentence.
    pub fn refuse(&mut self, name: &str, detail: impl Into<String>) {
        let pointer = self.pointer_to(name);
        self.errors.push(pointer, detail);
    }

    /// Records an error of the whole object.
    pub fn refuse_whole(&mut self, detail: impl Into<String>) {
        self.errors.push(self.pointer.clone(), detail);
    }

    /// The field as it was sent. Its name is known from here on.
    pub fn value(&mut self, name: &'v str) -> Option<&'v Value> {
        if !self.known.contains(&name) {
            self.known.push(name);
        }
        self.fields.get(name).filter(|value| !value.is_null())
    }

    /// The field as it was sent, without its name being known from here on.
    pub fn peek(&self, name: &str) -> Option<&'v Value> {
        self.fields.get(name).filter(|value| !value.is_null())
    }

    /// Tells whether the field is there. Its name is known from here on.
    pub fn has(&mut self, name: &'v str) -> bool {
        self.value(name).is_some()
    }

    /// Records an error for each of these fields that is absent.
    pub fn require(&mut self, names: &[&'v str]) {
        for name in names {
            if !self.has(name) {
                self.refuse(name, format!("{name} is missing"));
            }
        }
    }

    /// Reads the field with a function of `scalar`, whose error continues a sentence that begins with the name.
    pub fn read<T>(&mut self, name: &'v str, read: impl FnOnce(&'v Value, Source) -> Result<T, String>) -> Option<T> {
        let value = self.value(name)?;
        read(value, self.source).map_err(|error| self.refuse(name, format!("{name} {error}"))).ok()
    }

    /// A whole number within `range`.
    pub fn integer(&mut self, name: &'v str, range: RangeInclusive<u64>) -> Option<u64> {
        self.read(name, |value, source| scalar::integer(value, source, &range))
    }

    /// A finite number within `range`, in `unit` (`""` for none).
    pub fn number(&mut self, name: &'v str, range: RangeInclusive<f64>, unit: &str) -> Option<f64> {
        self.read(name, |value, source| scalar::number_within(value, source, &range, unit))
    }

    /// A boolean.
    pub fn boolean(&mut self, name: &'v str) -> Option<bool> {
        self.read(name, scalar::boolean)
    }

    /// A text.
    pub fn text(&mut self, name: &'v str) -> Option<&'v str> {
        self.read(name, |value, _| scalar::text(value))
    }

    /// The meaning of one of the words in `known`.
    pub fn choice<T: Copy>(&mut self, name: &'v str, known: &[(&str, T)]) -> Option<T> {
        self.read(name, |value, _| scalar::choice(value, known))
    }

    /// A reader of an object within this one, with the same errors. Finish it before reading on here.
    pub fn object(&mut self, name: &'v str) -> Option<Reader<'v, '_>> {
        let fields = self.read(name, |value, _| {
            value.as_object().ok_or_else(|| format!("is {}; it must be an object", scalar::shown(value)))
        })?;
        Some(Reader::new(fields, self.pointer_to(name), self.source, self.errors))
    }

    /// Like `object`, if it can be read in one go: calls `read` and finishes the reader.
    pub fn within<T>(&mut self, name: &'v str, read: impl FnOnce(&mut Reader<'v, '_>) -> T) -> Option<T> {
        let mut reader = self.object(name)?;
        let value = read(&mut reader);
        reader.finish();
        Some(value)
    }

    /// An array of at most `limit` values.
    pub fn array(&mut self, name: &'v str, limit: usize) -> Option<&'v [Value]> {
        self.read(name, |value, _| match value.as_array() {
            Some(items) if items.len() <= limit => Ok(items.as_slice()),
            _ => Err(format!("is {}; it must be an array of at most {limit}", scalar::shown(value))),
        })
    }

    /// Numbers with names: an object of some of them, or an array of all in this order. Absent numbers are left unchanged.
    pub fn numbers(&mut self, name: &'v str, names: &[&'v str], range: &RangeInclusive<f64>, into: &mut [f64]) {
        if !self.fields.get(name).is_some_and(Value::is_array) {
            self.within(name, |reader| {
                for (number, name) in into.iter_mut().zip(names) {
                    *number = reader.number(name, range.clone(), "").unwrap_or(*number);
                }
            });
            return;
        }
        let (source, pointer) = (self.source, self.pointer_to(name));
        let items = self.array(name, names.len()).filter(|items| items.len() == names.len());
        let Some(items) = items else {
            return self.refuse(name, format!("{name} must have a number for each of {}", names.join(", ")));
        };
        for (index, (number, item)) in into.iter_mut().zip(items).enumerate() {
            match scalar::number_within(item, source, range, "") {
                Ok(value) => *number = value,
                Err(error) => self.errors.push(format!("{pointer}/{index}"), format!("{} {error}", names[index])),
            }
        }
    }

    /// An array of at most `limit` objects. Calls `each` with a reader for each, and finishes the reader.
    pub fn objects(&mut self, name: &'v str, limit: usize, mut each: impl FnMut(usize, &mut Reader<'v, '_>)) {
        for (index, item) in self.array(name, limit).unwrap_or_default().iter().enumerate() {
            let pointer = format!("{}/{index}", self.pointer_to(name));
            match item.as_object() {
                Some(fields) => {
                    let mut reader = Reader::new(fields, pointer, self.source, self.errors);
                    each(index, &mut reader);
                    reader.finish();
                }
                None => {
                    let detail = format!("{name} {index} is {}; it must be an object", scalar::shown(item));
                    self.errors.push(pointer, detail);
                }
            }
        }
    }

    /// Reports unknown fields, with the names of the known ones.
    pub fn finish(self) {
        for name in self.fields.keys().filter(|name| !self.known.contains(&name.as_str())) {
            let shown = crate::http::problem::shortened(name);
            let known = match self.known.as_slice() {
                [] => "no field is known here".to_owned(),
                known => format!("known here: {}", known.join(", ")),
            };
            let meant = did_you_mean(name, self.known.iter().copied());
            self.errors.push(join(&self.pointer, name), format!("unknown field `{shown}`{meant}; {known}"));
        }
    }
}

/// The pointer of the field `name` in the object at `pointer` (RFC 6901: `~` and `/` in a name are escaped).
pub fn join(pointer: &str, name: &str) -> String {
    format!("{pointer}/{}", name.replace('~', "~0").replace('/', "~1"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn errors_of(value: &Value, source: Source, read: impl FnOnce(&mut Reader)) -> Vec<(String, String)> {
        let mut errors = Errors::default();
        let mut reader = Reader::new(value.as_object().unwrap(), String::new(), source, &mut errors);
        read(&mut reader);
        reader.finish();
        errors.0.into_iter().map(|error| (error.pointer, error.detail)).collect()
    }

    #[test]
    fn all_errors_are_reported_at_once() {
        let body = json!({"bounces": "ten", "method": "guess", "table": {"gain": 7}, "x/y": 1});
        let errors = errors_of(&body, Source::Json, |reader| {
            assert_eq!(reader.integer("bounces", 1..=10).unwrap_or(5), 5);
            assert_eq!(reader.choice("method", &[("map", ())]), None);
            assert_eq!(reader.within("table", |table| table.number("gain", 0.0..=1.0, "m")), Some(None));
        });
        let expected = [
            ("/bounces", "bounces is \"ten\"; it must be a whole number from 1 to 10"),
            ("/method", "method is \"guess\"; it must be \"map\""),
            ("/table/gain", "gain is 7; it must be from 0 to 1 m"),
            ("/x~1y", "unknown field `x/y`; known here: bounces, method, table"),
        ];
        let expected = expected.map(|(pointer, detail)| (pointer.to_owned(), detail.to_owned()));
        assert_eq!(errors, expected);
    }

    #[test]
    fn null_is_absent() {
        let errors = errors_of(&json!({"a": null, "b": null}), Source::Json, |reader| {
            assert_eq!(reader.integer("a", 1..=2), None);
            reader.require(&["b"]);
        });
        assert_eq!(errors, [("/b".to_owned(), "b is missing".to_owned())]);
    }

    #[test]
    fn objects_in_an_array_have_pointers_of_their_own() {
        let errors = errors_of(&json!({"list": [{"n": 1}, 5, {"m": 1}]}), Source::Json, |reader| {
            let mut seen = vec![];
            reader.objects("list", 3, |index, item| seen.push((index, item.integer("n", 1..=9))));
            assert_eq!(seen, [(0, Some(1)), (2, None)]);
        });
        let pointers: Vec<&str> = errors.iter().map(|(pointer, _)| pointer.as_str()).collect();
        assert_eq!(pointers, ["/list/1", "/list/2/m"]);
    }

    #[test]
    fn a_query_is_read_by_schema_and_json_is_not() {
        let body = json!({"n": "3"});
        assert_eq!(errors_of(&body, Source::Query, |reader| assert_eq!(reader.integer("n", 1..=9), Some(3))), []);
        assert_eq!(errors_of(&body, Source::Json, |reader| assert_eq!(reader.integer("n", 1..=9), None)).len(), 1);
    }

    #[test]
    fn errors_are_bounded() {
        let body = Value::Object((0..1000).map(|n| (n.to_string(), json!(n))).collect());
        assert_eq!(errors_of(&body, Source::Json, |_| ()).len(), limits::ERRORS);
    }
}
