//! Parts that answers of several resources share.

pub mod answer_parts;
pub mod arrow;
pub mod margins;
pub mod model_words;
pub mod outcome;
pub mod refusal;
pub mod request_parts;
pub mod stacked;
pub mod table;
pub mod write;
