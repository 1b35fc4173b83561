//! Measured impacts: columns, and the checks that need no model.

use super::impact_map::{STATES, T, Vector, X};
use super::statistics::median;
use std::f64::consts::{FRAC_PI_2, PI};

const THETA: usize = 0;
const X_DOT: usize = 1;
const Y_DOT: usize = 2;
const THETA_DOT: usize = 3;

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

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeasuredRow {
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

    /// Columns of the values that take part.
    pub(super) fn columns(self) -> impl Iterator<Item = usize> {
        (0..STATES).filter(move |&column| self.counts(column))
    }
}

/// Longest flight, s, where gravity is unknown. Times in ms are a thousand times as long.
const LONGEST_FLIGHT: f64 = 60.0;
/// Highest apex, m, that a scene can have: longer flights are in another unit.
const HIGHEST: f64 = 100.0;
/// Correlation from which a column follows another one, so that their ratio speaks of units.
const FOLLOWS: f64 = 0.9;
/// Fewest pairs that show it.
const FEWEST_PAIRS: usize = 5;
/// Share of angles beyond a right angle from which they are in another unit: there the centre of gravity is below the table.
const MOST_BELOW: f64 = 0.2;
/// Largest factor between a velocity and the change of its place over time that is not one of units.
const SAME_UNIT: f64 = 5.0;

