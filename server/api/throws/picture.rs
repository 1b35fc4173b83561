//! The picture of `throws`: path and angle of the flight.

use crate::api::formats::Pictured;
use crate::api::throws::answer::{ThrowAnswer, ThrownFlight};
use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot, chart, significant};
use crate::http::Problem;

/// Points of a curve.
const POINTS: usize = 129;

impl ThrownFlight {
    /// Time since the throw, s, and x, y and θ then, evenly over the flight.
    fn points(&self) -> impl Iterator<Item = (f64, [f64; 3])> {
        let Self { release, gravity, length } = *self;
        (0..POINTS).map(move |n| {
            let t = length * n as f64 / (POINTS - 1) as f64;
            let state = release.state;
            let y = release.height + t * (state.y_dot - 0.5 * gravity * t);
            (t, [release.x + state.x_dot * t, y, state.theta + state.theta_dot * t])
        })
    }
}

impl Pictured for ThrowAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let apex = &self.apex;
        let four = |value: f64| significant(value, 4);
        let rise = apex.t;
        let curve = |label, style, points| Curve { label, style, points };
        let time = ChartAxis::new("time after the throw", "t", "s");
        let over_time = |index: usize| self.flight.points().map(|(t, at)| (t, at[index])).collect();
        let height = Plot {
            x: time,
            y: ChartAxis::new("height of the centre of gravity", "y", "m"),
            curves: vec![
                curve("flight", CurveStyle::Truth, over_time(1)),
                curve("apex", CurveStyle::BesideDots, vec![(rise, apex.y)]),
            ],
        };
        let angle = Plot {
            x: time,
            y: ChartAxis::new("angle", "θ", "rad"),
            curves: vec![
                curve("", CurveStyle::Truth, over_time(2)),
                curve("", CurveStyle::BesideDots, vec![(rise, apex.theta)]),
            ],
        };
        Ok(chart(&Chart {
            title: "A throw to an apex of chosen height and angle",
            subtitle: format!(
                "the table strikes at α = {} rad and {} m/s along its normal",
                four(self.alpha),
                four(self.table_velocity)
            ),
            caption: format!(
                "The apex is {} s after the throw, at {} m and {} rad, {} m to the side.",
                four(rise),
                four(apex.y),
                four(apex.theta),
                four(apex.x - self.flight.release.x)
            ),
            plots: vec![height, angle],
        }))
    }
}
