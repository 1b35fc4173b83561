//! Writes SVG: elements with presentation attributes, escaped text, fixed decimals. Knows nothing of charts.

use std::fmt::Write as _;

use crate::charts::draw::text::Span;

/// Fonts that have Greek and dotted letters, the page's own first.
const FONTS: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', 'DejaVu Sans', Arial, sans-serif";

/// Largest coordinate that is written, px. Renderers differ beyond it.
const FARTHEST: f64 = 100_000.0;

/// An SVG document being written.
pub(crate) struct Svg {
    out: String,
}

/// An element whose attributes are being written.
pub(crate) struct Tag<'a> {
    svg: &'a mut Svg,
}

/// Alignment of a text to its point.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// Type of a text: size, colour, alignment and direction.
#[derive(Clone, Copy)]
pub(crate) struct Type {
    pub(crate) size: f64,
    pub(crate) colour: &'static str,
    pub(crate) bold: bool,
    pub(crate) anchor: Anchor,
    /// Text that reads upwards.
    pub(crate) upwards: bool,
}

impl Type {
    pub(crate) const fn new(size: f64, colour: &'static str) -> Self {
        Self { size, colour, bold: false, anchor: Anchor::Start, upwards: false }
    }

    pub(crate) const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    pub(crate) const fn anchored(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(crate) const fn upwards(self) -> Self {
        Self { upwards: true, ..self }
    }
}

impl Svg {
    /// Opens a document of this size in px. Title and description are for readers who cannot see it.
    ///
    /// `charts` are the top and the height of the part with the charts: a page that has words of its own shows that part alone.
    pub(crate) fn new(width: f64, height: f64, charts: [f64; 2], title: &str, description: &str) -> Self {
        let mut svg = Self { out: String::with_capacity(16 * 1024) };
        svg.out.push_str("<svg xmlns=\"http://www.w3.org/2000/svg\" role=\"img\"");
        let _ = write!(svg.out, " width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"", fixed(width), fixed(height));
        let [top, tall] = charts.map(fixed);
        let _ = write!(svg.out, " data-charts=\"0 {top} {} {tall}\"", fixed(width));
        svg.out.push_str(" font-family=\"");
        svg.escape(FONTS);
        svg.out.push_str("\">\n<title>");
        svg.escape(title);
        svg.out.push_str("</title>\n<desc>");
        svg.escape(description);
        svg.out.push_str("</desc>\n");
        svg
    }

    /// Starts an element without content. `Tag::end` ends it.
    pub(crate) fn tag(&mut self, name: &str) -> Tag<'_> {
        self.out.push('<');
        self.out.push_str(name);
        Tag { svg: self }
    }

    /// Writes one line of text.
    pub(crate) fn text(&mut self, x: f64, y: f64, style: Type, spans: &[Span<'_>]) {
        let mut tag = self.tag("text").number("x", x).number("y", y).number("font-size", style.size);
        tag = tag.word("fill", style.colour);
        if style.bold {
            tag = tag.word("font-weight", "600");
        }
        tag = match style.anchor {
            Anchor::Start => tag,
            Anchor::Middle => tag.word("text-anchor", "middle"),
            Anchor::End => tag.word("text-anchor", "end"),
        };
        if style.upwards {
            tag = tag.word("transform", &format!("rotate(-90 {} {})", fixed(x), fixed(y)));
        }
        tag.svg.out.push('>');
        let small = fixed(style.size * 0.72);
        let mut lowered = false;
        for span in spans {
            let raise = if lowered { format!(" dy=\"{}\"", fixed(-style.size * 0.22)) } else { String::new() };
            lowered = false;
            match span {
                Span::Plain("") => {}
                Span::Plain(text) if raise.is_empty() => self.escape(text),
                Span::Plain(text) => self.span(&raise, text),
                Span::Symbol(text) => self.span(&format!("{raise} font-style=\"italic\""), text),
                Span::Below(text) => {
                    let drop = if raise.is_empty() { fixed(style.size * 0.22) } else { "0".to_owned() };
                    self.span(&format!(" dy=\"{drop}\" font-size=\"{small}\""), text);
                    lowered = true;
                }
            }
        }
        self.out.push_str("</text>\n");
    }

    fn span(&mut self, attributes: &str, text: &str) {
        self.out.push_str("<tspan");
        self.out.push_str(attributes);
        self.out.push('>');
        self.escape(text);
        self.out.push_str("</tspan>");
    }

    /// Starts a group with a data attribute, from which a page finds its elements. `end_group` ends it.
    pub(crate) fn begin_group(&mut self, name: &str, value: &str) {
        let tag = self.tag("g").word(name, value);
        tag.svg.out.push_str(">\n");
    }

    pub(crate) fn end_group(&mut self) {
        self.out.push_str("</g>\n");
    }

    /// Closes the document.
    pub(crate) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    /// Writes text for XML 1.0. Characters that it does not allow become U+FFFD, line breaks become spaces.
    fn escape(&mut self, text: &str) {
        for character in text.chars() {
            match character {
                '&' => self.out.push_str("&amp;"),
                '<' => self.out.push_str("&lt;"),
                '>' => self.out.push_str("&gt;"),
                '"' => self.out.push_str("&quot;"),
                '\t' | '\n' | '\r' => self.out.push(' '),
                character if character.is_control() || matches!(character, '\u{fffe}' | '\u{ffff}') => {
                    self.out.push('\u{fffd}');
                }
                character => self.out.push(character),
            }
        }
    }
}

impl Tag<'_> {
    pub(crate) fn number(self, name: &str, value: f64) -> Self {
        let _ = write!(self.svg.out, " {name}=\"{}\"", fixed(value));
        self
    }

    pub(crate) fn word(self, name: &str, value: &str) -> Self {
        let _ = write!(self.svg.out, " {name}=\"");
        self.svg.escape(value);
        self.svg.out.push('"');
        self
    }

    pub(crate) fn end(self) {
        self.svg.out.push_str("/>\n");
    }
}

/// A coordinate with at most two decimals. NaN becomes 0.
pub(crate) fn fixed(value: f64) -> String {
    let value = if value.is_nan() { 0.0 } else { value.clamp(-FARTHEST, FARTHEST) };
    let mut text = format!("{value:.2}");
    while text.ends_with('0') {
        text.pop();
    }
    if text.ends_with('.') {
        text.pop();
    }
    if text == "-0" { "0".to_owned() } else { text }
}
