//! A chart of curves, such as the truth beside wrong results: in one panel or in rows of two, linear or logarithmic.

use crate::charts::draw::colour::{BLUE, GREEN, ORANGE, SOFT_INK, VERMILION};
use crate::charts::draw::geometry::{Frame, Point};
use crate::charts::draw::legend::{LegendSample, legend};
use crate::charts::draw::marks::{readable_dots, readable_line, ring};
use crate::charts::draw::panel::{Axis, Panel};
use crate::charts::draw::scale::Range;
use crate::charts::draw::sheet::{Sheet, Words};

/// A picture of one panel, or of rows of two.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Title in a few words.
    pub title: &'static str,
    /// Content in a sentence.
    pub subtitle: String,
    /// Reading aid with numbers.
    pub caption: String,
    /// The panels. One legend has the labels of all.
    pub plots: Vec<Plot>,
}

/// A panel with its curves. Later curves are drawn over earlier ones.
#[derive(Clone, Debug)]
pub struct Plot {
    /// Axis along x.
    pub x: ChartAxis,
    /// Axis along y.
    pub y: ChartAxis,
    /// The curves.
    pub curves: Vec<Curve>,
}

/// An axis.
#[derive(Clone, Copy, Debug)]
pub struct ChartAxis {
    /// Name in words.
    pub name: &'static str,
    /// Symbol in formulas.
    pub symbol: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// True for a logarithmic axis. Values without a logarithm are left out.
    pub logarithmic: bool,
    /// Ends of the axis. Without them it is around all points.
    pub ends: Option<(f64, f64)>,
}

/// Points with a meaning.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Label in the legend. Empty if another curve has it.
    pub label: &'static str,
    /// Style of the curve.
    pub style: CurveStyle,
    /// x and y. Points that are NaN or outside the panel are left out.
    pub points: Vec<(f64, f64)>,
}

/// Names of a panel and of its curves, in their order.
#[derive(Clone, Copy, Debug)]
pub struct PanelNames {
    /// Name of the panel.
    pub panel: &'static str,
    /// Names of the curves.
    pub curves: &'static [&'static str],
}

/// The style of a curve. Colour and kind of line carry the same information.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveStyle {
    /// The truth: a full line.
    Truth,
    /// The truth, as dots.
    TruthDots,
    /// A wrong result: a dashed line.
    Wrong,
    /// A wrong result, as rings.
    WrongRings,
    /// Another wrong result: a line in short dashes.
    Second,
    /// A comparison: a thin full line.
    Beside,
    /// A comparison, as dots.
    BesideDots,
    /// A limit: a thin dotted line.
    Limit,
}

