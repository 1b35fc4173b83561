//! Columns of margins in rows: for each field, side and number one, `tilt_gain_below_limit` and so on.

use crate::api::shared::margins::{ENERGY_GAIN, FEEDBACK, Margin, MarginEnd, RELEASE, SMALL, Side, TILT_GAIN};
use crate::api::shared::table::columns::RowColumn;
use crate::api::shared::table::gather::Read;

/// A row with margins.
pub trait HasMargins {
    /// The margins.
    fn margins(&self) -> &[Margin];

    /// The end of a margin.
    fn end(&self, of: &str, field: &str, side: Side) -> Option<&MarginEnd> {
        self.margins().iter().find(|margin| (margin.of, margin.field) == (of, field))?.end(side)
    }
}

/// Columns of a number of both ends of fields.
macro_rules! columns {
    ($($prefix:literal, $of:ident, $field:ident, $unit:literal;)+ => $number:ident, $about:literal, $read:expr) => {
        [$(
            columns!($prefix, "_below_", $of, $field, Below, $unit, $number, $about, $read),
            columns!($prefix, "_above_", $of, $field, Above, $unit, $number, $about, $read),
        )+]
    };
    ($prefix:literal, $way:literal, $of:ident, $field:ident, $side:ident, $unit:literal, $number:ident, $about:literal, $read:expr) => {
        RowColumn::new(
            concat!($prefix, $way, stringify!($number)),
            $unit,
            $about,
            Read::Sparse(|row| row.end($of, $field, Side::$side).and_then($read)),
        )
    };
}

/// Limits of a state feedback for small deviations.
pub const fn limits_of_feedback<Row: HasMargins>() -> [RowColumn<Row>; 2] {
    columns!["feedback", SMALL, FEEDBACK, ""; => limit, "Value at which it is lost.", |end| Some(end.limit)]
}

/// Margins of it.
pub const fn margins_of_feedback<Row: HasMargins>() -> [RowColumn<Row>; 2] {
    columns!["feedback", SMALL, FEEDBACK, ""; => margin, "Distance to it.", |end| Some(end.margin)]
}

/// Columns of a number of both ends of all gains, for small deviations.
macro_rules! of_gains {
    ($number:ident, $about:literal, $read:expr) => {
        columns![
            "tilt_gain", SMALL, TILT_GAIN, "";
            "energy_gain", SMALL, ENERGY_GAIN, "s²/m²";
            "feedback", SMALL, FEEDBACK, "";
            => $number, $about, $read
        ]
    };
}

/// Columns of a number of both ends of the gain that is searched, for the run of the release.
macro_rules! of_release {
    ($number:ident, $about:literal, $read:expr) => {
        columns![
            "release_tilt_gain", RELEASE, TILT_GAIN, "";
            "release_feedback", RELEASE, FEEDBACK, "";
            => $number, $about, $read
        ]
    };
}

/// Limits of the gains for small deviations.
pub const fn limits<Row: HasMargins>() -> [RowColumn<Row>; 6] {
    of_gains![limit, "Value at which it is lost.", |end| Some(end.limit)]
}

/// Margins of them.
pub const fn margins<Row: HasMargins>() -> [RowColumn<Row>; 6] {
    of_gains![margin, "Distance to it.", |end| Some(end.margin)]
}

/// Least margins over tolerances.
pub const fn least<Row: HasMargins>() -> [RowColumn<Row>; 6] {
    of_gains![least, "Least distance to it over the tolerances.", |end| end.least]
}

/// Limits of the gains for the run of the release.
pub const fn release_limits<Row: HasMargins>() -> [RowColumn<Row>; 4] {
    of_release![limit, "Value at which the run ends otherwise.", |end| Some(end.limit)]
}

/// Margins of them.
pub const fn release_margins<Row: HasMargins>() -> [RowColumn<Row>; 4] {
    of_release![margin, "Distance to it.", |end| Some(end.margin)]
}
