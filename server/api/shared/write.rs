//! Writes answers: JSON, tables as CSV, NDJSON and Arrow, pictures, and the canonical form of a request; and lines that report the progress
//! of work. These depend on the work done and not on a clock, so the same request has the same lines. Large answers stop when their client
//! has gone.

use std::io;
use std::io::Write;

use equipoise_physics::scene::Scene;
use schemars::JsonSchema;
use serde::ser::{Error, Impossible, SerializeMap, SerializeStruct};
use serde::{Serialize, Serializer};
use serde_json::Value;

use crate::api::scene::write::Resolved;
use crate::api::shared::table::Table;
use crate::charts::{NoPixels, png};
use crate::compute::{Cancelled, TimeSlice};
use crate::http::Problem;
use crate::limits;

/// Length of a cell as text, bytes: a number of 17 digits with sign, point and comma.
const CELL_BYTES: usize = 20;

/// Length of a cell in Arrow, bytes: a double, with its share of bits for nulls.
const ARROW_CELL_BYTES: usize = 9;

/// Length of an answer besides its table, bytes, of most answers.
const OTHER_BYTES: usize = 2048;

/// Room for a table of so many cells, bytes.
fn room(cells: usize) -> usize {
    OTHER_BYTES + CELL_BYTES * cells
}

/// An answer as JSON.
pub(crate) fn json(answer: &impl Serialize, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    json_with_table(answer, 0, slice)
}

/// An answer with a table of so many cells as JSON.
pub(crate) fn json_with_table(answer: &impl Serialize, cells: usize, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    write_to_memory(room(cells), &|| slice.should_continue(), |out| Ok(serde_json::to_writer(out, answer)?))
}

/// A table as CSV.
pub(crate) fn csv(table: &Table, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    write_to_memory(room(table.cells()), &|| slice.should_continue(), |out| table.write_csv(out))
}

/// A table as NDJSON, with `end` in its last line.
pub(crate) fn ndjson(table: &Table, end: &impl Serialize, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    let room = room(table.cells()) + table.rows() * table.names_bytes();
    write_to_memory(room, &|| slice.should_continue(), |out| table.write_ndjson(end, out))
}

/// A table as a stream of Arrow, with meanings of its columns, and the rest of the answer as JSON in its schema.
pub(crate) fn arrow(
    table: &Table,
    about: impl Fn(&str) -> &'static str,
    rest: String,
    slice: &TimeSlice,
) -> Result<Vec<u8>, Problem> {
    let room = ARROW_CELL_BYTES * table.cells() + rest.len() + OTHER_BYTES;
    write_to_memory(room, &|| slice.should_continue(), |out| table.write_arrow(about, rest, out))
}

/// The JSON of an answer without some of its members.
pub(crate) fn rest_of(
    answer: &impl Serialize,
    members: &'static [&'static str],
    slice: &TimeSlice,
) -> Result<String, Problem> {
    let rest = json(&Part { answer, members: Members::Without(members) }, slice)?;
    String::from_utf8(rest).map_err(|_| Problem::internal())
}

/// An SVG in pixels, as PNG.
pub(crate) fn pixels(svg: &str, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
    png(svg, || slice.should_continue()).map_err(|none| match none {
        NoPixels::Cancelled => Cancelled.into(),
        NoPixels::Unfit => Problem::internal(),
    })
}

/// Canonical form of a request: the scene with all defaults, and everything else that determines the answer.
pub(crate) fn canonical(scene: &Scene, rest: &impl Serialize) -> Vec<u8> {
    canonical_of(&(Resolved(*scene), rest))
}

/// Canonical form of a request that is written with all its defaults.
pub(crate) fn canonical_of(request: &impl Serialize) -> Vec<u8> {
    // Writing to memory does not fail.
    serde_json::to_vec(request).unwrap_or_default()
}

/// Members of an object.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Members {
    Only(&'static [&'static str]),
    Without(&'static [&'static str]),
}

impl Members {
    fn have(self, name: &str) -> bool {
        match self {
            Self::Only(names) => names.contains(&name),
            Self::Without(names) => !names.contains(&name),
        }
    }
}

/// Some members of an answer, which is an object. All members within them stay.
#[derive(Debug)]
pub(crate) struct Part<'a, A> {
    pub(crate) answer: &'a A,
    pub(crate) members: Members,
}

