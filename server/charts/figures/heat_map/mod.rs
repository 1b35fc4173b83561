//! The picture of a quantity over two fields of a scene, with the linear boundary over it. The cells themselves are drawn
//! by `cells`, the boundary by `boundary`.

pub mod boundary;
pub mod cells;
pub mod cividis;

use crate::charts::draw::colour::{AXIS, INK, SOFT_INK};
use crate::charts::draw::geometry::{Frame, Point};
use crate::charts::draw::legend::{LegendSample, legend};
use crate::charts::draw::marks::{cased, line};
use crate::charts::draw::number::significant;
use crate::charts::draw::panel::{Axis, Panel, TICK_SIZE, TITLE_SIZE, title};
use crate::charts::draw::scale::{Range, Scale, Ticks, ticks};
use crate::charts::draw::sheet::{Sheet, Words};
use crate::charts::draw::svg::{Anchor, Svg, Type, fixed};
use crate::charts::draw::text::{Span, width};
use crate::charts::figures::heat_map::cells::{CellGrid, GridSide, MOST};
use crate::charts::figures::heat_map::cividis::{COLOURS, colour};

/// Highest number of segments of the boundary that are drawn.
const MOST_SEGMENTS: usize = 40_000;

/// Largest end of an axis; twice as much is still finite.
const LARGEST: f64 = 1e300;

/// A quantity over two fields.
#[derive(Clone, Copy, Debug)]
pub struct HeatMap<'a> {
    /// The scene in a few words.
    pub title: &'a str,
    /// The computation in a few words.
    pub subtitle: &'a str,
    /// The field along x.
    pub x: HeatAxis<'a>,
    /// The field along y.
    pub y: HeatAxis<'a>,
    /// Values row by row, the first row at `y.from`. `None` if the fields make no valid scene.
    pub values: &'a [Option<f64>],
    /// Number of the outcome of each cell's run. Empty without runs.
    pub outcomes: &'a [u8],
    /// Values at the ends of the colour bar, which may be equal.
    pub scale: (f64, f64),
    /// Name of the quantity.
    pub quantity: &'a str,
    /// Unit of the quantity; empty for a pure number.
    pub unit: &'a str,
    /// Segments of the linear boundary: the residue there, 0 or 1, and both ends as values of the fields.
    pub boundary: &'a [(f64, [f64; 2], [f64; 2])],
}

/// A field along a side.
#[derive(Clone, Copy, Debug)]
pub struct HeatAxis<'a> {
    /// Name in words.
    pub name: &'a str,
    /// Symbol in formulas.
    pub symbol: &'a str,
    /// Unit; empty for a pure number.
    pub unit: &'a str,
    /// Value in the first column or row.
    pub from: f64,
    /// Value in the last column or row.
    pub to: f64,
    /// Number of columns or rows.
    pub count: usize,
}

impl HeatAxis<'_> {
    /// From edge to edge: half a cell beyond the first and the last value, in whose cells they are central.
    fn axis(&self) -> Axis<'_> {
        let sane = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-LARGEST, LARGEST) };
        let (low, high) = (sane(self.from.min(self.to)), sane(self.from.max(self.to)));
        let half = match self.count {
            0 => 0.0,
            // A single cell is at `from`, whatever `to` is, and gets some width.
            1 => return self.alone(sane(self.from)),
            count => 0.5 * (high - low) / (count - 1) as f64,
        };
        self.over(Range::new(low - half, high + half))
    }

    fn alone(&self, value: f64) -> Axis<'_> {
        let half = if value == 0.0 { 0.5 } else { 0.05 * value.abs() };
        self.over(Range::new(value - half, value + half))
    }

    fn over(&self, range: Range) -> Axis<'_> {
        Axis { name: self.name, symbol: self.symbol, unit: self.unit, range }
    }

    fn side(&self) -> GridSide {
        GridSide { count: self.count, reversed: self.count > 1 && self.from > self.to }
    }
}

