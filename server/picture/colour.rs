//! Colours: those of Okabe and Ito (2008), which people with any colour vision tell apart, and the greys of the paper.

/// What pictures stand on, whatever the page around them.
pub(super) const PAPER: &str = "#ffffff";
/// Edge of the paper.
pub(super) const EDGE: &str = "#d5d8dc";
/// Text and marks that matter most; 16:1 on paper.
pub(super) const INK: &str = "#1b1f24";
/// Second text; 7:1 on paper.
pub(super) const SOFT_INK: &str = "#4d5560";
/// Frames and ticks of axes.
pub(super) const AXIS: &str = "#6b7480";
/// Lines through zero.
pub(super) const ZERO: &str = "#b9bfc7";
/// Lines at ticks.
pub(super) const GRID: &str = "#eceef1";

pub(super) const BLUE: &str = "#0072b2";
pub(super) const GREEN: &str = "#009e73";
pub(super) const ORANGE: &str = "#e69f00";
pub(super) const SKY: &str = "#56b4e9";
pub(super) const PURPLE: &str = "#cc79a7";
pub(super) const VERMILION: &str = "#d55e00";
/// Blue so light that everything reads on it.
pub(super) const PALE_BLUE: &str = "#e3f0f8";
/// Green for an area, and one on which it still stands out.
pub(super) const LIGHT_GREEN: &str = "#9fd8c4";
pub(super) const PALE_GREEN: &str = "#dff2eb";

/// Under the hatching of what has no value.
pub(super) const PALE_GREY: &str = "#eff0f2";
/// Hatching.
pub(super) const HATCH: &str = "#8f97a1";
