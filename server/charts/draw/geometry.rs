//! Points and frames, px.

/// A point: distance from the left and from the top, px.
pub(crate) type Point = (f64, f64);

/// A rectangle such as the frame of a panel, px.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}
