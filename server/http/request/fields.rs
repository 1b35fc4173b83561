//! Fields of a request, each declared once: how it is read, and what the contract says of it.
//!
//! [`request_fields!`](crate::request_fields) declares a struct with a line for each field: its word (the doc comment), its type, and its specification.
//! Reader, JSON schema and query parameters follow from that.

use std::ops::RangeInclusive;

use serde_json::{Map, Value, json};

use crate::http::request::reader::{LARGEST_EXACT, Reader};

/// Specification of a field whose value is a `T`.
pub trait FieldSpec<T> {
    /// Reads the field. None if it is wrong, or absent without a default.
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<T>;

    /// Adds the field to a list.
    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList);
}

/// A struct of declared fields.
pub trait Fields: Sized {
    /// Reads all fields. None if one is wrong or missing; the reader then has the errors.
    fn read_fields(reader: &mut Reader<'_, '_>) -> Option<Self>;

    /// Adds all fields to a list.
    fn describe_fields(list: &mut FieldList);
}

/// Descriptions of fields in the contract: JSON properties, and query parameters.
#[derive(Debug, Default)]
pub struct FieldList {
    prefix: String,
    /// Schemas of the properties, by name.
    pub properties: Map<String, Value>,
    /// Names of the properties without which there is no value.
    pub required: Vec<&'static str>,
    /// Query parameters: name, schema, word, and whether it is required.
    pub parameters: Vec<Parameter>,
}

/// A query parameter.
#[derive(Debug, Clone)]
pub struct Parameter {
    /// Dotted path in the request.
    pub name: String,
    /// Schema of its value.
    pub schema: Value,
    /// Its word.
    pub about: String,
    /// An example of a value, if there is one.
    pub example: Option<Value>,
    /// True if no request does without it.
    pub required: bool,
}

impl FieldList {
    /// Adds a field whose value is not an object, with an example.
    pub fn leaf(&mut self, name: &str, about: &str, schema: Value, example: Option<Value>) {
        self.property(name, about, &schema);
        self.parameter(name, about, schema, example);
    }

    /// Adds a property alone. Null means absent.
    pub fn property(&mut self, name: &str, about: &str, schema: &Value) {
        self.properties.insert(name.to_owned(), or_null(described(schema.clone(), about)));
    }

    /// Adds a query parameter alone.
    pub fn parameter(&mut self, name: &str, about: &str, schema: Value, example: Option<Value>) {
        let name = format!("{}{name}", self.prefix);
        self.parameters.push(Parameter { name, schema, about: about.to_owned(), example, required: false });
    }

    /// The fields of an object at `path` below this one: its schema. The parameters are added here.
    pub fn nested(&mut self, path: &str, describe: impl FnOnce(&mut Self)) -> Value {
        let mut inner = Self { prefix: format!("{}{path}.", self.prefix), ..Self::default() };
        describe(&mut inner);
        // A field is no example of an object that has to have another one.
        for parameter in &mut inner.parameters {
            let own = parameter.name[inner.prefix.len()..].split('.').next();
            if inner.required.iter().any(|name| own != Some(name)) {
                parameter.example = None;
            }
        }
        self.parameters.append(&mut inner.parameters);
        inner.into_schema()
    }

    /// Marks a field as required. A parameter is required if all objects that it is in are.
    pub fn require(&mut self, name: &'static str) {
        self.required.push(name);
        never_null(&mut self.properties[name]);
        let name = format!("{}{name}", self.prefix);
        self.parameters.iter_mut().filter(|parameter| parameter.name == name).for_each(|it| it.required = true);
    }

    /// The parameters of an object that may be absent are not required, and none has a default, which clients would send and so make the object.
    /// If one of them needs another, none has an example of its own.
    pub fn may_be_absent(&mut self, name: &str) {
        let below = format!("{}{name}.", self.prefix);
        let mut parameters: Vec<_> = self.parameters.iter_mut().filter(|it| it.name.starts_with(&below)).collect();
        let needs_another = parameters.iter().any(|parameter| parameter.required);
        for parameter in &mut parameters {
            parameter.required = false;
            parameter.example.take_if(|_| needs_another);
            if let Some(default) = parameter.schema.as_object_mut().and_then(|schema| schema.shift_remove("default")) {
                parameter.schema["x-default"] = default;
            }
        }
    }

