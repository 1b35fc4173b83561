//! Schemas of the contract that are not of a type: words of which a text is one, and objects whose members come from a list.

use equipoise_physics::map::strike;

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
            $vis $name = $crate::api::shared::table::columns::columns_schema("", &$columns.into_iter().collect::<Vec<_>>());
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
