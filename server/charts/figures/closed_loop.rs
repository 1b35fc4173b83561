//! The picture of a law: the eigenvalues of its loop on the unit circle with their path as the gain is scaled, and the largest |λ|
//! over the factor, with the stable interval of factors.

use crate::charts::draw::colour::{AXIS, BLUE, INK, PALE_BLUE, SOFT_INK, VERMILION};
use crate::charts::draw::geometry::Frame;
use crate::charts::draw::legend::{LegendSample, legend};
use crate::charts::draw::marks::{arrow, band, disc, dots, hollow, line, listed, readable_line};
use crate::charts::draw::number::significant;
use crate::charts::draw::panel::{Axis, Panel};
use crate::charts::draw::scale::Range;
use crate::charts::draw::sheet::{Sheet, Words};
use crate::charts::draw::svg::{Anchor, Svg, Type};
use crate::charts::draw::text::Span;
use crate::charts::draw::trail::modulus;

/// A law and its loop. Eigenvalues are (re, im).
#[derive(Clone, Copy, Debug)]
pub struct Loop<'a> {
    /// The scene in a few words.
    pub title: &'a str,
    /// The law.
    pub subtitle: &'a str,
    /// Interpretation.
    pub caption: &'a str,
    /// Eigenvalues with the law.
    pub closed: &'a [(f64, f64)],
    /// Eigenvalues without it.
    pub open: &'a [(f64, f64)],
    /// Rising factors on the gain, with the eigenvalues at each.
    pub way: &'a [(f64, Vec<(f64, f64)>)],
    /// The factors between which it is stable.
    pub margin: (Option<f64>, Option<f64>),
}

/// Largest real part that is drawn to scale. An arrow points to eigenvalues beyond it.
const FARTHEST: f64 = 2.6;

/// Draws the two panels.
pub fn closed_loop(law: &Loop<'_>) -> String {
    const ROOM: f64 = 464.0;
    const CIRCLE: Frame = Frame { left: 78.0, top: 30.0, width: 372.0, height: 348.0 };
    const MODULUS: Frame = Frame { left: 546.0, top: 30.0, width: 380.0, height: 348.0 };
    let description = format!("{}. {}", law.subtitle, law.caption);
    let words = Words { title: law.title, subtitle: law.subtitle, caption: law.caption, description: &description };
    let Sheet { mut svg, top } = Sheet::new(960.0, ROOM, words);
    draw_circle(law, &mut svg, Frame { top: top + CIRCLE.top, ..CIRCLE });
    draw_modulus(law, &mut svg, Frame { top: top + MODULUS.top, ..MODULUS });
    let entries = [
        (LegendSample::Disc(INK), "with the law"),
        (LegendSample::Hollow(INK), "without it"),
        (LegendSample::Dot { radius: 2.0, colour: BLUE }, "gain scaled, stable"),
        (LegendSample::Dot { radius: 2.0, colour: VERMILION }, "gain scaled, not stable"),
    ];
    legend(&mut svg, 480.0, top + ROOM - 22.0, &entries);
    svg.finish()
}

/// Largest modulus of some eigenvalues.
fn largest(values: &[(f64, f64)]) -> f64 {
    values.iter().copied().map(modulus).fold(0.0, f64::max)
}

fn draw_circle(law: &Loop<'_>, svg: &mut Svg, frame: Frame) {
    let ends = || law.closed.iter().chain(law.open).map(|value| value.0).filter(|re| re.is_finite());
    let low = (1.12 * ends().fold(0.0, f64::min)).clamp(-FARTHEST, -1.7);
    let high = (1.12 * ends().fold(0.0, f64::max)).clamp(1.7, FARTHEST);
    let range = Range::new(low, high);
    // Both axes have the same scale, so that the circle is one.
    let tall = 0.5 * (range.high - range.low) * frame.height / frame.width;
    let re = Axis { name: "Re", symbol: "λ", unit: "", range };
    let im = Axis { name: "Im", symbol: "λ", unit: "", range: Range::new(-tall, tall) };
    let panel = Panel::draw(svg, frame, re, im);
    let (centre, rim) = (panel.at(0.0, 0.0), panel.at(1.0, 0.0));
    let circle = svg.tag("circle").number("cx", centre.0).number("cy", centre.1).number("r", rim.0 - centre.0);
    circle.word("fill", PALE_BLUE).word("stroke", AXIS).number("stroke-width", 1.2).end();
    let is_within = |value: &&(f64, f64)| value.0 > range.low && value.0 < range.high && value.1.abs() < tall;
    for (colour, stable) in [(BLUE, true), (VERMILION, false)] {
        let steps = law.way.iter().filter(|(_, values)| (largest(values) < 1.0) == stable);
        let points = steps.flat_map(|(_, values)| values.iter().filter(is_within)).map(|(re, im)| panel.at(*re, *im));
        dots(svg, points, 1.6, colour);
    }
    for value in law.open {
        draw_mark(svg, &panel, range, *value, "without the law", hollow_mark);
    }
    for value in law.closed {
        draw_mark(svg, &panel, range, *value, "", disc_mark);
    }
    panel.edge(svg);
}

