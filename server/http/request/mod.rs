//! A request as it is read: fields of a query or a JSON body, with everything that is wrong.

pub mod api_request;
pub mod body;
pub mod context;
pub mod json;
pub mod ndjson;
pub mod query;
pub mod reader;
pub mod scalar;
