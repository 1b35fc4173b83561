//! The picture of a verdict: eigenvalues on the unit circle with the path of the angle's pair over κ, and |λ| over κ.

use crate::charts::draw::colour::{AXIS, BLUE, INK, ORANGE, PALE_BLUE, SOFT_INK, VERMILION};
use crate::charts::draw::geometry::{Frame, Point};
use crate::charts::draw::legend::{LegendSample, legend};
use crate::charts::draw::marks::{arrow, band, disc, hollow, line};
use crate::charts::draw::number::significant;
use crate::charts::draw::panel::{Axis, Panel};
use crate::charts::draw::scale::{Range, ticks};
use crate::charts::draw::sheet::{Sheet, Words};
use crate::charts::draw::svg::{Anchor, Svg, Type};
use crate::charts::draw::text::Span;
use crate::charts::draw::trail::{Law, Trail, modulus};

/// A verdict and its evidence.
#[derive(Clone, Copy, Debug)]
pub struct Eigenvalues<'a> {
    /// The scene in a few words.
    pub title: &'a str,
    /// The verdict in words.
    pub verdict: &'a str,
    /// The reason, in a sentence.
    pub reason: &'a str,
    /// The linear analysis. Without a fixed point there is none, and the picture shows only `reason`.
    pub linear: Option<Spectrum<'a>>,
}

/// The linear analysis about a fixed point.
#[derive(Clone, Copy, Debug)]
pub struct Spectrum<'a> {
    /// All eigenvalues, as (re, im).
    pub eigenvalues: &'a [(f64, f64)],
    /// κ of the scene. NaN if no κ balances.
    pub tilt_gain: f64,
    /// Smallest κ that balances, or NaN.
    pub lower: f64,
    /// κ_c, the largest κ that balances, or NaN.
    pub critical: f64,
    /// Greene's residue. A point mass has none.
    pub residue: Option<f64>,
    /// σ, rad per bounce, if the angle circles.
    pub rotation: Option<f64>,
}

/// Dashes of the path outside the stable interval.
const DASHES: Option<&str> = Some("6 4");

/// Draws the two panels, or a small sheet with the reason if there is no linear analysis.
pub fn eigenvalues(judged: &Eigenvalues<'_>) -> String {
    const ROOM: f64 = 464.0;
    const CIRCLE: Frame = Frame { left: 78.0, top: 30.0, width: 372.0, height: 348.0 };
    const MODULUS: Frame = Frame { left: 546.0, top: 30.0, width: 380.0, height: 348.0 };
    let Some(spectrum) = judged.linear else {
        let description = format!("There is no linear analysis to draw: {}", judged.reason);
        let caption =
            "There is no fixed point that some tilt gain balances, so there is no way of eigenvalues over κ to draw.";
        let subtitle = format!("{}: {}", judged.verdict, judged.reason);
        let words = Words { title: judged.title, subtitle: &subtitle, caption, description: &description };
        return Sheet::new(620.0, 0.0, words).svg.finish();
    };
    let view = View::new(spectrum);
    let caption = sentence(&spectrum);
    let subtitle = format!("{}: {}", judged.verdict, judged.reason);
    let description = format!("Verdict: {subtitle}. {caption}");
    let words = Words { title: judged.title, subtitle: &subtitle, caption: &caption, description: &description };
    let Sheet { mut svg, top } = Sheet::new(960.0, ROOM, words);
    view.draw_circle(&mut svg, Frame { top: top + CIRCLE.top, ..CIRCLE });
    view.draw_modulus(&mut svg, Frame { top: top + MODULUS.top, ..MODULUS });

    let own = if spectrum.residue.is_some() { "this scene: angle pair" } else { "this scene: angle" };
    let others = if spectrum.residue.is_some() { "drift and energy" } else { "energy" };
    let entries = [
        (LegendSample::Disc(INK), own),
        (LegendSample::Hollow(INK), others),
        (LegendSample::Line { colour: ORANGE, dashes: DASHES }, "κ too small"),
        (LegendSample::Line { colour: BLUE, dashes: None }, "stable κ"),
        (LegendSample::Line { colour: VERMILION, dashes: DASHES }, "κ too large"),
        (LegendSample::Arrow(SOFT_INK), "growing κ"),
    ];
    legend(&mut svg, 480.0, top + ROOM - 22.0, &entries);
    svg.finish()
}

