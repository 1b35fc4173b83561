//! A panel: a frame with two axes, their grid, ticks and titles, with marks inside; and its sheet: paper with a title above the panels and a
//! caption below them.

use crate::charts::draw::colour::{AXIS, EDGE, GRID, INK, PAPER, SOFT_INK, ZERO};
use crate::charts::draw::marks::{Frame, band, line, listed};
use crate::charts::draw::scale::{Range, Scale, Ticks, decades, raised, ticks};
use crate::charts::draw::svg::{Anchor, Span, Svg, Tag, Type, sentence, width, wrap};

/// Text of ticks, px.
pub(crate) const TICK_SIZE: f64 = 12.0;

/// Text of axis titles, px.
pub(crate) const TITLE_SIZE: f64 = 13.5;

/// An axis: its title and its range.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis<'a> {
    /// Name in words.
    pub(crate) name: &'a str,
    /// Symbol in formulas.
    pub(crate) symbol: &'a str,
    /// Unit; empty for a pure number.
    pub(crate) unit: &'a str,
    /// Range of values.
    pub(crate) range: Range,
}

/// A frame with its scales.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Panel {
    pub(crate) frame: Frame,
    x: Scale,
    y: Scale,
}

impl Panel {
    /// Draws grid, ticks and titles, and returns the panel for the marks. Call `edge` after the marks.
    pub(crate) fn draw(svg: &mut Svg, frame: Frame, x: Axis<'_>, y: Axis<'_>) -> Self {
        Self::draw_scaled(svg, frame, x, y, [false; 2])
    }

    /// The same for ranges of logarithms to base ten in x or y. The values of marks are then logarithms too.
    pub(crate) fn draw_scaled(svg: &mut Svg, frame: Frame, x: Axis<'_>, y: Axis<'_>, logarithmic: [bool; 2]) -> Self {
        let panel = Self {
            frame,
            x: Scale::linear(x.range, frame.left, frame.left + frame.width),
            y: Scale::linear(y.range, frame.top + frame.height, frame.top),
        };
        panel.draw_axes(svg, x, y, logarithmic);
        panel
    }

    /// The place of a point, px. Points outside are put on the edge.
    pub(crate) fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (self.x.at(x), self.y.at(y))
    }

    /// Draws the frame over the marks.
    pub(crate) fn edge(&self, svg: &mut Svg) {
        self.edge_tag(svg).end();
    }

    /// The same with data attributes, from which a page reads values at a place: `data-panel` has the name, `data-x` and `data-y` the
    /// values at the ends of each axis.
    pub(crate) fn readable_edge(&self, svg: &mut Svg, name: &str, x: Range, y: Range) {
        let [x, y] = [x, y].map(|range| listed([range.low, range.high].into_iter()));
        self.edge_tag(svg).word("data-panel", name).word("data-x", &x).word("data-y", &y).end();
    }

    fn edge_tag<'a>(&self, svg: &'a mut Svg) -> Tag<'a> {
        self.frame.tag(svg).word("fill", "none").word("stroke", AXIS)
    }

    fn draw_axes(&self, svg: &mut Svg, x: Axis<'_>, y: Axis<'_>, logarithmic: [bool; 2]) {
        let choose = |way: usize, range: Range, most: u32| if logarithmic[way] { decades } else { ticks }(range, most);
        let Frame { left, top, width: across, height } = self.frame;
        let (right, bottom) = (left + across, top + height);
        // As many labels as fit side by side.
        let ticks_x = (2..=6).rev().map(|most| choose(0, x.range, most)).find(|ticks| crowding(ticks) < 0.75 * across);
        let ticks_x = ticks_x.unwrap_or_else(|| choose(0, x.range, 2));
        let ticks_y = choose(1, y.range, 6);
        band(svg, self.frame, PAPER);
        let style = Type::new(TICK_SIZE, SOFT_INK);
        let mut widest: f64 = 0.0;
        for (value, label) in &ticks_x.marks {
            let at = self.x.at(*value);
            line(svg, &[(at, top), (at, bottom)], grid(*value, logarithmic[0]), 1.0, None);
            line(svg, &[(at, bottom), (at, bottom + 5.0)], AXIS, 1.0, None);
            svg.text(at, bottom + 19.0, style.anchored(Anchor::Middle), &[Span::Plain(label)]);
        }
        for (value, label) in &ticks_y.marks {
            let at = self.y.at(*value);
            line(svg, &[(left, at), (right, at)], grid(*value, logarithmic[1]), 1.0, None);
            line(svg, &[(left - 5.0, at), (left, at)], AXIS, 1.0, None);
            svg.text(left - 9.0, at + 4.2, style.anchored(Anchor::End), &[Span::Plain(label)]);
            widest = widest.max(width(label, TICK_SIZE));
        }
        let style = Type::new(TITLE_SIZE, INK).anchored(Anchor::Middle);
        title(svg, left + 0.5 * across, bottom + 40.0, style, x, &ticks_x);
        title(svg, left - 20.0 - widest, top + 0.5 * height, style.upwards(), y, &ticks_y);
    }
}

