//! Drawing: SVG, text, scales, colours and marks, and SVG in pixels.

pub mod colour;
pub mod marks;
pub mod panel;
pub mod pixels;
pub mod scale;
pub mod svg;
