//! The tree of fields of a request, from a query, a JSON body or a table; the body itself: its media type, its size, and the time it takes to
//! arrive.

use std::collections::BTreeMap;
use std::fmt;
use std::panic::catch_unwind;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrowPrimitiveType, RecordBatch};
use arrow_ipc::reader::StreamReader;
use arrow_schema::{ArrowError, DataType};
use axum::body::{Body, Bytes, to_bytes};
use axum::http::{HeaderMap, header};
use http_body_util::LengthLimitError;
use percent_encoding::percent_decode_str;
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};
use serde_json::{Map, Number, Value};
use tokio::time::timeout;

use crate::http::problem::{Problem, shortened};
use crate::http::request::reader::{Errors, did_you_mean, join};
use crate::limits;
use crate::limits::Limits;

/// A media type that is read.
pub(crate) struct MediaType {
    name: &'static str,
    is: fn(&str) -> bool,
}

/// One request.
pub(crate) const JSON: MediaType = MediaType {
    name: "application/json",
    is: |essence| essence == "application/json" || (essence.starts_with("application/") && essence.ends_with("+json")),
};

/// Many requests, one on each line.
pub(crate) const NDJSON: MediaType = MediaType {
    name: "application/x-ndjson",
    is: |essence| matches!(essence, "application/x-ndjson" | "application/ndjson" | "application/jsonl"),
};

/// The fields of a form of a page.
pub(crate) const FORM: MediaType = MediaType {
    name: "application/x-www-form-urlencoded",
    is: |essence| essence == "application/x-www-form-urlencoded",
};

/// A table in the form of RFC 4180.
pub(crate) const CSV: MediaType = MediaType { name: "text/csv", is: |essence| essence == "text/csv" };

/// A table as a stream of Arrow.
pub(crate) const ARROW: MediaType = MediaType {
    name: "application/vnd.apache.arrow.stream",
    is: |essence| essence == "application/vnd.apache.arrow.stream",
};

impl MediaType {
    /// True if both are the same.
    pub(super) fn is(&self, other: &Self) -> bool {
        self.name == other.name
    }

    /// Refuses a body of another type, not in UTF-8, or compressed: 415.
    pub(crate) fn check(&self, headers: &HeaderMap) -> Result<(), Problem> {
        Self::among(&[self], headers).map(|_| ())
    }

    /// The one of these types that a body has. Refuses another one, a body not in UTF-8, and a compressed one: 415.
    pub(super) fn among<'t>(types: &[&'t Self], headers: &HeaderMap) -> Result<&'t Self, Problem> {
        let names = types.iter().map(|one| one.name).collect::<Vec<_>>().join(", ");
        let refused = |detail: String| Err(Problem::unsupported_media_type(&names, detail));
        let text = |name| headers.get(name).map(|value| value.to_str().unwrap_or("not text"));
        let Some(media_type) = text(header::CONTENT_TYPE) else {
            return refused(format!("the request has no Content-Type; send it as Content-Type: {names}"));
        };
        let mut parameters = media_type.split(';').map(str::trim);
        let essence = parameters.next().unwrap_or_default().to_ascii_lowercase();
        let Some(found) = types.iter().find(|one| (one.is)(&essence)) else {
            let shown = shortened(media_type);
            return refused(format!("the request has Content-Type: {shown}; send it as Content-Type: {names}"));
        };
        let charset =
            parameters.find_map(|parameter| parameter.to_ascii_lowercase().strip_prefix("charset=").map(str::to_owned));
        let is_read = |charset: &String| matches!(charset.trim_matches('"'), "utf-8" | "utf8" | "us-ascii");
        if let Some(charset) = charset.filter(|charset| !is_read(charset)) {
            return refused(format!("the request is in {}; bodies are read as UTF-8", shortened(&charset)));
        }
        match text(header::CONTENT_ENCODING) {
            Some(coding) if !coding.trim().eq_ignore_ascii_case("identity") => refused(format!(
                "the request has Content-Encoding: {}; bodies are read uncompressed",
                shortened(coding)
            )),
            _ => Ok(*found),
        }
    }
}