/// The marks of a curve.
#[derive(Clone, Copy, Debug)]
enum Mark {
    Line { colour: &'static str, dashes: Option<&'static str> },
    Dots { radius: f64, colour: &'static str },
    Rings(&'static str),
}

impl Mark {
    /// The mark in a legend.
    fn sample(self) -> LegendSample {
        match self {
            Self::Line { colour, dashes } => LegendSample::Line { colour, dashes },
            Self::Dots { radius, colour } => LegendSample::Dot { radius, colour },
            Self::Rings(colour) => LegendSample::Ring(colour),
        }
    }
}

impl CurveStyle {
    fn mark(self) -> Mark {
        let full = |colour| Mark::Line { colour, dashes: None };
        let dashed = |colour, dashes| Mark::Line { colour, dashes: Some(dashes) };
        match self {
            Self::Truth => full(BLUE),
            Self::TruthDots => Mark::Dots { radius: 2.6, colour: BLUE },
            Self::Wrong => dashed(VERMILION, "7 4"),
            Self::WrongRings => Mark::Rings(VERMILION),
            Self::Second => dashed(ORANGE, "3 3"),
            Self::Beside => full(GREEN),
            Self::BesideDots => Mark::Dots { radius: 2.2, colour: GREEN },
            Self::Limit => dashed(SOFT_INK, "1 3"),
        }
    }
}

impl ChartAxis {
    /// A linear axis around all points.
    pub const fn new(name: &'static str, symbol: &'static str, unit: &'static str) -> Self {
        Self { name, symbol, unit, logarithmic: false, ends: None }
    }

    /// The same, logarithmic.
    pub const fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// The same between two values.
    pub const fn between(self, low: f64, high: f64) -> Self {
        Self { ends: Some((low, high)), ..self }
    }

    /// Place of a value along the axis. NaN if it has none.
    fn place(self, value: f64) -> f64 {
        match self.logarithmic {
            true if value > 0.0 => libm::log10(value),
            true => f64::NAN,
            false => value,
        }
    }

    fn axis(&self, values: impl Iterator<Item = f64>) -> Axis<'_> {
        let range = match self.ends {
            Some((low, high)) => Range::new(self.place(low), self.place(high)),
            None => Range::around(values.map(|value| self.place(value))),
        };
        Axis { name: self.name, symbol: self.symbol, unit: self.unit, range }
    }
}

/// Draws a chart.
pub fn chart(drawn: &Chart) -> String {
    readable_chart(drawn, &[])
}

/// The same with data attributes, from which a page reads values at a place: a name for each panel (`data-panel`, with the ends of its
/// axes), and one for each of its curves (`data-curve`).
pub fn readable_chart(drawn: &Chart, names: &[PanelNames]) -> String {
    // Height of a panel, and from one row to the next.
    let (height, pitch) = match drawn.plots.len() {
        0..=2 => (332.0, 0.0),
        3..=4 => (230.0, 312.0),
        _ => (180.0, 258.0),
    };
    let rows = drawn.plots.len().div_ceil(2).max(1);
    let room = height + 92.0 + pitch * (rows - 1) as f64;
    let description = format!("{}: {} {}", drawn.title, drawn.subtitle, drawn.caption);
    let words =
        Words { title: drawn.title, subtitle: &drawn.subtitle, caption: &drawn.caption, description: &description };
    let two = drawn.plots.len() > 1;
    let (width, across) = if two { (960.0, 350.0) } else { (720.0, 580.0) };
    let Sheet { mut svg, top } = Sheet::new(width, room, words);
    let mut entries: Vec<(LegendSample, &str)> = Vec::new();
    for (n, plot) in drawn.plots.iter().enumerate() {
        let (row, column) = ((n / 2) as f64, (n % 2) as f64);
        let (left, top) = (104.0 + 480.0 * column, top + 6.0 + pitch * row);
        let frame = Frame { left, top, width: across, height };
        let points = || plot.curves.iter().flat_map(|curve| curve.points.iter().copied());
        let (x, y) = (plot.x.axis(points().map(|point| point.0)), plot.y.axis(points().map(|point| point.1)));
        let panel = Panel::draw_scaled(&mut svg, frame, x, y, [plot.x.logarithmic, plot.y.logarithmic]);
        let named = names.get(n);
        for (index, curve) in plot.curves.iter().enumerate() {
            let data = named.and_then(|names| names.curves.get(index)).map(|name| ("data-curve", *name));
            let data = data.as_slice();
            let placed = curve.points.iter().map(|(x, y)| (plot.x.place(*x), plot.y.place(*y)));
            let inside = |range: Range, value: f64| (range.low..=range.high).contains(&value);
            let drawn: Vec<Point> = placed
                .filter(|place| inside(x.range, place.0) && inside(y.range, place.1))
                .map(|place| panel.at(place.0, place.1))
                .collect();
            let thickness = if matches!(curve.style, CurveStyle::Beside | CurveStyle::Limit) { 1.6 } else { 2.4 };
            match curve.style.mark() {
                Mark::Line { .. } if drawn.is_empty() => {}
                Mark::Line { colour, dashes } => readable_line(&mut svg, &drawn, colour, thickness, dashes, data),
                Mark::Dots { radius, colour } => readable_dots(&mut svg, drawn.into_iter(), radius, colour, data),
                Mark::Rings(colour) => drawn.into_iter().for_each(|point| ring(&mut svg, point, 4.5, colour)),
            }
            if !curve.label.is_empty() {
                entries.push((curve.style.mark().sample(), curve.label));
            }
        }
        match named {
            Some(names) => panel.readable_edge(&mut svg, names.panel, x.range, y.range),
            None => panel.edge(&mut svg),
        }
    }
    legend(&mut svg, 0.5 * width, top + room - 22.0, &entries);
    svg.finish()
}
