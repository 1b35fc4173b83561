//! Schemas of the contract that are not of a type, and the form of all schemas that generators of clients read.

use std::collections::BTreeSet;

use equipoise_physics::map::strike;
use serde_json::{Map, Value, json};

/// Units that end the first sentence of a word.
const UNITS: [&str; 22] = [
    "m",
    "s",
    "rad",
    "m/s",
    "rad/s",
    "m/s²",
    "rad/s²",
    "m²/s²",
    "s²/m²",
    "1/s",
    "1/rad²",
    "rad/m",
    "rad·s/m",
    "s/m",
    "kg",
    "ms",
    "ns",
    "unix ms",
    "m²",
    "rad²",
    "ns an impact",
    "bounces",
];

/// Name of a component of the contract for a path, as in `SceneTableTiltGain`: generators make a name of a type of it.
pub fn component(path: &str) -> String {
    let capitalized = |part: &str| part[..1].to_uppercase() + &part[1..];
    path.split(|letter: char| !letter.is_ascii_alphanumeric()).map(capitalized).collect()
}

/// Gives an object within a schema that is called as another schema a schema of its own, as in `InterventionThrow`: generators would give both the
/// same name.
pub fn named_apart(schemas: &mut Map<String, Value>) {
    let names: BTreeSet<String> = schemas.keys().cloned().collect();
    let mut own = Map::new();
    for (name, schema) in schemas.iter_mut() {
        part(name, schema, &names, &mut own);
    }
    schemas.append(&mut own);
}

fn part(within: &str, schema: &mut Value, names: &BTreeSet<String>, own: &mut Map<String, Value>) {
    for (key, inner) in schema.get_mut("properties").and_then(Value::as_object_mut).into_iter().flatten() {
        let name = component(key);
        part(&format!("{within}{name}"), inner, names, own);
        if inner.get("properties").is_some() && names.contains(&name) {
            let name = format!("{within}{name}");
            let mut object = inner.take();
            let reference = json!({"$ref": format!("#/components/schemas/{name}")});
            *inner = match object["type"].take().is_array() {
                true => json!({"anyOf": [reference, {"type": "null"}]}),
                false => reference,
            };
            object["type"] = json!("object");
            own.insert(name, object);
        }
    }
    if let Some(items) = schema.get_mut("items") {
        part(within, items, names, own);
    }
}

/// Completes the schemas within a schema: no object has other fields than those that are named, and numbers have their units.
pub fn complete(schema: &mut Value) {
    if let Some(object) = schema.as_object_mut() {
        if object.get("properties").is_some_and(Value::is_object) && object.contains_key("type") {
            object.entry("additionalProperties").or_insert(json!(false));
        }
        match object.get("format").and_then(Value::as_str) {
            Some("double") => {
                object.remove("format");
            }
            Some("uint64" | "uint" | "uint32" | "uint16") => {
                object.remove("format");
            }
            _ => {}
        }
        if let Some(unit) = object.get("description").and_then(Value::as_str).and_then(unit_of)
            && !object.contains_key("x-unit")
        {
            object.insert("x-unit".to_owned(), json!(unit));
        }
        // A choice of forms, which generators read as one type for each.
        if let Some(forms) = object.get("anyOf").and_then(Value::as_array)
            && forms.iter().all(|form| form["type"] != "null")
            && let Some(forms) = object.shift_remove("anyOf")
        {
            object.insert("oneOf".to_owned(), forms);
        }
        if object.get("items").is_some_and(|items| items["items"]["type"] == json!(["number", "null"])) {
            object.insert("items".to_owned(), json!({"$ref": "#/components/schemas/NumbersOrNull"}));
        }
        for (key, inner) in object.iter_mut() {
            if key == "properties" {
                inner.as_object_mut().into_iter().flat_map(|all| all.values_mut()).for_each(complete);
            } else if !matches!(key.as_str(), "examples" | "default" | "enum" | "const" | "required") {
                complete(inner);
            }
        }
    } else if let Some(items) = schema.as_array_mut() {
        items.iter_mut().for_each(complete);
    }
}

