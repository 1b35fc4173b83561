//! A sheet: paper with a title above the panels and a caption below them.

use crate::charts::draw::colour::{EDGE, INK, PAPER, SOFT_INK};
use crate::charts::draw::svg::{Svg, Type};
use crate::charts::draw::text::{sentence, wrap};

/// Sizes of title, subtitle and caption, px.
const TITLE: f64 = 18.0;
const SUBTITLE: f64 = 13.5;
const CAPTION: f64 = 12.5;

/// Highest number of lines of each.
const LINES: usize = 4;

/// Height of a line over its text.
const LEADING: f64 = 1.4;

/// Space left and right of text, px.
const MARGIN: f64 = 28.0;

/// The words on a sheet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Words<'a> {
    pub(crate) title: &'a str,
    pub(crate) subtitle: &'a str,
    pub(crate) caption: &'a str,
    /// Description for readers who cannot see the picture.
    pub(crate) description: &'a str,
}

/// Paper with room for panels.
pub(crate) struct Sheet {
    pub(crate) svg: Svg,
    /// Top of the panels, px.
    pub(crate) top: f64,
}

impl Sheet {
    /// A sheet of this width with `room` px of height for panels. The words determine its height.
    pub(crate) fn new(width: f64, room: f64, words: Words<'_>) -> Self {
        let space = width - 2.0 * MARGIN;
        // Words that are code elsewhere have no type of their own here.
        let [given, subtitle, caption, description] =
            [words.title, words.subtitle, words.caption, words.description].map(|words| words.replace('`', ""));
        let title = wrap(&given, TITLE, space, LINES);
        let subtitle = wrap(&subtitle, SUBTITLE, space, LINES);
        let caption = wrap(&caption, CAPTION, space, LINES);
        let tall = |lines: &[String], size: f64| lines.len() as f64 * size * LEADING;
        let top = 22.0 + tall(&title, TITLE) + tall(&subtitle, SUBTITLE) + 18.0;
        let below = if caption.is_empty() { 8.0 } else { tall(&caption, CAPTION) + 16.0 };
        let height = top + room + below;
        let mut svg = Svg::new(width, height, [top, room], &given, &description);
        let paper = svg.tag("rect").number("x", 0.5).number("y", 0.5).number("width", width - 1.0);
        paper.number("height", height - 1.0).number("rx", 6.0).word("fill", PAPER).word("stroke", EDGE).end();
        let mut y = 22.0;
        let mut write = |lines: &[String], style: Type| {
            for line in lines {
                svg.text(MARGIN, y + style.size, style, &sentence(line));
                y += style.size * LEADING;
            }
        };
        write(&title, Type::new(TITLE, INK).bold());
        write(&subtitle, Type::new(SUBTITLE, SOFT_INK));
        let mut y = top + room;
        for line in &caption {
            svg.text(MARGIN, y + CAPTION, Type::new(CAPTION, SOFT_INK), &sentence(line));
            y += CAPTION * LEADING;
        }
        Self { svg, top }
    }
}
