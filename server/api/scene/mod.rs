//! Presets, the table of scene fields, and scenes read from requests and written to answers.

pub mod derived;
pub mod fields;
pub mod presets;
pub(crate) mod quantity;
pub mod read;
pub mod write;

pub use crate::api::scene::derived::{bounce_price, has_angle};
pub use crate::api::scene::read::{build_scene, read_value};
pub use derived::{Derived, EnergyTarget};
pub use fields::{explain, field_text};
pub use read::{complete_law, read_draft, read_scene, read_scene_without_law};
pub use write::{Resolved, scene_to_json, scene_to_query, value_to_json, value_to_query};
