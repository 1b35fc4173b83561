//! The cells of a heat map: binned to the resolution of the picture, and drawn as one path for each colour.
//!
//! Runs of one colour in a row are one rectangle. Moves are relative and rectangles left open, which filling closes: a
//! run takes about twelve bytes.

use std::fmt::Write as _;

use crate::charts::draw::colour::PALE_GREY;
use crate::charts::draw::geometry::Frame;
use crate::charts::draw::marks::hatch;
use crate::charts::draw::svg::{Svg, fixed};
use crate::charts::figures::heat_map::cividis::{COLOURS, colour};

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
}
