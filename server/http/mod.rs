//! HTTP: problems, reading requests, negotiation, entity tags and responses.
//!
//! This folder knows neither physics nor routes, only JSON values, bytes and formats.

pub mod request;
pub mod response;
pub mod security;

pub mod problem;
pub mod transfer;

pub use crate::http::request::api_request::{ApiRequest, BatchItem, NdjsonBatch, peer};
pub use crate::http::request::context::{REQUEST_ID, RequestContext};
pub use crate::http::request::reader::{Errors, Reader, Source};
pub use crate::http::response::answers::{AnswerCounts, Answers};
pub use crate::http::response::negotiate::Format;
pub use crate::http::response::respond::{BodyWriter, Resource};
pub use crate::http::security::host::HostName;
pub use crate::http::security::origin::Origin;
pub use crate::http::security::token::Token;
pub use problem::{Problem, ProblemError};