/// κ, its interval, residue and rotation in words.
fn sentence(spectrum: &Spectrum<'_>) -> String {
    let number = |value: f64| significant(value, 4);
    let (lower, critical) = (number(spectrum.lower), number(spectrum.critical));
    let mut text = match spectrum.lower.is_nan() {
        true => "No tilt gain balances.".to_owned(),
        false => format!("κ = {}; stable κ: {lower} to κ_c = {critical}.", number(spectrum.tilt_gain)),
    };
    if let Some(residue) = spectrum.residue {
        text.push_str(&format!(" Residue R = {} (stable: 0 to 1).", number(residue)));
    }
    if let Some(rotation) = spectrum.rotation {
        text.push_str(&format!(" Rotation σ = {} rad per bounce", number(rotation)));
        if rotation > 0.0 {
            text.push_str(&format!(", a turn in {} bounces", significant(std::f64::consts::TAU / rotation, 3)));
        }
        text.push('.');
    }
    let largest = spectrum.eigenvalues.iter().copied().map(modulus).fold(0.0, f64::max);
    text + &format!(" Largest |λ| = {}.", number(largest))
}

/// The values that both panels show.
struct View<'a> {
    spectrum: Spectrum<'a>,
    /// The eigenvalues of the angle first, their count, then the others.
    eigenvalues: Vec<(f64, f64)>,
    own: usize,
    residue: f64,
    trail: Option<Trail>,
}

impl<'a> View<'a> {
    fn new(spectrum: Spectrum<'a>) -> Self {
        let (lower, width) = (spectrum.lower, spectrum.critical - spectrum.lower);
        let law = if spectrum.residue.is_some() { Law::Pair } else { Law::Single };
        let residue = spectrum.residue.unwrap_or((spectrum.tilt_gain - lower) / width);
        let drawable = width > 0.0 && width.is_finite() && lower.is_finite();
        let mut rest: Vec<_> =
            spectrum.eigenvalues.iter().copied().filter(|(re, im)| modulus((*re, *im)).is_finite()).collect();
        let mut eigenvalues = Vec::with_capacity(rest.len());
        let wanted = if law == Law::Pair { 2 } else { 1 };
        for target in law.at(residue).into_iter().take(wanted) {
            let far = |value: &(f64, f64)| modulus((value.0 - target.0, value.1 - target.1));
            let nearest = (0..rest.len()).min_by(|a, b| far(&rest[*a]).total_cmp(&far(&rest[*b])));
            if let Some(nearest) = nearest {
                eigenvalues.push(rest.remove(nearest));
            }
        }
        let own = eigenvalues.len();
        eigenvalues.append(&mut rest);
        let trail = drawable.then(|| Trail::around(law, residue));
        Self { spectrum, eigenvalues, own, residue, trail }
    }

    /// κ at a residue.
    fn tilt_gain(&self, residue: f64) -> f64 {
        self.spectrum.lower + residue * (self.spectrum.critical - self.spectrum.lower)
    }

    fn draw_circle(&self, svg: &mut Svg, frame: Frame) {
        let (low, high) = self.trail.as_ref().map_or((-1.0, 1.0), Trail::real_ends);
        let range = Range::new((1.12 * low).min(-1.7), (1.12 * high).max(1.7));
        // Both axes have the same scale, so that the circle is one.
        let tall = 0.5 * (range.high - range.low) * frame.height / frame.width;
        let re = Axis { name: "Re", symbol: "λ", unit: "", range };
        let im = Axis { name: "Im", symbol: "λ", unit: "", range: Range::new(-tall, tall) };
        let panel = Panel::draw(svg, frame, re, im);
        let place = |(re, im): (f64, f64)| panel.at(re, im);
        let (centre, rim) = (place((0.0, 0.0)), place((1.0, 0.0)));
        let circle = svg.tag("circle").number("cx", centre.0).number("cy", centre.1).number("r", rim.0 - centre.0);
        circle.word("fill", PALE_BLUE).word("stroke", AXIS).number("stroke-width", 1.2).end();
        if let Some(trail) = &self.trail {
            self.draw_rotation(svg, &panel, trail.law);
            let branches = if trail.law == Law::Pair { 0..2 } else { 0..1 };
            for branch in branches {
                for (part, colour, dashes, tip) in [
                    (&trail.below, ORANGE, DASHES, 12),
                    (&trail.stable, BLUE, None, if (0.2..0.45).contains(&self.residue) { 42 } else { 24 }),
                    (&trail.beyond, VERMILION, DASHES, 52),
                ] {
                    let points: Vec<Point> = part.iter().map(|(_, pair)| place(pair[branch])).collect();
                    line(svg, &points, colour, 3.0, dashes);
                    let (from, to) = (points[tip - 2], points[tip]);
                    let clear = self.eigenvalues.iter().all(|value| {
                        let mark = place(*value);
                        modulus((mark.0 - to.0, mark.1 - to.1)) > 16.0
                    });
                    let ends = (points[0], points[points.len() - 1]);
                    if clear && modulus((ends.1.0 - ends.0.0, ends.1.1 - ends.0.1)) > 36.0 {
                        arrow(svg, to, (to.0 - from.0, to.1 - from.1), 11.0, colour);
                    }
                }
            }
            let style = Type::new(12.5, SOFT_INK);
            let lower = format!(" = {}", significant(self.spectrum.lower, 4));
            let critical = format!(" = {}", significant(self.spectrum.critical, 4));
            self.draw_scale(svg, &panel, trail.law);
            let (start, end) = (place((1.0, 0.0)), place((-1.0, 0.0)));
            svg.text(start.0 + 9.0, start.1 + 24.0, style, &[Span::Symbol("κ"), Span::Plain(&lower)]);
            let spans = [Span::Symbol("κ"), Span::Below("c"), Span::Plain(&critical)];
            svg.text(end.0 - 9.0, end.1 + 24.0, style.anchored(Anchor::End), &spans);
        }
        self.draw_marks(svg, &panel, range);
        panel.edge(svg);
    }

