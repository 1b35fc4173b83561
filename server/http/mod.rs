//! What the server knows of HTTP: problems, reading requests, negotiation, entity tags and answers.
//!
//! No physics and no routes here: everything is told in JSON values, bytes and formats.

pub mod answer;
mod asked;
mod body;
pub mod encode;
pub mod etag;
pub mod fixed;
pub mod host;
pub mod json;
pub mod leaf;
pub mod lines;
pub mod negotiate;
pub mod origin;
pub mod outlet;
pub mod output;
pub mod problem;
pub mod query;
pub mod reader;
pub mod request;
pub mod site;
mod token;
pub mod transfer;

pub use answer::Resource;
pub use asked::{Asked, REQUEST_ID};
pub use host::HostName;
pub use leaf::Source;
pub use lines::{Line, Lines};
pub use negotiate::Format;
pub use origin::Origin;
pub use outlet::Outlet;
pub use problem::{FieldError, Problem};
pub use reader::{Errors, Reader};
pub use request::{Ask, peer};
pub use token::Token;
