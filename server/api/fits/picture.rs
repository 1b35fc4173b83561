//! The picture of `fits`: residuals over the impacts, a panel for each measured column.

use equipoise_physics::fitting::{COLUMNS, FittedRow};
use schemars::JsonSchema;

use crate::api::fits::answer::FitAnswer;
use crate::api::formats::{Pictured, Watched};
use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot, chart, significant};
use crate::http::Problem;

/// Symbols of the columns.
const SYMBOLS: [&str; COLUMNS.len()] = ["δθ", "δẋ", "δẏ", "δθ̇", "δx", "δt"];

impl Pictured for FitAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let plots = (0..COLUMNS.len())
            .filter(|&column| self.rows.iter().any(|row| row.residuals[column].is_some()))
            .enumerate()
            .map(|(place, column)| {
                let points = |is_outlier: bool| {
                    let taken = self.rows.iter().filter(move |row| row.outliers[column] == is_outlier);
                    taken.filter_map(move |row: &FittedRow| Some((row.n as f64, row.residuals[column]?))).collect()
                };
                let (name, unit) = COLUMNS[column];
                // The first panel has the labels of all.
                let label = |label| if place == 0 { label } else { "" };
                Plot {
                    x: ChartAxis::new("impact", "n", ""),
                    y: ChartAxis::new(name, SYMBOLS[column], unit),
                    curves: vec![
                        Curve { label: label("residual"), style: CurveStyle::TruthDots, points: points(false) },
                        Curve { label: label("outlier"), style: CurveStyle::WrongRings, points: points(true) },
                    ],
                }
            })
            .collect();
        let told = self.estimates.iter().map(|estimate| {
            let value = significant(estimate.value, 6);
            let unit = if estimate.unit == "1" { "" } else { estimate.unit };
            estimate.sd.map_or_else(
                || format!("{} is not told", estimate.field),
                |sd| format!("{} = {value} ± {} {unit}", estimate.field, significant(sd, 2)),
            )
        });
        Ok(chart(&Chart {
            title: "Measured less fitted impacts",
            subtitle: told.collect::<Vec<_>>().join(", "),
            caption: format!(
                "χ² is {} at {} degrees of freedom.",
                significant(self.chi_squared, 4),
                self.degrees_of_freedom
            ),
            plots,
        }))
    }
}

impl Watched for FitAnswer {
    fn to_pictures(&self) -> Result<Vec<(&'static str, String)>, Problem> {
        Ok(vec![("residuals", self.to_picture()?)])
    }
}

/// The last line of a fit with progress. Without it or a problem the answer is incomplete.
#[derive(JsonSchema)]
#[schemars(rename = "FitProgressEnd")]
#[expect(dead_code, reason = "a schema alone")]
pub(super) struct LineOfAnswer {
    end: FitAnswer,
    pictures: Pictures,
}

/// Pictures as SVG, the same bytes as with `format=svg`.
#[derive(JsonSchema)]
#[schemars(rename = "FitPictures")]
#[expect(dead_code, reason = "a schema alone")]
struct Pictures {
    residuals: String,
}
