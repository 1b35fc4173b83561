//! The picture of `precision`: error over cost.

use crate::api::formats::{Pictured, Watched};
use crate::api::precision::answer::{PrecisionAnswer, PrecisionOutcome};
use crate::api::precision::request::CostAxis;
use crate::charts::{CostAndError, SYMBOLS, Series, SpeedAccuracy, speed_accuracy};
use crate::comparison::{METHODS, WorkPrecisionPoint};
use crate::http::Problem;

const _: () = assert!(SYMBOLS.len() == METHODS.len(), "each method has a symbol of its own");

impl Pictured for PrecisionAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        Ok(self.draw(self.axis))
    }
}

impl Watched for PrecisionAnswer<'_> {
    /// The picture over each cost: no second request has the same measurement.
    fn to_pictures(&self) -> Result<Vec<(&'static str, String)>, Problem> {
        Ok(CostAxis::ALL.map(|(name, axis)| (name, self.draw(axis))).into())
    }
}

impl PrecisionAnswer<'_> {
    fn draw(&self, axis: CostAxis) -> String {
        let (cost_name, unit) = match axis {
            CostAxis::Time => ("clock time", "ns per impact"),
            CostAxis::Evaluations => ("evaluations of motion and gap", "per impact"),
            CostAxis::Steps => ("steps", "per impact"),
        };
        let cost = |point: &WorkPrecisionPoint| match axis {
            CostAxis::Time => point.cost_ns(),
            CostAxis::Evaluations => point.evaluations_per_bounce().map(|count| [count; 3]),
            CostAxis::Steps => point.steps_per_bounce().map(|count| [count; 3]),
        };
        let is_first = |point: &WorkPrecisionPoint| match axis {
            CostAxis::Time => point.pareto,
            CostAxis::Evaluations => point.pareto_evaluations,
            CostAxis::Steps => false,
        };
        let points = &self.chart.points;
        let place = |point: &WorkPrecisionPoint| cost(point).filter(|cost| cost[1] > 0.0).zip(point.error);
        let series: Vec<Series<'_>> = METHODS
            .iter()
            .zip(SYMBOLS)
            .map(|(method, symbol)| {
                let own = points.iter().enumerate().filter(|(_, point)| point.method == *method);
                let own = own
                    .filter_map(|(index, point)| place(point).map(|(cost, error)| CostAndError { index, cost, error }));
                Series { symbol, name: method.name, label: method.title, points: own.collect() }
            })
            .filter(|series| !series.points.is_empty())
            .collect();
        let front: Vec<_> = points
            .iter()
            .filter(|point| is_first(point))
            .filter_map(|point| place(point).map(|(cost, error)| (cost[1], error)))
            .collect();
        let PrecisionOutcome { kind, bounces, .. } = self.reference.outcome;
        let missing: Vec<String> = self
            .methods
            .iter()
            .filter(|method| method.name != "extended" && series.iter().all(|series| series.label != method.title))
            .map(|method| method.title.to_owned())
            .collect();
        let bars = if axis == CostAxis::Time { "; bars are quartiles" } else { "" };
        let front_in_words = match axis {
            CostAxis::Time | CostAxis::Evaluations => "No point lies below the Pareto front.",
            CostAxis::Steps => "Steps of different methods are different work, so there is no front.",
        };
        let mut caption = format!("Each point is a step or a tolerance{bars}. {front_in_words}");
        if let Some([_, cost_ns, _]) =
            points.iter().find(|point| point.method.name == "extended").and_then(WorkPrecisionPoint::cost_ns)
        {
            caption += &format!(" The reference takes {cost_ns:.0} ns per impact.");
        }
        if !missing.is_empty() {
            caption += &format!(" Not drawn, since their runs end otherwise or not at all: {}.", missing.join(", "));
        }
        speed_accuracy(&SpeedAccuracy {
            title: "Speed against accuracy",
            subtitle: &format!(
                "{}, {bounces} bounces, {kind}: how far methods end from the run with 31 digits",
                self.model.name.replace('_', " ")
            ),
            caption: &caption,
            cost: (cost_name, unit),
            error: &format!("error at impact {bounces}"),
            series: &series,
            front: &front,
            rounding: self.reference.rounding,
        })
    }
}