/// Reads a body within the limits of size and time.
pub(crate) async fn read(body: Body, headers: &HeaderMap, limits: &Limits) -> Result<Bytes, Problem> {
    let announced = headers.get(header::CONTENT_LENGTH).and_then(|length| length.to_str().ok()?.parse::<u64>().ok());
    if announced.is_some_and(|length| length > limits.body_bytes as u64) {
        return Err(Problem::too_large(limits.body_bytes));
    }
    let reading = timeout(limits.body_time, to_bytes(body, limits.body_bytes)).await;
    let Ok(read) = reading else {
        let limit_s = limits.body_time.as_secs();
        return Err(Problem::too_slow(format!("the request body took longer than the limit of {limit_s} s to arrive")));
    };
    read.map_err(|error| {
        use std::error::Error;
        match error.source().is_some_and(|source| source.is::<LengthLimitError>()) {
            true => Problem::too_large(limits.body_bytes),
            false => Problem::not_readable("the connection ended, or broke the protocol, within the request body"),
        }
    })
}

// Unfolds a dotted query into a JSON tree: `a.b=1&c.0=2` becomes `{"a": {"b": "1"}, "c": ["2"]}`.
//
// Every value is text; `reader` reads it as the schema asks. Arrays are written by indices from 0.

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

/// Takes values of these types as they are.
macro_rules! scalars {
    ($($visit:ident($kind:ty);)+) => {$(
        fn $visit<E: Error>(self, value: $kind) -> Result<Value, E> {
            Ok(Value::from(value))
        }
    )+};
}

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

    scalars! { visit_bool(bool); visit_u64(u64); visit_i64(i64); visit_str(&str); visit_string(String); }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Value, E> {
        Number::from_f64(value).map(Value::Number).ok_or_else(|| E::custom("number out of range"))
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

/// The table that a resource takes as a body in place of a field of its request.
#[derive(Debug)]
pub struct TableBody {
    /// The field: an object of columns.
    pub field: &'static str,
    /// Names of columns in a header, each with the column that it is and the factor to the unit of that column.
    pub columns: fn() -> Vec<(String, &'static str, f64)>,
    /// Names of further columns, which are left out.
    pub others: fn() -> Vec<String>,
    /// Largest number of rows.
    pub rows: usize,
}

impl TableBody {
    /// The fields of a request: those of the query and the table.
    ///
    /// # Errors
    /// 400 for a body that is no table, 422 for columns that are not known, or there twice, and for a table in the query.
    pub(super) fn fields_of(
        &self,
        mut fields: Map<String, Value>,
        media_type: &MediaType,
        body: &[u8],
    ) -> Result<Map<String, Value>, Problem> {
        let place = join("", self.field);
        if fields.contains_key(self.field) {
            return Err(Problem::invalid_at(
                place,
                format!("{} is the body; it is not read from the query", self.field),
            ));
        }
        let mut columns = Columns { table: self, known: (self.columns)(), errors: Errors::default() };
        let table = if media_type.is(&ARROW) { columns.of_arrow(body)? } else { columns.of_csv(body)? };
        columns.errors.into_result()?;
        fields.insert(self.field.to_owned(), Value::Object(table));
        Ok(fields)
    }
}

/// A header that is read.
struct Columns<'a> {
    table: &'a TableBody,
    known: Vec<(String, &'static str, f64)>,
    errors: Errors,
}

impl Columns<'_> {
    /// The columns of a header that are read: place, name and factor.
    fn of<'h>(&mut self, header: impl IntoIterator<Item = &'h str>) -> Vec<(usize, &'static str, f64)> {
        let (mut read, others) = (Vec::new(), (self.table.others)());
        for (place, written) in header.into_iter().enumerate() {
            // `t [s]`, `theta_dot (rad/s)` are `t_s`, `theta_dot_rad_per_s`.
            let name = written.trim_end_matches([']', ')']).replace([' ', '[', '('], "_").replace("__", "_");
            let name = name.replace('/', "_per_");
            let pointer = join(&join("", self.table.field), written);
            if let Some((_, column, factor)) = self.known.iter().find(|(known, ..)| *known == name) {
                if read.iter().any(|(_, other, _)| other == column) {
                    self.errors.push(pointer, format!("the column {column} is there twice"));
                }
                read.push((place, *column, *factor));
            } else if !others.contains(&name) {
                let known: Vec<&str> = self.known.iter().map(|(name, ..)| name.as_str()).collect();
                let (meant, listed) = (did_you_mean(&name, known.iter().copied()), known.join(", "));
                let shown = shortened(written);
                self.errors.push(pointer, format!("unknown column `{shown}`{meant}; known here: {listed}"));
            }
        }
        read
    }

    fn of_csv(&mut self, body: &[u8]) -> Result<Map<String, Value>, Problem> {
        let place = join("", self.table.field);
        let not_csv = |error: csv::Error| match error.kind() {
            csv::ErrorKind::UnequalLengths { .. } => Problem::invalid_at(place.clone(), error.to_string()),
            _ => Problem::not_readable(format!("the body is not CSV: {error}")),
        };
        if body.trim_ascii().is_empty() {
            return Err(Problem::invalid_at(
                place.clone(),
                format!("{} is empty: a table has a header and rows", self.table.field),
            ));
        }
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(body);
        let read = self.of(reader.headers().map_err(not_csv)?);
        let mut cells = vec![Vec::new(); read.len()];
        for row in reader.records() {
            let row = row.map_err(not_csv)?;
            for (column, (place, _, factor)) in cells.iter_mut().zip(&read) {
                let cell = row.get(*place).filter(|cell| !cell.is_empty());
                column.push(cell.map_or(Value::Null, |cell| Value::String(scaled(cell, *factor))));
            }
        }
        Ok(read.iter().zip(cells).map(|((_, name, _), cells)| ((*name).to_owned(), Value::Array(cells))).collect())
    }

    fn of_arrow(&mut self, body: &[u8]) -> Result<Map<String, Value>, Problem> {
        // A buffer beyond the end of its message is a panic of the library.
        let batches = catch_unwind(|| StreamReader::try_new(body, None)?.collect::<Result<Vec<_>, ArrowError>>());
        let batches = batches.unwrap_or_else(|_| Err(ArrowError::ParseError("a buffer is beyond the end".to_owned())));
        let batches: Vec<RecordBatch> = batches.map_err(|error| {
            Problem::not_readable(format!("the body is not a stream of Arrow without compression: {error}"))
        })?;
        let rows: usize = batches.iter().map(RecordBatch::num_rows).fold(0, usize::saturating_add);
        let (field, most) = (self.table.field, self.table.rows);
        if rows > most {
            return Err(Problem::invalid_at(
                join("", field),
                format!("{field} has {rows} rows; at most {most} are read"),
            ));
        }
        let Some(schema) = batches.first().map(RecordBatch::schema) else {
            return Err(Problem::invalid_at(join("", field), format!("{field} has no rows")));
        };
        let mut table = Map::new();
        for (place, name, factor) in self.of(schema.fields().iter().map(|field| field.name().as_str())) {
            let mut cells = Vec::with_capacity(rows);
            for column in batches.iter().map(|batch| batch.column(place)) {
                match numbers(column, factor) {
                    Some(numbers) => cells.extend(numbers),
                    None => {
                        let (pointer, kind) = (join(&join("", field), name), column.data_type());
                        self.errors.push(pointer, format!("{name} is of type {kind}; it must be numbers"));
                        break;
                    }
                }
            }
            table.insert(name.to_owned(), Value::Array(cells));
        }
        Ok(table)
    }
}

