//! The card of a run, 1200 × 630 px, as programs show it beside a link: a headline, the scene and the orbit.
//!
//! Cards are shown at a third of their size, so the text is large and there are no ticks.

use crate::charts::draw::colour::{AXIS, BLUE, EDGE, GREEN, INK, PALE_GREY, PAPER, SKY, SOFT_INK, VERMILION, ZERO};
use crate::charts::draw::marks::{Frame, band, disc, dots, line, ring, square, straight};
use crate::charts::draw::scale::Range;
use crate::charts::draw::svg::{Anchor, Span, Svg, Type, sentence, wrap};

/// Size of a card, px: the one that link previews ask for.
pub const CARD_SIZE: (f64, f64) = (1200.0, 630.0);

/// Highest number of dots in the orbit.
const MOST_DOTS: usize = 4000;

/// Largest part of the path that is drawn, in heights of the release. A body that drifts away would make the scene tiny.
const REACH: f64 = 4.0;

/// A body in a place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlacedBody {
    /// Centre of gravity, m.
    pub centre: (f64, f64),
    /// Outline, m: one point, the two ends of a rod, or the corners of a polygon.
    pub outline: Vec<(f64, f64)>,
}

/// The first contact of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstContact {
    /// The body.
    pub body: PlacedBody,
    /// Contact point, m.
    pub foot: (f64, f64),
    /// Direction of the table.
    pub table: (f64, f64),
}

/// A plane of the states just before the contacts.
#[derive(Clone, Copy, Debug)]
pub struct CardPlane<'a> {
    /// Symbols of the axes.
    pub symbols: (&'static str, &'static str),
    /// The states in the order of contacts.
    pub states: &'a [(f64, f64)],
}

/// The contents of a card.
#[derive(Clone, Copy, Debug)]
pub struct Card<'a> {
    /// Headline.
    pub title: &'a str,
    /// A sentence or two.
    pub text: &'a str,
    /// True if the run did not end by itself.
    pub goes_on: bool,
    /// The centre of gravity on the first flights, m.
    pub path: &'a [(f64, f64)],
    /// The body at the release.
    pub release: &'a PlacedBody,
    /// The first contact, if there is one.
    pub contact: Option<&'a FirstContact>,
    /// The orbit.
    pub plane: CardPlane<'a>,
}

/// Draws a card.
pub fn card(card: &Card<'_>) -> String {
    const MARGIN: f64 = 60.0;
    /// Bottom of scene and orbit.
    const BOTTOM: f64 = 582.0;
    /// Share of a line that bold text fills at most by the estimate of its width.
    const BOLD: f64 = 0.88;
    let (width, height) = CARD_SIZE;
    let mut svg = Svg::new(width, height, [0.0, height], card.title, card.text);
    let paper = Frame { left: 0.0, top: 0.0, width, height };
    band(&mut svg, paper, PAPER);
    let colour = if card.goes_on { GREEN } else { VERMILION };
    band(&mut svg, Frame { height: 14.0, ..paper }, colour);
    let name = Type::new(26.0, SOFT_INK).bold().anchored(Anchor::End);
    svg.text(width - MARGIN, height - 14.0, name, &[Span::Plain("equipoise")]);

    let mut y = 38.0;
    for (text, style, room, lines) in [
        (card.title, Type::new(50.0, INK).bold(), BOLD * (width - 2.0 * MARGIN), 2),
        (card.text, Type::new(28.0, SOFT_INK), width - 2.0 * MARGIN, 2),
    ] {
        for line in wrap(text, style.size, room, lines) {
            svg.text(MARGIN, y + style.size, style, &sentence(&line));
            y += 1.25 * style.size;
        }
        y += 4.0;
    }
    let top = y + 22.0;
    draw_scene(&mut svg, Frame { left: MARGIN, top, width: 560.0, height: BOTTOM - top }, card);
    draw_orbit(&mut svg, Frame { left: 690.0, top, width: 450.0, height: BOTTOM - top }, &card.plane, colour);
    svg.finish()
}

/// The part of the path near the release.
fn near(card: &Card<'_>) -> Vec<(f64, f64)> {
    let (x, y) = card.release.centre;
    let reach = REACH * y.abs().max(1e-6);
    card.path.iter().take_while(|at| (at.0 - x).abs() <= reach && at.1.abs() <= reach).copied().collect()
}

