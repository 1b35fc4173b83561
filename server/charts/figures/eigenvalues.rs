//! Pictures of eigenvalues on the unit circle. That of a verdict has the path of the angle's pair over κ, and |λ| over κ. That of a law has the
//! path of its loop as the gain is scaled, and the largest |λ| over the factor, with the stable interval of factors.

use crate::charts::draw::colour::{AXIS, BLUE, INK, ORANGE, PALE_BLUE, SOFT_INK, VERMILION};
use crate::charts::draw::marks::{
    Frame, LegendSample, Point, arrow, band, disc, dots, hollow, legend, line, listed, readable_line,
};
use crate::charts::draw::panel::{Axis, Panel, Sheet};
use crate::charts::draw::scale::{Range, significant, ticks};
use crate::charts::draw::svg::{Anchor, Span, Svg, Type};

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
    /// Smallest κ that balances, −∞ without an end, or NaN.
    pub lower: f64,
    /// κ_c, the largest κ that balances, ∞ without an end, or NaN.
    pub critical: f64,
    /// Greene's residue. A point mass has none.
    pub residue: Option<f64>,
    /// σ, rad per bounce, if the angle circles.
    pub rotation: Option<f64>,
}

/// Room below the words, and the two panels of both pictures, px.
const ROOM: f64 = 464.0;
const CIRCLE: Frame = Frame { left: 78.0, top: 30.0, width: 372.0, height: 348.0 };
const MODULUS: Frame = Frame { left: 546.0, top: 30.0, width: 380.0, height: 348.0 };

/// Dashes of the path outside the stable interval.
const DASHES: Option<&str> = Some("6 4");