/// Width of all labels side by side, px.
fn crowding(ticks: &Ticks) -> f64 {
    ticks.marks.iter().map(|(_, label)| width(label, TICK_SIZE)).sum()
}

/// Zero stands out, unless it is the logarithm of 1.
fn grid(value: f64, is_logarithm: bool) -> &'static str {
    if value == 0.0 && !is_logarithm { ZERO } else { GRID }
}

/// The title of an axis: name, symbol, unit and power of ten.
pub(crate) fn title(svg: &mut Svg, x: f64, y: f64, style: Type, axis: Axis<'_>, ticks: &Ticks) {
    let unit = match (ticks.power, axis.unit) {
        (0, "") => String::new(),
        (0, unit) => format!(" ({unit})"),
        (power, unit) => format!(" (10{} {unit})", raised(power)).replace(" )", ")"),
    };
    let name = format!("{} ", axis.name);
    svg.text(x, y, style, &[Span::Plain(&name), Span::Symbol(axis.symbol), Span::Plain(&unit)]);
}

/// Sizes of title, subtitle and caption, px.
const TITLE: f64 = 18.0;
const SUBTITLE: f64 = 13.5;
const CAPTION: f64 = 12.5;

/// Highest number of lines of each.
const LINES: usize = 4;

/// Height of a line over its text.
const LEADING: f64 = 1.4;

/// Space left and right of text, px.
const MARGIN: f64 = 28.0;

/// Paper with room for panels.
pub(crate) struct Sheet {
    pub(crate) svg: Svg,
    /// Top of the panels, px.
    pub(crate) top: f64,
}

impl Sheet {
    /// A sheet of this width with `room` px of height for panels, and with a title, a subtitle and a caption, which determine its height. The
    /// description is for readers who cannot see the picture.
    pub(crate) fn new(width: f64, room: f64, words: [&str; 3], description: &str) -> Self {
        let space = width - 2.0 * MARGIN;
        // Words that are code elsewhere have no type of their own here.
        let [given, subtitle, caption] = words.map(|words| words.replace('`', ""));
        let description = description.replace('`', "");
        let title = wrap(&given, TITLE, space, LINES);
        let subtitle = wrap(&subtitle, SUBTITLE, space, LINES);
        let caption = wrap(&caption, CAPTION, space, LINES);
        let tall = |lines: &[String], size: f64| lines.len() as f64 * size * LEADING;
        let top = 22.0 + tall(&title, TITLE) + tall(&subtitle, SUBTITLE) + 18.0;
        let below = if caption.is_empty() { 8.0 } else { tall(&caption, CAPTION) + 16.0 };
        let height = top + room + below;
        let mut svg = Svg::new(width, height, [top, room], &given, &description);
        let paper = svg.tag("rect").number("x", 0.5).number("y", 0.5).number("width", width - 1.0);
        paper.number("height", height - 1.0).number("rx", 6.0).word("fill", PAPER).word("stroke", EDGE).end();
        let mut y = 22.0;
        let mut write = |lines: &[String], style: Type| {
            for line in lines {
                svg.text(MARGIN, y + style.size, style, &sentence(line));
                y += style.size * LEADING;
            }
        };
        write(&title, Type::new(TITLE, INK).bold());
        write(&subtitle, Type::new(SUBTITLE, SOFT_INK));
        let mut y = top + room;
        for line in &caption {
            svg.text(MARGIN, y + CAPTION, Type::new(CAPTION, SOFT_INK), &sentence(line));
            y += CAPTION * LEADING;
        }
        Self { svg, top }
    }
}
