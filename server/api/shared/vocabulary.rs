//! Words of the contract: lists of which a text in an answer is one.

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