    /// Ticks of κ along the circle, which the angle's pair passes as κ grows.
    fn draw_scale(&self, svg: &mut Svg, panel: &Panel, law: Law) {
        let (lower, width) = (self.spectrum.lower, self.spectrum.critical - self.spectrum.lower);
        if law != Law::Pair {
            return;
        }
        let style = Type::new(11.5, SOFT_INK).anchored(Anchor::Middle);
        for (kappa, label) in ticks(Range::new(lower, self.spectrum.critical), 6).marks {
            let residue = (kappa - lower) / width;
            // The ends have labels of their own.
            if !(0.06..=0.94).contains(&residue) {
                continue;
            }
            let [(re, im), _] = law.at(residue);
            let at = |radius: f64| panel.at(radius * re, radius * im);
            line(svg, &[at(0.96), at(1.04)], SOFT_INK, 1.5, None);
            let (x, y) = at(1.17);
            svg.text(x, y + 4.0, style, &[Span::Plain(&label)]);
        }
    }

    /// The angle σ by which a small deviation turns at every bounce.
    fn draw_rotation(&self, svg: &mut Svg, panel: &Panel, law: Law) {
        let [(re, im), _] = law.at(self.residue);
        if self.spectrum.rotation.is_none() || im <= 0.05 {
            return;
        }
        let (centre, ray) = (panel.at(0.0, 0.0), panel.at(re, im));
        line(svg, &[centre, ray], SOFT_INK, 1.2, None);
        // Points of the arc by halving the angle between two directions, which needs no sine.
        let mut arc = vec![(1.0, 0.0), (re, im)];
        for _ in 0..5 {
            let halves = arc.windows(2).map(|pair| {
                let sum = (pair[0].0 + pair[1].0, pair[0].1 + pair[1].1);
                let length = modulus(sum).max(1e-9);
                (sum.0 / length, sum.1 / length)
            });
            let halves: Vec<_> = halves.collect();
            let mut finer = Vec::with_capacity(2 * arc.len());
            for (n, point) in arc.iter().enumerate() {
                finer.push(*point);
                finer.extend(halves.get(n));
            }
            arc = finer;
        }
        let points: Vec<Point> = arc.iter().map(|(re, im)| panel.at(0.3 * re, 0.3 * im)).collect();
        line(svg, &points, SOFT_INK, 1.2, None);
        let (re, im) = arc[arc.len() / 2];
        let (x, y) = panel.at(0.44 * re, 0.44 * im);
        svg.text(x, y + 4.5, Type::new(14.0, INK).anchored(Anchor::Middle), &[Span::Symbol("σ")]);
    }

    fn draw_marks(&self, svg: &mut Svg, panel: &Panel, range: Range) {
        let mut seen: Vec<((f64, f64), usize, bool)> = Vec::new();
        for (n, value) in self.eigenvalues.iter().enumerate().rev() {
            let near = |other: &(f64, f64)| modulus((other.0 - value.0, other.1 - value.1)) < 1e-6;
            match seen.iter_mut().find(|(other, ..)| near(other)) {
                Some((_, count, own)) => {
                    *count += 1;
                    *own |= n < self.own;
                }
                None => seen.push((*value, 1, n < self.own)),
            }
        }
        let style = Type::new(12.5, INK).anchored(Anchor::Middle);
        for ((re, im), count, own) in seen {
            let (x, y) = panel.at(re, im);
            if re < range.low || re > range.high {
                let direction = if re > 0.0 { 1.0 } else { -1.0 };
                arrow(svg, (x - 3.0 * direction, y), (direction, 0.0), 15.0, INK);
                let label = format!("λ = {}", significant(re, 3));
                let anchor = if re > 0.0 { Anchor::End } else { Anchor::Start };
                svg.text(x - 5.0 * direction, y - 14.0, style.anchored(anchor), &[Span::Plain(&label)]);
                continue;
            }
            if own {
                disc(svg, (x, y), 5.5, INK);
            } else {
                hollow(svg, (x, y), 5.0, INK);
            }
            if count > 1 {
                svg.text(x + 13.0, y - 11.0, style, &[Span::Plain(&format!("×{count}"))]);
            }
        }
    }

