//! The picture of speed against accuracy: error over cost, both logarithmic, a symbol and a colour for each method.

use crate::charts::draw::colour::{BLUE, GREEN, INK, ORANGE, PAPER, PURPLE, SKY, SOFT_INK, VERMILION};
use crate::charts::draw::marks::{Frame, Point, line, readable_line, straight};
use crate::charts::draw::panel::{Axis, Panel, Sheet};
use crate::charts::draw::scale::Range;
use crate::charts::draw::svg::{Span, Svg, Type};

/// Speed and accuracy of methods.
#[derive(Clone, Debug)]
pub struct SpeedAccuracy<'a> {
    /// Title in a few words.
    pub title: &'a str,
    /// Content in a sentence.
    pub subtitle: &'a str,
    /// Reading aid, and methods that are not drawn.
    pub caption: &'a str,
    /// Kind and unit of the cost.
    pub cost: (&'a str, &'a str),
    /// Kind of the error.
    pub error: &'a str,
    /// The methods.
    pub series: &'a [Series<'a>],
    /// Cost and error of the points on the Pareto front.
    pub front: &'a [(f64, f64)],
    /// One unit in the last place of the state.
    pub rounding: f64,
}

/// One method.
#[derive(Clone, Debug)]
pub struct Series<'a> {
    /// Symbol and colour.
    pub symbol: Symbol,
    /// Name in requests.
    pub name: &'a str,
    /// Name in words.
    pub label: &'a str,
    /// The points, in the order of the method's settings.
    pub points: Vec<CostAndError>,
}

/// A point of the chart.
#[derive(Clone, Copy, Debug)]
pub struct CostAndError {
    /// Place among the points of the answer, from 0.
    pub index: usize,
    /// Lower quartile, median and upper quartile of the cost.
    pub cost: [f64; 3],
    /// Error.
    pub error: f64,
}

/// The mark of a method: a colour and an outline, each of which tells methods apart.
#[derive(Clone, Copy, Debug)]
pub struct Symbol {
    colour: &'static str,
    outline: &'static [Point],
    is_open: bool,
}

impl Symbol {
    /// The symbol without its filling.
    pub const fn open(self) -> Self {
        Self { is_open: true, ..self }
    }
}

const fn symbol(colour: &'static str, outline: &'static [Point]) -> Symbol {
    Symbol { colour, outline, is_open: false }
}

/// The symbols, one for each method.
pub const SYMBOLS: [Symbol; 11] = [
    symbol(
        BLUE,
        &[(-0.9, -0.4), (-0.4, -0.9), (0.4, -0.9), (0.9, -0.4), (0.9, 0.4), (0.4, 0.9), (-0.4, 0.9), (-0.9, 0.4)],
    ),
    symbol(SKY, &[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)]),
    symbol(GREEN, &[(0.0, -1.1), (1.1, 0.9), (-1.1, 0.9)]),
    symbol(INK, &[(-1.0, -0.3), (1.0, -0.3), (1.0, 0.3), (-1.0, 0.3)]),
    symbol(VERMILION, &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)]),
    symbol(PURPLE, &[(0.0, 1.1), (1.1, -0.9), (-1.1, -0.9)]),
    symbol(PURPLE, &[(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)]),
    symbol(
        PURPLE,
        &[
            (0.0, -0.4),
            (0.7, -1.1),
            (1.1, -0.7),
            (0.4, 0.0),
            (1.1, 0.7),
            (0.7, 1.1),
            (0.0, 0.4),
            (-0.7, 1.1),
            (-1.1, 0.7),
            (-0.4, 0.0),
            (-1.1, -0.7),
            (-0.7, -1.1),
        ],
    ),
    symbol(
        ORANGE,
        &[
            (-0.35, -1.2),
            (0.35, -1.2),
            (0.35, -0.35),
            (1.2, -0.35),
            (1.2, 0.35),
            (0.35, 0.35),
            (0.35, 1.2),
            (-0.35, 1.2),
            (-0.35, 0.35),
            (-1.2, 0.35),
            (-1.2, -0.35),
            (-0.35, -0.35),
        ],
    ),
    symbol(SOFT_INK, &[(-1.1, 0.0), (0.9, -1.1), (0.9, 1.1)]),
    symbol(SOFT_INK, &[(1.1, 0.0), (-0.9, -1.1), (-0.9, 1.1)]),
];

/// Size of a symbol, px.
const SIZE: f64 = 5.0;

/// Largest space between lines of the legend, px.
const LEADING: f64 = 23.0;

/// Height of the legend, px.
const LEGEND: f64 = 450.0;