    /// The schema of the object.
    pub fn into_schema(self) -> Value {
        let mut schema = json!({"type": "object", "additionalProperties": false});
        if !self.required.is_empty() {
            schema["required"] = json!(self.required);
        }
        schema["properties"] = Value::Object(self.properties);
        schema
    }
}

/// A schema with a description, after what it has.
fn described(mut schema: Value, about: &str) -> Value {
    if !about.is_empty() {
        schema["description"] = json!(about);
    }
    schema
}

/// A schema that takes null too.
fn or_null(mut schema: Value) -> Value {
    let kind = schema["type"].take();
    if kind.is_string() {
        schema["type"] = json!([kind, "null"]);
        if let Some(words) = schema.get_mut("enum").and_then(Value::as_array_mut) {
            words.push(Value::Null);
        }
        return schema;
    }
    let about = schema.as_object_mut().and_then(|schema| {
        schema.remove("type");
        schema.remove("description")
    });
    let mut kinds = schema["anyOf"].as_array().cloned().unwrap_or_else(|| vec![schema]);
    kinds.push(json!({"type": "null"}));
    let schema = json!({"anyOf": kinds});
    if let Some(Value::String(about)) = about { described(schema, &about) } else { schema }
}

/// The opposite of [`or_null`], for a required field.
fn never_null(schema: &mut Value) {
    if let Some(kind) = schema["type"].get(0).cloned() {
        schema["type"] = kind;
        if let Some(words) = schema.get_mut("enum").and_then(Value::as_array_mut) {
            words.pop();
        }
    }
}

/// A whole number within a range.
#[derive(Debug, Clone)]
pub struct Whole(RangeInclusive<u64>);

/// A whole number within a range.
pub const fn whole(range: RangeInclusive<u64>) -> Whole {
    Whole(range)
}

/// A whole number that every JSON reader keeps exactly.
pub const fn exact_whole() -> Whole {
    Whole(0..=LARGEST_EXACT)
}

impl FieldSpec<u64> for Whole {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<u64> {
        reader.integer(name, self.0.clone())
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let (least, most) = (self.0.start(), self.0.end());
        let mut schema = json!({"type": "integer", "minimum": least, "maximum": most});
        // Generated clients take 32 bits otherwise.
        if *most > i32::MAX as u64 {
            schema["format"] = json!("int64");
        }
        list.leaf(name, about, schema, None);
    }
}