    fn draw_modulus(&self, svg: &mut Svg, frame: Frame) {
        let Spectrum { tilt_gain, lower, critical, .. } = self.spectrum;
        let (range, reach) = match &self.trail {
            Some(trail) => {
                let (low, high) = trail.ends();
                (Range::new(self.tilt_gain(low), self.tilt_gain(high)), trail.reach())
            }
            None => (Range::around([tilt_gain]), 1.0),
        };
        let top = (1.1 * reach).max(1.4);
        let kappa = Axis { name: "tilt gain", symbol: "κ", unit: "", range };
        let moduli = Axis { name: "modulus", symbol: "|λ|", unit: "", range: Range::new(0.0, top) };
        // The band lies under the grid's marks but over its paper, so the panel is drawn first.
        let panel = Panel::draw(svg, frame, kappa, moduli);
        let bottom = frame.top + frame.height;
        if let Some(trail) = &self.trail {
            let (left, right) = (panel.at(lower, 0.0).0, panel.at(critical, 0.0).0);
            band(svg, Frame { left, width: right - left, ..frame }, PALE_BLUE);
            let one = panel.at(range.low, 1.0).1;
            line(svg, &[(frame.left, one), (frame.left + frame.width, one)], AXIS, 1.0, None);
            let style = Type::new(12.5, SOFT_INK).anchored(Anchor::Middle);
            for (x, below, value) in [(left, Span::Plain(""), lower), (right, Span::Below("c"), critical)] {
                line(svg, &[(x, frame.top), (x, bottom)], AXIS, 1.0, Some("2 3"));
                let value = format!(" = {}", significant(value, 4));
                svg.text(x, frame.top - 7.0, style, &[Span::Symbol("κ"), below, Span::Plain(&value)]);
            }
            let middle = 0.5 * left + 0.5 * right;
            let style = Type::new(12.5, BLUE).anchored(Anchor::Middle);
            svg.text(middle, frame.top + 20.0, style, &[Span::Plain("stable")]);
            let branches = if trail.law == Law::Pair { 0..2 } else { 0..1 };
            for branch in branches {
                for (part, colour, dashes) in
                    [(&trail.below, ORANGE, DASHES), (&trail.stable, BLUE, None), (&trail.beyond, VERMILION, DASHES)]
                {
                    let place = |(residue, pair): &(f64, [(f64, f64); 2])| {
                        panel.at(self.tilt_gain(*residue), modulus(pair[branch]))
                    };
                    line(svg, &part.iter().map(place).collect::<Vec<_>>(), colour, 3.0, dashes);
                }
            }
        }
        self.draw_scene(svg, &panel, range, top);
        panel.edge(svg);
    }

    /// κ of the scene in the plane of |λ| over κ.
    fn draw_scene(&self, svg: &mut Svg, panel: &Panel, range: Range, top: f64) {
        let kappa = self.spectrum.tilt_gain;
        if !kappa.is_finite() {
            return;
        }
        let Frame { top: above, height, .. } = panel.frame;
        let (x, _) = panel.at(kappa, 0.0);
        let style = Type::new(13.0, INK).bold();
        let label = format!(" = {}", significant(kappa, 4));
        let spans = [Span::Symbol("κ"), Span::Plain(&label)];
        if kappa < range.low || kappa > range.high {
            let direction = if kappa > range.high { 1.0 } else { -1.0 };
            let anchor = if kappa > range.high { Anchor::End } else { Anchor::Start };
            arrow(svg, (x, above - 29.0), (direction, 0.0), 15.0, INK);
            svg.text(x - 20.0 * direction, above - 24.5, style.anchored(anchor), &spans);
            return;
        }
        line(svg, &[(x, above - 4.0), (x, above + height)], INK, 1.5, None);
        svg.text(x, above - 24.5, style.anchored(Anchor::Middle), &spans);
        let mut drawn: Vec<f64> = Vec::new();
        for (n, value) in self.eigenvalues.iter().enumerate() {
            let size = modulus(*value);
            if size <= top && !drawn.iter().any(|other| (other - size).abs() < 1e-6) {
                drawn.push(size);
                let place = panel.at(kappa, size);
                if n < self.own { disc(svg, place, 5.5, INK) } else { hollow(svg, place, 5.0, INK) }
            }
        }
    }
}