/// A cell in the unit of its column. A cell that is no number stays, and its reader refuses it.
fn scaled(cell: &str, factor: f64) -> String {
    match cell.parse::<f64>() {
        Ok(number) if factor != 1.0 => (number * factor).to_string(),
        _ => cell.to_owned(),
    }
}

/// The cells of a column of numbers.
fn numbers(column: &dyn Array, factor: f64) -> Option<Vec<Value>> {
    fn of<T: ArrowPrimitiveType<Native: ToString>>(column: &dyn Array, factor: f64) -> Vec<Value> {
        let cell = |cell: Option<T::Native>| {
            cell.map_or(Value::Null, |number| Value::String(scaled(&number.to_string(), factor)))
        };
        column.as_primitive::<T>().iter().map(cell).collect()
    }
    Some(match column.data_type() {
        DataType::Null => vec![Value::Null; column.len()],
        DataType::Float64 => of::<Float64Type>(column, factor),
        DataType::Float32 => of::<Float32Type>(column, factor),
        DataType::Int64 => of::<Int64Type>(column, factor),
        DataType::Int32 => of::<Int32Type>(column, factor),
        DataType::Int16 => of::<Int16Type>(column, factor),
        DataType::Int8 => of::<Int8Type>(column, factor),
        DataType::UInt64 => of::<UInt64Type>(column, factor),
        DataType::UInt32 => of::<UInt32Type>(column, factor),
        DataType::UInt16 => of::<UInt16Type>(column, factor),
        DataType::UInt8 => of::<UInt8Type>(column, factor),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn tree(query: &str) -> Result<Value, Problem> {
        unfold(parameters(query)?).map(Value::Object)
    }

    fn told(problem: &Problem) -> (u16, String, String) {
        let pointer = problem.errors().first().map(|error| error.pointer.clone()).unwrap_or_default();
        (problem.status().as_u16(), pointer, problem.detail().to_owned())
    }

    fn refused(query: &str) -> (u16, String, String) {
        told(&tree(query).unwrap_err())
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

    fn refused_body(body: &str) -> (u16, String, String) {
        told(&object(body.as_bytes()).unwrap_err())
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
        let (status, _, detail) = refused_body("{\n \"a\": 1,\n}");
        assert_eq!((status, detail.contains("line 3 column 1")), (400, true), "{detail}");
        for body in ["", "  ", "{", "{} {}", "{\"a\": NaN}", "{'a': 1}", "{\"a\": 01}"] {
            assert_eq!(refused_body(body).0, 400, "{body}");
        }
        assert_eq!(object(b"{\"a\": \"\xff\"}").unwrap_err().status(), 400);
    }

    #[test]
    fn what_is_no_object_is_not_valid() {
        for body in ["1", "[]", "null", "\"a\""] {
            assert_eq!(refused_body(body).0, 422, "{body}");
        }
    }

    #[test]
    fn a_key_comes_once() {
        let (status, pointer, detail) = refused_body(r#"{"scene": {"list": [{"a": 1, "a": 1}]}}"#);
        assert_eq!((status, pointer.as_str()), (422, "/scene/list/0/a"));
        assert_eq!(detail, "a is there twice in one object");
        assert_eq!(object(br#"{"a": {"x": 1}, "b": {"x": 1}}"#).unwrap()["b"], json!({"x": 1}));
    }

    #[test]
    fn a_number_too_large_has_its_pointer() {
        let (status, pointer, detail) = refused_body(r#"{"ok": 1, "scene": {"body": [0, 1e999]}}"#);
        assert_eq!((status, pointer.as_str()), (422, "/scene/body/1"), "{detail}");
    }

    #[test]
    fn names_are_bounded() {
        let named = |bytes: usize| format!("{{\"scene\": {{\"{}\": [1e999, {{}}]}}}}", "é".repeat(bytes / 2));
        let (status, pointer, detail) = refused_body(&named(limits::NAME_BYTES + 2));
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
        assert_eq!(refused_body(&nested(limits::DEPTH + 1)).0, 422);
        assert_eq!(refused_body(&format!("{{\"a\":{}", "[".repeat(100_000))).0, 422);
    }

    const TABLE: TableBody = TableBody {
        field: "measured",
        columns: || {
            [("t", "t", 1.0), ("t_s", "t", 1.0), ("theta_deg", "theta", 0.5)]
                .map(|(name, column, factor)| (name.to_owned(), column, factor))
                .into()
        },
        others: || vec!["y_m".to_owned()],
        rows: 3,
    };

    fn read(body: &str) -> Result<Value, Problem> {
        let fields = TABLE.fields_of(Map::new(), &CSV, body.as_bytes())?;
        Ok(fields["measured"].clone())
    }

    #[test]
    fn tables_of_spreadsheets_are_read() {
        let wanted = json!({"t": ["1", "2.50"], "theta": ["2", null]});
        for body in [
            "t,theta_deg\n1,4\n2.50,\n",
            "\u{feff}t_s,theta_deg\r\n1,4\r\n2.50,\r\n",
            "\"t [s]\",y_m,\"theta (deg)\"\n\"1\",x,\"4\"\n\"2.50\",\"a, \"\"b\"\"\",\"\"",
        ] {
            assert_eq!(read(body).unwrap(), wanted, "{body}");
        }
        assert_eq!(read("t\n1e-3\nx\n").unwrap(), json!({"t": ["1e-3", "x"]}));
    }

    #[test]
    fn what_is_no_table_is_refused_with_its_place() {
        for body in ["", " \n", "t,theta_deg\n1\n"] {
            assert_eq!(read(body).unwrap_err().status(), 422, "{body:?}");
        }
        for (body, pointer, detail) in [
            ("t_ms\n1", "/measured/t_ms", "unknown column `t_ms` (did you mean `t_s`?); known here: t, t_s, theta_deg"),
            ("t,t_s\n1,1", "/measured/t_s", "the column t is there twice"),
        ] {
            let problem = read(body).unwrap_err();
            let error = &problem.errors()[0];
            assert_eq!(
                (problem.status().as_u16(), error.pointer.as_str(), error.detail.as_str()),
                (422, pointer, detail)
            );
        }
        assert_eq!(TABLE.fields_of(Map::new(), &ARROW, b"ARROW1").unwrap_err().status(), 400);
    }
}
