//! Scenes: the table of fields, a draft that collects values, and the scene that it becomes.

mod build;
pub mod capability;
mod draft;
pub(crate) mod error;
mod fields;
pub mod model;
mod text;

pub use build::Scene;
pub use draft::{Draft, VERTICES};
pub use error::{FieldError, FieldErrorKind};
pub(crate) use fields::{AIR, ERRORS, TURNING, names_of};
pub use fields::{FIELDS, Field, FieldKind, GAINS, Name, Value, field};

/// Motion of the table along its normal at a strike.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Striking {
    /// The table makes up the energy that the bounce loses, eq. (25) and (28).
    Compensated,
    /// The table does not move.
    Still,
}

names!(Striking: Compensated => "compensated", Still => "still");