fn draw_scene(svg: &mut Svg, frame: Frame, card: &Card<'_>) {
    let path = near(card);
    let foot = card.contact.map_or((card.release.centre.0, 0.0), |contact| contact.foot);
    let bodies = std::iter::once(card.release).chain(card.contact.map(|contact| &contact.body));
    let mut all: Vec<(f64, f64)> = bodies.flat_map(|body| body.outline.iter().copied().chain([body.centre])).collect();
    all.extend(path.iter().copied().chain([foot]));
    all.retain(|(x, y)| x.is_finite() && y.is_finite());
    let bounds = |of: fn(&(f64, f64)) -> f64| {
        all.iter().map(of).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| (low.min(at), high.max(at)))
    };
    let ((left, right), (low, high)) = (bounds(|point| point.0), bounds(|point| point.1));
    let scale = (0.92 * frame.width / (right - left).max(1e-9)).min(0.88 * frame.height / (high - low).max(1e-9));
    let at = |(x, y): (f64, f64)| {
        let place = frame.left + 0.5 * frame.width + (x - 0.5 * (left + right)) * scale;
        (place, frame.top + 0.94 * frame.height - (y - low) * scale)
    };
    let all_at = |points: &[(f64, f64)]| points.iter().copied().map(at).collect::<Vec<_>>();
    let (x, ground) = at(foot);
    line(svg, &[(frame.left, ground), (frame.left + frame.width, ground)], ZERO, 2.0, Some("3 7"));
    if path.len() > 1 {
        line(svg, &all_at(&path), SKY, 3.5, Some("9 6"));
    }
    draw_body(svg, &all_at(&card.release.outline), EDGE);
    if let Some(FirstContact { body, table, .. }) = card.contact {
        const HALF: f64 = 120.0;
        let (along, up) = (HALF * table.0, HALF * table.1);
        line(svg, &[(x - along, ground + up), (x + along, ground - up)], AXIS, 7.0, None);
        draw_body(svg, &all_at(&body.outline), INK);
        disc(svg, at(body.centre), 9.0, INK);
    }
}

fn draw_body(svg: &mut Svg, points: &[(f64, f64)], stroke: &'static str) {
    match points {
        [] => {}
        [point] => disc(svg, *point, 13.0, stroke),
        [foot, top] => line(svg, &[*foot, *top], stroke, 10.0, None),
        corners => {
            let path = straight(corners.iter().copied()) + "Z";
            let tag = svg.tag("path").word("d", &path).word("fill", PALE_GREY).word("stroke", stroke);
            tag.number("stroke-width", 5.0).word("stroke-linejoin", "round").end();
        }
    }
}

fn draw_orbit(svg: &mut Svg, frame: Frame, plane: &CardPlane<'_>, last: &'static str) {
    let Frame { left, top, width, height } = frame;
    frame.tag(svg).word("fill", "none").word("stroke", EDGE).number("stroke-width", 2.0).end();
    let axis = Type::new(30.0, SOFT_INK);
    svg.text(left + width - 12.0, top + height - 14.0, axis.anchored(Anchor::End), &[Span::Symbol(plane.symbols.0)]);
    svg.text(left + 12.0, top + 36.0, axis, &[Span::Symbol(plane.symbols.1)]);
    let finite = plane.states.iter().copied().filter(|(x, y)| x.is_finite() && y.is_finite());
    let states: Vec<(f64, f64)> = finite.collect();
    let ranges = [Range::around(states.iter().map(|state| state.0)), Range::around(states.iter().map(|state| state.1))];
    let scaled = |range: Range, value: f64| (value - range.low) / (range.high - range.low);
    let at = |(x, y): (f64, f64)| {
        let inner = 0.9;
        let place = |share: f64, length: f64| length * (0.5 + inner * (share - 0.5));
        (left + place(scaled(ranges[0], x), width), top + place(1.0 - scaled(ranges[1], y), height))
    };
    for zero in [true, false] {
        let range = ranges[usize::from(!zero)];
        if range.low < 0.0 && range.high > 0.0 {
            let (x, y) = at(if zero { (0.0, ranges[1].low) } else { (ranges[0].low, 0.0) });
            let ends = if zero { [(x, top), (x, top + height)] } else { [(left, y), (left + width, y)] };
            line(svg, &ends, ZERO, 1.5, None);
        }
    }
    let step = states.len().div_ceil(MOST_DOTS).max(1);
    let radius = if states.len() > 600 { 2.2 } else { 3.2 };
    dots(svg, states.iter().step_by(step).map(|state| at(*state)), radius, BLUE);
    if let (Some(first), Some(end)) = (states.first(), states.last()) {
        if states.len() > 1 {
            square(svg, at(*end), 9.0, last);
        }
        ring(svg, at(*first), 9.0, INK);
    }
}
