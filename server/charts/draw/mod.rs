//! Drawing: SVG, text, scales, colours and marks, and SVG in pixels.

pub mod colour;
pub mod geometry;
pub mod legend;
pub mod marks;
pub mod number;
pub mod panel;
pub mod pixels;
pub mod scale;
pub mod sheet;
pub mod svg;
pub mod text;
pub mod trail;
