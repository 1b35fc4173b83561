//! The picture of a quantity over two fields of a scene, with the linear boundary over it.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::charts::draw::colour::{AXIS, COLOURS, INK, PALE_GREY, SOFT_INK, colour};
use crate::charts::draw::marks::{Frame, LegendSample, Point, cased, hatch, legend, line};
use crate::charts::draw::panel::{Axis, Panel, Sheet, TICK_SIZE, TITLE_SIZE, title};
use crate::charts::draw::scale::{Range, Scale, Ticks, significant, ticks};
use crate::charts::draw::svg::{Anchor, Span, Svg, Type, fixed, width};

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
    let words = [map.title, map.subtitle, &caption];
    let Sheet { mut svg, top } = Sheet::new(WIDTH, ROOM, words, &description);
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
        let path = path(&segments, frame);
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
        frame.tag(svg).word("fill", "none").word("stroke", AXIS).end();
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

// The cells of a heat map: binned to the resolution of the picture, and drawn as one path for each colour.
//
// Runs of one colour in a row are one rectangle. Moves are relative and rectangles left open, which filling closes: a
// run takes about twelve bytes.

/// Highest number of cells along a side: one for each pixel of the frame.
pub(crate) const MOST: usize = 512;

/// Distance of two lines of hatching along a side, px.
const HATCHING: f64 = 8.0;

/// One side of the cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GridSide {
    /// Number of cells.
    pub(crate) count: usize,
    /// True if they run from the right or from the top.
    pub(crate) reversed: bool,
}

impl GridSide {
    /// Number of cells that are drawn.
    pub(crate) fn drawn(self) -> usize {
        self.count.min(MOST)
    }

    /// Place of a drawn cell.
    fn bin(self, index: usize) -> usize {
        let index = if self.reversed { self.count - 1 - index } else { index };
        if self.count > MOST { index * MOST / self.count } else { index }
    }
}

/// The drawn cells: rows from below, a value for each cell.
pub(crate) struct CellGrid {
    columns: usize,
    rows: usize,
    values: Vec<Option<f64>>,
    /// Number of drawn cells that hide cells of different kinds behind a mean.
    pub(crate) mixed: usize,
}

/// The cells that one drawn cell stands for, so far.
#[derive(Clone, Copy, Default)]
struct Bin {
    sum: f64,
    count: u32,
    kind: Option<CellOutcome>,
    mixed: bool,
}

/// The outcome of a cell with a value; `None` without a value.
type CellOutcome = Option<u8>;

impl CellGrid {
    /// Puts the cells into bins row by row and takes the mean of the finite values in each bin. `outcomes` are any numbers in the order
    /// of the values; missing ones count as equal.
    pub(crate) fn binned(values: &[Option<f64>], outcomes: &[u8], x: GridSide, y: GridSide) -> Self {
        let (columns, rows) = (x.drawn(), y.drawn());
        let mut bins = vec![Bin::default(); columns * rows];
        for (row, values) in values.chunks(x.count.max(1)).take(y.count).enumerate() {
            let (below, first) = (y.bin(row) * columns, row * x.count);
            for (column, value) in values.iter().enumerate().take(x.count) {
                let bin = &mut bins[below + x.bin(column)];
                let value = value.filter(|value| value.is_finite());
                let kind = value.map(|_| outcomes.get(first + column).copied().unwrap_or_default());
                bin.mixed |= *bin.kind.get_or_insert(kind) != kind;
                if let Some(value) = value {
                    bin.sum += value;
                    bin.count += 1;
                }
            }
        }
        let mean = |bin: &Bin| (bin.count > 0).then(|| bin.sum / f64::from(bin.count));
        let mixed = bins.iter().filter(|bin| bin.mixed).count();
        Self { columns, rows, values: bins.iter().map(mean).collect(), mixed }
    }

    /// True if any cell is drawn without a value.
    pub(crate) fn any_empty(&self) -> bool {
        self.values.iter().any(Option::is_none)
    }