impl Measured {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.columns.iter().map(Vec::len).max().unwrap_or(0)
    }

    /// Faults of the data: no times, too few impacts, columns of different length, impacts out of order, other units or signs. Gravity in
    /// m/s², `None` if it is unknown.
    pub(super) fn faults(&self, gravity: Option<f64>) -> Vec<DataError> {
        let fault = |column, row, detail: String| DataError { column, row, detail };
        let rows = self.rows();
        if self.columns[T].iter().all(Option::is_none) {
            return vec![fault("t", None, "t has no values: the times of the impacts, in s, are needed".to_owned())];
        }
        if rows < 2 {
            return vec![fault("", None, format!("there is {rows} impact; a fit needs at least 2"))];
        }
        let mut found = Vec::new();
        for (column, (name, _)) in self.columns.iter().zip(COLUMNS).filter(|(column, _)| !column.is_empty()) {
            if column.len() != rows {
                let count = column.len();
                let detail = format!("{name} has {count} values and another column {rows}; all need the same number");
                found.push(fault(name, None, detail));
            }
        }
        if !self.n.is_empty() && self.n.len() != rows {
            found.push(fault("n", None, format!("n has {} values and the columns {rows}", self.n.len())));
        }
        for (row, pair) in self.n.windows(2).enumerate().filter(|(_, pair)| pair[1] <= pair[0]) {
            let detail =
                format!("impact {} follows impact {}; numbers of impacts rise from row to row", pair[1], pair[0]);
            found.push(fault("n", Some(row + 1), detail));
        }
        let mut before = None::<f64>;
        for (row, t) in self.columns[T].iter().enumerate().filter_map(|(row, t)| Some((row, (*t)?))) {
            if let Some(before) = before.filter(|before| t <= *before) {
                let detail = format!("t is {t} s after {before} s; times of impacts rise from row to row");
                found.push(fault("t", Some(row), detail));
            }
            before = Some(t);
        }
        if let Some((row, theta)) = first(&self.columns[THETA], |theta| theta.abs() > PI) {
            let detail = format!("theta is {theta}, and an angle here is from −π to π rad; is the column in degrees?");
            found.push(fault("theta", Some(row), detail));
        }
        let angles = self.columns[THETA].iter().flatten();
        let (count, below) = (angles.clone().count(), angles.filter(|theta| theta.abs() > FRAC_PI_2).count());
        if found.is_empty() && below as f64 > MOST_BELOW * count as f64 {
            let detail = format!(
                "{below} of {count} values of theta are beyond π/2, where the body would be below the table; is the column in degrees? It must \
                 be in rad"
            );
            found.push(fault("theta", None, detail));
        }
        if found.is_empty() { self.unit_faults(gravity) } else { found }
    }

    /// Faults of units and signs, of columns without other faults.
    fn unit_faults(&self, gravity: Option<f64>) -> Vec<DataError> {
        let fault = |column, detail: String| DataError { column, row: None, detail };
        let flights = self.flights();
        let longest = gravity.map_or(LONGEST_FLIGHT, |gravity| (8.0 * HIGHEST / gravity).sqrt());
        if let Some(middle) = median(flights.iter().map(|flight| flight.1).collect())
            && middle > longest
        {
            let detail = format!(
                "half of the flights last {middle} s or longer, and {longest} s is the limit; is t in ms? It must be in s"
            );
            return vec![fault("t", detail)];
        }
        let of = |column: usize, row: usize| self.columns[column].get(row).copied().flatten();
        let mut found = Vec::new();
        for (place, velocity, other) in [(THETA, THETA_DOT, "degrees"), (X, X_DOT, "mm or cm")] {
            // Both are constant in flight, so the velocity before an impact is the change over the flight.
            let pairs = flights.iter().filter_map(|&(row, time)| {
                Some((of(velocity, row + 1)?, (of(place, row + 1)? - of(place, row)?) / time))
            });
            let (name, unit) = COLUMNS[velocity];
            let (of_place, place_unit) = COLUMNS[place];
            if let Some(ratio) = other_unit(pairs.collect()) {
                let detail = format!(
                    "{of_place} changes over a flight by {ratio} times {name} · time, where 1 is due; is one of them in {other}, or of the other \
                     sign? They must be in {place_unit} and {unit}"
                );
                found.push(fault(name, detail));
            }
        }
        if let Some(gravity) = gravity {
            let falls = flights.iter().filter_map(|&(row, time)| Some((-0.5 * gravity * time, of(Y_DOT, row + 1)?)));
            if let Some(ratio) = other_unit(falls.collect()) {
                let detail = format!(
                    "y_dot before an impact is {ratio} times −½ · {gravity} m/s² · the time of flight, where about 1 is due; is it in mm/s or cm/s, \
                     or upwards negative? It must be in m/s, and a falling body has less than 0"
                );
                found.push(fault("y_dot", detail));
            }
        }
        found
    }

    /// Flights between impacts that follow each other: the row before, and the time in s.
    fn flights(&self) -> Vec<(usize, f64)> {
        let follow = |row: usize| self.n.get(row..row + 2).is_none_or(|pair| pair[1] == pair[0] + 1);
        let times = self.columns[T].windows(2).enumerate().filter(|(row, _)| follow(*row));
        times.filter_map(|(row, pair)| Some((row, pair[1]? - pair[0]?))).collect()
    }

    /// The impacts of data without faults, in their order.
    pub(super) fn impacts(&self) -> Vec<MeasuredRow> {
        let number = |row: usize| self.n.get(row).copied().unwrap_or(row as u64 + 1);
        let value = |column: &Vec<Option<f64>>, row: usize| column.get(row).copied().flatten().unwrap_or(f64::NAN);
        let impact = |row| MeasuredRow {
            n: number(row),
            index: row,
            values: std::array::from_fn(|column| value(&self.columns[column], row)),
            outlier: [false; STATES],
        };
        (0..self.rows()).map(impact).collect()
    }
}

/// The slope of a line through the origin, if the points follow one that is no line of slope 1.
fn other_unit(points: Vec<(f64, f64)>) -> Option<f64> {
    let sum = |product: fn(f64, f64) -> f64| points.iter().map(|&(x, y)| product(x, y)).sum::<f64>();
    let (xx, xy, yy) = (sum(|x, _| x * x), sum(|x, y| x * y), sum(|_, y| y * y));
    let (slope, correlation) = (xy / xx, xy / (xx * yy).sqrt());
    let is_other = !(1.0 / SAME_UNIT..SAME_UNIT).contains(&slope);
    (points.len() >= FEWEST_PAIRS && correlation.abs() > FOLLOWS && is_other).then_some(slope)
}

fn first(column: &[Option<f64>], is_fault: impl Fn(f64) -> bool) -> Option<(usize, f64)> {
    column.iter().enumerate().find_map(|(row, value)| value.filter(|&value| is_fault(value)).map(|value| (row, value)))
}
