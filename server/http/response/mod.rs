//! Responses: negotiated, tagged, compressed, kept, whole, in ranges or streamed.

pub mod answers;
pub(crate) mod builder;
pub mod cached;
pub mod etag;
pub mod gzip;
pub mod negotiate;
pub(crate) mod ranges;
pub(crate) mod repeats;
pub mod static_asset;
pub mod streaming;
