//! The picture of `catches` over time, through strikes and hold: angle, height and place of the body; tilt, height and speed of the table.

use equipoise_physics::catching::outcome::CatchStrike;
use equipoise_physics::map::strike::State;
use equipoise_physics::map::table::actuator_load::height_between;
use equipoise_physics::numbers::trig::sin_cos;
use equipoise_physics::run::lasting_contact::HoldSample;
use equipoise_physics::scene::Scene;

use crate::api::catches::answer::CatchAnswer;
use crate::api::formats::Pictured;
use crate::charts::{Chart, ChartAxis, Curve, CurveStyle, PanelNames, Plot, readable_chart};
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
        let body = |label, points| vec![Curve { label, style: CurveStyle::Truth, points }];
        let dots = |label, points| Curve { label, style: CurveStyle::BesideDots, points };
        let line = |label, points| Curve { label, style: CurveStyle::Beside, points };
        let way = Curve { label: "table between strikes", style: CurveStyle::Limit, points: way(&caught.strikes) };
        let notes: String = self.facts.notes.iter().map(|note| format!("; {note}")).collect();
        let drawn = Chart {
            title: "A falling body, caught and held by a table",
            subtitle: format!("{}: {}", self.outcome.kind, self.outcome.detail),
            caption: format!("Strategy {}: {}{}", self.strategy.name, self.strategy.reason, notes),
            plots: vec![
                plot("angle of the body", "θ", "rad", body("body", motion.theta)),
                plot(
                    "tilt of the table",
                    "α",
                    "rad",
                    vec![
                        dots("table at strikes", strikes(|at| at.strike.alpha)),
                        line("table in contact", held(|sample| sample.alpha)),
                    ],
                ),
                plot("height of the body", "y", "m", body("", motion.y)),
                plot(
                    "height of the table",
                    "",
                    "m",
                    vec![way, dots("", strikes(|_| 0.0)), line("", held(|sample| sample.table_y))],
                ),
                plot("place of the body", "x", "m", body("", motion.x)),
                plot(
                    "speed of the table",
                    "w",
                    "m/s",
                    vec![dots("", strikes(|at| at.strike.table_speed())), line("", held(|sample| sample.table_y_dot))],
                ),
            ],
        };
        Ok(readable_chart(&drawn, &PANELS))
    }
}

/// Names of the panels and curves for a page. Those of the body are on the left, those of the table on the right.
static PANELS: [PanelNames; 6] = [
    PanelNames { panel: "theta", curves: &["body"] },
    PanelNames { panel: "alpha", curves: &["strikes", "contact"] },
    PanelNames { panel: "y", curves: &["body"] },
    PanelNames { panel: "table_y", curves: &["way", "strikes", "contact"] },
    PanelNames { panel: "x", curves: &["body"] },
    PanelNames { panel: "table_speed", curves: &["strikes", "contact"] },
];

/// Height of the table from strike to strike: the way whose range is the stroke of the demand.
fn way(strikes: &[CatchStrike]) -> Points {
    let vertical = |at: &CatchStrike| at.strike.table_velocity.1;
    let pairs = strikes.windows(2).take(FLIGHTS);
    let between = pairs.flat_map(|pair| {
        let (t, time) = (pair[0].t, pair[0].flight_time.unwrap_or(0.0));
        let velocities = (vertical(&pair[0]), vertical(&pair[1]));
        let share = |n: usize| n as f64 / (POINTS - 1) as f64;
        (0..POINTS).map(move |n| (t + time * share(n), height_between(velocities, time, share(n))))
    });
    between.collect()
}
