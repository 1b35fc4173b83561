//! Lines of text: their pieces, their estimated width (a server has no fonts to ask), and breaking them.

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
