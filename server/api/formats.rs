//! Sets of formats for answers.
//!
//! Each set is an enum, and an answer is written by a `match` over it: the compiler demands a writer for every format.

use std::borrow::Cow;
use std::fmt;

use serde::Serialize;

use crate::api::ops::metrics::plain;
use crate::api::shared::table::Table;
use crate::api::shared::write;
use crate::compute::TimeSlice;
use crate::http::{Format, Problem};

/// The formats of an answer; the first is the default.
pub trait FormatSet: Copy + Send + 'static {
    /// All formats of the set, for content negotiation.
    const FORMATS: &'static [Format];

    /// The member of the set for a format; `None` if the set lacks it.
    fn of(format: Format) -> Option<Self>;
}

/// Defines a set of formats.
macro_rules! format_set {
    ($(#[$about:meta])* $name:ident { $($format:ident),+ }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        #[expect(missing_docs, reason = "the formats are described where `Format` lists them")]
        pub enum $name { $($format),+ }

        impl FormatSet for $name {
            const FORMATS: &'static [Format] = &[$(Format::$format),+];

            fn of(format: Format) -> Option<Self> {
                [$((Format::$format, Self::$format)),+].into_iter().find(|(own, _)| *own == format).map(|(_, own)| own)
            }
        }
    };
}

format_set! {
    /// Formats of an answer with columns.
    TableFormat { Json, Csv, Ndjson, Arrow }
}

format_set! {
    /// Formats of an answer with a picture.
    FigureFormat { Json, Svg, Png }
}

format_set! {
    /// Formats of an answer with columns and a picture.
    ChartFormat { Json, Csv, Ndjson, Arrow, Svg, Png }
}

format_set! {
    /// Formats of a verdict: those of a chart, and gauges.
    GaugeFormat { Json, Csv, Ndjson, Arrow, Svg, Png, OpenMetrics }
}

format_set! {
    /// Formats of gauges.
    ProbeFormat { OpenMetrics, Prometheus }
}

format_set! {
    /// Formats of an answer with columns, a picture and reports of progress.
    ProgressFormat { Json, Csv, Ndjson, Arrow, Progress, Svg, Png }
}

/// An answer with columns.
pub trait Tabular: Serialize + Sized {
    /// Members of the answer in the last line of NDJSON: what is outside the columns.
    const END: &'static [&'static str] = &[];

    /// The columns.
    fn to_table(&self) -> Cow<'_, Table>;

    /// Last line of NDJSON.
    fn end(&self) -> impl Serialize {
        write::Part { answer: self, members: write::Members::Only(Self::END) }
    }

    /// The columns in Arrow, whose names may say more.
    fn to_arrow_table(&self) -> Cow<'_, Table> {
        self.to_table()
    }

    /// Members of the JSON answer whose values are all in the columns.
    fn in_table(&self) -> &'static [&'static str] {
        &[]
    }

    /// Meaning of a column; empty if its name says all.
    fn about(&self, _name: &str) -> &'static str {
        ""
    }

    /// Number of cells in JSON, if it is known. Memory is reserved for so many.
    fn cells(&self) -> usize {
        0
    }
}

/// An answer that can be drawn.
pub trait Pictured: Serialize {
    /// The picture as SVG.
    ///
    /// # Errors
    /// A problem if this answer has nothing to draw.
    fn to_picture(&self) -> Result<String, Problem>;
}

/// An answer that Prometheus can scrape.
pub trait Scraped: Tabular + Pictured {
    /// The gauges as OpenMetrics.
    ///
    /// # Errors
    /// Failure of the encoder.
    fn to_open_metrics(&self) -> Result<String, fmt::Error>;
}

