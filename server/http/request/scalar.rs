//! Single values of a request: numbers, whole numbers, booleans and texts, with the words of their errors.
//!
//! A JSON value must have the type of its field; the text of a query is read as that type. `reader` has names, pointers and
//! nesting.

use std::fmt::Display;
use std::ops::RangeInclusive;

use serde_json::Value;

use crate::http::problem::shortened;

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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

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
}
