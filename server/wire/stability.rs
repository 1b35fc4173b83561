//! The answer of `stability`.
