//! The picture of an ensemble: the share of runs that continue after each contact, with the number at risk below the axis, and the
//! quantiles of their angle.

use crate::charts::draw::colour::{BLUE, GREEN, INK, LIGHT_GREEN, PALE_BLUE, PALE_GREEN, SOFT_INK};
use crate::charts::draw::geometry::{Frame, Point};
use crate::charts::draw::legend::{LegendSample, legend};
use crate::charts::draw::marks::{area, line, readable_line};
use crate::charts::draw::panel::{Axis, Panel, TICK_SIZE};
use crate::charts::draw::scale::{Range, ticks};
use crate::charts::draw::sheet::{Sheet, Words};
use crate::charts::draw::svg::{Anchor, Svg, Type};
use crate::charts::draw::text::Span;

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
    let words =
        Words { title: drawn.title, subtitle: drawn.subtitle, caption: drawn.caption, description: &description };
    let Sheet { mut svg, top } = Sheet::new(720.0, ROOM, words);
    let range = Range::new(0.0, drawn.curve.len().max(1) as f64);
    let x = Axis { name: "contact", symbol: "n", unit: "", range };
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
