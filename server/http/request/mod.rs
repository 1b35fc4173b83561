//! Requests: reading the fields of a query or a JSON body, with all errors.

pub mod api_request;
pub mod body;
pub mod context;
pub mod fields;
pub mod json;
pub mod ndjson;
pub mod query;
pub mod reader;
pub mod scalar;
pub mod suggestion;
pub mod table;