/// Draws the cells, the boundary, a colour bar and a legend.
///
/// At most 512 × 512 cells are drawn, each the mean of the cells in it. The caption says so, with the number of means over different
/// outcomes, of cells without a value, and of values beyond the colour bar.
pub fn heat_map(map: &HeatMap<'_>) -> String {
    const WIDTH: f64 = 784.0;
    const ROOM: f64 = 598.0;
    const SIDE: f64 = MOST as f64;
    let cells = CellGrid::binned(map.values, map.outcomes, map.x.side(), map.y.side());
    let bar = Bar::new(map);
    let caption = caption(map, &bar, cells.mixed);
    let description = format!(
        "{} Colours: {} from {} to {} over {} {} (to the right) and {} {} (upwards). {caption}",
        map.subtitle,
        map.quantity,
        with_unit(bar.low, map.unit),
        with_unit(bar.high, map.unit),
        map.x.name,
        map.x.symbol,
        map.y.name,
        map.y.symbol
    );
    let words = Words { title: map.title, subtitle: map.subtitle, caption: &caption, description: &description };
    let Sheet { mut svg, top } = Sheet::new(WIDTH, ROOM, words);
    // On whole pixels, so that each of 512 cells has one.
    let frame = Frame { left: 104.0, top: top.ceil(), width: SIDE, height: SIDE };
    let (x, y) = (map.x.axis(), map.y.axis());
    let panel = Panel::draw(&mut svg, frame, x, y);
    cells.draw(&mut svg, frame, |value| bar.shade(value));
    let place = |[right, up]: [f64; 2]| -> Point {
        (along(right, x.range, frame.left, SIDE), along(up, y.range, frame.top + SIDE, -SIDE))
    };
    let mut entries = Vec::new();
    for (residue, dashes, meaning) in
        [(1.0, None, "linear boundary κ_c (residue 1)"), (0.0, Some("7 5"), "linear boundary κ = 1 (residue 0)")]
    {
        let own = map.boundary.iter().take(MOST_SEGMENTS).filter(|(at, ..)| *at == residue);
        let segments: Vec<(Point, Point)> = own.map(|(_, from, to)| (place(*from), place(*to))).collect();
        let path = boundary::path(&segments, frame);
        if !path.is_empty() {
            cased(&mut svg, &path, dashes);
            entries.push((LegendSample::Cased { dashes }, meaning));
        }
    }
    panel.edge(&mut svg);
    bar.draw(&mut svg, Frame { left: frame.left + SIDE + 28.0, width: 18.0, ..frame }, map);
    if cells.any_empty() {
        entries.push((LegendSample::Hatched, "no such scene"));
    }
    legend(&mut svg, 0.5 * WIDTH, top + ROOM - 22.0, &entries);
    svg.finish()
}

/// Place of a value along a side, also beyond its ends.
fn along(value: f64, range: Range, from: f64, length: f64) -> f64 {
    from + (value - range.low) / (range.high - range.low) * length
}

fn with_unit(value: f64, unit: &str) -> String {
    let value = significant(value, 4);
    if unit.is_empty() { value } else { format!("{value} {unit}") }
}

/// Describes the cells in words.
fn caption(map: &HeatMap<'_>, bar: &Bar, mixed: usize) -> String {
    let (columns, rows) = (map.x.count, map.y.count);
    let all = columns.saturating_mul(rows);
    if all == 0 {
        return "There are no cells to draw.".to_owned();
    }
    let values = || map.values.iter().take(all).flatten().copied();
    let mut text = if all == 1 {
        "1 cell.".to_owned()
    } else {
        format!("{columns} × {rows} cells, each with its values of the axes at its centre.")
    };
    if columns > MOST || rows > MOST {
        let (columns, rows) = (map.x.side().drawn(), map.y.side().drawn());
        text.push_str(&format!(
            " Drawn as {columns} × {rows}; the shade of each is the mean of the cells in it that have a value. Mixed are {mixed}: \
             their cells ended differently, or not all have a value."
        ));
    }
    let finite = values().filter(|value| value.is_finite()).count();
    let broken = values().count() - finite;
    let none = all - finite - broken;
    if none > 0 {
        text.push_str(&format!(" No such scene: {none} {}.", if none == 1 { "cell" } else { "cells" }));
    }
    if broken > 0 {
        text.push_str(&format!(" Left out as not finite numbers: {broken}."));
    }
    let beyond = values().filter(|value| value.is_finite() && (*value < bar.low || *value > bar.high)).count();
    if beyond > 0 {
        text.push_str(&format!(" Beyond the colour bar, and in the colour of its nearer end: {beyond}."));
    }
    let left_out = map.boundary.len().saturating_sub(MOST_SEGMENTS);
    if left_out > 0 {
        text.push_str(&format!(" {left_out} pieces of the linear boundary are left out."));
    }
    text
}

