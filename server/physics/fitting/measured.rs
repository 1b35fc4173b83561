//! Measured impacts: columns, and the checks that need no model.

use super::impact_map::{STATES, T, Vector};
use std::f64::consts::PI;

/// Names and units of the columns, in the order of a state.
pub const COLUMNS: [(&str, &str); STATES] =
    [("theta", "rad"), ("x_dot", "m/s"), ("y_dot", "m/s"), ("theta_dot", "rad/s"), ("x", "m"), ("t", "s")];

/// Measured impacts, one row each: states just before the impact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Numbers of the impacts, from 1 and rising, or nothing.
    pub n: Vec<u64>,
    /// A column for each of [`COLUMNS`], with `None` where a value is missing; empty if it was not measured.
    pub columns: [Vec<Option<f64>>; STATES],
}

/// A fault of the data.
#[derive(Clone, Debug, PartialEq)]
pub struct DataError {
    /// Name of the column, or "" for the data as a whole.
    pub column: &'static str,
    /// Index of the row, if it is of one.
    pub row: Option<usize>,
    /// A sentence on it.
    pub detail: String,
}

/// An impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredRow {
    /// Number of the impact.
    pub(super) n: u64,
    /// Index of its row in the data.
    pub(super) index: usize,
    /// Values, NaN where there is none.
    pub(super) values: Vector,
    /// True for values that are taken for outliers.
    pub(super) outlier: [bool; STATES],
}

impl MeasuredRow {
    /// Tells whether a value takes part in the fit.
    pub(super) fn counts(&self, column: usize) -> bool {
        !self.values[column].is_nan() && !self.outlier[column]
    }
}

/// Longest flight of which data speak, s. Times in ms are a thousand times as long.
const LONGEST_FLIGHT: f64 = 60.0;

impl Measured {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// The impacts, in their order.
    ///
    /// # Errors
    /// The first fault: no times, too few impacts, impacts out of order, an angle in degrees, times in ms.
    pub(super) fn impacts(&self) -> Result<Vec<MeasuredRow>, DataError> {
        let fault = |column, row, detail: String| Err(DataError { column, row, detail });
        let rows = self.rows();
        if self.columns[T].is_empty() {
            return fault(
                "t",
                None,
                "t is missing: the times of the impacts, in s, number them and time the flights".into(),
            );
        }
        if rows < 2 {
            return fault("", None, format!("there is {rows} impact; a fit needs at least 2"));
        }
        let lengths = self.columns.iter().zip(COLUMNS).filter(|(column, _)| !column.is_empty());
        for (column, (name, _)) in lengths {
            if column.len() != rows {
                let detail =
                    format!("{name} has {} values and another column {rows}; all need the same number", column.len());
                return fault(name, None, detail);
            }
        }
        if !self.n.is_empty() && self.n.len() != rows {
            return fault("n", None, format!("n has {} values and the columns {rows}", self.n.len()));
        }
        for (row, pair) in self.n.windows(2).enumerate() {
            if pair[1] <= pair[0] {
                let detail = format!("impact {} follows impact {}; numbers of impacts rise", pair[1], pair[0]);
                return fault("n", Some(row + 1), detail);
            }
        }
        let mut last: Option<f64> = None;
        for (row, t) in self.columns[T].iter().enumerate() {
            let (Some(t), before) = (*t, last) else { continue };
            if before.is_some_and(|before| t <= before) {
                let before = before.unwrap_or(t);
                return fault(
                    "t",
                    Some(row),
                    format!("t is {t} s after {before} s; times of impacts rise from row to row"),
                );
            }
            last = Some(t);
        }
        if let Some((row, theta)) = first(&self.columns[0], |theta| theta.abs() > PI) {
            let detail = format!("theta is {theta}, and an angle here is from −π to π rad; is the column in degrees?");
            return fault("theta", Some(row), detail);
        }
        let flights = flight_times(&self.columns[T]);
        if let Some(middle) = median(flights)
            && middle > LONGEST_FLIGHT
        {
            let detail = format!("half of the flights are longer than {middle} s; is t in ms? It must be in s");
            return fault("t", None, detail);
        }
        let number = |row: usize| self.n.get(row).copied().unwrap_or(row as u64 + 1);
        let value = |column: &Vec<Option<f64>>, row: usize| column.get(row).copied().flatten().unwrap_or(f64::NAN);
        Ok((0..rows)
            .map(|row| MeasuredRow {
                n: number(row),
                index: row,
                values: std::array::from_fn(|column| value(&self.columns[column], row)),
                outlier: [false; STATES],
            })
            .collect())
    }
}

fn first(column: &[Option<f64>], is_fault: impl Fn(f64) -> bool) -> Option<(usize, f64)> {
    column.iter().enumerate().find_map(|(row, value)| value.filter(|&value| is_fault(value)).map(|value| (row, value)))
}

fn flight_times(times: &[Option<f64>]) -> Vec<f64> {
    times.windows(2).filter_map(|pair| Some(pair[1]? - pair[0]?)).collect()
}

/// The median; `None` of nothing.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        odd if odd % 2 == 1 => Some(values[middle]),
        _ => Some(0.5 * (values[middle - 1] + values[middle])),
    }
}
