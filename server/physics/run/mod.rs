//! Runs from contact to contact: how they go on and end, how they are computed (doubles, 31 digits, closed form), and how large
//! their errors are.

pub mod cancellation;
pub mod carried_errors;
pub mod ending;
pub mod error_estimate;
mod inexact;
pub mod lanes;
pub mod lasting_contact;
pub mod orbit;
pub mod rules;