fn hollow_mark(svg: &mut Svg, at: (f64, f64)) {
    hollow(svg, at, 5.0, INK);
}

fn disc_mark(svg: &mut Svg, at: (f64, f64)) {
    disc(svg, at, 5.5, INK);
}

/// A mark, or an arrow with the value of an eigenvalue farther out.
fn draw_mark(
    svg: &mut Svg,
    panel: &Panel,
    range: Range,
    (re, im): (f64, f64),
    whose: &str,
    mark: impl Fn(&mut Svg, (f64, f64)),
) {
    let (x, y) = panel.at(re, im);
    if re >= range.low && re <= range.high {
        mark(svg, (x, y));
        return;
    }
    let direction = if re > 0.0 { 1.0 } else { -1.0 };
    arrow(svg, (x - 3.0 * direction, y), (direction, 0.0), 15.0, INK);
    let anchor = if re > 0.0 { Anchor::End } else { Anchor::Start };
    let style = Type::new(12.5, INK).anchored(anchor);
    for (up, text) in [(30.0, whose), (14.0, format!("λ = {}", significant(re, 3)).as_str())] {
        svg.text(x - 5.0 * direction, y - up, style, &[Span::Plain(text)]);
    }
}

fn draw_modulus(law: &Loop<'_>, svg: &mut Svg, frame: Frame) {
    let range = match (law.way.first(), law.way.last()) {
        (Some((first, _)), Some((last, _))) => Range::new(*first, *last),
        _ => Range::new(0.0, 2.0),
    };
    let sizes: Vec<(f64, f64)> = law.way.iter().map(|(factor, values)| (*factor, largest(values))).collect();
    let reach = sizes.iter().map(|(_, size)| *size).filter(|size| size.is_finite()).fold(1.0, f64::max);
    let top = (1.1 * reach).clamp(1.3, 3.0);
    let factor = Axis { name: "factor on the gain", symbol: "K", unit: "", range };
    let moduli = Axis { name: "largest modulus", symbol: "|λ|", unit: "", range: Range::new(0.0, top) };
    let panel = Panel::draw(svg, frame, factor, moduli);
    let bottom = frame.top + frame.height;
    let (lower, upper) = law.margin;
    let (left, right) = (panel.at(lower.unwrap_or(range.low), 0.0).0, panel.at(upper.unwrap_or(range.high), 0.0).0);
    band(svg, Frame { left, width: (right - left).max(0.0), ..frame }, PALE_BLUE);
    let one = panel.at(range.low, 1.0).1;
    line(svg, &[(frame.left, one), (frame.left + frame.width, one)], AXIS, 1.0, None);
    let style = Type::new(12.5, SOFT_INK).anchored(Anchor::Middle);
    for (x, end) in [(left, lower), (right, upper)] {
        let Some(end) = end.filter(|end| *end >= range.low && *end <= range.high) else { continue };
        line(svg, &[(x, frame.top), (x, bottom)], AXIS, 1.0, Some("2 3"));
        svg.text(x, frame.top - 7.0, style, &[Span::Plain(&significant(end, 4))]);
    }
    let drawn = || sizes.iter().filter(|(_, size)| *size <= top);
    let points: Vec<_> = drawn().map(|it| panel.at(it.0, it.1)).collect();
    if points.len() > 1 {
        let (factors, moduli) = (listed(drawn().map(|it| it.0)), listed(drawn().map(|it| it.1)));
        readable_line(svg, &points, BLUE, 3.0, None, &[("data-factor", &factors), ("data-modulus", &moduli)]);
    }
    let own = largest(law.closed);
    if own <= top {
        let at = panel.at(1.0, own);
        line(svg, &[(at.0, frame.top), (at.0, bottom)], INK, 1.0, None);
        disc(svg, at, 5.5, INK);
    }
    panel.edge(svg);
}
