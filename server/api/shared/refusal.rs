//! The reason why a valid request has no answer.

use crate::compute::Cancelled;
use crate::http::Problem;

/// The reason why there is no answer.
#[derive(Debug)]
pub enum Refusal {
    /// The client has gone.
    Cancelled,
    /// A field of the request does not allow it: JSON pointer and sentence.
    At(&'static str, String),
}

impl From<Cancelled> for Refusal {
    fn from(Cancelled: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<(&'static str, String)> for Refusal {
    fn from((pointer, detail): (&'static str, String)) -> Self {
        Self::At(pointer, detail)
    }
}

impl From<Refusal> for Problem {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Cancelled => Cancelled.into(),
            Refusal::At(pointer, detail) => Problem::invalid_at(pointer, detail),
        }
    }
}
