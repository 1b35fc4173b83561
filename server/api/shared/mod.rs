//! Parts that answers of several resources share.

pub mod actuator_load;
pub mod closed_loop;
pub mod eigenvalue;
pub mod fixed_point;
pub mod margins;
pub mod model_choice;
pub mod nearest_vertex;
pub mod outcome;
pub mod progress;
pub mod refusal;
pub mod state;
pub mod table;
pub mod tile;
pub mod weights;
pub mod write;
