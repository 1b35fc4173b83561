//! Writes SVG: elements with presentation attributes, escaped text, fixed decimals; lines of text, with their estimated width, since a server has
//! no fonts to ask. Knows nothing of charts.

use std::fmt::Write as _;

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

/// A piece of a line.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Span<'a> {
    /// Upright text.
    Plain(&'a str),
    /// A mathematical symbol: slanted.
    Symbol(&'a str),
    /// A subscript.
    Below(&'a str),
}

/// Symbols with a subscript, as sentences write them.
const SUBSCRIPTED: [&str; 3] = ["κ_c", "σ_t", "σ_θ"];

/// The pieces of a sentence, in which κ_c is set as κ with the subscript c, and so on.
pub(crate) fn sentence(text: &str) -> Vec<Span<'_>> {
    let (mut spans, mut rest) = (Vec::new(), text);
    let next = |rest: &str| SUBSCRIPTED.iter().filter_map(|symbol| Some((rest.find(symbol)?, *symbol))).min();
    while let Some((at, symbol)) = next(rest) {
        let (letter, below) = symbol.split_once('_').unwrap_or((symbol, ""));
        spans.extend([Span::Plain(&rest[..at]), Span::Plain(letter), Span::Below(below)]);
        rest = &rest[at + symbol.len()..];
    }
    spans.push(Span::Plain(rest));
    spans
}

/// Width of a character in ems. Generous, so that a line fits in any of the fonts.
const CHARACTER: f64 = 0.56;

/// Width of a text in px, by estimate.
pub(crate) fn width(text: &str, size: f64) -> f64 {
    let ems: f64 = text.chars().map(character_width).sum();
    ems * size
}

fn character_width(character: char) -> f64 {
    match character {
        '\u{300}'..='\u{36f}' => 0.0,
        ' ' | ',' | '.' | '·' | 'i' | 'l' | '|' | '(' | ')' => 0.34,
        '\u{1100}'..
            if !('\u{2000}'..='\u{22ff}').contains(&character) && !('\u{1e00}'..='\u{1fff}').contains(&character) =>
        {
            1.05
        }
        '0'..='9' => 0.64,
        '−' | '=' | '+' | '<' | '>' => 0.84,
        _ => CHARACTER,
    }
}

/// Breaks a text at spaces, or inside words too long for a line, into at most `most` lines of at most `room` px. A longer text ends
/// in an ellipsis.
pub(crate) fn wrap(text: &str, size: f64, room: f64, most: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut line = String::new();
    for word in text.split_whitespace() {
        let mut word = word;
        if !line.is_empty() && width(&line, size) + width(" ", size) + width(word, size) > room {
            lines.push(std::mem::take(&mut line));
        }
        while width(word, size) > room {
            let (head, rest) = word.split_at(fitting(word, size, room));
            lines.push(head.to_owned());
            word = rest;
            if lines.len() > most {
                break;
            }
        }
        if lines.len() > most {
            break;
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(word);
    }
    if !line.is_empty() {
        lines.push(line);
    }
    if lines.len() > most {
        lines.truncate(most);
        if let Some(last) = lines.last_mut() {
            let kept = fitting(last, size, room - width("…", size));
            last.truncate(kept);
            last.push('…');
        }
    }
    lines
}

/// Number of bytes of the longest beginning that fits, at least one character.
fn fitting(text: &str, size: f64, room: f64) -> usize {
    let mut used = 0.0;
    for (at, character) in text.char_indices() {
        used += character_width(character) * size;
        if used > room && at > 0 {
            return at;
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_have_their_subscripts() {
        let set: String = sentence("σ_t = 10 ms, σ_θ and κ_c")
            .into_iter()
            .map(|span| match span {
                Span::Plain(text) => text.to_owned(),
                Span::Symbol(text) | Span::Below(text) => format!("[{text}]"),
            })
            .collect();
        assert_eq!(set, "σ[t] = 10 ms, σ[θ] and κ[c]");
        assert_eq!(sentence("max_theta").len(), 1);
    }

    #[test]
    fn lines_fit_and_nothing_is_lost_but_what_the_ellipsis_says() {
        let text = "the table stands still and restitution is 0.5: every bounce loses energy, so no bounce repeats";
        let lines = wrap(text, 12.0, 200.0, 10);
        assert!(lines.len() > 1 && lines.iter().all(|line| width(line, 12.0) <= 200.0), "{lines:?}");
        assert_eq!(lines.join(" "), text);
        let cut = wrap(text, 12.0, 200.0, 2);
        assert!(cut.len() == 2 && cut[1].ends_with('…') && width(&cut[1], 12.0) <= 200.0, "{cut:?}");
        assert_eq!(wrap(&"θ".repeat(100), 12.0, 100.0, 99).concat(), "θ".repeat(100));
    }
}
