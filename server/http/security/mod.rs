//! Access control: token, origin, host and site.

pub mod host;
pub mod origin;
pub(crate) mod sign_in;
pub mod site;
pub mod token;
