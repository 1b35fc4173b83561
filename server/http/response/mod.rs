//! Responses: negotiated, tagged, compressed, kept, whole, in ranges or streamed.

pub mod answers;
pub mod negotiate;
pub mod representation;
pub mod respond;
