//! The picture of a branch of periodic orbits: largest angle against a parameter, stable solid, unstable dashed.

use crate::charts::draw::colour::{BLUE, INK, SOFT_INK, VERMILION};
use crate::charts::draw::geometry::{Frame, Point};
use crate::charts::draw::legend::{LegendSample, legend};
use crate::charts::draw::marks::{hollow, line, listed, readable_line};
use crate::charts::draw::number::significant;
use crate::charts::draw::panel::{Axis, Panel};
use crate::charts::draw::scale::Range;
use crate::charts::draw::sheet::{Sheet, Words};
use crate::charts::draw::svg::{Anchor, Svg, Type};
use crate::charts::draw::text::Span;

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
    let words = Words { title: drawn.title, subtitle: &subtitle, caption: &caption, description: &description };
    let Sheet { mut svg, top } = Sheet::new(720.0, ROOM, words);
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
