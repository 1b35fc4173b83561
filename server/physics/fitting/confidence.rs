//! Standard deviations, intervals and correlations of fitted fields, and the fields that the data do not tell.

use super::elimination::Block;
use super::statistics::{NORMAL_975, student_quantile};
use crate::numbers::rounded::rounded;
use crate::scene::{Draft, Name, Value};
use nalgebra::{DMatrix, SVD};

/// A fitted field.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Field.
    pub name: Name,
    /// Best value, in the unit of the field.
    pub value: f64,
    /// Standard deviation; `None` if the data do not tell.
    pub sd: Option<f64>,
    /// Ends of the 95 % interval, cut to the range of the field; `None` if the data do not tell.
    pub interval: Option<(f64, f64)>,
    /// Reason why the data do not tell, or what was done to the interval.
    pub detail: Option<String>,
}

impl Estimate {
    /// True if the data tell the value.
    pub fn is_identifiable(&self) -> bool {
        self.sd.is_some()
    }
}

/// Change of the data, in standard deviations, below which a field that moves by its whole scale does not act on the motion.
const NO_EFFECT: f64 = 1e-3;

/// Least singular value that is told from rounding.
const LEAST_SINGULAR: f64 = 1e-6;

/// Share of a direction from which a field takes part in it.
const TAKES_PART: f64 = 0.2;

/// Correlation from which an estimate moves with another one, so that the data tell both or none.
const MOVES_WITH: f64 = 0.95;

/// Covariance of the fields by the data, in units of their scales.
#[derive(Clone, Debug)]
pub(super) struct Information {
    /// Scale of each field: a standard deviation as large tells nothing.
    pub(super) scales: Vec<f64>,
    /// Covariance over the scales.
    covariance: DMatrix<f64>,
    /// Reason for which a field is not told, if it is not.
    pub(super) untold: Vec<Option<String>>,
    /// Standard deviation of each field over that of the curvature, at least 1.
    factors: Vec<f64>,
}

/// Size of a field beside which a standard deviation is large.
pub(super) fn scale(name: Name, value: f64, typed: f64) -> f64 {
    let (minimum, maximum) = name.row().range();
    value.abs().max(typed.abs()).max((maximum - minimum) / 200.0)
}

impl Information {
    /// By the factor of (J_p | r) with the windows' own unknowns eliminated, and the blocks before that. `shifts` has the reasons for which
    /// fields cannot be told beside the place of the body.
    pub(super) fn new(
        draft: &Draft,
        (names, shifts): (&[Name], &[Option<String>]),
        (values, typed): (&[f64], &[f64]),
        reduced: &DMatrix<f64>,
        blocks: &[Block],
    ) -> Self {
        let fields = names.len();
        let scales: Vec<f64> = (0..fields).map(|field| scale(names[field], values[field], typed[field])).collect();
        let no_effect = |field: usize| (!acts(blocks, field, scales[field])).then(|| no_effect(draft, names[field]));
        let untold = Vec::from_iter((0..fields).map(|field| shifts[field].clone().or_else(|| no_effect(field))));
        let acting: Vec<usize> = (0..fields).filter(|&field| untold[field].is_none()).collect();
        let mut found = Self::blank(scales, untold);
        if acting.is_empty() {
            return found;
        }
        let Self { scales, covariance, untold, .. } = &mut found;
        let mut matrix = reduced.rows(0, fields).select_columns(&acting);
        for (mut column, &field) in matrix.column_iter_mut().zip(&acting) {
            column *= scales[field];
        }
        let Some(SVD { v_t: Some(directions), singular_values, .. }) =
            SVD::try_new(matrix, false, true, f64::EPSILON, 10_000)
        else {
            untold.fill(Some("the linear algebra of the intervals did not converge".to_owned()));
            return found;
        };
        let mut open = directions.clone();
        for (mut direction, value) in open.row_iter_mut().zip(&singular_values) {
            direction /= value.max(LEAST_SINGULAR);
        }
        let products = open.tr_mul(&open);
        for (row, &one) in acting.iter().enumerate() {
            for (column, &other) in acting.iter().enumerate() {
                covariance[(one, other)] = products[(row, column)];
            }
        }
        for (place, &field) in acting.iter().enumerate() {
            if covariance[(field, field)] <= 1.0 {
                continue;
            }
            let weak = open.column(place).iamax();
            let partners: Vec<&str> = (0..acting.len())
                .filter(|&other| other != place && directions[(weak, other)].abs() > TAKES_PART)
                .map(|other| names[acting[other]].row().path)
                .collect();
            let row = names[field].row();
            let sd = covariance[(field, field)].sqrt() * scales[field];
            untold[field] = Some(if partners.is_empty() {
                format!(
                    "the data leave {} open: its standard deviation would be {sd:e} {}, as large as the value itself or a 200th of its range",
                    row.path, row.unit
                )
            } else {
                format!(
                    "only a combination of {} with {} acts on the measured motion; say one of them",
                    row.path,
                    partners.join(" and ")
                )
            });
        }
        found
    }

    fn blank(scales: Vec<f64>, untold: Vec<Option<String>>) -> Self {
        let fields = scales.len();
        Self { scales, covariance: DMatrix::zeros(fields, fields), untold, factors: vec![1.0; fields] }
    }