    /// Draws all cells over the frame. `shade` returns the colour of a value.
    pub(crate) fn draw(&self, svg: &mut Svg, frame: Frame, shade: impl Fn(f64) -> usize) {
        if self.values.is_empty() {
            return;
        }
        // One more path for cells without a value.
        let mut paths = vec![Runs::default(); COLOURS + 1];
        for (row, values) in self.values.chunks(self.columns).enumerate() {
            let shades: Vec<usize> =
                values.iter().map(|value| value.map_or(COLOURS, |value| shade(value).min(COLOURS - 1))).collect();
            let mut column = 0;
            for run in shades.chunk_by(usize::eq) {
                paths[run[0]].add(column, row, run.len());
                column += run.len();
            }
        }
        // Six decimals place the far side to a thousandth of a pixel.
        let (wide, tall) = (frame.width / self.columns as f64, frame.height / self.rows as f64);
        let bottom = frame.top + frame.height;
        let place = format!("matrix({wide:.6} 0 0 -{tall:.6} {} {})", fixed(frame.left), fixed(bottom));
        for (index, runs) in paths.iter().enumerate().filter(|(_, runs)| !runs.path.is_empty()) {
            let fill = if index == COLOURS { PALE_GREY.to_owned() } else { colour(index) };
            let tag = svg.tag("path").word("d", &runs.path).word("fill", &fill).word("transform", &place);
            // Smoothed edges would show the paper between neighbours.
            tag.word("shape-rendering", "crispEdges").end();
        }
        let hatching = self.hatching(frame);
        if !hatching.is_empty() {
            hatch(svg, &hatching);
        }
    }

    /// Parallel lines through all cells without a value, cut at the cells' edges.
    fn hatching(&self, frame: Frame) -> String {
        let mut path = String::new();
        if !self.any_empty() {
            return path;
        }
        let (wide, tall) = (frame.width / self.columns as f64, frame.height / self.rows as f64);
        let lines = ((frame.width + frame.height) / HATCHING) as usize;
        for line in 1..lines {
            // x + y = sum, px from the top left corner; the edges of columns and rows that it crosses, as x.
            let sum = line as f64 * HATCHING;
            let (from, to) = ((sum - frame.height).max(0.0), sum.min(frame.width));
            let columns = (0..=self.columns).map(|n| n as f64 * wide);
            let rows = (0..=self.rows).map(|n| sum - n as f64 * tall);
            let mut edges: Vec<f64> = columns.chain(rows).filter(|x| (from..=to).contains(x)).collect();
            edges.extend([from, to]);
            edges.sort_by(f64::total_cmp);
            let mut start = None;
            for edge in edges.windows(2) {
                let middle = 0.5 * (edge[0] + edge[1]);
                if self.is_empty_at(middle / wide, (frame.height - (sum - middle)) / tall) {
                    start.get_or_insert(edge[0]);
                } else if let Some(start) = start.take() {
                    stroke(&mut path, frame, sum, start, edge[0]);
                }
            }
            if let Some(start) = start {
                stroke(&mut path, frame, sum, start, to);
            }
        }
        path
    }

    fn is_empty_at(&self, column: f64, row: f64) -> bool {
        let (column, row) = ((column as usize).min(self.columns - 1), (row as usize).min(self.rows - 1));
        self.values[row * self.columns + column].is_none()
    }
}

/// A piece of a line of hatching. Very short pieces are left out.
fn stroke(path: &mut String, frame: Frame, sum: f64, from: f64, to: f64) {
    if to - from >= 1.0 {
        let (x, y, length) = (fixed(frame.left + from), fixed(frame.top + sum - from), fixed(to - from));
        let _ = write!(path, "M{x} {y}l{length}-{length}");
    }
}

/// Rectangles of one colour, one cell high.
#[derive(Clone, Default)]
struct Runs {
    path: String,
    /// Position of the pen.
    pen: (i64, i64),
}

impl Runs {
    fn add(&mut self, column: usize, row: usize, length: usize) {
        let (column, row) = (column as i64, row as i64);
        let (right, up) = (column - self.pen.0, row - self.pen.1);
        // A minus needs no space before it.
        let space = if up < 0 { "" } else { " " };
        let _ = write!(self.path, "m{right}{space}{up}h{length}v1h-{length}");
        self.pen = (column, row + 1);
    }
}

