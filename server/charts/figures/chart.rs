//! Charts of curves: the truth beside wrong results, in one panel or in rows of two, linear or logarithmic; a branch of periodic orbits; the
//! survival of an ensemble.

use crate::charts::draw::colour::{BLUE, GREEN, INK, LIGHT_GREEN, ORANGE, PALE_BLUE, PALE_GREEN, SOFT_INK, VERMILION};
use crate::charts::draw::marks::{
    Frame, LegendSample, Point, area, hollow, legend, line, listed, readable_dots, readable_line, ring,
};
use crate::charts::draw::panel::{Axis, Panel, Sheet, TICK_SIZE};
use crate::charts::draw::scale::{Range, significant, ticks};
use crate::charts::draw::svg::{Anchor, Span, Svg, Type};

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

impl Curve {
    /// A curve.
    pub fn new(label: &'static str, style: CurveStyle, points: Vec<(f64, f64)>) -> Self {
        Self { label, style, points }
    }
}

impl Plot {
    /// A panel without curves.
    pub fn new(x: ChartAxis, y: ChartAxis) -> Self {
        Self { x, y, curves: Vec::new() }
    }

    /// The panel with these curves.
    #[must_use]
    pub fn with(self, curves: Vec<Curve>) -> Self {
        Self { curves, ..self }
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
    let words = [drawn.title, &drawn.subtitle, &drawn.caption];
    let two = drawn.plots.len() > 1;
    let (width, across) = if two { (960.0, 350.0) } else { (720.0, 580.0) };
    let Sheet { mut svg, top } = Sheet::new(width, room, words, &description);
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

// The picture of a branch of periodic orbits: largest angle against a parameter, stable solid, unstable dashed.

/// Angles below this are rounding noise around 0, rad.
const ROUNDING: f64 = 1e-12;

/// A place on the branch where stability changes.
#[derive(Clone, Copy, Debug)]
pub struct StabilityChange {
    /// Parameter and largest |θ|.
    pub at: (f64, f64),
    /// Kind of the change.
    pub kind: &'static str,
}

/// A branch of periodic orbits.
#[derive(Clone, Copy, Debug)]
pub struct Branches<'a> {
    /// Title in a few words.
    pub title: &'a str,
    /// The parameter in words.
    pub name: &'a str,
    /// Symbol of the parameter.
    pub symbol: &'a str,
    /// Unit of the parameter; empty for none.
    pub unit: &'a str,
    /// Requested range of the parameter.
    pub ends: (f64, f64),
    /// Parameter, largest |θ|, and stability; `None` at a change.
    pub points: &'a [(f64, f64, Option<bool>)],
    /// Changes of stability.
    pub changes: &'a [StabilityChange],
    /// κ_c, if the parameter is κ.
    pub critical: Option<f64>,
}

/// Draws the diagram.
pub fn branches(drawn: &Branches<'_>) -> String {
    const ROOM: f64 = 464.0;
    const FRAME: Frame = Frame { left: 86.0, top: 30.0, width: 600.0, height: 348.0 };
    let changes: Vec<String> = drawn
        .changes
        .iter()
        .map(|change| {
            let theta = if change.at.1 < ROUNDING { 0.0 } else { change.at.1 };
            let (kind, parameter, theta) = (change.kind.replace('_', " "), change.at.0, significant(theta, 3));
            format!("{kind} at {} (θ = {theta} rad)", significant(parameter, 6))
        })
        .collect();
    let caption = if changes.is_empty() {
        "Stability does not change on this branch.".to_owned()
    } else {
        format!("Stability changes: {}.", changes.join(", "))
    };
    let subtitle = format!("largest angle of the orbit against {}", drawn.name.to_lowercase());
    let description = format!("{}: {subtitle}. {caption}", drawn.title);
    let words = [drawn.title, &subtitle, &caption];
    let Sheet { mut svg, top } = Sheet::new(720.0, ROOM, words, &description);
    let frame = Frame { top: top + FRAME.top, ..FRAME };
    let range = Range::new(drawn.ends.0.min(drawn.ends.1), drawn.ends.0.max(drawn.ends.1));
    let highest = drawn.points.iter().map(|point| point.1).fold(0.0, f64::max);
    let tall = Range::new(0.0, f64::max(1.06 * highest, 0.1));
    let name = drawn.name.to_lowercase();
    let x = Axis { name: &name, symbol: drawn.symbol, unit: drawn.unit, range };
    let y = Axis { name: "largest angle", symbol: "|θ|", unit: "rad", range: tall };
    let panel = Panel::draw(&mut svg, frame, x, y);
    if let Some(critical) = drawn.critical.filter(|critical| (range.low..=range.high).contains(critical)) {
        let (at, bottom) = panel.at(critical, 0.0);
        line(&mut svg, &[(at, frame.top), (at, bottom)], SOFT_INK, 1.0, Some("2 3"));
        let label = format!(" = {}", significant(critical, 4));
        let style = Type::new(12.5, SOFT_INK).anchored(Anchor::Middle);
        svg.text(at, frame.top - 7.0, style, &[Span::Symbol("κ"), Span::Below("c"), Span::Plain(&label)]);
    }
    let mut run: Vec<(f64, f64)> = Vec::new();
    let mut last: Option<bool> = None;
    for pair in drawn.points.windows(2) {
        // A change between two points is a point of its own, so one of the two has a stability.
        let stable = pair[0].2.or(pair[1].2).unwrap_or(false);
        if last.is_some_and(|last| last != stable) {
            draw_run(&mut svg, &panel, &run, !stable);
            run.clear();
        }
        if run.is_empty() {
            run.push((pair[0].0, pair[0].1));
        }
        run.push((pair[1].0, pair[1].1));
        last = Some(stable);
    }
    if let Some(stable) = last {
        draw_run(&mut svg, &panel, &run, stable);
    }
    for change in drawn.changes {
        hollow(&mut svg, panel.at(change.at.0, change.at.1), 5.0, INK);
    }
    panel.edge(&mut svg);
    let entries = [
        (LegendSample::Line { colour: BLUE, dashes: None }, "stable"),
        (LegendSample::Line { colour: VERMILION, dashes: Some("6 4") }, "unstable"),
        (LegendSample::Hollow(INK), "stability changes"),
    ];
    legend(&mut svg, 386.0, top + ROOM - 22.0, &entries);
    svg.finish()
}

/// One stable or unstable part of the branch, with its values as data attributes: `data-value` and `data-theta` have a number
/// for each point of the path, and `data-stable` says which part it is.
fn draw_run(svg: &mut Svg, panel: &Panel, run: &[(f64, f64)], stable: bool) {
    let points: Vec<Point> = run.iter().map(|&(parameter, theta)| panel.at(parameter, theta)).collect();
    let parameters = listed(run.iter().map(|point| point.0));
    let thetas = listed(run.iter().map(|point| point.1));
    let data = [
        ("data-value", parameters.as_str()),
        ("data-theta", thetas.as_str()),
        ("data-stable", if stable { "true" } else { "false" }),
    ];
    let (colour, dashes) = if stable { (BLUE, None) } else { (VERMILION, Some("6 4")) };
    readable_line(svg, &points, colour, 3.0, dashes, &data);
}

// The picture of an ensemble: the share of runs that continue after each contact, with the number at risk below the axis, and the
// quantiles of their angle.

/// Survival of many runs.
#[derive(Clone, Copy, Debug)]
pub struct SurvivalCurve<'a> {
    /// Title in a few words.
    pub title: &'a str,
    /// Outcomes of the runs, in a sentence.
    pub subtitle: &'a str,
    /// Conclusion with numbers.
    pub caption: &'a str,
    /// The curve: one point for each contact, from 1.
    pub curve: &'a [SurvivalAt],
    /// Quantiles of |θ| over the runs that continue, at some contacts.
    pub angles: &'a [AnglesAt],
}