/// Colours and the values they stand for.
struct Bar {
    low: f64,
    high: f64,
    /// Range of the bar, unless it has one value only.
    range: Option<Range>,
}

impl Bar {
    /// The colours between the ends of the map's scale, in either order. An end that is NaN is replaced by the other.
    fn new(map: &HeatMap<'_>) -> Self {
        let (one, other) = map.scale;
        let sane = |value: f64| if value.is_nan() { 0.0 } else { value.clamp(-LARGEST, LARGEST) };
        let (low, high) = (sane(one.min(other)), sane(one.max(other)));
        let range = Range::new(low, high);
        // A range that had to be widened has one value.
        let is_one = range.high - range.low > high - low;
        Self { low, high, range: (!is_one).then_some(range) }
    }

    /// Index of a value's colour; the middle colour if all values are equal.
    fn shade(&self, value: f64) -> usize {
        match self.range {
            Some(range) => {
                let share = (value - range.low) / (range.high - range.low);
                ((share.clamp(0.0, 1.0) * COLOURS as f64) as usize).min(COLOURS - 1)
            }
            None if value < self.low => 0,
            None if value > self.high => COLOURS - 1,
            None => COLOURS / 2,
        }
    }

    fn draw(&self, svg: &mut Svg, frame: Frame, map: &HeatMap<'_>) {
        let Frame { left, top, width: across, height } = frame;
        let (right, bottom) = (left + across, top + height);
        for index in 0..COLOURS {
            let (from, to) = (index as f64 / COLOURS as f64, (index + 1) as f64 / COLOURS as f64);
            let path = format!(
                "M{} {}h{}V{}H{}",
                fixed(left),
                fixed(bottom - from * height),
                fixed(across),
                fixed(bottom - to * height),
                fixed(left)
            );
            let tag = svg.tag("path").word("d", &path).word("fill", &colour(index));
            tag.word("shape-rendering", "crispEdges").end();
        }
        let tag = svg.tag("rect").number("x", left).number("y", top).number("width", across);
        tag.number("height", height).word("fill", "none").word("stroke", AXIS).end();
        let (scale, ticks) = match self.range {
            Some(range) => (Scale::linear(range, bottom, top), ticks(range, 6)),
            None => {
                let around = Range { low: self.low - 1.0, high: self.low + 1.0 };
                let label = significant(self.low, 4);
                let ticks = Ticks { power: 0, marks: vec![(self.low, label)] };
                (Scale::linear(around, bottom, top), ticks)
            }
        };
        let style = Type::new(TICK_SIZE, SOFT_INK);
        let mut widest: f64 = 0.0;
        for (value, label) in &ticks.marks {
            let at = if self.range.is_some() { scale.at(*value) } else { 0.5 * (top + bottom) };
            line(svg, &[(right, at), (right + 5.0, at)], AXIS, 1.0, None);
            svg.text(right + 9.0, at + 4.2, style, &[Span::Plain(label)]);
            widest = widest.max(width(label, TICK_SIZE));
        }
        let style = Type::new(TITLE_SIZE, INK).anchored(Anchor::Middle).upwards();
        let range = scale.range;
        let quantity = Axis { name: map.quantity, symbol: "", unit: map.unit, range };
        title(svg, right + 26.0 + widest, top + 0.5 * height, style, quantity, &ticks);
    }
}
