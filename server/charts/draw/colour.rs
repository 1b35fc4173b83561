//! Colours: those of Okabe and Ito (2008), which people with any colour vision tell apart, and the greys of the paper.

/// The paper of pictures, independent of the page around them.
pub(crate) const PAPER: &str = "#ffffff";
/// Edge of the paper.
pub(crate) const EDGE: &str = "#d5d8dc";
/// Most important text and marks; contrast 16:1 on paper.
pub(crate) const INK: &str = "#1b1f24";
/// Secondary text; contrast 7:1 on paper.
pub(crate) const SOFT_INK: &str = "#4d5560";
/// Frames and ticks of axes.
pub(crate) const AXIS: &str = "#6b7480";
/// Lines through zero.
pub(crate) const ZERO: &str = "#b9bfc7";
/// Lines at ticks.
pub(crate) const GRID: &str = "#eceef1";

pub(crate) const BLUE: &str = "#0072b2";
pub(crate) const GREEN: &str = "#009e73";
pub(crate) const ORANGE: &str = "#e69f00";
pub(crate) const SKY: &str = "#56b4e9";
pub(crate) const PURPLE: &str = "#cc79a7";
pub(crate) const VERMILION: &str = "#d55e00";
/// Light blue that every mark is visible on.
pub(crate) const PALE_BLUE: &str = "#e3f0f8";
/// Green for an area, and a lighter green behind it.
pub(crate) const LIGHT_GREEN: &str = "#9fd8c4";
pub(crate) const PALE_GREEN: &str = "#dff2eb";

/// Ground of the hatching for cells without a value.
pub(crate) const PALE_GREY: &str = "#eff0f2";
/// Hatching.
pub(crate) const HATCH: &str = "#8f97a1";
