//! The rest of an answer: its JSON without the members that a table has.

use serde::ser::{Error, Impossible, SerializeMap, SerializeStruct};
use serde::{Serialize, Serializer};

/// An answer without some of its members. The answer is an object; members within its members stay.
#[derive(Debug)]
pub(crate) struct Rest<'a, A> {
    pub(crate) answer: &'a A,
    pub(crate) without: &'static [&'static str],
}

impl<A: Serialize> Serialize for Rest<'_, A> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.answer.serialize(Outermost { inner: serializer, without: self.without })
    }
}

/// Writes an object without some of its members.
struct Outermost<S> {
    inner: S,
    without: &'static [&'static str],
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
        if name.as_str().is_some_and(|name| self.without.contains(&name)) {
            return Ok(());
        }
        self.inner.serialize_entry(key, value)
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
        if self.without.contains(&key) { Ok(()) } else { self.inner.serialize_entry(key, value) }
    }

    fn end(self) -> Result<S::Ok, S::Error> {
        self.inner.end()
    }
}

const NOT_AN_OBJECT: &str = "the rest of an answer is that of an object";

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
        Ok(Outermost { inner: self.inner.serialize_map(None)?, without: self.without })
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

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

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
        serde_json::from_str(&serde_json::to_string(&Rest { answer, without: &["t"] })?)
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
}