/// Draws a symbol. `mark` is the method of a point, for pages that read the chart; a legend has none.
fn draw_symbol(svg: &mut Svg, (x, y): Point, Symbol { colour, outline, is_open }: Symbol, mark: Option<&str>) {
    let path = straight(outline.iter().map(|(right, down)| (x + SIZE * right, y + SIZE * down))) + "Z";
    let (fill, edge, width) = if is_open { (PAPER, colour, 1.6) } else { (colour, PAPER, 0.8) };
    let tag = svg.tag("path").word("d", &path).word("fill", fill);
    let tag = tag.word("stroke", edge).number("stroke-width", width);
    match mark {
        Some(method) => tag.word("data-mark", method).end(),
        None => tag.end(),
    }
}

/// Draws the chart.
pub fn speed_accuracy(drawn: &SpeedAccuracy<'_>) -> String {
    const ROOM: f64 = 470.0;
    let description = format!("{} {} {}", drawn.title, drawn.subtitle, drawn.caption);
    let words = [drawn.title, drawn.subtitle, drawn.caption];
    let Sheet { mut svg, top } = Sheet::new(960.0, ROOM, words, &description);
    let frame = Frame { left: 96.0, top: top + 6.0, width: 580.0, height: 396.0 };
    // Values without a logarithm are drawn on the lower edge.
    let place = |value: f64| if value > 0.0 { libm::log10(value) } else { f64::NEG_INFINITY };
    let points = || drawn.series.iter().flat_map(|series| series.points.iter());
    let cost = Range::around(points().flat_map(|point| point.cost).map(place));
    let error = Range::around(points().map(|point| point.error).chain([drawn.rounding]).map(place));
    let x = Axis { name: drawn.cost.0, symbol: "", unit: drawn.cost.1, range: cost };
    let y = Axis { name: drawn.error, symbol: "", unit: "m or m/s", range: error };
    let panel = Panel::draw_scaled(&mut svg, frame, x, y, [true; 2]);
    let at = |cost: f64, error: f64| panel.at(place(cost), place(error));

    let (floor, right) = (at(f64::INFINITY, drawn.rounding).1, frame.left + frame.width);
    if drawn.rounding > 0.0 {
        line(&mut svg, &[(frame.left, floor), (right, floor)], SOFT_INK, 1.4, Some("2 3"));
    }
    let mut front: Vec<Point> = drawn.front.iter().map(|&(cost, error)| at(cost, error)).collect();
    front.sort_by(|one, other| one.0.total_cmp(&other.0));
    if let (Some(&first), Some(&last)) = (front.first(), front.last()) {
        let mut stairs = vec![(first.0, frame.top)];
        for point in front {
            let before = stairs.last().map_or(point.1, |point| point.1);
            if stairs.len() > 1 {
                stairs.push((point.0, before));
            }
            stairs.push(point);
        }
        stairs.push((right, last.1));
        readable_line(&mut svg, &stairs, INK, 1.6, None, &[("data-curve", "front")]);
    }
    for series in drawn.series {
        let colour = series.symbol.colour;
        let middles: Vec<Point> = series.points.iter().map(|point| at(point.cost[1], point.error)).collect();
        let indices: Vec<String> = series.points.iter().map(|point| point.index.to_string()).collect();
        readable_line(&mut svg, &middles, colour, 1.2, None, &[("data-point", &indices.join(" "))]);
        for (CostAndError { cost, error, .. }, middle) in series.points.iter().zip(middles) {
            line(&mut svg, &[at(cost[0], *error), at(cost[2], *error)], colour, 2.4, None);
            draw_symbol(&mut svg, middle, series.symbol, Some(series.name));
        }
    }
    panel.edge(&mut svg);

    let left = right + 26.0;
    let mut y = frame.top + 12.0;
    // The front and the rounding have lines too.
    let leading = LEADING.min(LEGEND / (drawn.series.len() + 2) as f64);
    let mut label = |svg: &mut Svg, text: &str, draw: &dyn Fn(&mut Svg, f64)| {
        draw(svg, y);
        svg.text(left + 26.0, y + 4.3, Type::new(12.5, SOFT_INK), &[Span::Plain(text)]);
        y += leading;
    };
    for series in drawn.series {
        label(&mut svg, series.label, &|svg, y| draw_symbol(svg, (left + 8.0, y), series.symbol, None));
    }
    if !drawn.front.is_empty() {
        label(&mut svg, "Pareto front", &|svg, y| line(svg, &[(left, y), (left + 18.0, y)], INK, 1.6, None));
    }
    label(&mut svg, "rounding of doubles", &|svg, y| {
        line(svg, &[(left, y), (left + 18.0, y)], SOFT_INK, 1.4, Some("2 3"));
    });
    svg.finish()
}
