//! The picture of a trajectory: the planes ⟨θ, θ̇⟩ and ⟨ẋ, ẏ⟩ with a dot for every impact, as in the paper's figures.

use crate::charts::draw::colour::{BLUE, GREEN, SOFT_INK, VERMILION};
use crate::charts::draw::marks::{Frame, LegendSample, dots, legend, ring, square};
use crate::charts::draw::panel::{Axis, Panel, Sheet};
use crate::charts::draw::scale::Range;
use crate::charts::draw::svg::{Anchor, Span, Svg, Type};

/// Highest number of dots in a plane. More would only fill the area, at megabytes of SVG.
const MOST_DOTS: usize = 20_000;

/// States just before the impacts of a run, one entry of each slice per impact.
#[derive(Clone, Copy, Debug)]
pub struct PhasePlanes<'a> {
    /// The scene in a few words.
    pub title: &'a str,
    /// The outcome of the run.
    pub subtitle: &'a str,
    /// θ, rad.
    pub theta: &'a [f64],
    /// θ̇, rad/s. A point mass has none, and its first plane is left out.
    pub theta_dot: Option<&'a [f64]>,
    /// ẋ, m/s.
    pub x_dot: &'a [f64],
    /// ẏ, m/s.
    pub y_dot: &'a [f64],
}

/// Draws the two planes, or the second alone.
///
/// Values that are not finite are left out. Of more than 20,000 impacts one in k is drawn, with the first and the last. The caption
/// says so.
pub fn phase_planes(run: &PhasePlanes<'_>) -> String {
    const ROOM: f64 = 432.0;
    const PLANE: Frame = Frame { left: 104.0, top: 6.0, width: 350.0, height: 340.0 };
    let impacts = run.x_dot.len().min(run.y_dot.len());
    let step = impacts.div_ceil(MOST_DOTS).max(1);
    let mut planes = Vec::new();
    if let Some(theta_dot) = run.theta_dot {
        planes.push(Plane {
            x: PlaneAxis("angle", "θ", "rad", run.theta),
            y: PlaneAxis("angular velocity", "θ̇", "rad/s", theta_dot),
        });
    }
    planes.push(Plane {
        x: PlaneAxis("horizontal velocity", "ẋ", "m/s", run.x_dot),
        y: PlaneAxis("vertical velocity", "ẏ", "m/s", run.y_dot),
    });
    let left_out = planes.iter().map(Plane::not_finite).max().unwrap_or(0);

    let both = planes.len() == 2;
    let mut caption = match impacts {
        0 => "No impact happened.".to_owned(),
        1 => "The state just before the only impact.".to_owned(),
        _ => format!("States just before each of {impacts} impacts."),
    };
    if !both {
        caption.push_str(" A point mass has no orientation, so there is no plane of angle and angular velocity.");
    }
    if step > 1 {
        caption.push_str(&format!(" One in {step} is drawn, with the first and the last."));
    }
    if left_out > 0 {
        caption.push_str(&format!(" {left_out} that are not finite numbers are left out."));
    }
    let shown = if both { "angular velocity against angle, and vertical" } else { "vertical" };
    let description = format!("{} Dots: {shown} against horizontal velocity. {caption}", run.subtitle);
    let words = [run.title, run.subtitle, &caption];
    let width = if both { 960.0 } else { 620.0 };
    let Sheet { mut svg, top } = Sheet::new(width, ROOM, words, &description);

    let radius = match impacts {
        0..=400 => 2.2,
        401..=4000 => 1.5,
        _ => 1.0,
    };
    for (n, plane) in planes.iter().enumerate() {
        let left = if both { PLANE.left + 480.0 * n as f64 } else { 0.5 * (width - PLANE.width) + 34.0 };
        plane.draw(&mut svg, Frame { left, top: top + PLANE.top, ..PLANE }, step, radius);
    }
    let last = format!("last (n = {impacts})");
    let entries = [
        (LegendSample::Dot { radius: radius.max(2.2), colour: BLUE }, "impact"),
        (LegendSample::Ring(GREEN), "first (n = 1)"),
        (LegendSample::Square(VERMILION), last.as_str()),
    ];
    let entries = match impacts {
        0 => &entries[..0],
        1 => &entries[..2],
        _ => &entries[..],
    };
    legend(&mut svg, 0.5 * width, top + ROOM - 22.0, entries);
    svg.finish()
}

/// Name, symbol and unit of an axis, and the values along it.
struct PlaneAxis<'a>(&'a str, &'a str, &'a str, &'a [f64]);

impl PlaneAxis<'_> {
    fn axis(&self) -> Axis<'_> {
        let Self(name, symbol, unit, values) = *self;
        Axis { name, symbol, unit, range: Range::around(values.iter().copied()) }
    }
}

struct Plane<'a> {
    x: PlaneAxis<'a>,
    y: PlaneAxis<'a>,
}

impl Plane<'_> {
    fn points(&self) -> impl DoubleEndedIterator<Item = (f64, f64)> + ExactSizeIterator {
        self.x.3.iter().copied().zip(self.y.3.iter().copied())
    }

    fn not_finite(&self) -> usize {
        self.points().filter(|point| !finite(point)).count()
    }

    fn draw(&self, svg: &mut Svg, frame: Frame, step: usize, radius: f64) {
        let panel = Panel::draw(svg, frame, self.x.axis(), self.y.axis());
        let count = self.points().len();
        let kept = self.points().enumerate().filter(|(n, _)| n % step == chosen(n / step, step) || n + 1 == count);
        let drawn = kept.map(|(_, point)| point).filter(finite).map(|(x, y)| panel.at(x, y));
        dots(svg, drawn, radius, BLUE);
        if let Some((x, y)) = self.points().next_back().filter(finite)
            && count > 1
        {
            square(svg, panel.at(x, y), 5.5, VERMILION);
        }
        if let Some((x, y)) = self.points().next().filter(finite) {
            ring(svg, panel.at(x, y), 6.5, GREEN);
        }
        if count == 0 {
            let style = Type::new(14.0, SOFT_INK).anchored(Anchor::Middle);
            let middle = (frame.left + 0.5 * frame.width, frame.top + 0.5 * frame.height - 8.0);
            svg.text(middle.0, middle.1, style, &[Span::Plain("no impact")]);
        }
        panel.edge(svg);
    }
}

/// Chooses the impact that is drawn for a block of `step`. A fixed choice would show one island of a chain of `step`.
fn chosen(block: usize, step: usize) -> usize {
    // Knuth's multiplicative hash: the high half of the product is spread evenly.
    let spread = (block as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 32;
    (spread % step as u64) as usize
}

fn finite((x, y): &(f64, f64)) -> bool {
    x.is_finite() && y.is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_shows_every_island_of_a_chain() {
        for step in 2..=5 {
            let mut drawn = vec![0; step];
            (0..20_000).for_each(|block| drawn[chosen(block, step)] += 1);
            assert!(drawn.iter().all(|count| *count > 18_000 / step), "{step}: {drawn:?}");
        }
    }
}
