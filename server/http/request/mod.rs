//! Requests: reading the fields of a query or a JSON body, with all errors.

pub mod api_request;
pub mod context;
pub mod fields;
pub mod reader;
pub mod tree;