impl<A: Serialize> Serialize for Part<'_, A> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.answer.serialize(Outermost { inner: serializer, members: self.members })
    }
}

/// Writes some members of an object.
struct Outermost<S> {
    inner: S,
    members: Members,
}

/// Members under way. A map that gives key and value apart, which no answer does, is an error.
impl<S: SerializeMap> SerializeMap for Outermost<S> {
    type Ok = S::Ok;
    type Error = S::Error;

    fn serialize_entry<K: Serialize + ?Sized, V: Serialize + ?Sized>(
        &mut self,
        key: &K,
        value: &V,
    ) -> Result<(), S::Error> {
        let name = serde_json::to_value(key).map_err(S::Error::custom)?;
        if name.as_str().is_none_or(|name| self.members.have(name)) {
            self.inner.serialize_entry(key, value)
        } else {
            Ok(())
        }
    }

    fn serialize_key<T: Serialize + ?Sized>(&mut self, _: &T) -> Result<(), S::Error> {
        Err(S::Error::custom(NOT_AN_OBJECT))
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, _: &T) -> Result<(), S::Error> {
        Err(S::Error::custom(NOT_AN_OBJECT))
    }

    fn end(self) -> Result<S::Ok, S::Error> {
        self.inner.end()
    }
}

/// The same for a struct, which is written as a map.
impl<S: SerializeMap> SerializeStruct for Outermost<S> {
    type Ok = S::Ok;
    type Error = S::Error;

    fn serialize_field<T: Serialize + ?Sized>(&mut self, key: &'static str, value: &T) -> Result<(), S::Error> {
        if self.members.have(key) { self.inner.serialize_entry(key, value) } else { Ok(()) }
    }

    fn end(self) -> Result<S::Ok, S::Error> {
        self.inner.end()
    }
}

const NOT_AN_OBJECT: &str = "only an object has members";

/// Refuses values that are not objects.
macro_rules! refuse {
    ($($name:ident($($argument:ty),*) -> $result:ty;)+) => {
        $(fn $name(self, $(_: $argument),*) -> Result<$result, S::Error> {
            Err(S::Error::custom(NOT_AN_OBJECT))
        })+
    };
}

type Never<S> = Impossible<<S as Serializer>::Ok, <S as Serializer>::Error>;

impl<S: Serializer> Serializer for Outermost<S> {
    type Ok = S::Ok;
    type Error = S::Error;
    type SerializeSeq = Never<S>;
    type SerializeTuple = Never<S>;
    type SerializeTupleStruct = Never<S>;
    type SerializeTupleVariant = Never<S>;
    type SerializeMap = Outermost<S::SerializeMap>;
    type SerializeStruct = Outermost<S::SerializeMap>;
    type SerializeStructVariant = Never<S>;

    fn serialize_map(self, _: Option<usize>) -> Result<Self::SerializeMap, S::Error> {
        Ok(Outermost { inner: self.inner.serialize_map(None)?, members: self.members })
    }

