//! The picture of `catches`: angles, height, place and table speed over time, through strikes and hold.

use equipoise_physics::bounce::state::State;
use equipoise_physics::catching::outcome::CatchStrike;
use equipoise_physics::contact::HoldSample;
use equipoise_physics::numbers::trig::sin_cos;
use equipoise_physics::scene::Scene;

use crate::api::catches::answer::CatchAnswer;
use crate::api::formats::Pictured;
use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, Plot, chart};
use crate::http::Problem;

/// Points of a flight.
const POINTS: usize = 17;

/// Flights that are drawn with points of their own; the later ones are shorter than a pixel.
const FLIGHTS: usize = 128;

/// Points (time, value) of a curve.
type Points = Vec<(f64, f64)>;

/// The motion of the body over time: angle, height and place of the centre of gravity.
#[derive(Debug, Default)]
struct Motion {
    theta: Points,
    y: Points,
    x: Points,
}

/// A flight from its start.
struct Flight {
    t: f64,
    x: f64,
    y: f64,
    start: State,
    length: f64,
}

impl Motion {
    /// The fall, the flights between strikes, and the hold.
    fn new(scene: &Scene, strikes: &[CatchStrike], hold: &[HoldSample]) -> Self {
        let mut motion = Self::default();
        let gravity = scene.gravity();
        let length = scene.parameters::<f64>().contact_distance;
        let height = |theta: f64| length * sin_cos(theta).1;
        let release = scene.release();
        let first = strikes.first().map(|strike| strike.t).or(hold.first().map(|sample| sample.t));
        if let Some(length) = first {
            let (x, y, start) = (release.x, release.height, release.state);
            motion.fly(gravity, &Flight { t: 0.0, x, y, start, length });
        }
        for at in strikes.iter().take(FLIGHTS) {
            if let Some(length) = at.flight_time {
                let y = height(at.state.theta) + at.clearance;
                motion.fly(gravity, &Flight { t: at.t, x: at.x, y, start: at.strike.after, length });
            }
        }
        for sample in hold {
            motion.theta.push((sample.t, sample.theta));
            motion.y.push((sample.t, sample.table_y + height(sample.theta)));
            motion.x.push((sample.t, sample.x));
        }
        motion
    }

    fn fly(&mut self, gravity: f64, flight: &Flight) {
        for n in 0..POINTS {
            let since = flight.length * n as f64 / (POINTS - 1) as f64;
            let (t, start) = (flight.t + since, &flight.start);
            self.theta.push((t, start.theta + start.theta_dot * since));
            self.y.push((t, flight.y + since * (start.y_dot - 0.5 * gravity * since)));
            self.x.push((t, flight.x + start.x_dot * since));
        }
    }
}

impl Pictured for CatchAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let (scene, caught) = &self.drawn;
        let hold = caught.hold.as_ref().map_or(&[][..], |hold| &hold.samples);
        let motion = Motion::new(scene, &caught.strikes, hold);
        let strikes = |read: fn(&CatchStrike) -> f64| caught.strikes.iter().map(|at| (at.t, read(at))).collect();
        let held = |read: fn(&HoldSample) -> f64| hold.iter().map(|sample| (sample.t, read(sample))).collect();
        let time = ChartAxis::new("time", "t", "s");
        let plot = |name, symbol, unit, curves| Plot { x: time, y: ChartAxis::new(name, symbol, unit), curves };
        let body = |label, points| Curve { label, style: CurveStyle::Truth, points };
        let dots = |label, points| Curve { label, style: CurveStyle::BesideDots, points };
        let line = |label, points| Curve { label, style: CurveStyle::Beside, points };
        Ok(chart(&Chart {
            title: "A falling body, caught and held by a table",
            subtitle: format!("{}: {}", self.outcome.kind, self.outcome.detail),
            caption: format!("Strategy {}: {}. {}", self.strategy.name, self.strategy.reason, self.notes.join("; ")),
            plots: vec![
                plot(
                    "angle",
                    "θ, α",
                    "rad",
                    vec![
                        body("body", motion.theta),
                        dots("table at strikes", strikes(|at| at.strike.alpha)),
                        line("table in contact", held(|sample| sample.alpha)),
                    ],
                ),
                plot("height of the centre of gravity", "y", "m", vec![body("", motion.y)]),
                plot("place of the centre of gravity", "x", "m", vec![body("", motion.x)]),
                plot(
                    "speed of the table",
                    "w",
                    "m/s",
                    vec![dots("", strikes(|at| at.strike.table_speed())), line("", held(|sample| sample.table_y_dot))],
                ),
            ],
        }))
    }
}