/// Resolution at which ends count as the same, places per px.
const FINENESS: f64 = 20.0;

/// Smallest distance of two points of a curve, px.
const NEAR: f64 = 0.5;

/// The path of all segments inside the frame, px. Empty if no segment is inside.
pub(crate) fn path(segments: &[(Point, Point)], frame: Frame) -> String {
    let inside: Vec<_> = segments.iter().filter_map(|segment| cut(*segment, frame)).collect();
    let mut path = String::new();
    for curve in joined(&inside) {
        let mut last = curve[0];
        let _ = write!(path, "M{} {}", fixed(last.0), fixed(last.1));
        for (n, point) in curve.iter().enumerate().skip(1) {
            let far = (point.0 - last.0).abs().max((point.1 - last.1).abs()) >= NEAR;
            if far || n + 1 == curve.len() {
                let _ = write!(path, "L{} {}", fixed(point.0), fixed(point.1));
                last = *point;
            }
        }
    }
    path
}

/// The part of a segment inside the frame, after Liang and Barsky.
fn cut((from, to): (Point, Point), frame: Frame) -> Option<(Point, Point)> {
    if ![from.0, from.1, to.0, to.1].iter().all(|value| value.is_finite()) {
        return None;
    }
    let (mut first, mut last): (f64, f64) = (0.0, 1.0);
    for (start, end, low, wide) in [(from.0, to.0, frame.left, frame.width), (from.1, to.1, frame.top, frame.height)] {
        for (way, room) in [(start - end, start - low), (end - start, low + wide - start)] {
            if way == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if way < 0.0 {
                first = first.max(room / way);
            } else {
                last = last.min(room / way);
            }
        }
    }
    let at = |share: f64| (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
    // A remainder of a far segment by rounding or overflow is no part of it.
    let is_part = first <= last && place(at(first)) != place(at(last)) && at(first).0.is_finite();
    is_part.then(|| (at(first), at(last)))
}

fn place((x, y): Point) -> (i64, i64) {
    ((x * FINENESS).round() as i64, (y * FINENESS).round() as i64)
}

/// Joins segments that share ends into curves: first open curves from their ends, then closed ones.
fn joined(segments: &[(Point, Point)]) -> Vec<Vec<Point>> {
    let mut meeting: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (n, (from, to)) in segments.iter().enumerate() {
        meeting.entry(place(*from)).or_default().push(n);
        meeting.entry(place(*to)).or_default().push(n);
    }
    let (open, closed): (Vec<_>, Vec<_>) = meeting.keys().partition(|place| meeting[*place].len() % 2 == 1);
    let mut used = vec![false; segments.len()];
    let mut curves = Vec::new();
    for start in open.into_iter().chain(closed) {
        while let Some(first) = meeting[start].iter().find(|n| !used[**n]) {
            let mut curve = Vec::new();
            let (mut here, mut next) = (*start, Some(*first));
            while let Some(n) = next {
                used[n] = true;
                let (from, to) = segments[n];
                let (near, far) = if place(from) == here { (from, to) } else { (to, from) };
                if curve.is_empty() {
                    curve.push(near);
                }
                curve.push(far);
                here = place(far);
                next = meeting[&here].iter().find(|n| !used[**n]).copied();
            }
            curves.push(curve);
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALONG: GridSide = GridSide { count: 4, reversed: false };

    #[test]
    fn runs_of_one_colour_are_one_rectangle() {
        let values = [0.0, 0.0, 9.0, 0.0, 9.0, 9.0, 9.0, 9.0].map(Some);
        let cells = CellGrid::binned(&values, &[], ALONG, GridSide { count: 2, reversed: false });
        let mut svg = Svg::new(1.0, 1.0, [0.0, 1.0], "", "");
        cells.draw(&mut svg, Frame { left: 0.0, top: 0.0, width: 8.0, height: 8.0 }, |value| value as usize);
        let text = svg.finish();
        assert!(text.contains("d=\"m0 0h2v1h-2m3-1h1v1h-1\" fill=\"#00224e\""), "{text}");
        assert!(text.contains("d=\"m2 0h1v1h-1m-2 0h4v1h-4\""), "{text}");
        assert_eq!(text.matches("matrix(2.000000 0 0 -4.000000 0 8)").count(), 2, "{text}");
    }

    #[test]
    fn bins_hold_the_mean_of_what_has_a_value() {
        let values: Vec<_> = (0..2 * MOST).map(|n| (n != 0).then_some(n as f64)).collect();
        let x = GridSide { count: 2 * MOST, reversed: false };
        let cells = CellGrid::binned(&values, &[], x, GridSide { count: 1, reversed: false });
        assert_eq!((cells.values[0], cells.values[1], cells.values[MOST - 1]), (Some(1.0), Some(2.5), Some(1022.5)));
        let back =
            CellGrid::binned(&values, &[], GridSide { reversed: true, ..x }, GridSide { count: 1, reversed: true });
        assert_eq!(back.values[MOST - 1], Some(1.0));
        let odd = GridSide { count: MOST + 1, reversed: false };
        assert!(!CellGrid::binned(&values[1..MOST + 2], &[], odd, GridSide { count: 1, reversed: false }).any_empty());
    }

    #[test]
    fn bins_of_different_kinds_are_counted() {
        let (x, y) = (GridSide { count: 2 * MOST, reversed: false }, GridSide { count: 1, reversed: false });
        let values = vec![Some(1.0); 2 * MOST];
        let mut outcomes = vec![0; 2 * MOST];
        assert_eq!(CellGrid::binned(&values, &outcomes, x, y).mixed, 0);
        // Two bins of one kind, one of two.
        outcomes[4..7].fill(1);
        assert_eq!(CellGrid::binned(&values, &outcomes, x, y).mixed, 1);
        // A cell without a value beside one with, whatever its outcome; and two without.
        let holes: Vec<_> = (0..2 * MOST).map(|n| (![8, 10, 11].contains(&n)).then_some(1.0)).collect();
        assert_eq!(CellGrid::binned(&holes, &outcomes, x, y).mixed, 2);
        let shown = GridSide { count: MOST, reversed: false };
        assert_eq!(CellGrid::binned(&holes, &outcomes, shown, y).mixed, 0);
    }

    #[test]
    fn too_few_and_too_many_values_are_taken_as_they_come() {
        assert!(CellGrid::binned(&[Some(1.0); 3], &[], ALONG, ALONG).any_empty());
        assert_eq!(CellGrid::binned(&[Some(1.0); 99], &[], ALONG, ALONG).values, [Some(1.0); 16]);
        assert!(CellGrid::binned(&[Some(1.0)], &[], GridSide { count: 0, reversed: true }, ALONG).values.is_empty());
    }

    const FRAME: Frame = Frame { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn loose_segments_become_one_curve_in_any_order_and_direction() {
        let segments =
            [((4.0, 4.0), (2.0, 3.0)), ((0.0, 1.0), (2.0, 3.0)), ((6.0, 2.0), (4.0, 4.0)), ((9.0, 9.0), (9.0, 8.0))];
        assert_eq!(path(&segments, FRAME), "M0 1L2 3L4 4L6 2M9 8L9 9");
        let round = [((1.0, 1.0), (2.0, 1.0)), ((2.0, 2.0), (2.0, 1.0)), ((2.0, 2.0), (1.0, 1.0))];
        assert_eq!(path(&round, FRAME).matches('M').count(), 1);
    }

    #[test]
    fn what_is_outside_is_cut_off() {
        assert_eq!(path(&[((-5.0, 5.0), (15.0, 5.0))], FRAME), "M0 5L10 5");
        assert_eq!(path(&[((-5.0, 5.0), (-1.0, 5.0)), ((1.0, f64::NAN), (2.0, 2.0))], FRAME), "");
        assert_eq!(path(&[((3.0, 3.0), (3.0, 3.0))], FRAME), "");
        let _ = path(&[((-1e308, 5.0), (1e308, f64::MAX)), ((f64::MIN, f64::MIN), (f64::MAX, f64::MAX))], FRAME);
    }
}
