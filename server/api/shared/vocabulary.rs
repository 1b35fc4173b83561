//! Words of the contract: lists of which a text in an answer is one, and columns that an answer has as an object of lists.

use equipoise_physics::map::strike;

/// Declares schemas of words for `#[schemars(with = "…")]`: a name, and the list.
#[macro_export]
macro_rules! words {
    ($($(#[doc = $about:literal])+ $vis:vis $name:ident = $words:expr;)+) => {$(
        $(#[doc = $about])+
        #[derive(Debug)]
        $vis enum $name {}

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let words: Vec<&str> = $words.into_iter().collect();
                let about = $crate::http::request::fields::word(&[$($about),+]);
                schemars::json_schema!({"type": "string", "enum": words, "description": about})
            }
        }
    )+};
}

/// Declares schemas of columns for `#[schemars(with = "…")]`: a name, and what the contract says of each column.
#[macro_export]
macro_rules! column_lists {
    ($($(#[doc = $about:literal])+ $vis:vis $name:ident = $columns:expr;)+) => {$(
        $(#[doc = $about])+
        #[derive(Debug)]
        $vis enum $name {}

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let about = $crate::http::request::fields::word(&[$($about),+]);
                let schema = $crate::api::shared::table::columns::columns_schema(&about, $columns);
                schemars::Schema::try_from(schema).unwrap_or_default()
            }
        }
    )+};
}

crate::words! {
    /// Mode of a contact along the table: it slid one way throughout (`slide`); was at rest or came to rest, and stayed (`stick`); came to rest and
    /// slid the other way (`reverse_slide`); or was at rest and friction could not hold it (`slide_through`).
    pub ContactMode = strike::ContactMode::ALL.map(strike::ContactMode::name);
}