/// A member of an answer that may be absent is never null.
pub fn without_null_if_absent(schema: &mut Value) {
    let required = schema["required"].as_array().cloned().unwrap_or_default();
    let properties = schema.get_mut("properties").and_then(Value::as_object_mut).into_iter().flatten();
    for (_, schema) in properties.filter(|(name, _)| !required.contains(&json!(name))) {
        if let Some([kind, other]) = schema["type"].as_array().map(Vec::as_slice)
            && other == "null"
        {
            schema["type"] = kind.clone();
        }
        let some = schema["anyOf"].as_array().filter(|any| any.len() == 2 && any[1]["type"] == "null");
        if let Some(mut some) = some.map(|any| any[0].clone()) {
            if let Some(about) = schema.get("description") {
                some["description"] = about.clone();
            }
            *schema = some;
        }
    }
    schema.as_object_mut().into_iter().flatten().for_each(|(_, inner)| match inner {
        Value::Array(items) => items.iter_mut().filter(|item| item.is_object()).for_each(without_null_if_absent),
        Value::Object(_) => without_null_if_absent(inner),
        _ => {}
    });
}

/// The unit at the end of the first sentence of a word.
fn unit_of(word: &str) -> Option<&'static str> {
    let first = word.split(". ").next()?.trim_end_matches('.');
    let (_, last) = first.rsplit_once(", ")?;
    UNITS.into_iter().find(|unit| *unit == last)
}

/// Declares schemas for `#[schemars(with = "…")]`: a word, a name, and the schema as JSON.
#[macro_export]
macro_rules! schemas {
    ($($(#[doc = $about:literal])+ $vis:vis $name:ident = $schema:expr;)+) => {$(
        $(#[doc = $about])+
        #[derive(Debug)]
        $vis enum $name {}

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let mut schema: serde_json::Value = $schema;
                schema["description"] = $crate::http::request::fields::word(&[$($about),+]).into();
                schema.try_into().unwrap_or_default()
            }
        }
    )+};
}

/// Declares schemas of words for `#[schemars(with = "…")]`: a name, and the list.
#[macro_export]
macro_rules! words {
    ($($(#[doc = $about:literal])+ $vis:vis $name:ident = $words:expr;)+) => {
        $crate::schemas! {$(
            $(#[doc = $about])+
            $vis $name = serde_json::json!({"type": "string", "enum": $words.into_iter().collect::<Vec<&str>>()});
        )+}
    };
}

/// Declares names of schemas of the contract that are made elsewhere, for `#[schemars(with = "…")]`.
#[macro_export]
macro_rules! schema_names {
    ($($vis:vis $name:ident;)+) => {$(
        #[doc = concat!("The schema ", stringify!($name), ".")]
        #[derive(Debug)]
        $vis enum $name {}

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn inline_schema() -> bool {
                true
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({"$ref": concat!("#/components/schemas/", stringify!($name))})
            }
        }
    )+};
}

/// Declares schemas of columns for `#[schemars(with = "…")]`: a name, and what the contract says of each column.
#[macro_export]
macro_rules! column_lists {
    ($($(#[doc = $about:literal])+ $vis:vis $name:ident = $columns:expr;)+) => {
        $crate::schemas! {$(
            $(#[doc = $about])+
            $vis $name = $crate::api::shared::table::columns_schema("", &$columns.into_iter().collect::<Vec<_>>());
        )+}
    };
}

/// The schema of an object that has a number of things for each of these names.
pub fn counts<'a>(names: impl IntoIterator<Item = &'a str>) -> serde_json::Value {
    let names: Vec<_> = names.into_iter().collect();
    let number = serde_json::json!({"type": "integer", "minimum": 0});
    let properties: serde_json::Map<_, _> = names.iter().map(|name| ((*name).to_owned(), number.clone())).collect();
    serde_json::json!({"type": "object", "required": names, "properties": properties})
}

crate::words! {
    /// Mode of a contact along the table: it slid one way throughout (`slide`); was at rest or came to rest, and stayed (`stick`); came to rest and
    /// slid the other way (`reverse_slide`); or was at rest and friction could not hold it (`slide_through`).
    pub ContactMode = strike::ContactMode::ALL.map(strike::ContactMode::name);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_ends_the_first_sentence() {
        assert_eq!(unit_of("Time since the release, s."), Some("s"));
        assert_eq!(unit_of("Speed, m/s. Null for a point mass."), Some("m/s"));
        assert_eq!(unit_of("Counts apples, m and s."), None);
    }
}