/// The curve at a contact.
#[derive(Clone, Copy, Debug)]
pub struct SurvivalAt {
    /// Number of runs that reach it.
    pub at_risk: u64,
    /// Share of all runs that continue.
    pub share: f64,
    /// Confidence interval of the share.
    pub interval: (f64, f64),
}

/// Quantiles at a contact.
#[derive(Clone, Copy, Debug)]
pub struct AnglesAt {
    /// Number of the contact.
    pub n: u64,
    /// Five quantiles in rising order, rad.
    pub quantiles: [f64; 5],
}

/// Highest number of steps of a curve: two for each pixel.
const STEPS: usize = 1200;

/// The panels. The lower one stands below the row of numbers at risk.
const UPPER: Frame = Frame { left: 92.0, top: 6.0, width: 590.0, height: 226.0 };
const LOWER: Frame = Frame { top: 326.0, height: 170.0, ..UPPER };

/// Draws the chart.
pub fn survival_curve(drawn: &SurvivalCurve<'_>) -> String {
    const ROOM: f64 = 582.0;
    let description = format!("{}: {} {}", drawn.title, drawn.subtitle, drawn.caption);
    let words = [drawn.title, drawn.subtitle, drawn.caption];
    let Sheet { mut svg, top } = Sheet::new(720.0, ROOM, words, &description);
    let range = Range::new(0.0, drawn.curve.len().max(1) as f64);
    let x = Axis { name: "bounce", symbol: "n", unit: "", range };
    draw_survival(&mut svg, Frame { top: top + UPPER.top, ..UPPER }, x, drawn.curve);
    draw_angles(&mut svg, Frame { top: top + LOWER.top, ..LOWER }, x, drawn.angles);
    let entries = [
        (LegendSample::Line { colour: BLUE, dashes: None }, "still going"),
        (LegendSample::Area(PALE_BLUE), "95 % interval"),
        (LegendSample::Line { colour: GREEN, dashes: None }, "median |θ|"),
        (LegendSample::Area(LIGHT_GREEN), "25 to 75 %"),
        (LegendSample::Area(PALE_GREEN), "5 to 95 %"),
    ];
    legend(&mut svg, 360.0, top + ROOM - 22.0, &entries);
    svg.finish()
}

