//! Access control: token, origin, host and site.

pub mod host;
pub mod origin;
pub mod token;
