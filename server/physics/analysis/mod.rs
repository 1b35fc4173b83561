//! Analyses of the return map of a body: functions of the map, which know no part of the body.

pub mod evidence;
pub mod repeating;
pub mod return_map;
pub mod swing;