    fn serialize_struct(self, _: &'static str, _: usize) -> Result<Self::SerializeStruct, S::Error> {
        self.serialize_map(None)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<S::Ok, S::Error> {
        value.serialize(self)
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(self, _: &'static str, value: &T) -> Result<S::Ok, S::Error> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        _: u32,
        _: &'static str,
        _: &T,
    ) -> Result<S::Ok, S::Error> {
        Err(S::Error::custom(NOT_AN_OBJECT))
    }

    refuse! {
        serialize_bool(bool) -> S::Ok;
        serialize_i8(i8) -> S::Ok;
        serialize_i16(i16) -> S::Ok;
        serialize_i32(i32) -> S::Ok;
        serialize_i64(i64) -> S::Ok;
        serialize_u8(u8) -> S::Ok;
        serialize_u16(u16) -> S::Ok;
        serialize_u32(u32) -> S::Ok;
        serialize_u64(u64) -> S::Ok;
        serialize_f32(f32) -> S::Ok;
        serialize_f64(f64) -> S::Ok;
        serialize_char(char) -> S::Ok;
        serialize_str(&str) -> S::Ok;
        serialize_bytes(&[u8]) -> S::Ok;
        serialize_none() -> S::Ok;
        serialize_unit() -> S::Ok;
        serialize_unit_struct(&'static str) -> S::Ok;
        serialize_unit_variant(&'static str, u32, &'static str) -> S::Ok;
        serialize_seq(Option<usize>) -> Never<S>;
        serialize_tuple(usize) -> Never<S>;
        serialize_tuple_struct(&'static str, usize) -> Never<S>;
        serialize_tuple_variant(&'static str, u32, &'static str, usize) -> Never<S>;
        serialize_struct_variant(&'static str, u32, &'static str, usize) -> Never<S>;
    }
}

/// A line that reports progress.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
#[schemars(rename = "Progress")]
pub struct ProgressLine {
    progress: WorkDone,
}

/// Work done, in the unit of the resource.
#[derive(Debug, Clone, Copy, Serialize, JsonSchema)]
struct WorkDone {
    done: u64,
    /// The whole work.
    of: u64,
}

/// Progress reported so far.
#[derive(Debug, Default)]
pub struct Progress {
    hundredth: Option<u64>,
}

impl Progress {
    /// The line for `done` of `of`. Empty if its hundredth has been reported.
    pub fn line(&mut self, done: u64, of: u64) -> Vec<u8> {
        let hundredth = Some(100 * done / of.max(1));
        if self.hundredth == hundredth {
            return Vec::new();
        }
        self.hundredth = hundredth;
        line(&ProgressLine { progress: WorkDone { done, of } })
    }
}

/// A line of NDJSON.
pub fn line(value: &impl Serialize) -> Vec<u8> {
    // Writing to memory does not fail.
    let mut line = serde_json::to_vec(value).unwrap_or_default();
    line.push(b'\n');
    line
}

/// The last line: an answer in JSON, and its pictures by name.
pub fn end(answer: &[u8], pictures: Vec<(&'static str, String)>) -> Vec<u8> {
    let pictures: serde_json::Map<String, Value> =
        pictures.into_iter().map(|(name, picture)| (name.to_owned(), Value::String(picture))).collect();
    let pictures = Value::Object(pictures).to_string();
    [b"{\"end\":", answer, b",\"pictures\":", pictures.as_bytes(), b"}\n"].concat()
}

/// Bytes in memory, with a cancellation check now and then.
pub struct OutputBuffer<'a> {
    bytes: Vec<u8>,
    should_continue: &'a dyn Fn() -> bool,
    /// Length at which to check for cancellation again.
    next_check: usize,
    is_cancelled: bool,
}

/// Returns the bytes that `write` writes, and asks `should_continue` now and then. About `room` bytes are expected.
///
/// # Errors
/// A cancellation once `should_continue` is false; an internal error if `write` fails for another reason.
pub fn write_to_memory(
    room: usize,
    should_continue: &dyn Fn() -> bool,
    write: impl FnOnce(&mut OutputBuffer<'_>) -> io::Result<()>,
) -> Result<Vec<u8>, Problem> {
    let (bytes, next_check) = (Vec::new(), limits::WRITE_STEP_BYTES);
    let mut output = OutputBuffer { bytes, should_continue, next_check, is_cancelled: false };
    match output.reserve(room).and_then(|()| write(&mut output)) {
        Ok(()) => Ok(output.bytes),
        Err(_) if output.is_cancelled => Err(Cancelled.into()),
        Err(error) if error.kind() == io::ErrorKind::OutOfMemory => {
            Err(Problem::overloaded("the server is short of memory"))
        }
        Err(_) => Err(Problem::internal()),
    }
}

impl OutputBuffer<'_> {
    /// Makes room. Memory that there is not is an error: these are the largest pieces that any answer takes.
    #[inline]
    fn reserve(&mut self, bytes: usize) -> io::Result<()> {
        self.bytes.try_reserve(bytes).map_err(|_| io::ErrorKind::OutOfMemory.into())
    }
}

impl Write for OutputBuffer<'_> {
    #[inline]
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write_all(bytes).map(|()| bytes.len())
    }

    #[inline]
    fn write_all(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.reserve(bytes.len())?;
        self.bytes.extend_from_slice(bytes);
        if self.bytes.len() >= self.next_check {
            self.next_check = self.bytes.len() + limits::WRITE_STEP_BYTES;
            if !(self.should_continue)() {
                self.is_cancelled = true;
                return Err(io::Error::other(Cancelled));
            }
        }
        Ok(())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use equipoise_physics::numbers::double_double::DoubleDouble;
    use serde_json::{Value, json};

    use super::*;
    use crate::api::shared::table::{Cells, Column};

    #[test]
    fn a_large_table_is_not_written_for_nobody() {
        let cells = Cells::Decimals(vec![Some(DoubleDouble::from(0.1)); 100_000]);
        let table = Table(vec![Column { name: "t", unit: "s", cells }]);
        type Way = fn(&Table, &TimeSlice) -> Result<Vec<u8>, Problem>;
        let ways: [Way; 4] = [
            |table, slice| json(table, slice),
            csv,
            |table, slice| ndjson(table, &"end", slice),
            |table, slice| arrow(table, |_| "", "{}".to_owned(), slice),
        ];
        for write in ways {
            let slice = TimeSlice::unbounded();
            assert!(write(&table, &slice).unwrap().len() > 3_000_000);
            slice.cancel().set();
            assert_eq!(write(&table, &slice).unwrap_err().status(), 503);
        }
    }

    #[derive(Serialize)]
    struct Inner {
        t: Vec<f64>,
    }

    #[derive(Serialize)]
    struct Plain {
        scene: Inner,
        t: Vec<f64>,
        last: Option<u8>,
    }

    #[derive(Serialize)]
    struct Flat {
        scene: &'static str,
        #[serde(flatten)]
        inner: Inner,
    }

    fn rest(answer: &impl Serialize) -> Result<Value, serde_json::Error> {
        serde_json::from_str(&serde_json::to_string(&Part { answer, members: Members::Without(&["t"]) })?)
    }

    #[test]
    fn outer_members_are_left_out_and_inner_ones_stay() {
        let plain = Plain { scene: Inner { t: vec![1.0] }, t: vec![2.0], last: None };
        assert_eq!(rest(&plain).unwrap(), json!({"scene": {"t": [1.0]}, "last": null}));
        assert_eq!(rest(&Flat { scene: "a", inner: Inner { t: vec![1.0] } }).unwrap(), json!({"scene": "a"}));
        assert_eq!(rest(&json!({"t": 1, "n": [2]})).unwrap(), json!({"n": [2]}));
    }

    #[test]
    fn the_rest_is_that_of_an_object() {
        for answer in [json!(1), json!("t"), json!([1]), json!(null)] {
            assert!(rest(&answer).unwrap_err().to_string().contains("object"));
        }
    }

    #[test]
    fn there_is_a_line_for_each_hundredth() {
        let mut progress = Progress::default();
        let lines: Vec<_> = (0..=1000).map(|done| progress.line(done, 1000)).filter(|line| !line.is_empty()).collect();
        assert_eq!(lines.len(), 101);
        assert_eq!(lines[57], b"{\"progress\":{\"done\":570,\"of\":1000}}\n");
    }

    #[test]
    fn little_work_has_a_line_for_each_step() {
        let mut progress = Progress::default();
        assert!((0..=3).all(|done| !progress.line(done, 3).is_empty()));
        assert_eq!(Progress::default().line(0, 0), b"{\"progress\":{\"done\":0,\"of\":0}}\n");
    }

    #[test]
    fn bytes_come_out_as_they_go_in() {
        let bytes = write_to_memory(0, &|| true, |out| {
            (0..100_000_u32).try_for_each(|number| out.write_all(number.to_string().as_bytes()))
        });
        let all: String = (0..100_000_u32).map(|number| number.to_string()).collect();
        assert_eq!(bytes.unwrap(), all.into_bytes());
    }

    #[test]
    fn writing_ends_soon_after_nobody_waits() {
        let has_left = Cell::new(false);
        let mut rows = 0;
        let endless = |out: &mut OutputBuffer<'_>| {
            loop {
                rows += 1;
                if rows == 100 {
                    has_left.set(true);
                }
                out.write_all(&[b'0'; 1000])?;
            }
        };
        assert_eq!(write_to_memory(0, &|| !has_left.get(), endless).unwrap_err().status(), 503);
        assert!(rows <= 100 + limits::WRITE_STEP_BYTES / 1000 + 1, "{rows}");
    }

    #[test]
    fn other_failures_are_the_servers_own() {
        let failed = write_to_memory(0, &|| true, |_| Err(io::Error::other("on purpose")));
        assert_eq!(failed.unwrap_err().status(), 500);
    }
}
