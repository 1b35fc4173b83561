//! Reads the fields of one JSON object by name, and gathers all errors instead of stopping at the first.
//!
//! A getter returns None both for an absent field and for a wrong one, whose error is recorded. So `.unwrap_or(default)` is safe as
//! long as the errors are checked before the value is used. `null` is absent.

use std::fmt::Display;
use std::ops::RangeInclusive;

use serde_json::{Map, Value};

use crate::http::problem::{Problem, ProblemError, shortened};
use crate::limits;

/// Errors of a request so far.
#[derive(Debug, Default)]
pub struct Errors(Vec<ProblemError>);

impl Errors {
    /// Adds an error. Errors beyond the limit are dropped.
    pub fn push(&mut self, pointer: impl Into<String>, detail: impl Into<String>) {
        if self.0.len() < limits::ERRORS {
            self.0.push(ProblemError { pointer: pointer.into(), detail: detail.into() });
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

    /// All fields as they were sent.
    pub fn fields(&self) -> &'v Map<String, Value> {
        self.fields
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

    /// Reads the field with a function of a single value, whose error continues a sentence that begins with the name.
    pub fn read<T>(&mut self, name: &'v str, read: impl FnOnce(&'v Value, Source) -> Result<T, String>) -> Option<T> {
        let value = self.value(name)?;
        read(value, self.source).map_err(|error| self.refuse(name, format!("{name} {error}"))).ok()
    }

    /// A whole number within `range`.
    pub fn integer(&mut self, name: &'v str, range: RangeInclusive<u64>) -> Option<u64> {
        self.read(name, |value, source| integer(value, source, &range))
    }

    /// A finite number within `range`, in `unit` (`""` for none).
    pub fn number(&mut self, name: &'v str, range: RangeInclusive<f64>, unit: &str) -> Option<f64> {
        self.read(name, |value, source| number_within(value, source, &range, unit))
    }

    /// A boolean.
    pub fn boolean(&mut self, name: &'v str) -> Option<bool> {
        self.read(name, boolean)
    }

    /// A text.
    pub fn text(&mut self, name: &'v str) -> Option<&'v str> {
        self.read(name, |value, _| text(value))
    }

    /// The meaning of one of the words in `known`.
    pub fn choice<T: Copy>(&mut self, name: &'v str, known: &[(&str, T)]) -> Option<T> {
        self.read(name, |value, _| choice(value, known))
    }

    /// A reader of an object within this one, with the same errors. Finish it before reading on here.
    pub fn object(&mut self, name: &'v str) -> Option<Reader<'v, '_>> {
        let fields = self.read(name, |value, _| {
            value.as_object().ok_or_else(|| format!("is {}; it must be an object", shown(value)))
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
            _ => Err(format!("is {}; it must be an array of at most {limit}", shown(value))),
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
            match number_within(item, source, range, "") {
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
                    let detail = format!("{name} {index} is {}; it must be an object", shown(item));
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

// Single values of a request: numbers, whole numbers, booleans and texts, with the words of their errors.
//
// A JSON value must have the type of its field; the text of a query is read as that type. `reader` has names, pointers and
// nesting.

/// Source of the values of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A JSON body: a value must have the type of its field.
    Json,
    /// A query: a value is text, read as the type of its field.
    Query,
}

/// Largest whole number that every JSON reader keeps exactly, 2⁵³ − 1.
pub const LARGEST_EXACT: u64 = (1 << 53) - 1;

/// A finite number. The error continues a sentence that begins with the field's name.
pub fn number(value: &Value, source: Source) -> Result<f64, String> {
    let wrong = |why: &str| Err(format!("is {}; it must be a number{why}", shown(value)));
    let number = match (value, source) {
        (Value::Number(number), Source::Json) => number.as_f64(),
        (Value::String(text), Source::Query) => match text.parse() {
            Ok(number) => Some(number),
            Err(_) if text.contains(' ') && text.replace(' ', "+").parse::<f64>().is_ok() => {
                return wrong(" (in a query, + is written %2B)");
            }
            Err(_) => None,
        },
        (Value::String(_), Source::Json) => return wrong(", not text"),
        _ => None,
    };
    match number {
        Some(number) if number.is_finite() => Ok(number),
        Some(_) => wrong(" that is finite in double precision"),
        None => wrong(""),
    }
}

/// A finite number within `range`. The error names `unit`, such as `"m"`; `""` or `"1"` for none.
pub fn number_within(value: &Value, source: Source, range: &RangeInclusive<f64>, unit: &str) -> Result<f64, String> {
    let wanted = || describe_range(range, unit);
    let number =
        number(value, source).map_err(|error| error.replacen("a number", &format!("a number {}", wanted()), 1))?;
    if range.contains(&number) { Ok(number) } else { Err(format!("is {number}; it must be {}", wanted())) }
}

/// A whole number within `range`.
pub fn integer(value: &Value, source: Source, range: &RangeInclusive<u64>) -> Result<u64, String> {
    let wrong = |shown: &dyn Display| {
        format!("is {shown}; it must be a whole number from {} to {}", range.start(), range.end())
    };
    let number = number(value, source).map_err(|_| wrong(&shown(value)))?;
    // A JSON 100.0 is the same number as 100. Above 2⁵³ a double does not distinguish all whole numbers.
    let whole = number.fract() == 0.0 && (0.0..=LARGEST_EXACT as f64).contains(&number);
    if whole && range.contains(&(number as u64)) { Ok(number as u64) } else { Err(wrong(&number)) }
}

/// A boolean.
pub fn boolean(value: &Value, source: Source) -> Result<bool, String> {
    match (value, source) {
        (Value::Bool(yes), Source::Json) => Ok(*yes),
        (Value::String(text), Source::Query) if text == "true" || text == "1" => Ok(true),
        (Value::String(text), Source::Query) if text == "false" || text == "0" => Ok(false),
        (_, Source::Json) => Err(format!("is {}; it must be true or false", shown(value))),
        (_, Source::Query) => Err(format!("is {}; it must be true or false, or 1 or 0", shown(value))),
    }
}

/// A text. Every value of a query is one.
pub fn text(value: &Value) -> Result<&str, String> {
    value.as_str().ok_or_else(|| format!("is {}; it must be text", shown(value)))
}

/// The meaning of one of the words in `known`.
pub fn choice<T: Copy>(value: &Value, known: &[(&str, T)]) -> Result<T, String> {
    let found = value.as_str().and_then(|text| known.iter().find(|(word, _)| *word == text));
    found.map(|(_, meaning)| *meaning).ok_or_else(|| {
        let words: Vec<&str> = known.iter().map(|(word, _)| *word).collect();
        format!("is {}; it must be {}", shown(value), one_of(&words))
    })
}

/// `from -100 to 100 (no unit)`, `from 0.001 to 10 m`.
pub fn describe_range(range: &RangeInclusive<f64>, unit: &str) -> String {
    match unit {
        "" | "1" => format!("from {} to {} (no unit)", range.start(), range.end()),
        unit => format!("from {} to {} {unit}", range.start(), range.end()),
    }
}

/// `"a"`, or `"a" or "b"`, or `one of "a", "b", "c"`.
pub fn one_of(words: &[&str]) -> String {
    match words {
        [] => "absent".to_owned(),
        [one] => format!("{one:?}"),
        [one, two] => format!("{one:?} or {two:?}"),
        many => format!("one of {}", many.iter().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", ")),
    }
}

/// A value as an error shows it: as sent if it is short, by its type if it is large.
pub fn shown(value: &Value) -> String {
    match value {
        Value::Array(items) => format!("an array of {} values", items.len()),
        Value::Object(_) => "an object".to_owned(),
        Value::String(text) if text.is_empty() => "empty".to_owned(),
        Value::String(text) => format!("{:?}", shortened(text)),
        other => other.to_string(),
    }
}

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
    use serde_json::json;

    use super::*;

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

    #[test]
    fn json_is_held_to_its_kinds() {
        assert_eq!(number(&json!(1.5), Source::Json), Ok(1.5));
        assert_eq!(number(&json!("1.5"), Source::Json).unwrap_err(), "is \"1.5\"; it must be a number, not text");
        assert!(boolean(&json!("true"), Source::Json).is_err());
        assert_eq!(integer(&json!(100.0), Source::Json, &(1..=100)), Ok(100));
        assert!(text(&json!(1)).is_err());
    }

    #[test]
    fn a_query_is_read_as_the_field_asks() {
        assert_eq!(number(&json!("1e-3"), Source::Query), Ok(1e-3));
        assert_eq!(number(&json!("-0"), Source::Query).map(f64::to_bits), Ok((-0.0_f64).to_bits()));
        for (text, meaning) in [("true", true), ("1", true), ("false", false), ("0", false)] {
            assert_eq!(boolean(&json!(text), Source::Query), Ok(meaning));
        }
        assert!(boolean(&json!(1), Source::Json).is_err() && boolean(&json!("yes"), Source::Query).is_err());
        assert_eq!(integer(&json!("12"), Source::Query, &(1..=100)), Ok(12));
        assert!(number(&json!("1e 3"), Source::Query).unwrap_err().ends_with("(in a query, + is written %2B)"));
        for text in ["", " 1", "1,5", "0x10", "1_000", "one"] {
            assert!(number(&json!(text), Source::Query).is_err(), "{text:?}");
        }
    }

    #[test]
    fn only_finite_numbers_are_numbers() {
        for text in ["NaN", "nan", "inf", "-inf", "Infinity", "1e999", "-1e999"] {
            let error = number(&json!(text), Source::Query).unwrap_err();
            assert!(error.ends_with("it must be a number that is finite in double precision"), "{error}");
        }
    }

    #[test]
    fn whole_numbers_are_whole_and_in_range() {
        let range = 1..=100_000;
        for value in [json!(0), json!(100_001), json!(1.5), json!(-1), json!(1e300), json!("12"), json!(null)] {
            let error = integer(&value, Source::Json, &range).unwrap_err();
            assert!(error.ends_with("it must be a whole number from 1 to 100000"), "{error}");
        }
        assert_eq!(integer(&json!(LARGEST_EXACT), Source::Json, &(0..=LARGEST_EXACT)), Ok(LARGEST_EXACT));
        assert!(integer(&json!(LARGEST_EXACT + 1), Source::Json, &(0..=u64::MAX)).is_err());
    }

    #[test]
    fn errors_name_range_and_unit() {
        let error = number_within(&json!(5000), Source::Json, &(-100.0..=100.0), "").unwrap_err();
        assert_eq!(error, "is 5000; it must be from -100 to 100 (no unit)");
        let error = number_within(&json!("far"), Source::Query, &(0.5..=10.0), "m").unwrap_err();
        assert_eq!(error, "is \"far\"; it must be a number from 0.5 to 10 m");
        assert_eq!(choice(&json!("c"), &[("a", 1), ("b", 2)]).unwrap_err(), "is \"c\"; it must be \"a\" or \"b\"");
        assert_eq!(choice(&json!("b"), &[("a", 1), ("b", 2)]), Ok(2));
    }

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
