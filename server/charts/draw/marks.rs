//! Marks in frames, px: points, lines, bands and arrows, and a legend: one row of samples with their meaning.

use std::fmt::Write as _;

use crate::charts::draw::colour::{HATCH, INK, PALE_GREY, PAPER, SOFT_INK};
use crate::charts::draw::svg::{Svg, Tag, Type, fixed, sentence, width};

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

impl Frame {
    /// Starts the rectangle.
    pub(crate) fn tag(self, svg: &mut Svg) -> Tag<'_> {
        let Self { left, top, width, height } = self;
        svg.tag("rect").number("x", left).number("y", top).number("width", width).number("height", height)
    }
}

/// Straight lines through points, as the data of a path.
pub(crate) fn straight(points: impl IntoIterator<Item = Point>) -> String {
    points.into_iter().fold(String::new(), |path, (x, y)| {
        let kind = if path.is_empty() { "M" } else { "L" };
        path + kind + &fixed(x) + " " + &fixed(y)
    })
}

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
    let mut tag =
        svg.tag("path").word("d", &straight(points.iter().copied())).word("fill", "none").word("stroke", colour);
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
        let frame = Frame { left: x - half, top: y - half, width: 2.0 * half, height: 2.0 * half };
        frame.tag(svg).word("fill", "none").word("stroke", stroke).number("stroke-width", width).end();
    }
}

/// An arrow head with its tip at a point, pointing along `direction`.
pub(crate) fn arrow(svg: &mut Svg, (x, y): Point, direction: Point, size: f64, colour: &str) {
    let length = (direction.0 * direction.0 + direction.1 * direction.1).sqrt();
    if length.is_nan() || length <= 0.0 {
        return;
    }
    let (along, across) = (direction.0 / length * size, direction.1 / length * size);
    let base = (x - along, y - across);
    let side = |sign: f64| (base.0 - sign * 0.5 * across, base.1 + sign * 0.5 * along);
    let path = straight([(x, y), side(1.0), side(-1.0)]) + "Z";
    svg.tag("path").word("d", &path).word("fill", colour).word("stroke", PAPER).end();
}

/// A filled rectangle.
pub(crate) fn band(svg: &mut Svg, area: Frame, colour: &str) {
    area.tag(svg).word("fill", colour).end();
}

/// The filled area between two lines, both from left to right.
pub(crate) fn area(svg: &mut Svg, upper: &[Point], lower: &[Point], colour: &str) {
    let path = straight(upper.iter().chain(lower.iter().rev()).copied());
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
    area.tag(svg).word("fill", "none").word("stroke", HATCH).end();
}

/// Text of a legend, px.
const SIZE: f64 = 12.5;

/// A sample of a mark, which stands before its meaning.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LegendSample {
    Dot { radius: f64, colour: &'static str },
    Disc(&'static str),
    Ring(&'static str),
    Hollow(&'static str),
    Square(&'static str),
    Line { colour: &'static str, dashes: Option<&'static str> },
    Cased { dashes: Option<&'static str> },
    Area(&'static str),
    Hatched,
    Arrow(&'static str),
}

impl LegendSample {
    fn width(self) -> f64 {
        match self {
            Self::Line { .. } | Self::Cased { .. } => 26.0,
            Self::Hatched | Self::Area(_) => 18.0,
            Self::Dot { .. } | Self::Disc(_) | Self::Ring(_) | Self::Hollow(_) | Self::Square(_) | Self::Arrow(_) => {
                12.0
            }
        }
    }

    fn draw(self, svg: &mut Svg, x: f64, y: f64) {
        let middle = (x + 0.5 * self.width(), y);
        match self {
            Self::Dot { radius, colour } => dots(svg, std::iter::once(middle), radius, colour),
            Self::Disc(colour) => disc(svg, middle, 5.5, colour),
            Self::Ring(colour) => ring(svg, middle, 5.5, colour),
            Self::Hollow(colour) => hollow(svg, middle, 5.0, colour),
            Self::Square(colour) => square(svg, middle, 5.0, colour),
            Self::Line { colour, dashes } => line(svg, &[(x, y), (x + 26.0, y)], colour, 3.0, dashes),
            Self::Cased { dashes } => cased(svg, &format!("M{} {}h26", fixed(x), fixed(y)), dashes),
            Self::Area(colour) => band(svg, Frame { left: x, top: y - 6.0, width: 18.0, height: 12.0 }, colour),
            Self::Hatched => hatched(svg, Frame { left: x, top: y - 6.0, width: 18.0, height: 12.0 }),
            Self::Arrow(colour) => arrow(svg, (x + 11.0, y), (1.0, 0.0), 11.0, colour),
        }
    }
}

/// Draws a row of samples, centred on `middle`.
pub(crate) fn legend(svg: &mut Svg, middle: f64, y: f64, entries: &[(LegendSample, &str)]) {
    const GAP: f64 = 22.0;
    const SPACE: f64 = 7.0;
    let wide = |(sample, text): &(LegendSample, &str)| sample.width() + SPACE + width(text, SIZE);
    let all: f64 = entries.iter().map(wide).sum::<f64>() + GAP * (entries.len().saturating_sub(1)) as f64;
    let mut x = middle - 0.5 * all;
    for entry in entries {
        let (sample, text) = *entry;
        sample.draw(svg, x, y);
        svg.text(x + sample.width() + SPACE, y + 4.3, Type::new(SIZE, SOFT_INK), &sentence(text));
        x += wide(entry) + GAP;
    }
}