fn draw_survival(svg: &mut Svg, frame: Frame, x: Axis<'_>, curve: &[SurvivalAt]) {
    let y = Axis { name: "runs still going", symbol: "", unit: "", range: Range::new(0.0, 1.0) };
    let panel = Panel::draw(svg, frame, x, y);
    let stairs = |value: &dyn Fn(&SurvivalAt) -> f64| stairs(&panel, curve, value);
    svg.begin_group("data-curve", "interval");
    area(svg, &stairs(&|at| at.interval.1), &stairs(&|at| at.interval.0), PALE_BLUE);
    svg.end_group();
    readable_line(svg, &stairs(&|at| at.share), BLUE, 2.4, None, &[("data-curve", "survival")]);
    panel.readable_edge(svg, "survival", x.range, y.range);
    // At the ticks of the axis, which has room for six.
    let y = frame.top + frame.height + 62.0;
    let style = Type::new(TICK_SIZE, INK);
    svg.begin_group("data-row", "at-risk");
    for (n, _) in ticks(x.range, 6).marks {
        let place = (n as usize).saturating_sub(1);
        let Some(at) = curve.get(place) else { continue };
        svg.text(panel.at(n, 0.0).0, y, style.anchored(Anchor::Middle), &[Span::Plain(&at.at_risk.to_string())]);
    }
    svg.end_group();
    let label = Type::new(TICK_SIZE, SOFT_INK).anchored(Anchor::End);
    svg.text(frame.left - 22.0, y, label, &[Span::Plain("at risk")]);
}

/// A step curve that keeps its value from contact to contact, and is 1 before the first.
fn stairs(panel: &Panel, curve: &[SurvivalAt], value: &dyn Fn(&SurvivalAt) -> f64) -> Vec<Point> {
    let stride = curve.len().div_ceil(STEPS).max(1);
    let mut points = vec![panel.at(0.0, 1.0)];
    let mut height = points[0].1;
    for (place, at) in curve.iter().enumerate() {
        let n = place + 1;
        let is_last = n == curve.len();
        if !is_last && !n.is_multiple_of(stride) {
            continue;
        }
        let point = panel.at(n as f64, value(at));
        if point.1 != height || is_last {
            points.extend([(point.0, height), point]);
            height = point.1;
        }
    }
    points
}

fn draw_angles(svg: &mut Svg, frame: Frame, x: Axis<'_>, angles: &[AnglesAt]) {
    let highest = angles.iter().map(|at| at.quantiles[4]).fold(0.0, f64::max);
    let range = Range::new(0.0, if highest > 0.0 { 1.06 * highest } else { 0.1 });
    let y = Axis { name: "angle", symbol: "|θ|", unit: "rad", range };
    let panel = Panel::draw(svg, frame, x, y);
    let along =
        |which: usize| -> Vec<Point> { angles.iter().map(|at| panel.at(at.n as f64, at.quantiles[which])).collect() };
    area(svg, &along(4), &along(0), PALE_GREEN);
    area(svg, &along(3), &along(1), LIGHT_GREEN);
    line(svg, &along(2), GREEN, 2.0, None);
    panel.readable_edge(svg, "angle", x.range, y.range);
}
