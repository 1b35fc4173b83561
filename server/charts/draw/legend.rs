//! A legend: one row of samples with their meaning.

use crate::charts::draw::colour::SOFT_INK;
use crate::charts::draw::geometry::Frame;
use crate::charts::draw::marks::{arrow, band, cased, disc, dots, hatched, hollow, line, ring, square};
use crate::charts::draw::svg::{Svg, Type, fixed};
use crate::charts::draw::text::{sentence, width};

/// Text of a legend, px.
const SIZE: f64 = 12.5;

/// A sample of a mark, which stands before its meaning.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LegendSample {
    Dot { radius: f64, colour: &'static str },
    Disc(&'static str),
    Ring(&'static str),
    Hollow(&'static str),
    Square(&'static str),
    Line { colour: &'static str, dashes: Option<&'static str> },
    Cased { dashes: Option<&'static str> },
    Area(&'static str),
    Hatched,
    Arrow(&'static str),
}

impl LegendSample {
    fn width(self) -> f64 {
        match self {
            Self::Line { .. } | Self::Cased { .. } => 26.0,
            Self::Hatched | Self::Area(_) => 18.0,
            Self::Dot { .. } | Self::Disc(_) | Self::Ring(_) | Self::Hollow(_) | Self::Square(_) | Self::Arrow(_) => {
                12.0
            }
        }
    }

    fn draw(self, svg: &mut Svg, x: f64, y: f64) {
        let middle = (x + 0.5 * self.width(), y);
        match self {
            Self::Dot { radius, colour } => dots(svg, std::iter::once(middle), radius, colour),
            Self::Disc(colour) => disc(svg, middle, 5.5, colour),
            Self::Ring(colour) => ring(svg, middle, 5.5, colour),
            Self::Hollow(colour) => hollow(svg, middle, 5.0, colour),
            Self::Square(colour) => square(svg, middle, 5.0, colour),
            Self::Line { colour, dashes } => line(svg, &[(x, y), (x + 26.0, y)], colour, 3.0, dashes),
            Self::Cased { dashes } => cased(svg, &format!("M{} {}h26", fixed(x), fixed(y)), dashes),
            Self::Area(colour) => band(svg, Frame { left: x, top: y - 6.0, width: 18.0, height: 12.0 }, colour),
            Self::Hatched => hatched(svg, Frame { left: x, top: y - 6.0, width: 18.0, height: 12.0 }),
            Self::Arrow(colour) => arrow(svg, (x + 11.0, y), (1.0, 0.0), 11.0, colour),
        }
    }
}

/// Draws a row of samples, centred on `middle`.
pub(crate) fn legend(svg: &mut Svg, middle: f64, y: f64, entries: &[(LegendSample, &str)]) {
    const GAP: f64 = 22.0;
    const SPACE: f64 = 7.0;
    let wide = |(sample, text): &(LegendSample, &str)| sample.width() + SPACE + width(text, SIZE);
    let all: f64 = entries.iter().map(wide).sum::<f64>() + GAP * (entries.len().saturating_sub(1)) as f64;
    let mut x = middle - 0.5 * all;
    for entry in entries {
        let (sample, text) = *entry;
        sample.draw(svg, x, y);
        svg.text(x + sample.width() + SPACE, y + 4.3, Type::new(SIZE, SOFT_INK), &sentence(text));
        x += wide(entry) + GAP;
    }
}
