//! Errors in the fields of a scene.

use super::fields::Name;

/// An error in a field, in words with numbers, limits and units.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldError {
    /// Dotted path of the field, or of the group that is missing.
    pub path: &'static str,
    /// The error in words.
    pub detail: String,
    /// Kind of error.
    pub kind: FieldErrorKind,
}

/// Kind of error in a field. Those that a client may need more words for have one of their own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldErrorKind {
    /// A required field has no value.
    Missing(Name),
    /// Two fields say the same in two ways: a tilt gain and a state feedback, or a target height and a program.
    SaidTwice,
    /// Any other: a value outside its range, or fields that contradict one another.
    Other,
}

impl FieldError {
    /// An error of kind [`FieldErrorKind::Other`] at a path.
    pub fn at(path: &'static str, detail: impl Into<String>) -> Self {
        Self { path, detail: detail.into(), kind: FieldErrorKind::Other }
    }

    pub(super) fn new(name: Name, detail: impl Into<String>) -> Self {
        Self::at(name.row().path, detail)
    }

    pub(super) fn missing(name: Name) -> Self {
        let row = name.row();
        let detail = format!("{} is missing: {}", row.key(), row.limits());
        Self { path: row.path, detail, kind: FieldErrorKind::Missing(name) }
    }
}