    /// Without derivatives, because runs end a step beside the values.
    pub(super) fn missing(names: &[Name]) -> Self {
        let reason = "runs of the model end a step beside the best values, so there is no standard deviation";
        Self::blank(vec![1.0; names.len()], vec![Some(reason.to_owned()); names.len()])
    }

    /// Leaves untold each field that is above 0 by its range and not told from 0, and the fields that move with one that is not told: their
    /// curvature holds only as far as the untold one is near its value.
    pub(super) fn withdraw(&mut self, names: &[Name], values: &[f64]) {
        for (field, (&name, &value)) in names.iter().zip(values).enumerate() {
            let sd = self.sd(field);
            if self.untold[field].is_none() && name.row().range().0 > 0.0 && sd >= value {
                let row = name.row();
                let detail = format!(
                    "the data do not tell {} from 0: its standard deviation would be {} {unit}, and its value is {} {unit}",
                    row.path,
                    rounded(sd),
                    rounded(value),
                    unit = row.unit
                );
                self.untold[field] = Some(detail);
            }
        }
        let untold: Vec<usize> = (0..names.len()).filter(|&field| self.untold[field].is_some()).collect();
        for field in 0..names.len() {
            if self.untold[field].is_some() {
                continue;
            }
            let strongest = (untold.iter().map(|&other| (other, self.correlation(field, other))))
                .filter(|(_, correlation)| correlation.abs() > MOVES_WITH)
                .max_by(|one, other| one.1.abs().total_cmp(&other.1.abs()));
            if let Some((other, correlation)) = strongest {
                let (path, other) = (names[field].row().path, names[other].row().path);
                self.untold[field] = Some(format!(
                    "{path} moves with {other}, which the data do not tell: their correlation is {}; give {other} a known value",
                    rounded(correlation)
                ));
            }
        }
    }

    /// Correlation of two fields by the curvature; NaN of one that does not act.
    fn correlation(&self, one: usize, other: usize) -> f64 {
        let variances = self.covariance[(one, one)] * self.covariance[(other, other)];
        self.covariance[(one, other)] / variances.sqrt()
    }

    /// Takes the standard deviation of a field, and of those that move with it, for so many times that of the curvature.
    pub(super) fn widen(&mut self, field: usize, factor: f64) {
        for other in 0..self.factors.len() {
            if other == field || self.correlation(field, other).abs() > MOVES_WITH {
                self.factors[other] = self.factors[other].max(factor);
            }
        }
    }

    pub(super) fn stretch(&mut self) {
        let factors = &self.factors;
        let stretched = |row: usize, column: usize| self.covariance[(row, column)] * factors[row] * factors[column];
        self.covariance = DMatrix::from_fn(factors.len(), factors.len(), stretched);
    }

    /// Standard deviation of a field at unit variance of the data.
    pub(super) fn sd(&self, field: usize) -> f64 {
        self.covariance[(field, field)].sqrt() * self.scales[field]
    }

    /// Covariance of two fields, in their units; 0 if one of them is not told.
    pub(super) fn covariance(&self, one: usize, other: usize) -> f64 {
        if self.untold[one].is_some() || self.untold[other].is_some() {
            return 0.0;
        }
        self.covariance[(one, other)] * self.scales[one] * self.scales[other]
    }

    /// The estimates. With standard deviations that were estimated too, intervals are Student's with `freedom` degrees of freedom.
    pub(super) fn estimates(&self, names: &[Name], values: &[f64], estimated: bool, freedom: f64) -> Vec<Estimate> {
        let width = if estimated { student_quantile(freedom) } else { NORMAL_975 };
        let of_field = |field: usize| {
            let (name, value) = (names[field], values[field]);
            if let Some(detail) = &self.untold[field] {
                return Estimate { name, value, sd: None, interval: None, detail: Some(detail.clone()) };
            }
            let sd = self.sd(field);
            let (minimum, maximum) = name.row().range();
            let (low, high) = (value - width * sd, value + width * sd);
            let is_cut = low < minimum || high > maximum;
            let cut = is_cut
                .then(|| format!("the interval is cut to the range of {}, {}", name.row().path, name.row().limits()));
            let factor = self.factors[field];
            let wide = (factor > 1.0).then(|| {
                let times = rounded(factor);
                format!("the standard deviation is {times} times that of the curvature, since chi_squared rises less on one side")
            });
            let details: Vec<String> = wide.into_iter().chain(cut).collect();
            let detail = (!details.is_empty()).then(|| details.join("; "));
            Estimate { name, value, sd: Some(sd), interval: Some((low.max(minimum), high.min(maximum))), detail }
        };
        (0..names.len()).map(of_field).collect()
    }
}

/// Tells whether a field changes the data, if it moves by its scale.
pub(super) fn acts(blocks: &[Block], field: usize, scale: f64) -> bool {
    let squares: f64 = blocks.iter().map(|block| block.rows.column(block.own + field).norm_squared()).sum();
    squares.sqrt() * scale > NO_EFFECT
}

/// Reason why a field has no effect on the motion.
fn no_effect(draft: &Draft, name: Name) -> String {
    let path = name.row().path;
    let is_compensated = draft.get(Name::Strike) != Some(Value::Choice("still"));
    if name == Name::Restitution && is_compensated && draft.get(Name::AssumedRestitution).is_none() {
        return format!(
            "the table makes up what {path} loses (table.strike `compensated`, and it believes the true value), so it drops out of the \
             motion; measure with a table that stands still, or give table.assumed_restitution"
        );
    }
    format!("the measured motion does not depend on {path}")
}