/// Draws the two panels, or a small sheet with the reason if there is no linear analysis.
pub fn eigenvalues(judged: &Eigenvalues<'_>) -> String {
    let Some(spectrum) = judged.linear else {
        let description = format!("There is no linear analysis to draw: {}", judged.reason);
        let caption =
            "There is no fixed point that some tilt gain balances, so there is no way of eigenvalues over κ to draw.";
        let subtitle = format!("{}: {}", judged.verdict, judged.reason);
        let words = [judged.title, &subtitle, caption];
        return Sheet::new(620.0, 0.0, words, &description).svg.finish();
    };
    let view = View::new(spectrum);
    let caption = sentence(&spectrum);
    let subtitle = format!("{}: {}", judged.verdict, judged.reason);
    let description = format!("Verdict: {subtitle}. {caption}");
    let words = [judged.title, &subtitle, &caption];
    let Sheet { mut svg, top } = Sheet::new(960.0, ROOM, words, &description);
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

/// Half of the range of imaginary parts beside a range of real ones: both axes have the same scale, so that a circle is one.
fn height_of(frame: Frame, range: Range) -> f64 {
    0.5 * (range.high - range.low) * frame.height / frame.width
}

/// Draws the complex plane with the unit circle.
fn unit_circle(svg: &mut Svg, frame: Frame, range: Range) -> Panel {
    let tall = height_of(frame, range);
    let re = Axis { name: "Re", symbol: "λ", unit: "", range };
    let im = Axis { name: "Im", symbol: "λ", unit: "", range: Range::new(-tall, tall) };
    let panel = Panel::draw(svg, frame, re, im);
    let (centre, rim) = (panel.at(0.0, 0.0), panel.at(1.0, 0.0));
    let circle = svg.tag("circle").number("cx", centre.0).number("cy", centre.1).number("r", rim.0 - centre.0);
    circle.word("fill", PALE_BLUE).word("stroke", AXIS).number("stroke-width", 1.2).end();
    panel
}

/// Draws the stable part of a panel of moduli between two places, px, and the modulus 1.
fn stable_band(svg: &mut Svg, panel: &Panel, range: Range, (left, right): (f64, f64)) {
    let frame = panel.frame;
    band(svg, Frame { left, width: right - left, ..frame }, PALE_BLUE);
    let one = panel.at(range.low, 1.0).1;
    line(svg, &[(frame.left, one), (frame.left + frame.width, one)], AXIS, 1.0, None);
}

/// An arrow to an eigenvalue beyond the panel, under words and its value.
fn far_mark(svg: &mut Svg, (x, y): Point, re: f64, words: Option<&str>) {
    let (direction, anchor) = if re > 0.0 { (1.0, Anchor::End) } else { (-1.0, Anchor::Start) };
    arrow(svg, (x - 3.0 * direction, y), (direction, 0.0), 15.0, INK);
    let style = Type::new(12.5, INK).anchored(anchor);
    let value = format!("λ = {}", significant(re, 3));
    for (up, text) in words.map(|words| (30.0, words)).into_iter().chain([(14.0, value.as_str())]) {
        svg.text(x - 5.0 * direction, y - up, style, &[Span::Plain(text)]);
    }
}

/// κ, its interval, residue and rotation in words.
fn sentence(spectrum: &Spectrum<'_>) -> String {
    let number = |value: f64| significant(value, 4);
    let (lower, critical) = (number(spectrum.lower), number(spectrum.critical));
    let stable = match (spectrum.lower.is_finite(), spectrum.critical.is_finite()) {
        (true, true) => format!("{lower} to κ_c = {critical}"),
        (true, false) => format!("{lower} and more"),
        (false, true) => format!("up to κ_c = {critical}"),
        (false, false) => "all".to_owned(),
    };
    let mut text = match spectrum.lower.is_nan() {
        true => "No tilt gain balances.".to_owned(),
        false => format!("κ = {}; stable κ: {stable}.", number(spectrum.tilt_gain)),
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
    text + &format!(" Largest |λ| = {}.", number(largest(spectrum.eigenvalues)))
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
        let panel = unit_circle(svg, frame, range);
        let place = |(re, im): (f64, f64)| panel.at(re, im);
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
                far_mark(svg, (x, y), re, None);
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
            stable_band(svg, &panel, range, (left, right));
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

/// A law and its loop. Eigenvalues are (re, im).
#[derive(Clone, Copy, Debug)]
pub struct Loop<'a> {
    /// The scene in a few words.
    pub title: &'a str,
    /// The law.
    pub subtitle: &'a str,
    /// Interpretation.
    pub caption: &'a str,
    /// Eigenvalues with the law.
    pub closed: &'a [(f64, f64)],
    /// Eigenvalues without it.
    pub open: &'a [(f64, f64)],
    /// Rising factors on the gain, with the eigenvalues at each.
    pub way: &'a [(f64, Vec<(f64, f64)>)],
    /// The factors between which it is stable.
    pub margin: (Option<f64>, Option<f64>),
}

/// Largest real part that is drawn to scale. An arrow points to eigenvalues beyond it.
const FARTHEST_DRAWN: f64 = 2.6;

/// Draws the two panels.
pub fn closed_loop(law: &Loop<'_>) -> String {
    let description = format!("{}. {}", law.subtitle, law.caption);
    let words = [law.title, law.subtitle, law.caption];
    let Sheet { mut svg, top } = Sheet::new(960.0, ROOM, words, &description);
    draw_circle(law, &mut svg, Frame { top: top + CIRCLE.top, ..CIRCLE });
    draw_modulus(law, &mut svg, Frame { top: top + MODULUS.top, ..MODULUS });
    let entries = [
        (LegendSample::Disc(INK), "with the law"),
        (LegendSample::Hollow(INK), "without it"),
        (LegendSample::Dot { radius: 2.0, colour: BLUE }, "gain scaled, stable"),
        (LegendSample::Dot { radius: 2.0, colour: VERMILION }, "gain scaled, not stable"),
    ];
    legend(&mut svg, 480.0, top + ROOM - 22.0, &entries);
    svg.finish()
}

/// Largest modulus of some eigenvalues.
fn largest(values: &[(f64, f64)]) -> f64 {
    values.iter().copied().map(modulus).fold(0.0, f64::max)
}

fn draw_circle(law: &Loop<'_>, svg: &mut Svg, frame: Frame) {
    let ends = || law.closed.iter().chain(law.open).map(|value| value.0).filter(|re| re.is_finite());
    let low = (1.12 * ends().fold(0.0, f64::min)).clamp(-FARTHEST_DRAWN, -1.7);
    let high = (1.12 * ends().fold(0.0, f64::max)).clamp(1.7, FARTHEST_DRAWN);
    let range = Range::new(low, high);
    let (panel, tall) = (unit_circle(svg, frame, range), height_of(frame, range));
    let is_within = |value: &&(f64, f64)| value.0 > range.low && value.0 < range.high && value.1.abs() < tall;
    for (colour, stable) in [(BLUE, true), (VERMILION, false)] {
        let steps = law.way.iter().filter(|(_, values)| (largest(values) < 1.0) == stable);
        let points = steps.flat_map(|(_, values)| values.iter().filter(is_within)).map(|(re, im)| panel.at(*re, *im));
        dots(svg, points, 1.6, colour);
    }
    for (values, words, is_closed) in [(law.open, "without the law", false), (law.closed, "", true)] {
        for &(re, im) in values {
            let at = panel.at(re, im);
            match (range.low..=range.high).contains(&re) {
                true if is_closed => disc(svg, at, 5.5, INK),
                true => hollow(svg, at, 5.0, INK),
                false => far_mark(svg, at, re, Some(words)),
            }
        }
    }
    panel.edge(svg);
}

fn draw_modulus(law: &Loop<'_>, svg: &mut Svg, frame: Frame) {
    let range = match (law.way.first(), law.way.last()) {
        (Some((first, _)), Some((last, _))) => Range::new(*first, *last),
        _ => Range::new(0.0, 2.0),
    };
    let sizes: Vec<(f64, f64)> = law.way.iter().map(|(factor, values)| (*factor, largest(values))).collect();
    let reach = sizes.iter().map(|(_, size)| *size).filter(|size| size.is_finite()).fold(1.0, f64::max);
    let top = (1.1 * reach).clamp(1.3, 3.0);
    let factor = Axis { name: "factor on the gain", symbol: "K", unit: "", range };
    let moduli = Axis { name: "largest modulus", symbol: "|λ|", unit: "", range: Range::new(0.0, top) };
    let panel = Panel::draw(svg, frame, factor, moduli);
    let bottom = frame.top + frame.height;
    let (lower, upper) = law.margin;
    let (left, right) = (panel.at(lower.unwrap_or(range.low), 0.0).0, panel.at(upper.unwrap_or(range.high), 0.0).0);
    stable_band(svg, &panel, range, (left, right.max(left)));
    let style = Type::new(12.5, SOFT_INK).anchored(Anchor::Middle);
    for (x, end) in [(left, lower), (right, upper)] {
        let Some(end) = end.filter(|end| *end >= range.low && *end <= range.high) else { continue };
        line(svg, &[(x, frame.top), (x, bottom)], AXIS, 1.0, Some("2 3"));
        svg.text(x, frame.top - 7.0, style, &[Span::Plain(&significant(end, 4))]);
    }
    let drawn = || sizes.iter().filter(|(_, size)| *size <= top);
    let points: Vec<_> = drawn().map(|it| panel.at(it.0, it.1)).collect();
    if points.len() > 1 {
        let (factors, moduli) = (listed(drawn().map(|it| it.0)), listed(drawn().map(|it| it.1)));
        readable_line(svg, &points, BLUE, 3.0, None, &[("data-factor", &factors), ("data-modulus", &moduli)]);
    }
    let own = largest(law.closed);
    if own <= top {
        let at = panel.at(1.0, own);
        line(svg, &[(at.0, frame.top), (at.0, bottom)], INK, 1.0, None);
        disc(svg, at, 5.5, INK);
    }
    panel.edge(svg);
}

/// Points in each part of a trail.
const SAMPLES: usize = 64;

/// Smallest and largest distance that the residue is drawn beyond 0 and 1.
const BEYOND: f64 = 0.1;
const FARTHEST: f64 = 0.6;

/// The eigenvalues that are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Law {
    /// λ² − (2 − 4R)λ + 1 = 0: the pair of a rod, R Greene's residue.
    Pair,
    /// λ = 1 − 2R with R = κ: a point mass.
    Single,
}

impl Law {
    /// The eigenvalues (re, im) at a residue, the outer or upper one first. A single eigenvalue is returned twice.
    pub(crate) fn at(self, residue: f64) -> [(f64, f64); 2] {
        let half_trace = 1.0 - 2.0 * residue;
        if self == Self::Single {
            return [(half_trace, 0.0); 2];
        }
        let off_circle = residue * (residue - 1.0);
        if off_circle <= 0.0 {
            let imaginary = 2.0 * (-off_circle).sqrt();
            return [(half_trace, imaginary), (half_trace, -imaginary)];
        }
        let outer = half_trace + (2.0 * off_circle.sqrt()).copysign(half_trace);
        // Their product is 1, which keeps the digits that a difference would lose.
        [(outer, 0.0), (1.0 / outer, 0.0)]
    }
}

/// Residues and eigenvalues of one part of the path.
pub(crate) type Part = Vec<(f64, [(f64, f64); 2])>;

/// The path below the stable interval, in it and beyond it.
pub(crate) struct Trail {
    pub(crate) law: Law,
    pub(crate) below: Part,
    pub(crate) stable: Part,
    pub(crate) beyond: Part,
}

impl Trail {
    /// The path, long enough to show a scene at this residue, within bounds.
    pub(crate) fn around(law: Law, residue: f64) -> Self {
        let residue = if residue.is_nan() { 0.0 } else { residue };
        let low = (residue - 0.5 * BEYOND).clamp(-FARTHEST, -BEYOND);
        let high = (residue + 0.5 * BEYOND).clamp(1.0 + BEYOND, 1.0 + FARTHEST);
        // Steps shrink with their square towards 0 and 1, where the pair leaves the circle like a square root.
        let part = |residue: fn(f64, f64) -> f64, end: f64| {
            let sample = |n: usize| residue(n as f64 / SAMPLES as f64, end);
            (0..=SAMPLES).map(|n| (sample(n), law.at(sample(n)))).collect()
        };
        Self {
            law,
            below: part(|u, end| end * (1.0 - u) * (1.0 - u), low),
            stable: part(|u, _| u * u * (3.0 - 2.0 * u), 1.0),
            beyond: part(|u, end| 1.0 + (end - 1.0) * u * u, high),
        }
    }

    /// First and last residue.
    pub(crate) fn ends(&self) -> (f64, f64) {
        (self.below.first().map_or(0.0, |point| point.0), self.beyond.last().map_or(1.0, |point| point.0))
    }

    /// Smallest and largest real part.
    pub(crate) fn real_ends(&self) -> (f64, f64) {
        let parts = self.below.iter().chain(&self.stable).chain(&self.beyond);
        parts.fold((0.0, 0.0), |(low, high), (_, [(re, _), _])| (low.min(*re), high.max(*re)))
    }

    /// Largest |λ|.
    pub(crate) fn reach(&self) -> f64 {
        let parts = self.below.iter().chain(&self.stable).chain(&self.beyond);
        parts.map(|(_, [first, _])| modulus(*first)).fold(1.0, f64::max)
    }
}

/// |λ|.
pub(crate) fn modulus((re, im): (f64, f64)) -> f64 {
    (re * re + im * im).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pair_solves_its_equation() {
        for residue in [-3.0, -0.1, -1e-12, 0.0, 0.2, 0.75, 1.0, 1.0 + 1e-12, 1.1, 40.0] {
            for (re, im) in Law::Pair.at(residue) {
                let trace = 2.0 - 4.0 * residue;
                let real = re * re - im * im - trace * re + 1.0;
                let imaginary = 2.0 * re * im - trace * im;
                let scale = 1.0 + re * re;
                assert!(
                    real.abs() <= 1e-14 * scale && imaginary.abs() <= 1e-14 * scale,
                    "{residue}: {real} {imaginary}"
                );
            }
        }
    }

    #[test]
    fn the_trail_reaches_the_scene_within_bounds() {
        for (residue, low, high) in
            [(0.2, -0.1, 1.1), (1.3, -0.1, 1.35), (-40.0, -0.6, 1.1), (f64::INFINITY, -0.1, 1.6)]
        {
            let ends = Trail::around(Law::Pair, residue).ends();
            assert!((ends.0 - low).abs() < 1e-12 && (ends.1 - high).abs() < 1e-12, "{residue}: {ends:?}");
        }
    }
}
