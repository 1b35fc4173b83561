//! Who may ask: token, origin and host.

pub mod host;
pub mod origin;
pub mod site;
pub mod token;