/// A finite number within a range, in a unit (`""` for none).
#[derive(Debug, Clone)]
pub struct Number(RangeInclusive<f64>, &'static str);

/// A finite number within a range, in a unit (`""` for none).
pub const fn number(range: RangeInclusive<f64>, unit: &'static str) -> Number {
    Number(range, unit)
}

impl FieldSpec<f64> for Number {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<f64> {
        reader.number(name, self.0.clone(), self.1)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let mut schema = json!({"type": "number", "minimum": self.0.start(), "maximum": self.0.end()});
        if !self.1.is_empty() {
            schema["x-unit"] = json!(self.1);
        }
        list.leaf(name, about, schema, None);
    }
}

/// True or false; false by default.
#[derive(Debug, Clone, Copy)]
pub struct Flag;

impl FieldSpec<bool> for Flag {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<bool> {
        Some(reader.boolean(name).unwrap_or(false))
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        list.leaf(name, about, json!({"type": "boolean", "default": false}), Some(json!(true)));
    }
}

/// The meaning of one of these words.
#[derive(Debug, Clone, Copy)]
pub struct Choice<T: 'static>(&'static [(&'static str, T)]);

/// The meaning of one of these words.
pub const fn choice<T>(words: &'static [(&'static str, T)]) -> Choice<T> {
    Choice(words)
}

impl<T: Copy> FieldSpec<T> for Choice<T> {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<T> {
        reader.choice(name, self.0)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let words: Vec<_> = self.0.iter().map(|(word, _)| *word).collect();
        list.leaf(name, about, json!({"type": "string", "enum": words}), None);
    }
}

/// An object of declared fields.
#[derive(Debug, Clone, Copy)]
pub struct Object;

impl<T: Fields> FieldSpec<T> for Object {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<T> {
        reader.within(name, T::read_fields).flatten()
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(name, T::describe_fields);
        list.property(name, about, &schema);
    }
}

/// An object of declared fields that all have defaults. An absent object is an empty one.
#[derive(Debug, Clone, Copy)]
pub struct ObjectOfDefaults;

impl<T: Fields> FieldSpec<T> for ObjectOfDefaults {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<T> {
        if reader.has(name) {
            return Object.read(reader, name);
        }
        T::read_fields(&mut Reader::new(&Map::new(), reader.pointer_to(name), reader.source(), reader.errors()))
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        FieldSpec::<T>::describe(&Object, name, about, list);
        list.may_be_absent(name);
    }
}

/// The declared fields of a part, beside those around it.
#[derive(Debug, Clone, Copy)]
pub struct Part;

impl<T: Fields> FieldSpec<T> for Part {
    fn read(&self, reader: &mut Reader<'_, '_>, _: &'static str) -> Option<T> {
        T::read_fields(reader)
    }

    fn describe(&self, _: &'static str, _: &str, list: &mut FieldList) {
        T::describe_fields(list);
    }
}

/// Numbers with names, each with a default: an object of some of them, or an array of all in this order.
#[derive(Debug, Clone)]
pub struct NamedNumbers<const N: usize> {
    /// Names, and the words for them.
    pub names: [(&'static str, &'static str); N],
    /// Range of each.
    pub range: RangeInclusive<f64>,
    /// Defaults.
    pub defaults: [f64; N],
}

impl<const N: usize> FieldSpec<[f64; N]> for NamedNumbers<N> {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<[f64; N]> {
        let mut numbers = self.defaults;
        reader.numbers(name, &self.names.map(|(name, _)| name), &self.range, &mut numbers);
        Some(numbers)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let number = json!({"type": "number", "minimum": self.range.start(), "maximum": self.range.end()});
        let object = list.nested(name, |inner| {
            for ((name, about), default) in self.names.iter().zip(self.defaults) {
                let mut schema = number.clone();
                schema["default"] = json!(default);
                inner.leaf(name, about, schema, Some(json!(default)));
            }
        });
        let array = json!({"type": "array", "items": number, "minItems": N, "maxItems": N});
        list.property(name, about, &json!({"anyOf": [object, array]}));
    }
}

/// A list of at most so many objects of declared fields.
#[derive(Debug, Clone, Copy)]
pub struct Objects(pub usize);

impl<T: Fields> FieldSpec<Vec<T>> for Objects {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Vec<T>> {
        let (mut all, mut is_whole) = (Vec::new(), true);
        reader.objects(name, self.0, |_, item| match T::read_fields(item) {
            Some(one) => all.push(one),
            None => is_whole = false,
        });
        is_whole.then_some(all)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        let schema = list.nested(&format!("{name}.0"), T::describe_fields);
        list.may_be_absent(name);
        list.property(name, about, &json!({"type": "array", "maxItems": self.0, "items": schema}));
    }
}

/// A field with a default.
#[derive(Debug, Clone)]
pub struct Or<S, T>(S, T);

/// A field that may be absent.
#[derive(Debug, Clone)]
pub struct Optional<S>(S);

/// A field without which there is no request.
#[derive(Debug, Clone)]
pub struct Required<S>(S);

/// Ways to treat an absent field.
pub trait Absence: Sized {
    /// Takes this value for an absent field.
    fn or<T>(self, default: T) -> Or<Self, T> {
        Or(self, default)
    }

    /// Takes None for an absent field.
    fn optional(self) -> Optional<Self> {
        Optional(self)
    }

    /// Refuses a request without the field.
    fn required(self) -> Required<Self> {
        Required(self)
    }
}

impl Absence for Whole {}
impl Absence for Number {}
impl<T> Absence for Choice<T> {}
impl Absence for Object {}

/// A default as JSON, and as the word for it in a list of choices.
pub trait ShownDefault<T> {
    /// The default in the contract.
    fn shown(&self, default: T) -> Value;
}

impl ShownDefault<u64> for Whole {
    fn shown(&self, default: u64) -> Value {
        json!(default)
    }
}

impl ShownDefault<f64> for Number {
    fn shown(&self, default: f64) -> Value {
        json!(default)
    }
}

impl<T: Copy + PartialEq> ShownDefault<T> for Choice<T> {
    fn shown(&self, default: T) -> Value {
        json!(self.0.iter().find(|(_, meaning)| *meaning == default).map(|(word, _)| *word))
    }
}

impl<S: FieldSpec<T> + ShownDefault<T>, T: Copy> FieldSpec<T> for Or<S, T> {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<T> {
        Some(self.0.read(reader, name).unwrap_or(self.1))
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        self.0.describe(name, about, list);
        let default = self.0.shown(self.1);
        list.properties[name]["default"] = default.clone();
        if let Some(parameter) = list.parameters.last_mut() {
            parameter.schema["default"] = default.clone();
            parameter.example = Some(default);
        }
    }
}

impl<S: FieldSpec<T>, T> FieldSpec<Option<T>> for Optional<S> {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<Option<T>> {
        Some(self.0.read(reader, name))
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        self.0.describe(name, about, list);
        list.may_be_absent(name);
    }
}

impl<S: FieldSpec<T>, T> FieldSpec<T> for Required<S> {
    fn read(&self, reader: &mut Reader<'_, '_>, name: &'static str) -> Option<T> {
        reader.require(&[name]);
        self.0.read(reader, name)
    }

    fn describe(&self, name: &'static str, about: &str, list: &mut FieldList) {
        self.0.describe(name, about, list);
        list.require(name);
    }
}

/// The word of a field, from the lines of its doc comment.
pub fn word(lines: &[&str]) -> String {
    lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ").trim().to_owned()
}

/// Declares a struct whose fields are read from a request: a doc comment, a type and a [`FieldSpec`] for each. With `impl` in place of `struct`
/// the struct is declared elsewhere.
#[macro_export]
macro_rules! request_fields {
    (impl $name:ident { $( $(#[doc = $about:literal])+ $field:ident: $kind:ty = $spec:expr ),+ $(,)? }) => {
        impl $crate::http::request::fields::Fields for $name {
            fn read_fields(reader: &mut $crate::http::Reader<'_, '_>) -> Option<Self> {
                use $crate::http::request::fields::FieldSpec;
                // All are read before one that is missing ends it, so that the reader gathers all errors.
                $( let $field: Option<$kind> = ($spec).read(reader, stringify!($field)); )+
                Some(Self { $( $field: $field? ),+ })
            }

            fn describe_fields(list: &mut $crate::http::request::fields::FieldList) {
                use $crate::http::request::fields::{FieldSpec, word};
                $( FieldSpec::<$kind>::describe(&($spec), stringify!($field), &word(&[$($about),+]), list); )+
            }
        }
    };
    (
        $(#[$meta:meta])*
        $vis:vis struct $name:ident {
            $( $(#[doc = $about:literal])+ $(#[serde($($serde:tt)+)])? $(#[schemars($($schemars:tt)+)])? $field_vis:vis $field:ident: $kind:ty = $spec:expr ),+ $(,)?
        }
    ) => {
        $(#[$meta])*
        $vis struct $name {
            $( $(#[doc = $about])+ $(#[serde($($serde)+)])? $(#[schemars($($schemars)+)])? $field_vis $field: $kind ),+
        }

        $crate::request_fields! { impl $name { $( $(#[doc = $about])+ $field: $kind = $spec ),+ } }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::http::request::reader::Errors;
    use crate::http::request::reader::Source;

    request_fields! {
        /// A rig.
        #[derive(Debug, PartialEq)]
        struct Rig {
            /// Number of bounces.
            bounces: u64 = whole(1..=100).or(7),
            /// Largest difference, m.
            tolerance: Option<f64> = number(0.0..=1.0, "m").optional(),
            /// The way.
            way: u8 = choice(&[("up", 1), ("down", 2)]).or(2),
            /// The inner part.
            inner: Option<Inner> = Object.optional(),
            /// The weights.
            weights: Weights = ObjectOfDefaults,
            /// The place.
            place: Place = Part,
        }
    }

    request_fields! {
        /// Weights.
        #[derive(Debug, PartialEq)]
        struct Weights {
            /// Weights of two.
            state: [f64; 2] = NamedNumbers { names: [("x", "Of x."), ("y", "Of y.")], range: 0.0..=9.0, defaults: [1.0, 2.0] },
        }
    }

    #[derive(Debug, PartialEq)]
    struct Place {
        at: f64,
    }

    request_fields! {
        impl Place {
            /// Place.
            at: f64 = number(0.0..=1.0, "").or(0.25),
        }
    }

    request_fields! {
        /// A part of it.
        #[derive(Debug, PartialEq)]
        struct Inner {
            /// Length, m.
            length: f64 = number(0.5..=2.0, "m").required(),
        }
    }

    fn read(body: &Value) -> (Option<Rig>, Vec<String>) {
        let mut errors = Errors::default();
        let mut reader = Reader::new(body.as_object().unwrap(), String::new(), Source::Json, &mut errors);
        let rig = Rig::read_fields(&mut reader);
        reader.finish();
        let problem = errors.into_result().err();
        (rig, problem.iter().flat_map(|problem| problem.errors()).map(|error| error.pointer.clone()).collect())
    }

    #[test]
    fn defaults_fill_in_and_all_errors_are_gathered() {
        let (weights, place) = (Weights { state: [1.0, 2.0] }, Place { at: 0.25 });
        let rig = Rig { bounces: 7, tolerance: None, way: 2, inner: None, weights, place };
        assert_eq!(read(&json!({})), (Some(rig), vec![]));
        let (inner, weights, place) = (Some(Inner { length: 1.0 }), Weights { state: [1.0, 5.0] }, Place { at: 0.5 });
        let rig = Rig { bounces: 9, tolerance: Some(0.5), way: 1, inner, weights, place };
        let body = json!({"bounces": 9, "tolerance": 0.5, "way": "up", "inner": {"length": 1}, "weights": {"state": {"y": 5}}, "at": 0.5});
        assert_eq!(read(&body), (Some(rig), vec![]));
        let body = json!({"bounces": 0, "tolerance": "x", "way": "left", "inner": {}, "weights": {"state": [1, -1]}, "other": 1});
        let pointers = ["/bounces", "/tolerance", "/way", "/inner/length", "/weights/state/1", "/other"];
        assert_eq!(read(&body).1, pointers);
    }

    #[test]
    fn schema_and_parameters_follow() {
        let mut list = FieldList::default();
        Rig::describe_fields(&mut list);
        let names: Vec<_> = list.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
        assert_eq!(names, ["bounces", "tolerance", "way", "inner.length", "weights.state.x", "weights.state.y", "at"]);
        assert!(list.parameters.iter().all(|parameter| !parameter.required));
        let schema = list.into_schema();
        assert_eq!(
            schema["properties"]["bounces"],
            json!({"type": ["integer", "null"], "minimum": 1, "maximum": 100, "description": "Number of bounces.", "default": 7})
        );
        assert_eq!(schema["properties"]["way"]["enum"], json!(["up", "down", null]));
        assert_eq!(schema["properties"]["inner"]["required"], json!(["length"]));
        assert_eq!(schema["properties"]["inner"]["properties"]["length"]["type"], "number");
        assert_eq!(schema["properties"]["tolerance"]["x-unit"], "m");
    }
}