/// An answer that tells its progress. Its pictures come with its last line, so that a page that waited for it needs no second request.
pub trait Watched: Tabular + Pictured {
    /// The pictures as SVG, by name.
    ///
    /// # Errors
    /// A problem if this answer has nothing to draw.
    fn to_pictures(&self) -> Result<Vec<(&'static str, String)>, Problem>;
}

/// A set of formats in which answers of type `A` are written.
pub trait WriteAnswer<A>: FormatSet {
    /// Writes an answer.
    ///
    /// # Errors
    /// Cancelled work, or a picture of an answer with nothing to draw.
    fn write(self, answer: &A, slice: &TimeSlice) -> Result<Vec<u8>, Problem>;
}

impl<A: Tabular> WriteAnswer<A> for TableFormat {
    fn write(self, answer: &A, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
        match self {
            Self::Json => write::json_with_table(answer, answer.cells(), slice),
            Self::Csv => write::csv(&answer.to_table(), slice),
            Self::Ndjson => write::ndjson(&answer.to_table(), &answer.end(), slice),
            Self::Arrow => {
                let rest = write::rest_of(answer, answer.in_table(), slice)?;
                write::arrow(&answer.to_arrow_table(), |name| answer.about(name), rest, slice)
            }
        }
    }
}

impl<A: Pictured> WriteAnswer<A> for FigureFormat {
    fn write(self, answer: &A, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
        match self {
            Self::Json => write::json(answer, slice),
            Self::Svg => Ok(answer.to_picture()?.into_bytes()),
            Self::Png => write::pixels(&answer.to_picture()?, slice),
        }
    }
}

impl<A: Tabular + Pictured> WriteAnswer<A> for ChartFormat {
    fn write(self, answer: &A, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
        match self {
            Self::Json => TableFormat::Json.write(answer, slice),
            Self::Csv => TableFormat::Csv.write(answer, slice),
            Self::Ndjson => TableFormat::Ndjson.write(answer, slice),
            Self::Arrow => TableFormat::Arrow.write(answer, slice),
            Self::Svg => FigureFormat::Svg.write(answer, slice),
            Self::Png => FigureFormat::Png.write(answer, slice),
        }
    }
}

impl<A: Scraped> WriteAnswer<A> for ProbeFormat {
    fn write(self, answer: &A, _: &TimeSlice) -> Result<Vec<u8>, Problem> {
        let text = answer.to_open_metrics().map_err(|_| Problem::internal())?;
        Ok(match self {
            Self::OpenMetrics => text,
            Self::Prometheus => plain(&text),
        }
        .into_bytes())
    }
}

impl<A: Scraped> WriteAnswer<A> for GaugeFormat {
    fn write(self, answer: &A, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
        match self {
            Self::Json => ChartFormat::Json.write(answer, slice),
            Self::Csv => ChartFormat::Csv.write(answer, slice),
            Self::Ndjson => ChartFormat::Ndjson.write(answer, slice),
            Self::Arrow => ChartFormat::Arrow.write(answer, slice),
            Self::Svg => ChartFormat::Svg.write(answer, slice),
            Self::Png => ChartFormat::Png.write(answer, slice),
            Self::OpenMetrics => ProbeFormat::OpenMetrics.write(answer, slice),
        }
    }
}

impl<A: Watched> WriteAnswer<A> for ProgressFormat {
    fn write(self, answer: &A, slice: &TimeSlice) -> Result<Vec<u8>, Problem> {
        match self {
            Self::Json => ChartFormat::Json.write(answer, slice),
            Self::Csv => ChartFormat::Csv.write(answer, slice),
            Self::Ndjson => ChartFormat::Ndjson.write(answer, slice),
            Self::Arrow => ChartFormat::Arrow.write(answer, slice),
            Self::Progress => Ok(write::end(&write::json(answer, slice)?, answer.to_pictures()?)),
            Self::Svg => ChartFormat::Svg.write(answer, slice),
            Self::Png => ChartFormat::Png.write(answer, slice),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_has_the_formats_it_lists_and_no_other() {
        for format in Format::ALL {
            assert_eq!(TableFormat::of(format).is_some(), TableFormat::FORMATS.contains(&format), "{}", format.name());
        }
        assert_eq!(ProgressFormat::of(Format::Progress), Some(ProgressFormat::Progress));
        assert_eq!(ChartFormat::of(Format::Events), None);
    }
}
