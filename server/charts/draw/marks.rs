//! Marks: points, lines, bands and arrows, in pixels.

use std::fmt::Write as _;

use crate::charts::draw::colour::{HATCH, INK, PALE_GREY, PAPER};
use crate::charts::draw::geometry::{Frame, Point};
use crate::charts::draw::svg::{Svg, Tag, fixed};

/// Many equal dots, as one path: a third of the bytes of circles.
pub(crate) fn dots(svg: &mut Svg, points: impl Iterator<Item = Point>, radius: f64, colour: &str) {
    readable_dots(svg, points, radius, colour, &[]);
}

/// The same with data attributes.
pub(crate) fn readable_dots(
    svg: &mut Svg,
    points: impl Iterator<Item = Point>,
    radius: f64,
    colour: &str,
    data: &[(&str, &str)],
) {
    let mut path = String::new();
    for (x, y) in points {
        let _ = write!(path, "M{} {}h0", fixed(x), fixed(y));
    }
    if !path.is_empty() {
        let tag = svg.tag("path").word("d", &path).word("fill", "none").word("stroke", colour);
        with_data(tag.number("stroke-width", 2.0 * radius).word("stroke-linecap", "round"), data).end();
    }
}

/// Adds data attributes to a tag.
fn with_data<'a>(tag: Tag<'a>, data: &[(&str, &str)]) -> Tag<'a> {
    data.iter().fold(tag, |tag, (name, value)| tag.word(name, value))
}

/// Straight lines through points, dashed by `dashes`.
pub(crate) fn line(svg: &mut Svg, points: &[Point], colour: &str, thickness: f64, dashes: Option<&str>) {
    readable_line(svg, points, colour, thickness, dashes, &[]);
}

/// The same with data attributes, from which a page reads the values behind the points.
pub(crate) fn readable_line(
    svg: &mut Svg,
    points: &[Point],
    colour: &str,
    thickness: f64,
    dashes: Option<&str>,
    data: &[(&str, &str)],
) {
    let mut path = String::new();
    for (x, y) in points {
        let _ = write!(path, "{}{} {}", if path.is_empty() { "M" } else { "L" }, fixed(*x), fixed(*y));
    }
    let mut tag = svg.tag("path").word("d", &path).word("fill", "none").word("stroke", colour);
    tag = tag.number("stroke-width", thickness).word("stroke-linejoin", "round");
    if let Some(dashes) = dashes {
        tag = tag.word("stroke-dasharray", dashes);
    }
    with_data(tag, data).end();
}

/// Numbers for a data attribute, apart by spaces, each with all its digits.
pub(crate) fn listed(values: impl Iterator<Item = f64>) -> String {
    values.map(|value| value.to_string()).collect::<Vec<_>>().join(" ")
}

/// A full disc with a rim of paper, which sets it off from marks below it.
pub(crate) fn disc(svg: &mut Svg, (x, y): Point, radius: f64, colour: &str) {
    let tag = svg.tag("circle").number("cx", x).number("cy", y).number("r", radius).word("fill", colour);
    tag.word("stroke", PAPER).number("stroke-width", 1.5).end();
}

/// An open circle.
pub(crate) fn ring(svg: &mut Svg, (x, y): Point, radius: f64, colour: &str) {
    for (stroke, width) in [(PAPER, 4.5), (colour, 2.0)] {
        let tag = svg.tag("circle").number("cx", x).number("cy", y).number("r", radius).word("fill", "none");
        tag.word("stroke", stroke).number("stroke-width", width).end();
    }
}

/// A circle filled with paper.
pub(crate) fn hollow(svg: &mut Svg, (x, y): Point, radius: f64, colour: &str) {
    let tag = svg.tag("circle").number("cx", x).number("cy", y).number("r", radius).word("fill", PAPER);
    tag.word("stroke", colour).number("stroke-width", 2.0).end();
}

/// An open square.
pub(crate) fn square(svg: &mut Svg, (x, y): Point, half: f64, colour: &str) {
    for (stroke, width) in [(PAPER, 4.5), (colour, 2.0)] {
        let tag = svg.tag("rect").number("x", x - half).number("y", y - half).number("width", 2.0 * half);
        tag.number("height", 2.0 * half)
            .word("fill", "none")
            .word("stroke", stroke)
            .number("stroke-width", width)
            .end();
    }
}

/// An arrow head with its tip at a point, pointing along `direction`.
pub(crate) fn arrow(svg: &mut Svg, (x, y): Point, direction: Point, size: f64, colour: &str) {
    let length = (direction.0 * direction.0 + direction.1 * direction.1).sqrt();
    if length.is_nan() || length <= 0.0 {
        return;
    }
    let (along, across) = (direction.0 / length * size, direction.1 / length * size);
    let path = format!(
        "M{} {}L{} {}L{} {}Z",
        fixed(x),
        fixed(y),
        fixed(x - along - 0.5 * across),
        fixed(y - across + 0.5 * along),
        fixed(x - along + 0.5 * across),
        fixed(y - across - 0.5 * along)
    );
    svg.tag("path").word("d", &path).word("fill", colour).word("stroke", PAPER).end();
}

/// A filled rectangle.
pub(crate) fn band(svg: &mut Svg, area: Frame, colour: &str) {
    let tag = svg.tag("rect").number("x", area.left).number("y", area.top).number("width", area.width);
    tag.number("height", area.height).word("fill", colour).end();
}

/// The filled area between two lines, both from left to right.
pub(crate) fn area(svg: &mut Svg, upper: &[Point], lower: &[Point], colour: &str) {
    let mut path = String::new();
    for (x, y) in upper.iter().chain(lower.iter().rev()) {
        let _ = write!(path, "{}{} {}", if path.is_empty() { "M" } else { "L" }, fixed(*x), fixed(*y));
    }
    if !path.is_empty() {
        svg.tag("path").word("d", &format!("{path}Z")).word("fill", colour).end();
    }
}

/// A dark path on a casing of paper, visible on any colour. Only the dark line is dashed.
pub(crate) fn cased(svg: &mut Svg, path: &str, dashes: Option<&str>) {
    for (stroke, width, dashes) in [(PAPER, 4.6, None), (INK, 2.0, dashes)] {
        let mut tag = svg.tag("path").word("d", path).word("fill", "none").word("stroke", stroke);
        tag = tag.number("stroke-width", width).word("stroke-linejoin", "round");
        if let Some(dashes) = dashes {
            tag = tag.word("stroke-dasharray", dashes);
        }
        tag.end();
    }
}

/// Hatching along a path.
pub(crate) fn hatch(svg: &mut Svg, path: &str) {
    let tag = svg.tag("path").word("d", path).word("fill", "none").word("stroke", HATCH);
    tag.number("stroke-width", 1.0).end();
}

/// A small hatched rectangle.
pub(crate) fn hatched(svg: &mut Svg, area: Frame) {
    let Frame { left, top, width, height } = area;
    band(svg, area, PALE_GREY);
    let mut path = String::new();
    for share in [0.0, 0.5] {
        // From the left side up to the top, then from the bottom up to the right side.
        let (x, y) = (share * width, share * height);
        let _ = write!(path, "M{} {}", fixed(left + x), fixed(top + height));
        let _ = write!(path, "L{} {}", fixed(left + width), fixed(top + y));
        if share > 0.0 {
            let _ = write!(path, "M{} {}L{} {}", fixed(left), fixed(top + y), fixed(left + x), fixed(top));
        }
    }
    hatch(svg, &path);
    let tag = svg.tag("rect").number("x", left).number("y", top).number("width", width).number("height", height);
    tag.word("fill", "none").word("stroke", HATCH).end();
}
