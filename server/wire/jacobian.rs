//! The answer of `jacobians`.
