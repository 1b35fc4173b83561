//! Responses: negotiated, tagged, compressed, whole or streamed.

pub(crate) mod builder;
pub mod cached;
pub mod etag;
pub mod gzip;
pub mod negotiate;
pub mod static_asset;
pub mod streaming;
